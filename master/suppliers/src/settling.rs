//! The phase before t = 0 in which a supplied pantograph or line comes to rest with the other side.
//!
//! The state of rest of such a side is known to its FMU only, so line and pantographs are run without travelling until
//! the contact force stays the same. A line of this program is that of the core with more damping on its masses, which
//! does not enter where it comes to rest; what is handed on is the height of the strip, from which the statics of the
//! line follow as for any other start. An FMU goes on from where it has come to: its clock is then ahead of the run's
//! by the length of the phase.

use std::sync::atomic::{AtomicBool, Ordering};

use scene::{Line, PantographModel, Scene, Start};

use crate::{SuppliedLine, SuppliedPantograph};
use component::exchange::{contact, line_output_count, load, strip};
use cosim::inprocess::InProcess;
use cosim::slave::{Slave, SlaveError};

/// Change of the contact force that counts as rest, N/s.
pub const REST: f64 = 0.1;

/// Longest phase, s.
pub const LONGEST: f64 = 20.0;

/// Time over which the change is observed, s: half a period of a span's lowest mode at least.
const WINDOW: f64 = 0.5;

/// Longest step, s, for FMUs that take any.
const STEP: f64 = 1e-3;

/// Least damping of the line's masses, 1/s: near critical for modes of 1 Hz, the lowest of a span.
const MASS_DAMPING: f64 = 6.0;

/// Reason for a phase at rest that could not be completed.
#[derive(Debug, thiserror::Error)]
pub enum SettlingError {
    /// The line has no static state.
    #[error("the line of the scene")]
    Line(#[from] catenary::CatenaryError),
    /// The other sides have no start beside those that have settled.
    #[error("the state at t = 0")]
    Equilibrium(#[from] system::equilibrium::EquilibriumError),
    /// A pantograph cannot be built.
    #[error("pantograph[{pantograph}]")]
    Pantograph {
        /// From 1.
        pantograph: usize,
        /// Reason.
        #[source]
        source: vehicle::VehicleError,
    },
    /// A side does not take the start or the end of the phase.
    #[error(transparent)]
    Slave(#[from] SlaveError),
    /// A side fails during the phase.
    #[error("while line and pantographs stand still before t = 0")]
    Step(#[source] SlaveError),
    /// An end was asked for meanwhile.
    #[error(
        "interrupted after {t:.3} s of at most {longest} s in which line and pantographs come to rest before t = 0: \
         nothing is written"
    )]
    Interrupted {
        /// Simulated time at rest, s.
        t: f64,
        /// Longest phase, s.
        longest: f64,
    },
}

impl SettlingError {
    /// True where the input is to blame, not the program.
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Line(_) | Self::Equilibrium(_))
    }
}

/// End of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Length of the phase, s.
    pub duration: f64,
    /// Communication steps taken.
    pub steps: u64,
    /// Change of the contact force that was left, N/s.
    pub change: f64,
}

/// The sides of a standing pair and what they exchange.
struct Pair<'a> {
    line: &'a mut dyn Slave,
    pantographs: Vec<&'a mut dyn Slave>,
    contacts: Vec<f64>,
    strips: Vec<f64>,
    motions: Vec<f64>,
}

impl Pair<'_> {
    fn read_strips(&mut self) -> Result<(), SlaveError> {
        let outputs = self.strips.chunks_exact_mut(strip::OUTPUTS);
        self.pantographs
            .iter_mut()
            .zip(outputs)
            .try_for_each(|(slave, values)| slave.outputs(values))
    }

    /// Steps the line, then the pantographs under its mean forces.
    fn step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        let motions = self.motions.chunks_exact_mut(strip::MOTION);
        for (motion, strip) in motions.zip(self.strips.chunks_exact(strip::OUTPUTS)) {
            motion.copy_from_slice(&strip[..strip::MOTION]);
        }
        self.line.set_inputs(&self.motions)?;
        self.line.do_step(t, h)?;
        self.line.outputs(&mut self.contacts)?;
        let contacts = self.contacts.chunks_exact(contact::COUNT);
        for (pantograph, contact) in self.pantographs.iter_mut().zip(contacts) {
            let mut given = [0.0; load::COUNT];
            given[..load::Y].copy_from_slice(&contact[contact::MEAN_FX..=contact::MEAN_FZ]);
            given[load::Y] = contact[contact::Y];
            pantograph.set_inputs(&given)?;
            pantograph.do_step(t, h)?;
        }
        self.read_strips()
    }

    fn forces(&self) -> impl Iterator<Item = f64> {
        self.contacts
            .chunks_exact(contact::COUNT)
            .map(|contact| contact[contact::FORCE])
    }

    /// Steps until the forces stay the same, all contacts being closed.
    fn settle(&mut self, h: f64, interrupted: &AtomicBool) -> Result<Settling, SettlingError> {
        let failed = SettlingError::Step;
        self.line.outputs(&mut self.contacts).map_err(failed)?;
        self.read_strips().map_err(failed)?;
        let window = (WINDOW / h).ceil() as u64;
        let mut n = 0;
        loop {
            let mut range: Vec<(f64, f64)> = self.forces().map(|force| (force, force)).collect();
            for _ in 0..window {
                if interrupted.load(Ordering::Relaxed) {
                    let (t, longest) = (n as f64 * h, LONGEST);
                    return Err(SettlingError::Interrupted { t, longest });
                }
                self.step(n as f64 * h, h).map_err(failed)?;
                n += 1;
                for (range, force) in range.iter_mut().zip(self.contacts.chunks_exact(contact::COUNT)) {
                    let force = force[contact::FORCE];
                    *range = (range.0.min(force), range.1.max(force));
                }
            }
            let widest = range.iter().map(|(least, most)| most - least).fold(0.0, f64::max);
            let found = Settling {
                duration: n as f64 * h,
                steps: n,
                change: widest / (window as f64 * h),
            };
            let closed = self.forces().all(|force| force > 0.0);
            if closed && found.change < REST || found.duration + WINDOW > LONGEST * (1.0 + 1e-9) {
                return Ok(found);
            }
        }
    }
}

/// The step of the phase, s: as short as wanted where every FMU takes any, else what they take.
fn step(macro_step: f64, units: &[Option<f64>], any_step: bool) -> f64 {
    let mut units = units.iter().flatten();
    match (units.next(), units.next()) {
        // Whole steps of the one that is bound.
        (Some(unit), None) if *unit <= macro_step => unit * (macro_step.min(STEP) / unit + 1e-9).floor().max(1.0),
        (None, _) if any_step => macro_step.min(STEP),
        _ => macro_step,
    }
}

/// Brings `supplied` pantographs, and a supplied line, to rest and writes into the scene where they have come to,
/// and the start of the others beside them.
///
/// # Errors
/// A side that cannot be built, or that fails while it stands; an end asked for meanwhile.
pub fn settle(
    scene: &mut Scene,
    statics: Option<&catenary::StaticLine>,
    mut other_line: Option<&mut SuppliedLine>,
    supplied: &mut [Option<SuppliedPantograph>],
    interrupted: &AtomicBool,
) -> Result<Settling, SettlingError> {
    if let Some(statics) = statics {
        // What the scene says of the others was found beside the pantographs at rest: a resolved scene takes the same
        // way again.
        forget_own_starts(scene);
        system::equilibrium::resolve(scene, statics)?;
    }
    let mut still = scene.clone();
    still.run.speed = 0.0;
    if let Line::Modelled(line) = &mut still.catenary {
        line.damping.alpha = line.damping.alpha.max(MASS_DAMPING);
    }
    let mut own: Vec<Option<InProcess<vehicle::Subsystem>>> = Vec::new();
    for (index, pantograph) in supplied.iter_mut().enumerate() {
        own.push(match pantograph {
            Some(pantograph) => {
                pantograph.stand()?;
                None
            }
            None => {
                let refused = |source| SettlingError::Pantograph {
                    pantograph: index + 1,
                    source,
                };
                Some(InProcess::pantograph(&still, index).map_err(refused)?)
            }
        });
    }
    let of_pantographs = supplied.iter().flatten();
    let mut units: Vec<Option<f64>> = of_pantographs.clone().map(SuppliedPantograph::unit).collect();
    let mut any_step = of_pantographs
        .clone()
        .all(|pantograph| pantograph.abilities().variable_step);
    if let Some(line) = &mut other_line {
        line.stand();
        units.push(line.unit());
        any_step &= line.abilities().variable_step;
    }
    let h = step(scene.coupling.macro_step, &units, any_step);
    let mut core;
    let line: &mut dyn Slave = match &mut other_line {
        Some(line) => *line,
        None => {
            core = InProcess::line(&still, &[])?;
            &mut core
        }
    };
    let strips = supplied.len();
    let mut pair = Pair {
        line,
        pantographs: supplied
            .iter_mut()
            .zip(&mut own)
            .filter_map(|pair| -> Option<&mut dyn Slave> {
                match pair {
                    (Some(pantograph), _) => Some(pantograph),
                    (None, own) => own.as_mut().map(|own| -> &mut dyn Slave { own }),
                }
            })
            .collect(),
        contacts: vec![0.0; line_output_count(strips, 0)],
        strips: vec![0.0; strips * strip::OUTPUTS],
        motions: vec![0.0; strips * strip::MOTION],
    };
    let found = pair.settle(h, interrupted)?;
    let forces: Vec<f64> = pair.forces().collect();
    let heights: Vec<f64> = pair
        .strips
        .chunks_exact(strip::OUTPUTS)
        .map(|strip| strip[strip::Z])
        .collect();
    let line_is_other = other_line.is_some();
    for (index, pantograph) in supplied.iter_mut().enumerate() {
        if let Some(pantograph) = pantograph {
            pantograph.depart(found.duration)?;
        }
        if pantograph.is_some() || line_is_other {
            scene.pantographs[index].start = Some(Start {
                height: heights[index],
                force: forces[index],
            });
        }
    }
    if let Some(line) = other_line {
        line.depart(found.duration)?;
    }
    if let Some(statics) = statics {
        forget_own_starts(scene);
        system::equilibrium::resolve(scene, statics)?;
    }
    Ok(found)
}

fn forget_own_starts(scene: &mut Scene) {
    for pantograph in &mut scene.pantographs {
        if !matches!(pantograph.model, PantographModel::Supplied(_)) {
            pantograph.start = None;
        }
    }
}
