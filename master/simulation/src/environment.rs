//! Environments of reinforcement learning: contact force as the aim, command of a drive as the action.
//!
//! [`ForceAim`] defines observation, action, reward and end of an episode; [`Environments`] steps many cases at once.

use std::sync::{Mutex, PoisonError};
use std::thread;

use scene::{ControlLaw, Scene};
use system::one_system::stepped::{SteppedError, SteppedSystem};

use crate::SetupError;
use cosim::chain;

/// Numbers of an observation.
pub const OBSERVED: usize = 4;

/// Reward of a step that the simulation cannot make.
pub const FAILED: f64 = -100.0;

/// Situation after a turn of an environment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Situation {
    /// Contact force less the desired one over the desired one, rise of the strip, m, its vertical velocity, m/s, force
    /// of the drive over its limit.
    pub observation: [f32; OBSERVED],
    /// Reward of the step; 0 after a start.
    pub reward: f64,
    /// True at the end of the run.
    pub truncated: bool,
    /// Reason of a step that could not be made, which terminates the episode.
    pub failure: Option<String>,
    /// Time, s.
    pub time: f64,
    /// Contact force, N.
    pub force: f64,
}

/// Contact force of a pantograph as the aim of whoever commands its drive: one step is one sample.
#[derive(Debug)]
pub struct ForceAim {
    /// Signals of the strips of the pantograph.
    forces: Vec<usize>,
    heights: Vec<usize>,
    velocities: Vec<usize>,
    drives: Vec<usize>,
    command: usize,
    /// Macro steps of a sample.
    steps: u64,
    /// N.
    desired: f64,
    /// Height of the strip at the start, m.
    start: f64,
    /// Limit of the actuator, N.
    limit: f64,
    /// Weight of the squared action in the reward.
    effort: f64,
}

impl ForceAim {
    /// Aim for pantograph `pantograph` (from 1) of a system at its start.
    ///
    /// # Errors
    /// A pantograph that takes no commands from outside, or whose actuator has no limit; a sample time that is no
    /// multiple of the macro step.
    pub fn new(scene: &Scene, system: &SteppedSystem, pantograph: usize, effort: f64) -> Result<Self, SetupError> {
        let refused = |what: String| Err(SetupError::NotAvailable(what));
        let path = format!("pantograph[{pantograph}].control");
        let index = pantograph.wrapping_sub(1);
        let Some(entry) = scene.pantographs.get(index) else {
            let most = scene.pantographs.len();
            return refused(format!(
                "pantograph = {pantograph}: must be a whole number from 1 to {most}"
            ));
        };
        let control = entry
            .control
            .as_ref()
            .filter(|control| control.law == ControlLaw::Given);
        let Some(control) = control else {
            return refused(format!("{path}.law: must be \"given\" for commands from outside"));
        };
        if let Some((number, _)) = scene.controller_of(index) {
            let number = number + 1;
            return refused(format!(
                "controller[{number}]: must be left out, as the action is the command"
            ));
        }
        let Some(limit) = control.actuator.limit else {
            return refused(format!(
                "{path}.actuator.limit: must be given, N; an action of 1 is a command of that force"
            ));
        };
        let (sample, step) = (control.sample_time, system.macro_step());
        let Some(steps) = suppliers::pieces(step, sample) else {
            return refused(format!(
                "{path}.sample_time = {sample} s: must be a whole number of coupling.macro_step = {step} s"
            ));
        };
        if !effort.is_finite() {
            return refused(format!("effort = {effort}: must be a finite number"));
        }
        let place = |name: &str| system.signals().iter().position(|signal| signal.name == name);
        let of_strips = |group: &str, name: &str| -> Vec<usize> {
            let strips = scene.strips_of(index);
            strips
                .filter_map(|strip| place(&format!("{group}[{}].{name}", strip + 1)))
                .collect()
        };
        let Some(command) = place(&format!("{path}.force")) else {
            return refused(format!("{path}.force: is no signal of the simulation"));
        };
        let mut aim = Self {
            forces: of_strips("contact", "force"),
            heights: of_strips("strip", "z"),
            velocities: of_strips("strip", "vz"),
            drives: of_strips("strip", "control.force"),
            command,
            steps: steps as u64,
            desired: 0.0,
            start: 0.0,
            limit,
            effort,
        };
        aim.desired = control.force.unwrap_or_else(|| aim.force(system));
        if aim.desired <= 0.0 {
            return refused(format!(
                "{path}.force = {} N: must be above 0 for this reward",
                aim.desired
            ));
        }
        aim.start = mean(system, &aim.heights);
        Ok(aim)
    }

    /// Contact force of the head, N.
    fn force(&self, system: &SteppedSystem) -> f64 {
        sum(system, &self.forces)
    }

    /// Missing force by the desired one, –.
    fn deviation(&self, system: &SteppedSystem) -> f64 {
        self.force(system) / self.desired - 1.0
    }

    fn situation(&self, system: &SteppedSystem) -> Situation {
        let values = [
            self.deviation(system),
            mean(system, &self.heights) - self.start,
            mean(system, &self.velocities),
            sum(system, &self.drives) / self.limit,
        ];
        Situation {
            observation: values.map(|value| value as f32),
            truncated: system.steps_left() == 0,
            time: system.time(),
            force: self.force(system),
            ..Situation::default()
        }
    }

    /// Goes back to the start, and `lead` samples on without a command; at least one macro step is left.
    ///
    /// # Errors
    /// See [`SteppedError`].
    pub fn begin(&self, system: &mut SteppedSystem, lead: u64) -> Result<Situation, SteppedError> {
        system.reset()?;
        let steps = lead
            .saturating_mul(self.steps)
            .min(system.steps_left().saturating_sub(1));
        (0..steps).try_for_each(|_| system.advance())?;
        Ok(self.situation(system))
    }

    /// Holds a command for a sample: `action` from −1 to 1, in parts of the limit of the actuator.
    ///
    /// Reward: less the mean of the squared deviation over the macro steps, less the effort.
    pub fn step(&self, system: &mut SteppedSystem, action: f64) -> Situation {
        let action = action.clamp(-1.0, 1.0);
        system.set(self.command, action * self.limit);
        let steps = self.steps.min(system.steps_left());
        let mut missing = 0.0;
        for _ in 0..steps {
            if let Err(error) = system.advance() {
                return Situation {
                    reward: FAILED,
                    truncated: false,
                    failure: Some(chain(&error)),
                    ..self.situation(system)
                };
            }
            missing += self.deviation(system).powi(2);
        }
        let reward = -missing / steps.max(1) as f64 - self.effort * action * action;
        Situation {
            reward,
            ..self.situation(system)
        }
    }
}

fn sum(system: &SteppedSystem, signals: &[usize]) -> f64 {
    signals.iter().map(|&signal| system.value(signal)).sum()
}

fn mean(system: &SteppedSystem, signals: &[usize]) -> f64 {
    sum(system, signals) / signals.len().max(1) as f64
}

/// Demand on one environment in a turn of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Another start: see [`ForceAim::begin`].
    Begin(u64),
    /// Another step: see [`ForceAim::step`].
    Step(f64),
    /// Nothing.
    Rest,
}

/// One environment of many.
struct Case {
    system: SteppedSystem,
    aim: ForceAim,
}

impl Case {
    fn meet(&mut self, demand: Demand) -> Result<Situation, SteppedError> {
        match demand {
            Demand::Begin(lead) => self.aim.begin(&mut self.system, lead),
            Demand::Step(action) => Ok(self.aim.step(&mut self.system, action)),
            Demand::Rest => Ok(self.aim.situation(&self.system)),
        }
    }
}

/// Many environments that are stepped at once, each the same bit for bit as alone.
pub struct Environments {
    cases: Vec<Case>,
    threads: usize,
}

impl Environments {
    /// Environments of `count` cases, made by `make` from their numbers, on up to `threads` threads.
    ///
    /// # Errors
    /// The first case (from 0) that is refused.
    pub fn new(
        count: usize,
        threads: usize,
        make: impl Fn(usize) -> Result<(SteppedSystem, ForceAim), SetupError> + Sync,
    ) -> Result<Self, (usize, Box<SetupError>)> {
        let made = on_threads(threads, (0..count).collect(), |case| {
            make(case).map_err(|error| (case, Box::new(error)))
        });
        let cases = made
            .into_iter()
            .map(|made| made.map(|(system, aim)| Case { system, aim }));
        Ok(Self {
            cases: cases.collect::<Result<_, _>>()?,
            threads,
        })
    }

    /// Meets the demand on each environment.
    ///
    /// # Errors
    /// The first environment (from 0) that does not come to its start.
    ///
    /// # Panics
    /// For another number of demands than environments.
    pub fn turn(&mut self, demands: &[Demand]) -> Result<Vec<Situation>, (usize, SteppedError)> {
        assert_eq!(demands.len(), self.cases.len(), "one demand for each environment");
        let cases = self.cases.iter_mut().zip(demands).collect();
        let met = on_threads(self.threads, cases, |(case, demand)| case.meet(*demand));
        let numbered = met.into_iter().enumerate();
        numbered
            .map(|(number, met)| met.map_err(|error| (number, error)))
            .collect()
    }

    /// Systems of the environments, for signals beyond the observation.
    pub fn systems(&self) -> impl Iterator<Item = &SteppedSystem> {
        self.cases.iter().map(|case| &case.system)
    }
}

/// Does `work` on all items on up to `threads` threads; results in the order of the items.
fn on_threads<I: Send, T: Send>(threads: usize, items: Vec<I>, work: impl Fn(I) -> T + Sync) -> Vec<T> {
    let threads = threads.min(items.len());
    if threads < 2 {
        return items.into_iter().map(work).collect();
    }
    let count = items.len();
    let queue = Mutex::new(items.into_iter().enumerate());
    let take = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let worker = || {
        std::iter::from_fn(take)
            .map(|(place, item)| (place, work(item)))
            .collect::<Vec<_>>()
    };
    let mut done: Vec<(usize, T)> = Vec::with_capacity(count);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        for worker in workers {
            match worker.join() {
                Ok(part) => done.extend(part),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    done.sort_unstable_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_items_whatever_the_threads() {
        let squares: Vec<u64> = (0..50).map(|number| number * number).collect();
        for threads in [0, 1, 2, 7, 80] {
            let found = on_threads(threads, (0..50).collect(), |number: u64| number * number);
            assert_eq!(found, squares, "{threads}");
        }
        assert_eq!(on_threads(4, Vec::new(), |number: u64| number), Vec::<u64>::new());
    }
}
