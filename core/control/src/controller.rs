//! Samples, delays and noise around a rule and a drive.

use dynamics::SplitMix64;
use serde::{Deserialize, Serialize};

use crate::actuator::{Drive, DriveState};
use crate::law::{KnownDrive, Law, Memory};
use crate::riccati::NoGains;

/// Part of a sample time within which two times are one.
const SAME_TIME: f64 = 1e-7;

/// Contact force and motion that the instruments of a pantograph see.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Contact force on the head, all strips together, N.
    pub force: f64,
    /// Vertical velocity of the driven point, m/s.
    pub driven: f64,
    /// Rises of the masses of a chain above their places of reference, head first, m; empty for a linkage.
    pub rises: Vec<f64>,
    /// Their velocities, m/s.
    pub velocities: Vec<f64>,
}

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
#[derive(Clone, Debug, PartialEq)]
pub struct Controller {
    sample: f64,
    delay: f64,
    desired: f64,
    law: Law,
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
            sample: control.sample_time,
            delay: control.delay(),
            desired,
            law: Law::new(control, lumped, desired, reference_force)?,
            drive: Drive::from(&control.actuator),
            sensors: control.sensors,
            state: ControllerState::default(),
            shown: Reading::default(),
        })
    }

    /// The state, to be kept and gone back to.
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

    /// Force of the drive at `t` s, N: valid up to the next event.
    #[must_use]
    pub fn force(&self, t: f64) -> f64 {
        self.drive.force(&self.state.drive, t)
    }

    /// First time after `t` s at which a sample is taken or a command takes effect, s.
    #[must_use]
    pub fn next_event(&self, t: f64) -> f64 {
        let after = self.first_after(t);
        let next = self.state.next.map_or(after, |next| next.max(after));
        let event = next as f64 * self.sample;
        match self.state.on_its_way {
            Some([time, _]) if !self.is_due(time, t) => event.min(time),
            _ => event,
        }
    }

    /// Does what is due at `t` s: a command takes effect, a sample is taken by `read`. Returns true where the force of
    /// the drive may have jumped.
    pub fn act(&mut self, t: f64, read: &mut dyn FnMut(&mut Reading)) -> bool {
        let mut jumped = false;
        if let Some([time, command]) = self.state.on_its_way
            && self.is_due(time, t)
        {
            self.state.on_its_way = None;
            jumped |= self.take_effect(t, command);
        }
        let next = self.state.next.unwrap_or_else(|| self.first_from(t));
        self.state.next = Some(next);
        if self.is_due(next as f64 * self.sample, t) {
            let command = self.sampled(t, next, read);
            self.state.next = Some(self.first_after(t));
            if self.delay > 0.0 {
                self.state.on_its_way = Some([next as f64 * self.sample + self.delay, command]);
            } else {
                jumped |= self.take_effect(t, command);
            }
        }
        jumped
    }

    fn take_effect(&mut self, t: f64, command: f64) -> bool {
        self.drive.turn_to(&mut self.state.drive, t, command);
        self.drive.jumps()
    }

    /// The command of sample `number` at `t` s, N.
    fn sampled(&mut self, t: f64, number: i64, read: &mut dyn FnMut(&mut Reading)) -> f64 {
        read(&mut self.shown);
        self.disturb(number);
        let drive = KnownDrive {
            force: self.force(t),
            command: self.state.drive.command,
        };
        let bounds = (self.drive.limit, self.state.given);
        self.law
            .command(&mut self.state.memory, &self.shown, self.desired, drive, bounds)
    }

    /// Adds the noise of sample `number` to what the sensors show.
    fn disturb(&mut self, number: i64) {
        let sensors = self.sensors;
        if [sensors.force_noise, sensors.velocity_noise, sensors.position_noise] == [0.0; 3] {
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
    }

    /// Number of the first sample at `t` s or later.
    fn first_from(&self, t: f64) -> i64 {
        (t / self.sample - SAME_TIME).ceil() as i64
    }

    /// Number of the first sample later than `t` s.
    fn first_after(&self, t: f64) -> i64 {
        ((t / self.sample + SAME_TIME).floor() as i64).saturating_add(1)
    }

    fn is_due(&self, event: f64, t: f64) -> bool {
        event <= t + SAME_TIME * self.sample
    }
}

/// A number of the standard normal distribution [G. Box, M. Muller, Ann. Math. Statist. 29 (1958) 610].
fn normal(random: &mut SplitMix64) -> f64 {
    let radius = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.unit()).cos()
}
