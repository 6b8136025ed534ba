//! The run in time: schedule, outcome, and the time loop of one system.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use component::{Frame, Observer, Point, Progress, Share, Work};
use dynamics::StepError;
use dynamics::lockstep::Stopwatch;
use scene::Scene;

use crate::one_system::OneSystem;
use crate::step_times::StepTimes;

/// Part of a step by which the duration may miss a whole number of them.
const ROUNDING: f64 = 1e-9;

/// Number of halvings of a step that fails, before the run ends: 1 ms becomes 16 µs. In one system of an internal step,
/// coupled of a macro step.
pub const HALVINGS: u32 = 6;

/// Note on `count` steps that failed and were done in halves, the first one for the reason `first`.
#[must_use]
pub fn halved_note(count: u64, first: &str) -> String {
    format!("{count} steps failed and were done in halves; the first: {first}")
}

/// Times of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Simulated time, s.
    pub duration: f64,
    /// Communication step, s.
    pub macro_step: f64,
    /// True where the last step may be shorter than the others; else the last step may pass the duration.
    pub may_shorten: bool,
}

impl Schedule {
    /// Times of a scene.
    #[must_use]
    pub fn of_scene(scene: &Scene, may_shorten: bool) -> Self {
        Self {
            duration: scene.run.duration,
            macro_step: scene.coupling.macro_step,
            may_shorten,
        }
    }

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
    /// Display of the time reached.
    pub progress: &'a dyn Progress,
    /// True where macro steps wait for real time.
    pub paced: bool,
    /// Called when all is there for the time loop to begin.
    pub begun: &'a dyn Fn(),
    /// Called when the time loop has ended, with all still there that it has worked with.
    pub ended: &'a dyn Fn(),
}

impl<'a> Watch<'a> {
    /// For one who wants nothing but to end the run and to see how far it is.
    #[must_use]
    pub fn new(interrupted: &'a AtomicBool, progress: &'a dyn Progress) -> Self {
        Self {
            interrupted,
            progress,
            paced: false,
            begun: &|| {},
            ended: &|| {},
        }
    }
}

/// Result of a run, complete or not.
#[derive(Debug)]
pub struct Outcome<E: std::error::Error + 'static> {
    /// Reason why the run did not reach its end.
    pub failure: Option<Failure<E>>,
    /// Energy that the coupling added, J.
    pub energy_residual: f64,
    /// The same as a share of the work that crossed the contact (–).
    pub energy_share: f64,
    /// Notes for the reader on the coupling, or on the time integration of one system.
    pub notes: Vec<String>,
    /// Simulated time, s.
    pub simulated: f64,
    /// Wall time of the time loop, s.
    pub wall: f64,
    /// Macro steps done.
    pub macro_steps: u64,
    /// Times that the slaves were taken back.
    pub rollbacks: u64,
    /// Lengths of the macro steps.
    pub steps: Steps,
    /// Wall times of the macro steps, without pictures.
    pub step_times: StepTimes,
    /// Work of all slaves during the run.
    pub work: Work,
    /// Shares of `wall`; empty where the slaves' time is not taken.
    pub shares: Vec<Share>,
}

/// Reason for a run that did not reach its end.
#[derive(Debug, thiserror::Error)]
pub enum Failure<E: std::error::Error + 'static> {
    /// Asked for from outside.
    #[error("interrupted at t = {t} s")]
    Interrupted {
        /// Simulated time, s.
        t: f64,
    },
    /// A step could not be completed.
    #[error(transparent)]
    Step(#[from] E),
    /// A panic in a step: what was recorded before stays.
    #[error("a defect of this program ended the run in the step from t = {t} s: {message}")]
    Defect {
        /// Simulated time, s.
        t: f64,
        /// Message of the panic.
        message: String,
    },
}

/// Makes time steps; returns the message of a panic in them, after which nothing that they work with may be asked.
pub fn caught(steps: impl FnOnce()) -> Option<String> {
    let panic = catch_unwind(AssertUnwindSafe(steps)).err()?;
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    Some(text.unwrap_or("no message").to_owned())
}

/// Lengths of the macro steps of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Steps that were taken back because their error was too large.
    pub refused: u64,
    /// Shortest step done, s; the last one, which ends at the duration, does not count.
    pub smallest: f64,
    /// Longest step done, s.
    pub largest: f64,
    /// Changes between growing and shrinking steps.
    pub turns: u64,
    last: f64,
    grew: Option<bool>,
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            refused: 0,
            smallest: f64::INFINITY,
            largest: 0.0,
            turns: 0,
            last: 0.0,
            grew: None,
        }
    }
}

impl Steps {
    /// Counts a step of `h` s that is done.
    pub fn done(&mut self, h: f64) {
        self.smallest = self.smallest.min(h);
        self.largest = self.largest.max(h);
        let change = h - self.last;
        if change.abs() > ROUNDING.sqrt() * h {
            let grows = change > 0.0;
            self.turns += u64::from(self.grew.is_some_and(|grew| grew != grows));
            self.grew = (self.last > 0.0).then_some(grows);
            self.last = h;
        }
    }
}

/// Steps one system through the schedule; every internal step is recorded.
pub fn run(
    whole: &mut OneSystem,
    recorder: &mut dyn Observer,
    schedule: Schedule,
    watch: &Watch<'_>,
) -> Outcome<StepError> {
    let begin = Stopwatch::start();
    let start = whole.point(0.0);
    recorder.start(&start);
    let mut points = [start.clone(), start];
    let draw = |whole: &mut OneSystem, recorder: &mut dyn Observer, point: &Point| {
        if recorder.wants_frame(point.t) {
            let mut frame = Frame::default();
            whole.draw(&mut frame);
            recorder.frame(point, frame);
        }
    };
    draw(whole, recorder, &points[0]);
    let (mut failure, mut macro_steps, mut shown) = (None, 0, 0.0);
    let mut step_times = StepTimes::new(watch.paced);
    let defect = caught(|| {
        for n in 1..=schedule.steps() {
            let t = points[0].t;
            if watch.interrupted.load(Ordering::Relaxed) {
                failure = Some(Failure::Interrupted { t });
                break;
            }
            let (end, h) = schedule.step(n);
            step_times.begin(t);
            if let Err(error) = whole.advance(t, h, &mut points, &mut |previous, present| {
                recorder.step(previous, present)
            }) {
                failure = Some(Failure::Step(error));
                break;
            }
            step_times.end(end);
            points[0].t = end;
            macro_steps = n;
            draw(whole, recorder, &points[0]);
            if end >= shown + 0.01 {
                shown = end;
                watch.progress.reached(end);
            }
        }
    });
    let sound = defect.is_none();
    if let Some(message) = defect {
        let t = macro_steps as f64 * schedule.macro_step;
        failure = Some(Failure::Defect { t, message });
    }
    let wall = begin.elapsed().as_secs_f64();
    Outcome {
        failure,
        energy_residual: 0.0,
        energy_share: 0.0,
        notes: match sound {
            true => whole.energy_note().into_iter().chain(whole.failure_note()).collect(),
            false => Vec::new(),
        },
        simulated: points[0].t,
        wall,
        macro_steps,
        rollbacks: 0,
        steps: Steps {
            smallest: schedule.macro_step,
            largest: schedule.macro_step,
            ..Steps::default()
        },
        step_times,
        work: if sound { whole.work() } else { Work::default() },
        shares: if sound { whole.shares(wall) } else { Vec::new() },
    }
}
