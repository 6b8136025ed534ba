//! Rules that make a command from a reading.

use scene::ControlLaw;

use crate::controller::Reading;
use crate::linear::{Delayed, LinearPantograph};
use crate::riccati::{NoGains, gains};

/// A rule with its gains.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Law {
    Pid {
        kp: f64,
        /// Integral gain by the sample time, –.
        ki: f64,
        /// Derivative gain over the sample time, –.
        kd: f64,
        /// Share of the last derivative that stays.
        kept: f64,
    },
    Lqr {
        /// For rise and velocity of each mass, N/m and N·s/m.
        masses: Vec<[f64; 2]>,
        /// For the force of the drive and the command on its way, –; 0 where the loop has none.
        drive: [f64; 2],
        wire_stiffness: f64,
        /// Rises of the masses above that of the head at the desired force, m.
        above_head: Vec<f64>,
    },
    Skyhook {
        damping: f64,
    },
    Given,
}

/// Memory of a rule from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Memory {
    /// Integral part of the command, N.
    pub integral: f64,
    /// Filtered derivative part of the command, N.
    pub derivative: f64,
    /// Error of the last sample, N.
    pub error: f64,
    /// False before the first sample.
    pub begun: bool,
}

impl Memory {
    /// Memory of a loop under way: derivative part, error, integral part; what is left out is 0.
    pub fn of(values: &[f64]) -> Self {
        let value = |index: usize| values.get(index).copied().unwrap_or_default();
        Self {
            derivative: value(0),
            error: value(1),
            integral: value(2),
            begun: true,
        }
    }

    /// The values again.
    pub fn values(&self) -> [f64; 3] {
        [self.derivative, self.error, self.integral]
    }
}

/// State of the drive as its controller knows it, N: the force now, and the command on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct KnownDrive {
    pub force: f64,
    pub command: f64,
}

impl Law {
    /// The rule of a scene; `desired` and `reference_force` (N) are the contact forces that the controller aims at and
    /// that holds the pantograph at its reference height.
    pub(crate) fn new(
        control: &scene::Control,
        lumped: Option<&scene::Lumped>,
        desired: f64,
        reference_force: f64,
    ) -> Result<Self, NoGains> {
        let sample = control.sample_time;
        Ok(match control.law {
            ControlLaw::Pid {
                kp,
                ki,
                kd,
                derivative_lag,
            } => Self::Pid {
                kp,
                ki: ki * sample,
                kd: kd / sample,
                kept: if derivative_lag > 0.0 {
                    (-sample / derivative_lag).exp()
                } else {
                    0.0
                },
            },
            ControlLaw::Lqr {
                force_weight,
                velocity_weight,
                effort_weight,
                wire_stiffness,
            } => {
                let lumped = lumped.ok_or(NoGains)?;
                let plant = LinearPantograph::new(lumped, &control.actuator, wire_stiffness);
                let delayed = Delayed::new(&plant, sample, control.delay());
                let mut weights = nalgebra::DMatrix::zeros(delayed.size(), delayed.size());
                weights[(0, 0)] = force_weight * wire_stiffness * wire_stiffness;
                let velocity = plant.masses() + plant.driven_mass();
                weights[(velocity, velocity)] += velocity_weight;
                let gains = gains(&delayed, &weights, effort_weight)?;
                let count = plant.masses();
                let drive = [
                    plant.drive_state().map_or(0.0, |state| gains[state]),
                    gains.get(plant.size()).copied().unwrap_or(0.0),
                ];
                // Each spring gives way to the force beyond that of the reference height.
                let excess = desired - reference_force;
                let mut above_head = vec![0.0; count];
                for i in 1..count {
                    above_head[i] = above_head[i - 1] + excess / lumped.stiffnesses[i - 1];
                }
                Self::Lqr {
                    masses: (0..count).map(|i| [gains[i], gains[count + i]]).collect(),
                    drive,
                    wire_stiffness,
                    above_head,
                }
            }
            ControlLaw::Skyhook { damping } => Self::Skyhook { damping },
            ControlLaw::Given => Self::Given,
        })
    }

    /// Number of values of [`Memory::of`] that go on from sample to sample.
    pub(crate) fn remembers(&self) -> usize {
        match self {
            Self::Pid { ki, .. } => 2 + usize::from(*ki > 0.0),
            Self::Lqr { .. } | Self::Skyhook { .. } | Self::Given => 0,
        }
    }

    /// Command at a sample, N, within ± `limit`; `given` is the one from outside.
    ///
    /// ```text
    /// PID      u = kp e + I + D,  e = F_desired − F,  I += ki T e,  D = a D + (1 − a) kd (e − e₋)/T,  a = exp(−T/T_d)
    /// skyhook  u = −c v
    /// LQR      u = −K x
    /// ```
    ///
    /// The integral of a PID stands still where it would drive a limited command further out. The state `x` of an LQR
    /// takes the place of the head from the contact force, over the stiffness of the wire, and those of the other
    /// masses relative to it: a wire that rises or falls along the track is no deviation (derived here).
    pub(crate) fn command(
        &self,
        memory: &mut Memory,
        reading: &Reading,
        desired: f64,
        drive: KnownDrive,
        (limit, given): (f64, f64),
    ) -> f64 {
        let limited = |command: f64| command.clamp(-limit, limit);
        match self {
            Self::Pid { kp, ki, kd, kept } => {
                let error = desired - reading.force;
                if !memory.begun {
                    (memory.error, memory.begun) = (error, true);
                }
                let change = kd * (error - memory.error);
                memory.derivative = kept * memory.derivative + (1.0 - kept) * change;
                memory.error = error;
                let rest = kp * error + memory.derivative;
                let integral = memory.integral + ki * error;
                let outward = (rest + integral).abs() > limit && (rest + integral) * error > 0.0;
                if !outward {
                    memory.integral = integral;
                }
                limited(rest + memory.integral)
            }
            Self::Lqr {
                masses,
                drive: [of_force, of_command],
                wire_stiffness,
                above_head,
            } => {
                let head = (reading.force - desired) / wire_stiffness;
                let mut command = -of_force * drive.force - of_command * drive.command;
                for (i, [of_rise, of_velocity]) in masses.iter().enumerate() {
                    let rise = head + reading.rises[i] - reading.rises[0] - above_head[i];
                    command -= of_rise * rise + of_velocity * reading.velocities[i];
                }
                limited(command)
            }
            Self::Skyhook { damping } => limited(-damping * reading.driven),
            Self::Given => limited(given),
        }
    }
}
