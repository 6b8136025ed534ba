//! A scene in a mode: from statics to a record.

#![forbid(unsafe_code)]

mod accuracy;
pub mod base_motion;
pub mod check;
pub mod check_page;
mod controlled;
pub mod environment;
mod error;
pub mod galloping;
mod galloping_page;
mod horns;
pub mod identity;
pub mod latency;
pub mod memory;
mod mesh;
mod modelled;
pub mod paths;
mod prepare;
mod rest_position;
pub mod size;
mod slaves;
pub mod sliding_joint;
mod static_lines;
mod statics_hints;
mod strip_overrun;
mod supervision;
mod table_files;
pub mod wearing;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use catenary::{CatenaryError, StaticLine};
use scene::{Evaluate, Initialise, Scene};

use component::exchange;
use cosim::algorithm::{self, Exchange, Sides};
use cosim::disturbance::disturb;
use cosim::head;
use cosim::parallel;
use cosim::run::{self, Control, Controller, Estimate};
use cosim::slave::Slave;
use cosim::timed::Timed;
use results::recorder::Recorder;
use results::standards;
use results::{self, DropperRow, LineGeometry, Record, RunInfo};
use suppliers::settling::{self, Settling};
use suppliers::{SuppliedController, SuppliedLine, SuppliedPantograph};
use system::disturbance::Disturbance;
use system::one_system::stepped::SteppedSystem;
use system::one_system::{Evidence, OneSystem};
use system::run::{Failure, Outcome, Schedule, Steps, Watch};
use system::step_times::StepTimes;

pub use self::error::{SetupError, lost_a_process};
pub use crate::prepare::{Other, prepare, prepare_on};
pub use crate::static_lines::StaticLines;
pub use crate::supervision::supervise;
use cosim::chain;

/// Contact stiffness of EN 50318, N/m: what errors of a height are weighted with where the line's own is not known.
const USUAL_STIFFNESS: f64 = 5e4;

/// The internal step that a run has made, s, with macro steps of `mean` s on average. Where these are controlled, the
/// one of the longest, which all but those shorter than a micro step have; or their mean where that is shorter. One
/// system and slaves of one step take the first macro step of a controlled one.
fn step_made(scene: &Scene, steps: &Steps, mean: f64) -> f64 {
    if scene.coupling.step_control.is_none() || steps.largest <= 0.0 {
        return scene.internal_step();
    }
    let of_longest = scene.internal_step_of(steps.largest);
    if steps.smallest < steps.largest {
        of_longest.min(mean)
    } else {
        of_longest
    }
}

/// How a scene is run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// FMUs through their C interface.
    #[default]
    Cosimulation,
    /// Line and pantographs as one system.
    Monolithic,
    /// The same subsystems as the FMUs', without them.
    Inprocess,
}

impl Mode {
    /// The word of the command line and of the summary.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cosimulation => "cosimulation",
            Self::Monolithic => "monolithic",
            Self::Inprocess => "inprocess",
        }
    }
}

/// A scene whose statics are known.
pub struct Prepared {
    /// The resolved scene.
    pub scene: Scene,
    /// Name of the scene in results.
    pub name: String,
    /// Static state of its line, which other scenes may share; nothing where the line is supplied.
    pub statics: Option<Arc<StaticLine>>,
    /// How supplied pantographs came to rest; nothing before a run.
    pub settling: Option<Settling>,
    /// Facts of supplied FMUs: wiring, abilities, remarks.
    pub others: Vec<Other>,
    /// Supplied pantographs, started; `None` for those modelled here.
    pub supplied: Vec<Option<SuppliedPantograph>>,
    /// Controller FMU of each pantograph, started; `None` for pantographs without one.
    pub(crate) controllers: Mutex<Vec<Option<SuppliedController>>>,
    /// Contact force at which each supplied pantograph starts by its own account, N; 0 for those modelled here.
    pub(crate) stated_forces: Vec<f64>,
    pub(crate) line: Option<SuppliedLine>,
    pub(crate) begin: Instant,
    /// Disturbance made on purpose.
    pub disturbance: Disturbance,
    /// True where pictures of the line are recorded for an animation.
    pub pictures: bool,
}

/// Numbers (from 1) of the supports that bound the evaluated spans.
#[must_use]
pub fn evaluated_supports(scene: &Scene) -> Vec<usize> {
    let Some((catenary, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let (first, last) = evaluated_spans(scene);
    (first..=last + 1).filter(|&k| k <= catenary.spans() + 1).collect()
}

/// First and last evaluated span (from 1): those that a strip passes during the evaluation.
#[must_use]
pub fn evaluated_spans(scene: &Scene) -> (usize, usize) {
    if let Evaluate::Spans { first, last } = scene.run.evaluate {
        return (first, last);
    }
    let Some((catenary, _)) = scene.modelled_line() else {
        return (1, 1);
    };
    let span = |x: f64| {
        (1..=catenary.spans())
            .find(|&span| x < catenary.support_x(span))
            .unwrap_or(catenary.spans())
    };
    let ranges = (0..scene.pantographs.len()).map(|index| scene.evaluation_x(index));
    ranges.fold((catenary.spans(), 1), |(first, last), (from, to)| {
        (first.min(span(from)), last.max(span(to)))
    })
}

/// Periods of the low-pass filter's cut-off that a run goes on after the evaluation range, –: what follows has no part
/// in the figures, and the filter has forgotten its end by a factor of exp(−24).
pub const SETTLE: f64 = 10.0;

/// Duration of a run in s that ends when the last strip has left the evaluation range and the low-pass filter has
/// settled; not longer than the scene's.
#[must_use]
pub fn settled(scene: &Scene) -> f64 {
    let evaluated = (0..scene.pantographs.len()).map(|index| scene.evaluation_time(index).1);
    let end = evaluated.fold(0.0, f64::max) + SETTLE / scene.run.low_pass_hz;
    scene.run.duration.min(end)
}

/// A run that has ended, complete or not.
pub struct Finished {
    /// Facts besides the record.
    pub info: RunInfo,
    /// Series.
    pub record: Record,
    /// Why it is incomplete.
    pub failure: Option<Box<dyn std::error::Error + Send + Sync>>,
    /// Wall times of the macro steps.
    pub step_times: StepTimes,
    /// Most Newton iterations of one internal step; 0 where FMUs do not say.
    pub most_iterations: u64,
    /// Observations of one system, where asked for.
    pub evidence: Option<Evidence>,
    /// Coupled slaves, still to be ended: an FMU that crashes there takes nothing with it once the results are written.
    pub slaves: Vec<Box<dyn Slave>>,
}

/// Source of the FMUs of a co-simulation.
pub struct FmuSource {
    /// Folder for the packages of the scene.
    pub folder: PathBuf,
    /// True where FMUs log debug messages.
    pub logging: bool,
}

impl Prepared {
    /// Makes the slaves, calls `good` when everything is known to be good and nothing is computed yet, and runs.
    ///
    /// # Errors
    /// See [`SetupError`], and what `good` returns.
    pub fn run<E: From<SetupError>>(
        self,
        mode: Mode,
        source: &FmuSource,
        watch: &Watch<'_>,
        good: impl FnOnce(&Scene) -> Result<(), E>,
    ) -> Result<Finished, E> {
        let supports = match &self.line {
            Some(line) => line.supports().to_vec(),
            None => evaluated_supports(&self.scene),
        };
        match mode {
            Mode::Monolithic => self.run_as_one(&supports, watch, good),
            Mode::Inprocess | Mode::Cosimulation => self.run_coupled(mode, &supports, source, watch, good),
        }
    }

    /// Controller FMUs, which are not here any more afterwards.
    fn take_controllers(&mut self) -> Vec<Option<SuppliedController>> {
        let controllers = std::mem::take(&mut self.controllers);
        controllers.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Which pantographs are to step on threads of their own. That goes by the scene alone, not by the machine.
    fn own_threads(&self) -> Vec<bool> {
        let pays = |pantograph: &scene::Pantograph| match self.scene.coupling.parallel {
            // A linkage in two coordinates costs less than a thread.
            scene::Parallel::Auto => {
                matches!(pantograph.model, scene::PantographModel::Linkage(_))
                    && !self.scene.model.has(scene::Reduction::Linkage)
            }
            scene::Parallel::Always => true,
            scene::Parallel::Never => false,
        };
        self.scene.pantographs.iter().map(pays).collect()
    }

    /// How the macro step is controlled, where it is; adds to `reason` what the slaves allow.
    fn control(&self, sides: &Sides<'_>, reason: &mut String) -> Option<Control> {
        let coupling = &self.scene.coupling;
        let asked = coupling.step_control?;
        if let Some(slave) = sides.with_fixed_step() {
            reason.push_str(&format!(
                "; {slave} takes steps of one length only: the macro step stays at {} s",
                coupling.macro_step
            ));
            return None;
        }
        let (stiffness, whose) = match &self.scene.contact {
            Some(contact) => (contact.stiffness, "contact.stiffness"),
            None => (USUAL_STIFFNESS, "assumed for a line that does not say its own"),
        };
        let degree = coupling.extrapolation;
        // `auto` predicts with degree 2 where it repeats steps by Newton's method.
        let newton = match coupling.algorithm {
            scene::Algorithm::InterfaceJacobian => true,
            scene::Algorithm::Auto => degree == 2,
            _ => false,
        };
        let (estimate, what) = if newton && sides.can_roll_back() && coupling.max_iterations > 1 {
            (Estimate::Course, "from the cubics that the line was given")
        } else {
            (Estimate::Prediction { degree }, "from their extrapolation")
        };
        reason.push_str(&format!(
            "; macro step from {} s to {} s by the strips' deviation {what} times {stiffness} N/m ({whose}), {} N in \
             the mean",
            asked.min, asked.max, asked.tolerance,
        ));
        if let Some(slave) = sides.without_rollback() {
            reason.push_str(&format!(
                "; {slave} cannot go back to a saved state: a step with too large an error stands, only the next one \
                 is shorter"
            ));
        }
        Some(Control {
            duration: self.scene.run.duration,
            tolerance: asked.tolerance,
            min: asked.min,
            max: asked.max,
            first: coupling.macro_step,
            micro_step: self.scene.solver.micro_step,
            stiffness,
            estimate,
        })
    }

    /// Droppers at rest; none of a supplied line.
    fn droppers_at_rest(&self) -> Vec<DropperRow> {
        let all = self.statics.as_ref().map(|line| line.report().droppers.iter());
        let row = |dropper: &catenary::DropperReport| DropperRow {
            tension_length: dropper.tension_length,
            span: dropper.span,
            number: dropper.dropper,
            x_m: dropper.x,
            length_m: dropper.length,
            force_n: dropper.force,
        };
        all.into_iter().flatten().map(row).collect()
    }

    fn recorder(&self, supports: &[usize]) -> Recorder {
        let line = self
            .scene
            .modelled_line()
            .map_or_else(LineGeometry::default, |(catenary, _)| LineGeometry {
                support_x: catenary.supports_x(),
                dropper_x: catenary.droppers_x(),
                droppers: self.droppers_at_rest(),
                tension_lengths: match catenary.tension_lengths.as_slice() {
                    [_] => Vec::new(),
                    several => several.iter().map(|length| (length.start_x, length.end_x())).collect(),
                },
            });
        let run = &self.scene.run;
        let recorder = Recorder::new(
            run.duration,
            run.output_step,
            self.scene.pantographs.len(),
            supports,
            line,
        );
        let recorder = if self.pictures {
            recorder
        } else {
            recorder.without_pictures()
        };
        recorder
            .with_heads(&self.scene.strip_counts())
            .with_wind((0..self.scene.pantographs.len()).filter(|&index| {
                let own = !matches!(self.scene.pantographs[index].model, scene::PantographModel::Supplied(_));
                own && vehicle::Air::of_scene(&self.scene, index).is_some()
            }))
            .with_control(
                (0..self.scene.pantographs.len()).filter(|&index| self.scene.pantographs[index].control.is_some()),
            )
    }

    fn run_coupled<E: From<SetupError>>(
        mut self,
        mode: Mode,
        supports: &[usize],
        source: &FmuSource,
        watch: &Watch<'_>,
        good: impl FnOnce(&Scene) -> Result<(), E>,
    ) -> Result<Finished, E> {
        if sliding_joint::holds(&self.scene) {
            let (mode, what) = (mode.name(), CatenaryError::SlidingJoint.to_string());
            return Err(SetupError::NotInThisMode { mode, what }.into());
        }
        let mut supplied = std::mem::take(&mut self.supplied);
        let controllers = self.take_controllers();
        let mut line = self.line.take();
        let others = line.is_some() || supplied.iter().any(Option::is_some);
        if self.scene.run.initialise == Initialise::Equilibrium
            && others
            && line.as_ref().is_none_or(SuppliedLine::can_stand)
        {
            let statics = self.statics.as_deref();
            let found = settling::settle(
                &mut self.scene,
                statics,
                line.as_mut(),
                &mut supplied,
                watch.interrupted,
            )
            .map_err(SetupError::from)?;
            self.settling = Some(found);
        }
        let own_threads = self.own_threads();
        let strips = self.scene.strip_counts();
        let outputs = exchange::line_output_count(strips.iter().sum(), supports.len());
        let (mut line, mut pantographs) = match mode {
            Mode::Cosimulation => self.fmu_slaves(supports, line, supplied, controllers, source)?,
            _ => self.core_slaves(supports, line, supplied, controllers)?,
        };
        disturb(&self.disturbance, &mut line, &mut pantographs, outputs, &strips);
        let beside_the_line = self.scene.coupling.algorithm == scene::Algorithm::Jacobi;
        let threads = parallel::arrange(&mut pantographs, &own_threads, beside_the_line);
        let mut line = Timed::new(line);
        let untimed = std::mem::take(&mut pantographs);
        for (slave, &strips) in untimed.into_iter().zip(&strips) {
            pantographs.extend(head::strips_of(Box::new(Timed::new(slave)), strips));
        }
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let (mut algorithm, choice) = algorithm::build(&self.scene.coupling, &sides);
        let algorithm::Choice { coupling, mut reason } = choice;
        self.scene.coupling = coupling;
        let mut exchange = Exchange::start(&mut sides, 0.0, outputs).map_err(SetupError::from)?;
        good(&self.scene)?;
        let setup = self.begin.elapsed().as_secs_f64();
        let mut recorder = self.recorder(supports);
        let control = self.control(&sides, &mut reason);
        if let Some(threads) = threads {
            reason.push_str(&format!("; {threads}"));
        }
        (watch.begun)();
        let outcome = if let Some(control) = control {
            let mut controller = Controller::new(control, strips.iter().sum(), sides.can_roll_back());
            run::run_controlled(
                &mut sides,
                &mut *algorithm,
                &mut exchange,
                &mut recorder,
                &mut controller,
                watch,
            )
        } else {
            let schedule = Schedule::of_scene(&self.scene, sides.can_vary_step());
            run::run(
                &mut sides,
                &mut *algorithm,
                &mut exchange,
                &mut recorder,
                schedule,
                watch,
            )
        };
        (watch.ended)();
        if let Some(report) = algorithm.report() {
            reason.push_str(&format!("; {report}"));
        }
        let coupling = results::Coupling {
            algorithm: self.scene.coupling.algorithm.name().to_owned(),
            reason,
            energy_residual: Some(outcome.energy_residual),
            energy_share: outcome.energy_share,
        };
        let mut finished = self.finished(mode, outcome, recorder.finish(), coupling, setup, None);
        finished.slaves = pantographs;
        finished.slaves.push(Box::new(line));
        Ok(finished)
    }

    /// Static state of the line, where the scene can be one system.
    fn statics_of_one_system(&self) -> Result<&StaticLine, SetupError> {
        let statics = self.statics.as_deref().filter(|_| OneSystem::can(&self.scene));
        statics.ok_or_else(|| SetupError::NotInThisMode {
            mode: Mode::Monolithic.name(),
            what: "line or pantograph is a supplied FMU, which has no equations to put into one system".to_owned(),
        })
    }

    /// The scene as one system that is advanced step by step from outside.
    ///
    /// # Errors
    /// A scene that is no one system; see [`SetupError`].
    pub fn stepped(mut self) -> Result<SteppedSystem, SetupError> {
        let controllers = self.take_controllers();
        let statics = self.statics_of_one_system()?;
        let mut stepped = SteppedSystem::new(&self.scene, statics, &evaluated_supports(&self.scene))?;
        for (index, controller) in controllers.into_iter().enumerate() {
            if let Some(mut controller) = controller {
                controller.keep_history()?;
                stepped.command_by(index, Box::new(controller));
            }
        }
        Ok(stepped)
    }

    fn run_as_one<E: From<SetupError>>(
        mut self,
        supports: &[usize],
        watch: &Watch<'_>,
        good: impl FnOnce(&Scene) -> Result<(), E>,
    ) -> Result<Finished, E> {
        let controllers = self.take_controllers();
        let statics = self.statics_of_one_system()?;
        let mut whole = OneSystem::new(&self.scene, statics, supports).map_err(SetupError::from)?;
        for (index, controller) in controllers.into_iter().enumerate() {
            if let Some(controller) = controller {
                whole.command_by(index, Box::new(controller));
            }
        }
        whole.disturb(&self.disturbance).map_err(SetupError::from)?;
        good(&self.scene)?;
        let setup = self.begin.elapsed().as_secs_f64();
        let mut schedule = Schedule::of_scene(&self.scene, true);
        if self.disturbance.audited {
            schedule.macro_step = self.scene.internal_step_of(schedule.macro_step);
        }
        let mut recorder = self.recorder(supports);
        (watch.begun)();
        let outcome = system::run::run(&mut whole, &mut recorder, schedule, watch);
        (watch.ended)();
        let coupling = results::Coupling {
            algorithm: "none".to_owned(),
            reason: "line and pantographs are one system".to_owned(),
            energy_residual: Some(0.0),
            energy_share: 0.0,
        };
        Ok(self.finished(
            Mode::Monolithic,
            outcome,
            recorder.finish(),
            coupling,
            setup,
            whole.evidence(),
        ))
    }

    fn finished<F: std::error::Error + Send + Sync + 'static>(
        &self,
        mode: Mode,
        outcome: Outcome<F>,
        record: Record,
        coupling: results::Coupling,
        setup: f64,
        evidence: Option<Evidence>,
    ) -> Finished {
        let scene = &self.scene;
        let mean_step = outcome.simulated / outcome.macro_steps as f64;
        let step = step_made(scene, &outcome.steps, mean_step);
        let evaluation = results::Evaluation {
            time: (0..scene.pantographs.len())
                .map(|index| scene.evaluation_time(index))
                .collect(),
            low_pass_hz: scene.run.low_pass_hz,
            filter: scene.run.filter.into(),
            bands_hz: scene.run.bands_hz.clone(),
            output_step: scene.run.output_step,
            speed: scene.run.speed,
        };
        let notes = (self.notes(step).into_iter())
            .chain(outcome.notes)
            .chain(fixed_work(scene, &outcome.work))
            .chain(sliding_joint::remarks(scene, &record))
            .chain(strip_overrun::remarks(scene, &record))
            .chain(horns::remarks(scene, &record))
            .chain(controlled::remarks(scene, &evaluation, &record))
            .chain(wearing::remarks(scene))
            .collect();
        let info = RunInfo {
            scene: self.name.clone(),
            title: scene.title.clone(),
            source: scene.source.clone().unwrap_or_default(),
            mode: mode.name().to_owned(),
            complete: outcome.failure.is_none(),
            incomplete_reason: outcome
                .failure
                .as_ref()
                .map_or_else(String::new, |failure| chain(failure)),
            evaluation,
            line: line_of(scene),
            assessment: scene.assessment.clone(),
            instrument: (scene.measurement.as_ref())
                .map(|measurement| results::Instrument::new(measurement, scene.run.output_step)),
            wear: wearing::of(scene),
            coupling,
            model: self.model(),
            accuracy: accuracy::of(scene, mode, step),
            uncertainty: Vec::new(),
            cost: results::Cost {
                wall_s: outcome.wall,
                setup_s: setup,
                simulated_s: outcome.simulated,
                real_time_factor: (outcome.simulated > 0.0).then(|| outcome.wall / outcome.simulated),
                macro_steps: outcome.macro_steps,
                micro_steps: outcome.work.micro_steps,
                newton_iterations: outcome.work.newton_iterations,
                factorizations: outcome.work.factorizations,
                rollbacks: outcome.rollbacks,
                refused_steps: outcome.steps.refused,
                smallest_macro_step_s: (outcome.macro_steps > 0).then_some(outcome.steps.smallest),
                largest_macro_step_s: (outcome.macro_steps > 0).then_some(outcome.steps.largest),
                mean_macro_step_s: (outcome.macro_steps > 0).then_some(mean_step),
                step_times: outcome.step_times.steps(),
                shares: outcome.shares,
            },
            notes,
        };
        let failure = outcome
            .failure
            .map(|failure: Failure<F>| -> Box<dyn std::error::Error + Send + Sync> { Box::new(failure) });
        Finished {
            info,
            record,
            failure,
            most_iterations: outcome.work.most_iterations,
            step_times: outcome.step_times,
            evidence,
            slaves: Vec::new(),
        }
    }
}

/// Note on what steps of fixed work leave.
fn fixed_work(scene: &Scene, work: &component::Work) -> Option<String> {
    (scene.solver.fixed_work).then(|| {
        format!(
            "solver.fixed_work: {} of {} internal steps ended above solver.newton_tolerance = {} N; a shorter \
             solver.micro_step leaves fewer",
            work.above_tolerance, work.micro_steps, scene.solver.newton_tolerance
        )
    })
}

/// Properties of the line that limits of standards depend on.
fn line_of(scene: &Scene) -> standards::Line {
    let catenary = scene.modelled_line().map(|(catenary, _)| catenary);
    standards::Line {
        electrification: scene.run.electrification,
        wave_speed: catenary.map(|catenary| catenary.contact_wire.wave_speed()),
        free_uplift: catenary.and_then(|catenary| catenary.registration_arms.free_uplift),
        uplift_stop: catenary.is_some_and(|catenary| catenary.registration_arms.uplift_stop),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_of_a_note_is_the_one_that_was_made() {
        const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
        let read = |macro_step: &str| {
            let overrides = [macro_step.to_owned(), "solver.micro_step=0.00125".to_owned()];
            system::load(EN_300, "scene.toml", &overrides).unwrap()
        };
        let made = |scene: &Scene, (smallest, largest): (f64, f64), mean: f64| {
            let mut steps = Steps::default();
            (steps.smallest, steps.largest) = (smallest, largest);
            step_made(scene, &steps, mean)
        };
        let controlled = read("coupling.macro_step={tolerance=1.0}");
        for (steps, mean, step) in [
            ((1e-3, 1e-2), 4e-3, 1.25e-3),
            // All the same, and a shorter one at the end.
            ((1.25e-3, 1.25e-3), 1.249e-3, 1.25e-3),
            ((1e-3, 1e-3), 0.999e-3, 1e-3),
            // A first step that is as long as all others are not.
            ((0.3e-3, 1e-3), 0.32e-3, 0.32e-3),
            ((0.3e-3, 1.25e-3), 0.9e-3, 0.9e-3),
            // None.
            ((f64::INFINITY, 0.0), f64::NAN, 1.25e-3),
        ] {
            assert_eq!(made(&controlled, steps, mean), step, "{steps:?}");
        }
        assert_eq!(made(&read("coupling.macro_step=0.002"), (0.002, 0.002), 0.002), 1e-3);
    }
}
