//! One system step by step: signals read and set between steps, states kept and gone back to.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::mem::swap;

use catenary::StaticLine;
use component::Point;
use component::exchange::{contact, instrument, moment, strip, support};
use control::{Asked, ControllerState, Rule};
use dynamics::{Checkpoint, OutsideError, StepError};
use scene::{ControlLaw, Scene};
use serde::{Deserialize, Serialize};
use vehicle::{Air, WIND_INPUTS};

use super::{OneSystem, OneSystemError};
use crate::run::Schedule;

/// Name of the group of signals of a pantograph.
const PANTOGRAPH: &str = "pantograph";

/// Outputs of the line that one system has, in the order of names.
const CONTACT: [usize; 8] = [
    contact::FORCE,
    contact::FX,
    contact::FY,
    contact::FZ,
    contact::X,
    contact::Y,
    contact::WIRE_Z,
    contact::GAP,
];

/// Outputs of a strip that one system has, in the order of names.
const STRIP: [usize; 10] = [
    strip::X,
    strip::Y,
    strip::Z,
    strip::VX,
    strip::VY,
    strip::VZ,
    strip::ROLL,
    strip::WIND_DRAG,
    strip::WIND_LIFT,
    strip::CONTROL,
];

/// Place of a signal's value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum At {
    /// Index in the outputs of the line.
    Line(usize),
    /// Index in the outputs of the strips.
    Strip(usize),
    /// Raising force of a pantograph, from 0.
    Uplift(usize),
    /// Index of an input of the system.
    Input(usize),
    /// Command of a controller, from 0.
    Command(usize),
}

/// A signal of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct SteppedSignal {
    /// Name, such as `contact[1].force`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// One sentence.
    pub description: String,
    /// `true` for a signal that can be set between steps.
    pub settable: bool,
    at: At,
}

/// Reason why a step cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum SteppedError {
    /// The run is at its end.
    #[error("t = {t} s is the end of the run: run.duration must be longer, or the simulation reset")]
    End {
        /// Time, s.
        t: f64,
    },
    /// An earlier step has failed.
    #[error("the step at t = {t} s has failed: the simulation must be reset, or go back to a kept state")]
    Failed {
        /// Time, s.
        t: f64,
    },
    /// The integrator.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Another system's state.
    #[error("the state is of another system: must be one that a simulation of the same scene has kept")]
    OtherSystem,
    /// A controller from outside that does not go to another state.
    #[error("the controller of pantograph[{pantograph}]")]
    Rule {
        /// From 1.
        pantograph: usize,
        /// Reason.
        #[source]
        source: OutsideError,
    },
}

/// State of a [`SteppedSystem`], from which it goes on bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SteppedState {
    /// Hash of the scene.
    scene: u64,
    step: u64,
    t: f64,
    /// Outputs of line and strips.
    outputs: [Vec<f64>; 2],
    uplift: Vec<f64>,
    controllers: Vec<ControllerState>,
    /// Questions to the controllers from outside since the start, one entry each; none where all are inside.
    asked: Vec<Asked>,
    simulator: Checkpoint,
}

/// One system in time, macro step by macro step: the same bits as the run of the same scene as one system, as long as
/// nothing is set.
pub struct SteppedSystem {
    whole: OneSystem,
    scene: u64,
    schedule: Schedule,
    step: u64,
    failed: bool,
    points: [Point; 2],
    signals: Vec<SteppedSignal>,
    start: SteppedState,
}

/// Signals of a scene as one system, with the supports of these numbers (from 1).
fn signals(scene: &Scene, settable: &[bool], supports: &[usize]) -> Vec<SteppedSignal> {
    let output = |name: String, declared: &component::DeclaredSignal, number: usize, at| SteppedSignal {
        name,
        unit: declared.unit().unwrap_or_default(),
        description: declared.description.replace("{}", &number.to_string()),
        settable: false,
        at,
    };
    let mut signals = Vec::new();
    for i in 0..scene.strip_count() {
        let declared = CONTACT.iter().map(|&index| (index, &contact::SIGNALS[index]));
        signals.extend(declared.map(|(index, declared)| {
            let name = declared.of(contact::GROUP, i + 1);
            output(name, declared, i + 1, At::Line(i * contact::COUNT + index))
        }));
        let control = scene.pantographs[scene.head_of(i).0].control.as_ref();
        let on_joint = control.is_some_and(|control| control.actuator.joint.is_some());
        let declared = STRIP.iter().map(|&index| match index {
            strip::CONTROL if on_joint => (index, &moment::CONTROL),
            index => (index, &strip::SIGNALS[index]),
        });
        signals.extend(declared.map(|(index, declared)| {
            let name = declared.of(strip::GROUP, i + 1);
            output(name, declared, i + 1, At::Strip(i * strip::OUTPUTS + index))
        }));
    }
    let first = scene.strip_count() * contact::COUNT;
    let declared = &support::SIGNALS[support::UPLIFT];
    signals.extend(supports.iter().enumerate().map(|(k, &number)| {
        let name = declared.of(support::GROUP, number);
        output(name, declared, number, At::Line(first + k))
    }));
    for (i, &settable) in settable.iter().enumerate() {
        signals.push(SteppedSignal {
            name: format!("{PANTOGRAPH}[{}].uplift_force", i + 1),
            unit: "N",
            description: "Force that raises the pantograph".to_owned(),
            settable,
            at: At::Uplift(i),
        });
        let controls = scene.pantographs[..i].iter().filter(|own| own.control.is_some());
        let control = scene.pantographs[i].control.as_ref();
        if let Some(control) = control.filter(|control| control.law == ControlLaw::Given) {
            let on_joint = control.actuator.joint.is_some();
            let declared = if on_joint { moment::COMMAND } else { instrument::INPUT };
            signals.push(SteppedSignal {
                name: declared.of(PANTOGRAPH, i + 1),
                unit: declared.unit().unwrap_or_default(),
                description: declared.description.to_owned(),
                settable: true,
                at: At::Command(controls.count()),
            });
        }
        if Air::of_scene(scene, i).is_none() {
            continue;
        }
        let axes = ["along the track", "to the left", "upward"].into_iter().enumerate();
        signals.extend(axes.map(|(axis, direction)| SteppedSignal {
            name: format!("{PANTOGRAPH}[{}].wind.v{}", i + 1, ["x", "y", "z"][axis]),
            unit: "m/s",
            description: format!("Wind {direction}, added to the scene's own"),
            settable: true,
            at: At::Input(WIND_INPUTS * i + axis),
        }));
    }
    signals
}

impl SteppedSystem {
    /// A resolved scene at its start; the supports of these numbers (from 1) are read out.
    ///
    /// # Errors
    /// See [`OneSystemError`].
    pub fn new(scene: &Scene, statics: &StaticLine, supports: &[usize]) -> Result<Self, OneSystemError> {
        let mut whole = OneSystem::with_wind(scene, statics, supports)?;
        let point = whole.point(0.0);
        let pantographs = &mut whole.simulator.system.pantographs;
        let settable = pantographs.iter_mut().map(|pantograph| {
            let force = pantograph.uplift_force();
            pantograph.set_uplift_force(force)
        });
        let settable: Vec<bool> = settable.collect();
        let mut hasher = DefaultHasher::new();
        scene.to_toml().hash(&mut hasher);
        let mut stepped = Self {
            whole,
            scene: hasher.finish(),
            schedule: Schedule::of_scene(scene, true),
            step: 0,
            failed: false,
            points: [point.clone(), point],
            signals: signals(scene, &settable, supports),
            start: SteppedState::default(),
        };
        let mut start = SteppedState::default();
        stepped.save(&mut start);
        stepped.start = start;
        Ok(stepped)
    }

    /// Takes the commands of pantograph `index` (from 0) from a rule, which is at its start: before the first step.
    pub fn command_by(&mut self, index: usize, rule: Box<dyn Rule>) {
        let control = &self.whole.control;
        let place = control.pantographs.iter().position(|&own| own == index);
        for signal in &mut self.signals {
            if place.is_some_and(|place| signal.at == At::Command(place)) {
                signal.settable = false;
                "Force that the controller has commanded at its last sample".clone_into(&mut signal.description);
            }
        }
        self.whole.command_by(index, rule);
        self.start.asked = vec![Asked::default(); self.whole.control.channels.len()];
    }

    /// Time reached, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.points[0].t
    }

    /// Steps left until the end of the run.
    #[must_use]
    pub fn steps_left(&self) -> u64 {
        self.schedule.steps() - self.step
    }

    /// Length of a step, s; the last one may be shorter.
    #[must_use]
    pub fn macro_step(&self) -> f64 {
        self.schedule.macro_step
    }

    /// Signals in their order.
    #[must_use]
    pub fn signals(&self) -> &[SteppedSignal] {
        &self.signals
    }

    /// Makes a macro step.
    ///
    /// # Errors
    /// See [`SteppedError`]; after a failed step only [`SteppedSystem::reset`] and [`SteppedSystem::restore`] help.
    pub fn advance(&mut self) -> Result<(), SteppedError> {
        let t = self.time();
        if self.failed {
            return Err(SteppedError::Failed { t });
        }
        if self.steps_left() == 0 {
            return Err(SteppedError::End { t });
        }
        let (end, h) = self.schedule.step(self.step + 1);
        self.failed = true;
        self.whole.advance(t, h, &mut self.points, &mut |_, _| {})?;
        self.failed = false;
        self.points[0].t = end;
        self.step += 1;
        Ok(())
    }

    /// Value of a signal by its place among [`SteppedSystem::signals`].
    #[must_use]
    pub fn value(&self, signal: usize) -> f64 {
        let simulator = &self.whole.simulator;
        match self.signals[signal].at {
            At::Line(index) => self.points[0].line[index],
            At::Strip(index) => self.points[0].strips[index],
            At::Uplift(index) => simulator.system.pantographs[index].uplift_force(),
            At::Input(index) => simulator.inputs()[index],
            At::Command(index) => self.whole.control.channels[index].controller.given(),
        }
    }

    /// Sets a signal by its place among [`SteppedSystem::signals`], for the steps that follow.
    ///
    /// # Panics
    /// For a signal that cannot be set.
    pub fn set(&mut self, signal: usize, value: f64) {
        let SteppedSignal { name, settable, at, .. } = &self.signals[signal];
        assert!(settable, "{name} cannot be set");
        let simulator = &mut self.whole.simulator;
        match *at {
            At::Uplift(index) => {
                simulator.system.pantographs[index].set_uplift_force(value);
            }
            At::Input(index) => {
                let mut inputs = simulator.inputs().to_vec();
                inputs[index] = value;
                simulator.set_inputs(&inputs);
            }
            At::Command(index) => self.whole.control.channels[index].controller.give(value),
            At::Line(_) | At::Strip(_) => {}
        }
    }

    /// Stores the whole state into `state`, reusing memory.
    pub fn save(&mut self, state: &mut SteppedState) {
        (state.scene, state.step, state.t) = (self.scene, self.step, self.time());
        state.outputs[0].clone_from(&self.points[0].line);
        state.outputs[1].clone_from(&self.points[0].strips);
        let simulator = &mut self.whole.simulator;
        state.uplift.clear();
        let forces = simulator.system.pantographs.iter();
        state.uplift.extend(forces.map(vehicle::PantographModel::uplift_force));
        simulator.save(&mut state.simulator);
        state.controllers.clear();
        state.controllers.extend(self.whole.control.states());
        state.asked.clear();
        let channels = &mut self.whole.control.channels;
        if channels.iter_mut().any(|channel| channel.controller.rule().is_some()) {
            let rules = channels.iter_mut().map(|channel| channel.controller.rule());
            state
                .asked
                .extend(rules.map(|rule| rule.map_or_else(Asked::default, |rule| rule.asked())));
        }
    }

    /// Goes back, or on, to a kept state.
    ///
    /// # Errors
    /// The state of another system; a matrix of the state that cannot be factored again.
    pub fn restore(&mut self, state: &SteppedState) -> Result<(), SteppedError> {
        if state.scene != self.scene {
            return Err(SteppedError::OtherSystem);
        }
        let control = &mut self.whole.control;
        self.failed = true;
        for ((channel, &index), asked) in control.channels.iter_mut().zip(&control.pantographs).zip(&state.asked) {
            if let Some(rule) = channel.controller.rule() {
                rule.ask_again(asked).map_err(|source| SteppedError::Rule {
                    pantograph: index + 1,
                    source,
                })?;
            }
        }
        let simulator = &mut self.whole.simulator;
        for (pantograph, &force) in simulator.system.pantographs.iter_mut().zip(&state.uplift) {
            pantograph.set_uplift_force(force);
        }
        simulator.restore(&state.simulator)?;
        let whole = &mut simulator.system;
        whole.slackening.restart(whole.line.elongations());
        self.whole.control.set_states(&state.controllers);
        let point = &mut self.points[0];
        (point.t, point.from) = (state.t, state.t);
        point.line.clone_from(&state.outputs[0]);
        point.strips.clone_from(&state.outputs[1]);
        self.step = state.step;
        self.failed = false;
        Ok(())
    }

    /// Goes back to the start.
    ///
    /// # Errors
    /// A matrix of the start that cannot be factored again.
    pub fn reset(&mut self) -> Result<(), SteppedError> {
        let mut start = SteppedState::default();
        swap(&mut start, &mut self.start);
        let result = self.restore(&start);
        self.start = start;
        result
    }
}
