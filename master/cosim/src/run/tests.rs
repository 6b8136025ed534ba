//! The time loop with slaves that are not physics.

use std::ops::Deref;
use std::sync::atomic::AtomicBool;

use component::exchange::{contact, strip};
use results::recorder::Recorder;
use results::{LineGeometry, Record};

use crate::slave::{Abilities, Slave, SlaveError};
use crate::timed::Timed;

use super::*;

#[test]
fn the_last_step_ends_exactly_at_the_duration() {
    let schedule = Schedule {
        duration: 1.0,
        macro_step: 0.3,
        may_shorten: true,
    };
    assert_eq!(schedule.steps(), 4);
    assert_eq!(schedule.step(3), (3.0 * 0.3, 0.3));
    assert_eq!(schedule.step(4), (1.0, 1.0 - 3.0 * 0.3));
    let equal = Schedule {
        may_shorten: false,
        ..schedule
    };
    assert_eq!(equal.step(4), (4.0 * 0.3, 0.3));
}

#[test]
fn rounding_makes_no_extra_step() {
    for (duration, macro_step, steps) in [
        (8.0, 0.001, 8000),
        (6.6, 0.001, 6600),
        (10.0, 0.0001, 100_000),
        (0.3, 0.1, 3),
    ] {
        let schedule = Schedule {
            duration,
            macro_step,
            may_shorten: true,
        };
        assert_eq!(schedule.steps(), steps);
        assert!((schedule.step(steps).1 / macro_step - 1.0).abs() < 1e-6, "no sliver");
    }
}

/// A slave that counts time in its output and refuses steps longer than it likes.
struct Fussy {
    longest: f64,
    time: f64,
    kept: f64,
    rollback: bool,
    outputs: usize,
}

impl Slave for Fussy {
    fn name(&self) -> &str {
        "fussy"
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: self.rollback,
            input_derivatives: 3,
            variable_step: true,
        }
    }

    fn set_inputs(&mut self, _values: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }

    fn set_input_derivatives(&mut self, _order: usize, _values: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        assert!(
            (t - self.time).abs() < 1e-12,
            "a step from {t} s begins where the last one ended, {} s",
            self.time
        );
        if h > self.longest {
            let source = Box::new(std::io::Error::other("too long"));
            return Err(SlaveError::Step {
                slave: "fussy".into(),
                t,
                h,
                retryable: true,
                source,
            });
        }
        self.time = t + h;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        assert_eq!(values.len(), self.outputs);
        values.fill(self.time);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = self.time;
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.time = self.kept;
        Ok(())
    }
}

/// A run and its record.
struct Recorded {
    outcome: Outcome<CouplingError>,
    record: Record,
}

impl Deref for Recorded {
    type Target = Outcome<CouplingError>;

    fn deref(&self) -> &Self::Target {
        &self.outcome
    }
}

fn run_with(pantograph_takes: f64, rollback: bool, interrupted: bool) -> Recorded {
    run_of(pantograph_takes, rollback, interrupted, |slave| slave)
}

/// The same, with both slaves in what `wrap` puts around them.
fn run_of(
    pantograph_takes: f64,
    rollback: bool,
    interrupted: bool,
    wrap: impl Fn(Box<dyn Slave>) -> Box<dyn Slave>,
) -> Recorded {
    let fussy = |longest, outputs| Fussy {
        longest,
        time: 0.0,
        kept: 0.0,
        rollback,
        outputs,
    };
    let mut line = wrap(Box::new(fussy(1.0, contact::COUNT)));
    let mut pantographs: Vec<Box<dyn Slave>> = vec![wrap(Box::new(fussy(pantograph_takes, strip::OUTPUTS)))];
    let mut sides = Sides {
        line: &mut *line,
        pantographs: &mut pantographs,
    };
    let coupling = scene::Coupling {
        algorithm: scene::Algorithm::GaussSeidel,
        order: scene::Order::CatenaryFirst,
        force: scene::Force::Mean,
        extrapolation: 1,
        macro_step: 0.1,
        step_control: None,
        parallel: scene::Parallel::Never,
        max_iterations: 20,
        force_tolerance: 1e-6,
    };
    let (mut algorithm, _) = crate::algorithm::build(&coupling, &sides);
    let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
    let schedule = Schedule {
        duration: 1.0,
        macro_step: 0.1,
        may_shorten: true,
    };
    let mut recorder = Recorder::new(1.0, 0.05, 1, &[], LineGeometry::default());
    let interrupted = AtomicBool::new(interrupted);
    let watch = Watch::new(&interrupted, &());
    let outcome = run(
        &mut sides,
        &mut *algorithm,
        &mut exchange,
        &mut recorder,
        schedule,
        &watch,
    );
    Recorded {
        outcome,
        record: recorder.finish(),
    }
}

#[test]
fn a_step_that_fails_is_taken_back_on_both_sides_and_halved() {
    let outcome = run_with(0.03, true, false);
    assert!(outcome.failure.is_none());
    // Each step of 0.1 s fails once, each of its halves once; the quarters pass.
    assert_eq!((outcome.macro_steps, outcome.rollbacks), (10, 30));
    let note = outcome.notes.last().expect("steps that failed are told");
    for part in [
        "30 steps failed",
        "done in halves",
        "fussy: the step from t = 0 s over 0.1 s failed",
    ] {
        assert!(note.contains(part), "{note}");
    }
    assert_eq!(outcome.record.time.len(), 21);
    for (time, force) in outcome.record.time.iter().zip(&outcome.record.pantographs[0].force) {
        assert!((time - force).abs() < 1e-12, "the output is the time: {time} {force}");
    }
}

#[test]
fn without_rollback_a_step_that_fails_ends_the_run_and_keeps_what_there_is() {
    let outcome = run_with(0.03, false, false);
    let failure = outcome.outcome.failure.as_ref().expect("the first step fails");
    assert!(
        failure
            .to_string()
            .contains("fussy: the step from t = 0 s over 0.1 s failed"),
        "{failure}"
    );
    assert_eq!(
        (outcome.macro_steps, outcome.rollbacks, outcome.record.time.len()),
        (0, 0, 1)
    );
}

#[test]
fn a_step_is_halved_six_times_and_its_smallest_part_tried_again_eight_times_at_most() {
    let outcome = run_with(0.1 / 100.0, true, false);
    assert!(outcome.failure.is_some());
    assert_eq!(outcome.rollbacks, 6 + 8);
}

#[test]
fn an_interrupted_run_keeps_its_start() {
    let outcome = run_with(1.0, true, true);
    assert_eq!(
        outcome.failure.as_ref().map(ToString::to_string).as_deref(),
        Some("interrupted at t = 0 s")
    );
    assert_eq!(outcome.record.time, [0.0]);
}

/// A slave that a defect makes panic in the step from half a second on.
struct Defective(Box<dyn Slave>);

impl Slave for Defective {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.0.set_inputs(values)
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.0.set_input_derivatives(order, values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        assert!(t < 0.45, "a defect in step {t:.1}");
        self.0.do_step(t, h)
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.0.outputs(values)
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.0.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.0.restore()
    }
}

#[test]
fn regress_35_a_run_that_panics_keeps_what_there_is_also_on_threads_of_their_own() {
    let on_thread = |slave: Box<dyn Slave>| -> Box<dyn Slave> {
        match crate::parallel::Parallel::new(Box::new(Defective(slave))) {
            Ok(parallel) => Box::new(parallel),
            Err(slave) => slave,
        }
    };
    let runs = [
        run_of(1.0, true, false, |slave| Box::new(Defective(slave))),
        run_of(1.0, true, false, on_thread),
    ];
    for run in runs {
        let failure = run.failure.as_ref().expect("it panics").to_string();
        let expected = "a defect of this program ended the run in the step from t = 0.5 s: a defect in step 0.5";
        assert_eq!(failure, expected);
        assert_eq!(run.macro_steps, 5);
        let last = run.record.time.last().copied();
        assert!(last.is_some_and(|last| (last - 0.5).abs() < 1e-9), "{last:?}");
    }
}

#[test]
fn slaves_whose_time_is_taken_do_the_same_and_share_the_loop_with_the_master() {
    let untimed = run_with(0.03, true, false);
    assert!(untimed.shares.is_empty());
    let timed = run_of(0.03, true, false, |slave| Box::new(Timed::new(slave)));
    assert_eq!(timed.record.pantographs, untimed.record.pantographs);
    assert_eq!(
        (timed.macro_steps, timed.rollbacks),
        (untimed.macro_steps, untimed.rollbacks)
    );
    let parts: Vec<&str> = timed.shares.iter().map(|share| &*share.part).collect();
    assert_eq!(parts, ["catenary", "pantograph[1]", "master"]);
    assert!(timed.shares.iter().all(|share| share.share > 0.0));
    let sum: f64 = timed.shares.iter().map(|share| share.share).sum();
    assert!((sum - 1.0).abs() < 1e-12, "rounding of a sum of three");
}
