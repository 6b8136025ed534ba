//! Samples, delays and noise around a rule and a drive.

use dynamics::{OutsideError, SplitMix64, StepError};
use serde::{Deserialize, Serialize};

use crate::actuator::{Drive, DriveState};
use crate::law::{KnownDrive, Law, Memory};
use crate::riccati::NoGains;
use crate::samples::Samples;

/// Contact force and motion that the instruments of a pantograph see.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Contact force on the head, all strips together, N.
    pub force: f64,
    /// Vertical velocity of the driven point, m/s.
    pub driven: f64,
    /// Place of the driven point, m: rise of a driven mass above its place of reference, height of the driven point of
    /// a linkage above the top of rail.
    pub driven_place: f64,
    /// Height of the head above the top of rail, m; 0 without commands from outside, as the two that follow.
    pub head_height: f64,
    /// Vertical velocity of the head, m/s.
    pub head_velocity: f64,
    /// Vertical acceleration of the head, m/s².
    pub head_acceleration: f64,
    /// Rises of the masses of a chain above their places of reference, head first, m; empty for a linkage.
    pub rises: Vec<f64>,
    /// Their velocities, m/s.
    pub velocities: Vec<f64>,
}

/// Rule of commands that is not of this crate, such as that of an FMU.
pub trait Rule: Send {
    /// Command of sample `number`, N, from what the instruments show; `desired` is the contact force aimed at, N.
    ///
    /// # Errors
    /// The reason why there is no command.
    fn command(&mut self, number: i64, shown: &Reading, desired: f64) -> Result<f64, OutsideError>;

    /// Questions since the start, from which its state follows.
    fn asked(&self) -> Asked;

    /// Goes back, or on, to the state after these questions.
    ///
    /// # Errors
    /// A rule that cannot go there.
    fn ask_again(&mut self, asked: &Asked) -> Result<(), OutsideError>;
}

/// Numbers that say what a rule has been asked since the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Asked(pub Vec<f64>);

/// State of a [`Controller`] between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ControllerState {
    /// Number of the next sample; none before the first time is known.
    next: Option<i64>,
    /// Command on its way: time of its effect, s, and value, N.
    on_its_way: Option<[f64; 2]>,
    drive: DriveState,
    memory: Memory,
    /// Command from outside, N.
    given: f64,
}

/// Sampled controller of one pantograph with its drive.
///
/// Sample `k` is at `t = k T`. It reads the pantograph; its command takes effect after the delays of sensors and
/// actuator together, which are at most `T`.
pub struct Controller {
    samples: Samples,
    delay: f64,
    desired: f64,
    law: Law,
    /// Rule that gives the commands in place of `law`.
    rule: Option<Box<dyn Rule>>,
    drive: Drive,
    sensors: scene::Sensors,
    state: ControllerState,
    /// Room for what the sensors show.
    shown: Reading,
}

impl Controller {
    /// Controller of a scene for a lumped pantograph, or a linkage; `reference_force` (N) is the contact force that
    /// holds the pantograph at its reference height, and `start` (N) that at the start, for a scene that desires no
    /// other.
    ///
    /// # Errors
    /// A linear-quadratic regulator without gains.
    pub fn new(
        control: &scene::Control,
        lumped: Option<&scene::Lumped>,
        reference_force: f64,
        start: f64,
    ) -> Result<Self, NoGains> {
        let desired = control.force.unwrap_or(start);
        Ok(Self {
            samples: Samples::every(control.sample_time),
            delay: control.delay(),
            desired,
            law: Law::new(control, lumped, desired, reference_force)?,
            rule: None,
            drive: Drive::from(&control.actuator),
            sensors: control.sensors,
            state: ControllerState::default(),
            shown: Reading::default(),
        })
    }

    /// Takes the commands from `rule`, in place of those from outside; the rule is not part of the state.
    pub fn obey(&mut self, rule: Box<dyn Rule>) {
        self.rule = Some(rule);
    }

    /// The rule in place of commands from outside.
    pub fn rule(&mut self) -> Option<&mut dyn Rule> {
        match &mut self.rule {
            Some(rule) => Some(&mut **rule),
            None => None,
        }
    }

    /// The state, to be kept and gone back to; without that of a rule from outside.
    #[must_use]
    pub fn state(&self) -> ControllerState {
        self.state
    }

    /// Goes back, or on, to a kept state.
    pub fn set_state(&mut self, state: ControllerState) {
        self.state = state;
    }

    /// Sets the command from outside, N, which `law = "given"` takes at the next sample.
    pub fn give(&mut self, command: f64) {
        self.state.given = command;
    }

    /// True where commands come from outside.
    #[must_use]
    pub fn takes_commands(&self) -> bool {
        self.law == Law::Given
    }

    /// Command from outside, N.
    #[must_use]
    pub fn given(&self) -> f64 {
        self.state.given
    }

    /// Desired contact force, N.
    #[must_use]
    pub fn desired(&self) -> f64 {
        self.desired
    }

    /// Reading of the instruments at `t` s, with the noise of the sample that is due then or next.
    pub fn show(&mut self, t: f64, read: &mut dyn FnMut(&mut Reading)) -> &Reading {
        read(&mut self.shown);
        self.disturb(self.samples.first_from(t));
        &self.shown
    }

    /// Force of the drive at `t` s, N: valid up to the next event.
    #[must_use]
    pub fn force(&self, t: f64) -> f64 {
        self.drive.force(&self.state.drive, t)
    }

    /// First time after `t` s at which a sample is taken or a command takes effect, s.
    #[must_use]
    pub fn next_event(&self, t: f64) -> f64 {
        let after = self.samples.first_after(t);
        let next = self.state.next.map_or(after, |next| next.max(after));
        let event = self.samples.time(next);
        match self.state.on_its_way {
            Some([time, _]) if !self.samples.is_due(time, t) => event.min(time),
            _ => event,
        }
    }

    /// Does what is due at `t` s: a command takes effect, a sample is taken by `read`. Returns true where the force of
    /// the drive may have jumped.
    ///
    /// # Errors
    /// A rule from outside that gives no command.
    pub fn act(&mut self, t: f64, read: &mut dyn FnMut(&mut Reading)) -> Result<bool, StepError> {
        let mut jumped = false;
        if let Some([time, command]) = self.state.on_its_way
            && self.samples.is_due(time, t)
        {
            self.state.on_its_way = None;
            jumped |= self.take_effect(t, command);
        }
        let next = self.state.next.unwrap_or_else(|| self.samples.first_from(t));
        self.state.next = Some(next);
        if self.samples.is_due(self.samples.time(next), t) {
            let command = self.sampled(t, next, read)?;
            self.state.next = Some(self.samples.first_after(t));
            if self.delay > 0.0 {
                self.state.on_its_way = Some([self.samples.time(next) + self.delay, command]);
            } else {
                jumped |= self.take_effect(t, command);
            }
        }
        Ok(jumped)
    }

    fn take_effect(&mut self, t: f64, command: f64) -> bool {
        self.drive.turn_to(&mut self.state.drive, t, command);
        self.drive.jumps()
    }

    /// The command of sample `number` at `t` s, N.
    fn sampled(&mut self, t: f64, number: i64, read: &mut dyn FnMut(&mut Reading)) -> Result<f64, StepError> {
        read(&mut self.shown);
        self.disturb(number);
        if let Some(rule) = &mut self.rule {
            let command = rule.command(number, &self.shown, self.desired);
            self.state.given = command.map_err(|source| StepError::NoCommand { t, source })?;
        }
        let drive = KnownDrive {
            force: self.force(t),
            command: self.state.drive.command,
        };
        let bounds = (self.drive.limit, self.state.given);
        let memory = &mut self.state.memory;
        Ok(self.law.command(memory, &self.shown, self.desired, drive, bounds))
    }

    /// Adds the noise of sample `number` to what the sensors show.
    fn disturb(&mut self, number: i64) {
        let sensors = self.sensors;
        let moving = [
            sensors.velocity_noise,
            sensors.position_noise,
            sensors.acceleration_noise,
        ];
        if sensors.force_noise == 0.0 && moving == [0.0; 3] {
            return;
        }
        let mut random = SplitMix64::stream(sensors.seed as u64, number as u64);
        let shown = &mut self.shown;
        shown.force += sensors.force_noise * normal(&mut random);
        shown.driven += sensors.velocity_noise * normal(&mut random);
        for rise in &mut shown.rises {
            *rise += sensors.position_noise * normal(&mut random);
        }
        for velocity in &mut shown.velocities {
            *velocity += sensors.velocity_noise * normal(&mut random);
        }
        shown.driven_place += sensors.position_noise * normal(&mut random);
        shown.head_height += sensors.position_noise * normal(&mut random);
        shown.head_velocity += sensors.velocity_noise * normal(&mut random);
        shown.head_acceleration += sensors.acceleration_noise * normal(&mut random);
    }
}

/// A number of the standard normal distribution [G. Box, M. Muller, Ann. Math. Statist. 29 (1958) 610].
fn normal(random: &mut SplitMix64) -> f64 {
    let radius = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.unit()).cos()
}
