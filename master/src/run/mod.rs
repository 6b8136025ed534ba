//! The time loop of a coupled run.

mod control;
mod stepper;
#[cfg(test)]
mod tests;

pub use control::{Control, Controller, Estimate, Verdict};
pub use stepper::Stepper;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use dynamics::StepError;

use crate::algorithm::{Algorithm, CouplingError, Exchange, Point, Sides};
use crate::monolithic::Monolithic;
use crate::recorder::Recorder;
use crate::report::Progress;
use crate::results::{Frame, Record, Share};
use crate::slave::Work;
use crate::time_shares;

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
    /// Called when all is there for the time loop to begin.
    pub begun: &'a dyn Fn(),
    /// Called when the time loop has ended, with all still there that it has worked with.
    pub ended: &'a dyn Fn(),
}

impl<'a> Watch<'a> {
    /// For one who wants nothing but to end the run and to see how far it is.
    #[must_use]
    pub fn new(interrupted: &'a AtomicBool, progress: &'a Progress) -> Self {
        Self {
            interrupted,
            progress,
            begun: &|| {},
            ended: &|| {},
        }
    }
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
    /// The same as a share of the work that crossed the contact (–).
    pub energy_share: f64,
    /// What a reader must be told on the coupling, or on the time integration of one system.
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
    /// Work of all slaves during the run.
    pub work: Work,
    /// What `wall` was spent on; empty where nobody takes the slaves' time.
    pub shares: Vec<Share>,
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
    fn done(&mut self, h: f64) {
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

/// Steps both sides through the schedule. Pictures and rows are recorded at each communication point.
pub fn run(
    sides: &mut Sides<'_>,
    algorithm: &mut dyn Algorithm,
    exchange: &mut Exchange,
    recorder: Recorder,
    schedule: Schedule,
    watch: &Watch<'_>,
) -> Outcome {
    let mut under_way = UnderWay::start(sides, algorithm, exchange, recorder, watch);
    for n in 1..=schedule.steps() {
        if under_way.interrupted() {
            break;
        }
        let (end, h) = schedule.step(n);
        if let Err(error) = under_way.advance(end, h) {
            under_way.failure = Some(error.into());
            break;
        }
        under_way.done(end, h, n == schedule.steps());
    }
    under_way.finish()
}

/// Steps both sides with the steps that `controller` chooses, up to its duration.
///
/// A step is repeated where all slaves can go back and take any step; else only the next one is shorter.
pub fn run_controlled(
    sides: &mut Sides<'_>,
    algorithm: &mut dyn Algorithm,
    exchange: &mut Exchange,
    recorder: Recorder,
    controller: &mut Controller,
    watch: &Watch<'_>,
) -> Outcome {
    let mut under_way = UnderWay::start(sides, algorithm, exchange, recorder, watch);
    while let Some((end, h)) = controller.next() {
        if under_way.interrupted() {
            break;
        }
        if let Err(error) = under_way.advance_controlled(controller, end, h) {
            under_way.failure = Some(error.into());
            break;
        }
    }
    under_way.finish()
}

/// A coupled run between its start and its end.
struct UnderWay<'a, 'b> {
    stepper: Stepper<'a, 'b>,
    recorder: Recorder,
    watch: &'a Watch<'a>,
    begin: Instant,
    failure: Option<Failure>,
    macro_steps: u64,
    steps: Steps,
    /// Simulated time that the bar shows, s.
    shown: f64,
    /// Time spent in the slaves before the loop, the line's first.
    spent_before: Vec<Option<Duration>>,
}

impl<'a, 'b> UnderWay<'a, 'b> {
    fn start(
        sides: &'a mut Sides<'b>,
        algorithm: &'a mut dyn Algorithm,
        exchange: &'a mut Exchange,
        mut recorder: Recorder,
        watch: &'a Watch<'a>,
    ) -> Self {
        let spent_before = spent(sides);
        let begin = Instant::now();
        recorder.start(exchange.point(0));
        draw(sides, exchange, &mut recorder);
        Self {
            stepper: Stepper::new(sides, algorithm, exchange),
            recorder,
            watch,
            begin,
            failure: None,
            macro_steps: 0,
            steps: Steps::default(),
            shown: 0.0,
            spent_before,
        }
    }

    /// Whether somebody has asked for an end.
    fn interrupted(&mut self) -> bool {
        let interrupted = self.watch.interrupted.load(Ordering::Relaxed);
        if interrupted {
            let t = self.stepper.exchange.point(0).t;
            self.failure = Some(Failure::Interrupted { t });
        }
        interrupted
    }

    /// Advances to `end` over `h` s.
    fn advance(&mut self, end: f64, h: f64) -> Result<(), CouplingError> {
        let recorder = &mut self.recorder;
        self.stepper.advance(end, h, &mut |exchange| record(recorder, exchange))
    }

    /// Tries the step that `controller` has chosen; it is done, or the controller chooses a shorter one.
    fn advance_controlled(&mut self, controller: &mut Controller, end: f64, h: f64) -> Result<(), CouplingError> {
        match self.stepper.attempt(h) {
            Err(error) if self.stepper.can_retry(&error) => {
                self.stepper.take_back()?;
                if controller.shorten() {
                    return Ok(());
                }
                // A step of the shortest length must be done, in parts if need be.
                let recorder = &mut self.recorder;
                self.stepper
                    .advance_in_halves(end, h, &mut |exchange| record(recorder, exchange))?;
                controller.skip();
            }
            result => {
                result?;
                if controller.judge(self.stepper.exchange, h) == Verdict::Refused {
                    self.steps.refused += 1;
                    return self.stepper.take_back();
                }
                self.stepper.exchange.accept(end);
                record(&mut self.recorder, self.stepper.exchange);
            }
        }
        self.done(end, h, controller.next().is_none());
        Ok(())
    }

    /// Counts a macro step that ended at `end` after `h` s.
    fn done(&mut self, end: f64, h: f64, last: bool) {
        self.macro_steps += 1;
        if !last || self.macro_steps == 1 {
            self.steps.done(h);
        }
        draw(self.stepper.sides, self.stepper.exchange, &mut self.recorder);
        // The bar is redrawn ten times a second at most; a hundred updates per simulated second are enough.
        if end >= self.shown + 0.01 {
            self.shown = end;
            self.watch.progress.set(end);
        }
    }

    fn finish(self) -> Outcome {
        let wall = self.begin.elapsed().as_secs_f64();
        let shares = self.shares(wall);
        let mut work = self.stepper.sides.line.work();
        let mut record = self.recorder.finish();
        self.stepper.sides.line.finish_drawing(&mut record.animation.frames);
        for pantograph in self.stepper.sides.pantographs.iter_mut() {
            let more = pantograph.work();
            work.micro_steps += more.micro_steps;
            work.newton_iterations += more.newton_iterations;
            work.factorizations += more.factorizations;
            work.most_iterations = work.most_iterations.max(more.most_iterations);
            pantograph.finish_drawing(&mut record.animation.frames);
        }
        Outcome {
            record,
            failure: self.failure,
            energy_residual: self.stepper.exchange.energy_residual(),
            energy_share: self.stepper.exchange.energy_share(),
            notes: self
                .stepper
                .exchange
                .energy_note()
                .into_iter()
                .chain(self.stepper.algorithm.warning())
                .collect(),
            simulated: self.stepper.exchange.point(0).t,
            wall,
            macro_steps: self.macro_steps,
            rollbacks: self.stepper.rollbacks,
            steps: self.steps,
            work,
            shares,
        }
    }

    /// Shares of a time loop of `wall` s.
    fn shares(&self, wall: f64) -> Vec<Share> {
        let now = spent(self.stepper.sides);
        let times = now.into_iter().zip(&self.spent_before).enumerate();
        time_shares::shares(
            wall,
            times.filter_map(|(side, (now, before))| {
                let part = match side {
                    0 => "catenary".to_owned(),
                    index => format!("pantograph[{index}]"),
                };
                Some((part, (now? - (*before)?).as_secs_f64()))
            }),
        )
    }
}

/// Time spent in each slave so far, the line first; none of one whose time nobody takes.
fn spent(sides: &Sides<'_>) -> Vec<Option<Duration>> {
    let pantographs = sides.pantographs.iter().map(|slave| slave.spent());
    std::iter::once(sides.line.spent()).chain(pantographs).collect()
}

/// Records the step to the present point.
fn record(recorder: &mut Recorder, exchange: &Exchange) {
    recorder.step(exchange.point(1), exchange.point(0));
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
    let record = recorder.finish();
    let wall = begin.elapsed().as_secs_f64();
    Outcome {
        record,
        failure,
        energy_residual: 0.0,
        energy_share: 0.0,
        notes: whole.energy_note().into_iter().collect(),
        simulated: points[0].t,
        wall,
        macro_steps,
        rollbacks: 0,
        steps: Steps {
            smallest: schedule.macro_step,
            largest: schedule.macro_step,
            ..Steps::default()
        },
        work: crate::inprocess::work(whole.counters()),
        shares: whole.shares(wall),
    }
}
