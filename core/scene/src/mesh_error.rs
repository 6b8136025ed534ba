//! What error a mesh is expected to make, and the mesh for an error.
//!
//! The rule is interpolated between measurements, and good to a factor of about two. An element of length `l` is measured against the
//! waves that carry a force of the low-pass frequency `f`: `c/f` behind a source at rest, `(c − v)/f` ahead of one that moves,
//!
//! ```text
//! μ = l f / √(c (c − v))
//! space:  a μ²    plain; half of it with one of contact_compliance and bending_layers
//!         b μ⁴    with both
//! time:   d (h f)²    d smaller with mass_correction
//! error of the filtered force, % of its standard deviation: √(space² + time²)
//! ```
//!
//! with the slower wave of the two wires, the longest element and the internal step `h`.

use crate::{Catenary, ContactLaw, Cure, Division, Scene};

/// Of the plain mesh, %. Measured with 4, 8 and 16 elements between droppers at 0.5 and 1 ms, against 12 cured ones at 0.25 ms, on
/// seven spans of EN 50318 at 250 and 300 km/h and eight of the thesis' line at 200 km/h under a lumped pantograph: 67 to 102.
const PLAIN: f64 = 80.0;
/// Share of it that is left with one cure; measured 0.44 to 0.73.
const WITH_ONE_CURE: f64 = 0.5;
/// Of the mesh with both cures, %. Measured with 4, 6 and 8 elements likewise: 89 to 250.
const CURED: f64 = 200.0;
/// Of the time step, %: at 1 ms and 20 Hz 2 %.
const STEP: f64 = 5000.0;
/// Of the time step with the mass correction, %: at 1 ms and 20 Hz 0.2 %. Measured with 8 elements of up to 0.81 m on the line of
/// EN 50318 at 300 and 250 km/h between 1 and 1.5 ms: 0.12 to 0.2 % per ms²; on that of the thesis between 0.5 and 1.5 ms 0.3 to 0.35.
const CORRECTED_STEP: f64 = 500.0;
/// The same of a sliding joint, whose force is not corrected as it moves, %: at 1 ms and 20 Hz 0.3 %.
const CORRECTED_STEP_OF_JOINT: f64 = 750.0;
/// An error that the rule does not go below, %: that of the measurements.
const LEAST: f64 = 0.3;
/// An error beyond which a mesh gives no force at all, %.
const MOST: f64 = 100.0;
/// Micro steps that the rule chooses from, s: those between 1 and 2 ms are what the mass correction of even elements takes.
const STEPS: [f64; 8] = [2e-3, 1.6e-3, 1.25e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5];
/// Most elements in an interval that the rule chooses.
const MOST_ELEMENTS: usize = 100;

/// The error of a mesh and a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshError {
    /// That of the mesh, % of the standard deviation of the filtered force.
    pub space: f64,
    /// That of the time step, likewise.
    pub time: f64,
}

impl MeshError {
    /// Both together, %.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.space.hypot(self.time)
    }
}

/// Elements, cures and micro step for an error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Choice {
    pub division: Division,
    pub cures: Vec<Cure>,
    pub micro_step: f64,
}

impl Scene {
    /// The error that mesh and time step of this scene's line are expected to make of the low-pass filtered contact force. `None`
    /// where no rule is known: faster than the waves of a wire, with a damping integrator, or of somebody else's line.
    #[must_use]
    pub fn expected_mesh_error(&self) -> Option<MeshError> {
        let (catenary, contact) = self.modelled_line()?;
        let f = self.run.low_pass_hz;
        let wave = shortest_wave(catenary, self.run.speed, f)?;
        if self.solver.rho_inf < 0.8 {
            return None;
        }
        let mesh = &catenary.mesh;
        let mu = catenary.longest_element() / wave;
        let plain = PLAIN * mu.powi(2);
        let space = match (mesh.has(Cure::ContactCompliance), mesh.has(Cure::BendingLayers)) {
            (true, true) => plain.min(CURED * mu.powi(4)),
            (false, false) => plain,
            _ => WITH_ONE_CURE * plain,
        };
        let step = match (mesh.has(Cure::MassCorrection), contact.law) {
            (false, _) => STEP,
            (true, ContactLaw::Penalty) => CORRECTED_STEP,
            (true, ContactLaw::SlidingJoint) => CORRECTED_STEP_OF_JOINT,
        };
        Some(MeshError {
            space: space.min(MOST),
            time: (step * (self.internal_step() * f).powi(2)).min(MOST),
        })
    }

    /// The cheapest mesh and step of those that the rule knows whose error is at most `error` %; `Err` says why there is none.
    pub(crate) fn mesh_for(&self, error: f64, micro_step_is_given: bool) -> Result<Choice, String> {
        if error < LEAST {
            return Err(format!(
                "must be at least {LEAST} %: below, no rule was measured; give elements_per_interval or element_length, and \
                 solver.micro_step, instead"
            ));
        }
        let no_rule = || {
            format!(
                "no rule is known for {:.1} km/h on wires with waves of {:.1} and {:.1} km/h and rho_inf = {}; give \
                 elements_per_interval or element_length instead",
                crate::run::kmh(self.run.speed),
                self.wave_speed_kmh(|line| line.contact_wire.wave_speed()),
                self.wave_speed_kmh(|line| line.messenger_wire.wave_speed()),
                self.solver.rho_inf
            )
        };
        let (catenary, _) = self.modelled_line().ok_or_else(no_rule)?;
        // The longest element makes the error: what is shorter costs for nothing.
        let divisions: Vec<Division> = (1..=MOST_ELEMENTS)
            .map(|count| catenary.evenly_divided(count))
            .collect();
        let mut best: Option<(f64, Choice)> = None;
        let mut trial = self.clone();
        let steps = if micro_step_is_given {
            vec![self.solver.micro_step]
        } else {
            STEPS.to_vec()
        };
        let mut least = f64::INFINITY;
        for micro_step in steps {
            trial.solver.micro_step = micro_step;
            // A step that the macro step shortens is another one of the list.
            if !micro_step_is_given && trial.internal_step() < 0.999 * micro_step {
                continue;
            }
            for division in &divisions {
                trial.set_division(*division);
                trial.choose_cures();
                let expected = trial.expected_mesh_error().ok_or_else(no_rule)?;
                least = least.min(expected.total());
                if expected.total() > error {
                    continue;
                }
                let cost = catenary.elements_per_span(*division) as f64 / trial.internal_step();
                let cheaper = best.as_ref().is_none_or(|(other, _)| cost < other * (1.0 - 1e-9));
                if cheaper {
                    let cures = trial.cures().to_vec();
                    let choice = Choice {
                        division: *division,
                        cures,
                        micro_step,
                    };
                    best = Some((cost, choice));
                }
                // More elements cost more at the same step.
                break;
            }
        }
        best.map(|(_, choice)| choice).ok_or_else(|| {
            let step = 1e3 * self.solver.micro_step;
            let with = if micro_step_is_given {
                format!(" with solver.micro_step = {step} ms")
            } else {
                String::new()
            };
            format!("must be at least {least:.2} %{with}: no mesh of up to {MOST_ELEMENTS} elements between droppers comes below")
        })
    }

    fn wave_speed_kmh(&self, of: impl Fn(&Catenary) -> f64) -> f64 {
        self.modelled_line().map_or(0.0, |(line, _)| crate::run::kmh(of(line)))
    }
}

/// Geometric mean of the waves that a force of frequency `f` Hz sends out at rest and ahead of itself at the speed `v`, m, on the wire
/// where it is shorter.
fn shortest_wave(catenary: &Catenary, v: f64, f: f64) -> Option<f64> {
    let c = (catenary.contact_wire.wave_speed()).min(catenary.messenger_wire.wave_speed());
    (v < c).then(|| (c * (c - v)).sqrt() / f)
}
