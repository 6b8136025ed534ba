//! The time loop of a coupled run.

mod control;
mod stepper;
#[cfg(test)]
mod tests;

pub use control::{Control, Controller, Estimate, Verdict};
pub use stepper::Stepper;

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use component::{Frame, Observer, Share, Work};
use system::run::{Failure, Outcome, Schedule, Steps, Watch, caught};
use system::step_times::StepTimes;
use system::time_shares;

use crate::algorithm::{Algorithm, CouplingError, Exchange, Sides};

/// Steps both sides through the schedule. Pictures and rows are recorded at each communication point.
pub fn run(
    sides: &mut Sides<'_>,
    algorithm: &mut dyn Algorithm,
    exchange: &mut Exchange,
    recorder: &mut dyn Observer,
    schedule: Schedule,
    watch: &Watch<'_>,
) -> Outcome<CouplingError> {
    let mut under_way = UnderWay::start(sides, algorithm, exchange, recorder, watch);
    let defect = caught(|| {
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
    });
    under_way.finish(defect)
}

/// Steps both sides with the steps that `controller` chooses, up to its duration.
///
/// A step is repeated where all slaves can go back and take any step; else only the next one is shorter.
pub fn run_controlled(
    sides: &mut Sides<'_>,
    algorithm: &mut dyn Algorithm,
    exchange: &mut Exchange,
    recorder: &mut dyn Observer,
    controller: &mut Controller,
    watch: &Watch<'_>,
) -> Outcome<CouplingError> {
    let mut under_way = UnderWay::start(sides, algorithm, exchange, recorder, watch);
    let defect = caught(|| {
        while let Some((end, h)) = controller.next() {
            if under_way.interrupted() {
                break;
            }
            if let Err(error) = under_way.advance_controlled(controller, end, h) {
                under_way.failure = Some(error.into());
                break;
            }
        }
    });
    under_way.finish(defect)
}

/// A coupled run between its start and its end.
struct UnderWay<'a, 'b> {
    stepper: Stepper<'a, 'b>,
    recorder: &'a mut dyn Observer,
    watch: &'a Watch<'a>,
    begin: Instant,
    failure: Option<Failure<CouplingError>>,
    macro_steps: u64,
    steps: Steps,
    step_times: StepTimes,
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
        recorder: &'a mut dyn Observer,
        watch: &'a Watch<'a>,
    ) -> Self {
        let spent_before = spent(sides);
        let begin = Instant::now();
        recorder.start(exchange.point(0));
        draw(sides, exchange, recorder);
        Self {
            stepper: Stepper::new(sides, algorithm, exchange),
            recorder,
            watch,
            begin,
            failure: None,
            macro_steps: 0,
            steps: Steps::default(),
            step_times: StepTimes::new(watch.paced),
            shown: 0.0,
            spent_before,
        }
    }

    /// True where an end has been asked for.
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
        let recorder = &mut *self.recorder;
        if self.macro_steps == 0 {
            self.stepper.get_ready()?;
        }
        self.step_times.begin(self.stepper.exchange.point(0).t);
        self.stepper
            .advance(end, h, &mut |exchange| record(recorder, exchange))?;
        self.step_times.end(end);
        Ok(())
    }

    /// Tries the step that `controller` has chosen; it is done, or the controller chooses a shorter one.
    fn advance_controlled(&mut self, controller: &mut Controller, end: f64, h: f64) -> Result<(), CouplingError> {
        self.step_times.begin(self.stepper.exchange.point(0).t);
        match self.stepper.attempt(h) {
            Err(error) if self.stepper.can_retry(&error) => {
                self.stepper.fail(&error);
                self.stepper.take_back()?;
                if controller.shorten() {
                    return Ok(());
                }
                // A step of the shortest length must be done, in parts if need be.
                let recorder = &mut *self.recorder;
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
                record(self.recorder, self.stepper.exchange);
            }
        }
        self.step_times.end(end);
        self.done(end, h, controller.next().is_none());
        Ok(())
    }

    /// Counts a macro step that ended at `end` after `h` s.
    fn done(&mut self, end: f64, h: f64, last: bool) {
        self.macro_steps += 1;
        if !last || self.macro_steps == 1 {
            self.steps.done(h);
        }
        draw(self.stepper.sides, self.stepper.exchange, self.recorder);
        // The bar is redrawn ten times a second at most; a hundred updates per simulated second are enough.
        if end >= self.shown + 0.01 {
            self.shown = end;
            self.watch.progress.reached(end);
        }
    }

    /// Work of the slaves; completes their pictures.
    fn work(&mut self) -> Work {
        let mut work = self.stepper.sides.line.work();
        self.stepper.sides.line.finish_drawing(self.recorder.frames());
        for pantograph in self.stepper.sides.pantographs.iter_mut() {
            let more = pantograph.work();
            work.micro_steps += more.micro_steps;
            work.newton_iterations += more.newton_iterations;
            work.factorizations += more.factorizations;
            work.above_tolerance += more.above_tolerance;
            work.most_iterations = work.most_iterations.max(more.most_iterations);
            pantograph.finish_drawing(self.recorder.frames());
        }
        work
    }

    /// The outcome; after a `defect`, its message, the slaves are asked nothing.
    fn finish(mut self, defect: Option<String>) -> Outcome<CouplingError> {
        let wall = self.begin.elapsed().as_secs_f64();
        let (shares, work) = match defect {
            Some(message) => {
                let t = self.stepper.exchange.point(0).t;
                self.failure = Some(Failure::Defect { t, message });
                (Vec::new(), Work::default())
            }
            None => (self.shares(wall), self.work()),
        };
        Outcome {
            failure: self.failure,
            energy_residual: self.stepper.exchange.energy_residual(),
            energy_share: self.stepper.exchange.energy_share(),
            notes: self
                .stepper
                .exchange
                .energy_note()
                .into_iter()
                .chain(self.stepper.algorithm.warning())
                .chain(self.stepper.failure_note())
                .collect(),
            simulated: self.stepper.exchange.point(0).t,
            wall,
            macro_steps: self.macro_steps,
            rollbacks: self.stepper.rollbacks,
            steps: self.steps,
            step_times: self.step_times,
            work,
            shares,
        }
    }

    /// Shares of a time loop of `wall` s.
    fn shares(&self, wall: f64) -> Vec<Share> {
        let now = spent(self.stepper.sides);
        let times = now.into_iter().zip(&self.spent_before);
        // The strips of a head share its time, which the first of them knows.
        let taken = times.filter_map(|(now, before)| Some((now?, (*before)?)));
        time_shares::shares(
            wall,
            taken.enumerate().map(|(side, (now, before))| {
                let part = match side {
                    0 => "catenary".to_owned(),
                    index => format!("pantograph[{index}]"),
                };
                (part, (now - before).as_secs_f64())
            }),
        )
    }
}

/// Time spent in each slave so far, the line first; none of a slave whose time is not taken.
fn spent(sides: &Sides<'_>) -> Vec<Option<Duration>> {
    let pantographs = sides.pantographs.iter().map(|slave| slave.spent());
    std::iter::once(sides.line.spent()).chain(pantographs).collect()
}

/// Records the step to the present point.
fn record(recorder: &mut dyn Observer, exchange: &Exchange) {
    recorder.step(exchange.point(1), exchange.point(0));
}

fn draw(sides: &mut Sides<'_>, exchange: &Exchange, recorder: &mut dyn Observer) {
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
