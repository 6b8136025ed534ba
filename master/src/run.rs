//! The time loop of a coupled run.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dynamics::StepError;

use crate::algorithm::{Algorithm, CouplingError, Exchange, Point, Sides};
use crate::monolithic::Monolithic;
use crate::recorder::Recorder;
use crate::report::Progress;
use crate::results::{Frame, Record};
use crate::slave::Work;

/// How often a macro step that fails is halved before the run is given up: 1 ms becomes 16 µs.
const HALVINGS: u32 = 6;

/// Part of a step by which the duration may miss a whole number of them.
const ROUNDING: f64 = 1e-9;

/// Times of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Simulated time, s.
    pub duration: f64,
    /// Communication step, s.
    pub macro_step: f64,
    /// Whether the last step may be shorter than the others; where not, it may pass the duration.
    pub may_shorten: bool,
}

impl Schedule {
    /// Number of macro steps.
    #[must_use]
    pub fn steps(&self) -> u64 {
        (self.duration / self.macro_step - ROUNDING).ceil().max(1.0) as u64
    }

    /// Communication point `n` and the length of the step that leads there, s.
    #[must_use]
    pub fn step(&self, n: u64) -> (f64, f64) {
        let end = n as f64 * self.macro_step;
        if self.may_shorten && n == self.steps() && end != self.duration {
            let start = (n - 1) as f64 * self.macro_step;
            return (self.duration, self.duration - start);
        }
        (end, self.macro_step)
    }
}

/// Whoever watches a run.
pub struct Watch<'a> {
    /// Set from outside to end the run in order.
    pub interrupted: &'a AtomicBool,
    /// Progress bar.
    pub progress: &'a Progress,
}

/// What a run left behind, complete or not.
#[derive(Debug)]
pub struct Outcome {
    /// Series up to where the run came.
    pub record: Record,
    /// Why it did not reach its end.
    pub failure: Option<Failure>,
    /// Energy that the coupling added, J.
    pub energy_residual: f64,
    /// Simulated time, s.
    pub simulated: f64,
    /// Wall time of the time loop, s.
    pub wall: f64,
    /// Macro steps done.
    pub macro_steps: u64,
    /// Times that the slaves were taken back.
    pub rollbacks: u64,
    /// Work of all slaves during the run.
    pub work: Work,
}

/// Why a run did not reach its end.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Somebody asked for it.
    #[error("interrupted at t = {t} s")]
    Interrupted {
        /// Simulated time, s.
        t: f64,
    },
    /// A step could not be completed.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A step of one system could not be completed.
    #[error(transparent)]
    Step(StepError),
}

/// Steps both sides through the schedule. Pictures and rows are recorded at each communication point.
pub fn run(
    sides: &mut Sides<'_>,
    algorithm: &mut dyn Algorithm,
    exchange: &mut Exchange,
    mut recorder: Recorder,
    schedule: Schedule,
    watch: &Watch<'_>,
) -> Outcome {
    let begin = Instant::now();
    recorder.start(exchange.point(0));
    draw(sides, exchange, &mut recorder);
    let (mut failure, mut macro_steps, mut rollbacks, mut shown) = (None, 0, 0, 0.0);
    for n in 1..=schedule.steps() {
        if watch.interrupted.load(Ordering::Relaxed) {
            failure = Some(Failure::Interrupted { t: exchange.point(0).t });
            break;
        }
        let (end, h) = schedule.step(n);
        let mut stepper = Stepper {
            sides,
            algorithm,
            recorder: &mut recorder,
            rollbacks: &mut rollbacks,
        };
        if let Err(error) = stepper.advance(exchange, end, h, HALVINGS) {
            failure = Some(error.into());
            break;
        }
        macro_steps = n;
        draw(sides, exchange, &mut recorder);
        // The bar is redrawn ten times a second at most; a hundred updates per simulated second are enough.
        if end >= shown + 0.01 {
            shown = end;
            watch.progress.set(end);
        }
    }
    let wall = begin.elapsed().as_secs_f64();
    let mut work = sides.line.work();
    let mut record = recorder.finish();
    sides.line.finish_drawing(&mut record.animation.frames);
    for pantograph in sides.pantographs.iter_mut() {
        let more = pantograph.work();
        work.micro_steps += more.micro_steps;
        work.newton_iterations += more.newton_iterations;
        work.factorizations += more.factorizations;
        pantograph.finish_drawing(&mut record.animation.frames);
    }
    Outcome {
        record,
        failure,
        energy_residual: exchange.energy_residual(),
        simulated: exchange.point(0).t,
        wall,
        macro_steps,
        rollbacks,
        work,
    }
}

fn draw(sides: &mut Sides<'_>, exchange: &Exchange, recorder: &mut Recorder) {
    let point = exchange.point(0);
    if recorder.wants_frame(point.t) {
        let mut frame = Frame::default();
        sides.line.draw(&mut frame);
        for pantograph in sides.pantographs.iter_mut() {
            pantograph.draw(&mut frame);
        }
        recorder.frame(point, frame);
    }
}

/// Steps one system through the schedule; every internal step is recorded.
pub fn run_as_one(whole: &mut Monolithic, mut recorder: Recorder, schedule: Schedule, watch: &Watch<'_>) -> Outcome {
    let begin = Instant::now();
    let start = whole.point(0.0);
    recorder.start(&start);
    let mut points = [start.clone(), start];
    let draw = |whole: &mut Monolithic, recorder: &mut Recorder, point: &Point| {
        if recorder.wants_frame(point.t) {
            let mut frame = Frame::default();
            whole.draw(&mut frame);
            recorder.frame(point, frame);
        }
    };
    draw(whole, &mut recorder, &points[0]);
    let (mut failure, mut macro_steps, mut shown) = (None, 0, 0.0);
    for n in 1..=schedule.steps() {
        let t = points[0].t;
        if watch.interrupted.load(Ordering::Relaxed) {
            failure = Some(Failure::Interrupted { t });
            break;
        }
        let (end, h) = schedule.step(n);
        if let Err(error) = whole.advance(t, h, &mut points, &mut |previous, present| {
            recorder.step(previous, present)
        }) {
            failure = Some(Failure::Step(error));
            break;
        }
        points[0].t = end;
        macro_steps = n;
        draw(whole, &mut recorder, &points[0]);
        if end >= shown + 0.01 {
            shown = end;
            watch.progress.set(end);
        }
    }
    Outcome {
        record: recorder.finish(),
        failure,
        energy_residual: 0.0,
        simulated: points[0].t,
        wall: begin.elapsed().as_secs_f64(),
        macro_steps,
        rollbacks: 0,
        work: crate::inprocess::work(whole.counters()),
    }
}

struct Stepper<'a, 'b> {
    sides: &'a mut Sides<'b>,
    algorithm: &'a mut dyn Algorithm,
    recorder: &'a mut Recorder,
    rollbacks: &'a mut u64,
}

impl Stepper<'_, '_> {
    /// Advances to `end` over `h` s; a step that fails is taken back and done in two halves, `halvings` times at most, where
    /// every slave can go back and takes any step.
    fn advance(&mut self, exchange: &mut Exchange, end: f64, h: f64, halvings: u32) -> Result<(), CouplingError> {
        let can_roll_back = self.sides.can_roll_back() && self.sides.can_vary_step();
        if can_roll_back && !self.algorithm.saves() {
            self.sides.save()?;
        }
        match self.algorithm.step(self.sides, exchange, h) {
            Ok(rollbacks) => {
                *self.rollbacks += rollbacks;
                exchange.accept(end);
                self.recorder.step(exchange.point(1), exchange.point(0));
                Ok(())
            }
            Err(error) if error.is_retryable() && can_roll_back && halvings > 0 => {
                self.sides.restore()?;
                *self.rollbacks += 1;
                let middle = end - 0.5 * h;
                self.advance(exchange, middle, 0.5 * h, halvings - 1)?;
                self.advance(exchange, end, 0.5 * h, halvings - 1)
            }
            Err(error) => Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::interface::{contact, strip};
    use crate::report::Show;
    use crate::results::LineGeometry;
    use crate::slave::{Abilities, Slave, SlaveError};

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

    fn run_with(pantograph_takes: f64, rollback: bool, interrupted: bool) -> Outcome {
        let fussy = |longest, outputs| Fussy {
            longest,
            time: 0.0,
            kept: 0.0,
            rollback,
            outputs,
        };
        let mut line = fussy(1.0, contact::COUNT);
        let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(fussy(pantograph_takes, strip::OUTPUTS))];
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let coupling = scene::Coupling {
            algorithm: scene::Algorithm::GaussSeidel,
            order: scene::Order::CatenaryFirst,
            force: scene::Force::Mean,
            extrapolation: 1,
            macro_step: 0.1,
            max_iterations: 20,
            force_tolerance: 1e-6,
            reason: "named",
        };
        let (mut algorithm, _) = crate::algorithm::build(&coupling, &sides);
        let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
        let schedule = Schedule {
            duration: 1.0,
            macro_step: 0.1,
            may_shorten: true,
        };
        let recorder = Recorder::new(1.0, 0.05, 1, &[], LineGeometry::default());
        let progress = Progress::simulated("", 1.0, Show::Never);
        let interrupted = AtomicBool::new(interrupted);
        let watch = Watch {
            interrupted: &interrupted,
            progress: &progress,
        };
        run(&mut sides, &mut *algorithm, &mut exchange, recorder, schedule, &watch)
    }

    #[test]
    fn a_step_that_fails_is_taken_back_on_both_sides_and_halved() {
        let outcome = run_with(0.03, true, false);
        assert!(outcome.failure.is_none());
        // Each step of 0.1 s fails once, each of its halves once; the quarters pass.
        assert_eq!((outcome.macro_steps, outcome.rollbacks), (10, 30));
        assert_eq!(outcome.record.time.len(), 21);
        for (time, force) in outcome.record.time.iter().zip(&outcome.record.pantographs[0].force) {
            assert!((time - force).abs() < 1e-12, "the output is the time: {time} {force}");
        }
    }

    #[test]
    fn without_rollback_a_step_that_fails_ends_the_run_and_keeps_what_there_is() {
        let outcome = run_with(0.03, false, false);
        let failure = outcome.failure.expect("the first step fails");
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
    fn a_step_is_halved_six_times_at_most() {
        let outcome = run_with(0.1 / 100.0, true, false);
        assert!(outcome.failure.is_some());
        assert_eq!(outcome.rollbacks, 6);
    }

    #[test]
    fn an_interrupted_run_keeps_its_start() {
        let outcome = run_with(1.0, true, true);
        assert_eq!(
            outcome.failure.map(|failure| failure.to_string()).as_deref(),
            Some("interrupted at t = 0 s")
        );
        assert_eq!(outcome.record.time, [0.0]);
    }
}
