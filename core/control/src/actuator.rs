//! Force of a drive behind its commands.

use serde::{Deserialize, Serialize};

/// A drive whose force follows a held command `c` as a lag of first order, no faster than its rate:
///
/// ```text
/// |c| ≤ limit,    dF/dt = clamp((c − F)/T, −r, r)
/// ```
///
/// Both phases have closed forms: `F` rises evenly while `|c − F| > r T`, then `c − F` decays as `exp(−t/T)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Largest command, N; infinite without limit.
    pub limit: f64,
    /// `r`, N/s; infinite without limit.
    pub rate: f64,
    /// `T`, s; 0 follows at once, as fast as the rate allows.
    pub lag: f64,
}

/// Force of a drive at a time, and the command that it follows from there on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriveState {
    /// s.
    pub since: f64,
    /// N, at [`DriveState::since`].
    pub force: f64,
    /// N.
    pub command: f64,
}

impl From<&scene::Actuator> for Drive {
    fn from(entry: &scene::Actuator) -> Self {
        Self {
            limit: entry.limit.unwrap_or(f64::INFINITY),
            rate: entry.rate_limit.unwrap_or(f64::INFINITY),
            lag: entry.lag,
        }
    }
}

impl Drive {
    /// Force at `t` s, N.
    #[must_use]
    pub fn force(&self, state: &DriveState, t: f64) -> f64 {
        let gap = state.command - state.force;
        let time = t - state.since;
        // Part of the gap that the lag covers without reaching the rate.
        let lagged = self.rate * self.lag;
        let even = if gap.abs() > lagged {
            (gap.abs() - lagged) / self.rate
        } else {
            0.0
        };
        if time < even {
            return state.force + gap.signum() * self.rate * time;
        }
        if self.lag == 0.0 {
            return state.command;
        }
        let left = gap.abs().min(lagged) * (-(time - even) / self.lag).exp();
        state.command - gap.signum() * left
    }

    /// Follows another command from `t` s on.
    pub fn turn_to(&self, state: &mut DriveState, t: f64, command: f64) {
        *state = DriveState {
            since: t,
            force: self.force(state, t),
            command,
        };
    }

    /// True for a drive whose force jumps with its command.
    #[must_use]
    pub fn jumps(&self) -> bool {
        self.lag == 0.0 && self.rate.is_infinite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(drive: Drive, command: f64, t: f64) -> f64 {
        let mut state = DriveState::default();
        drive.turn_to(&mut state, 0.0, command);
        drive.force(&state, t)
    }

    #[test]
    fn the_force_solves_its_differential_equation() {
        let drives = [
            (f64::INFINITY, 0.02),
            (500.0, 0.02),
            (500.0, 0.0),
            (1e6, 0.02),
            (f64::INFINITY, 0.0),
        ];
        for (rate, lag) in drives {
            let drive = Drive {
                limit: f64::INFINITY,
                rate,
                lag,
            };
            for command in [30.0, -30.0] {
                // Euler's method in small steps; its error is that of one step.
                let (h, mut force): (f64, f64) = (1e-6, 0.0);
                for step in 1..=100_000_u32 {
                    let gap: f64 = command - force;
                    let wanted = if lag == 0.0 { gap / h } else { gap / lag };
                    force += h * wanted.clamp(-rate, rate);
                    if step % 5000 == 0 {
                        let exact = after(drive, command, f64::from(step) * h);
                        assert!((exact - force).abs() < 2e-3, "{drive:?} {step}: {exact} {force}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_command_in_two_parts_is_the_same_command() {
        let drive = Drive {
            limit: f64::INFINITY,
            rate: 400.0,
            lag: 0.03,
        };
        let mut state = DriveState::default();
        drive.turn_to(&mut state, 0.0, 40.0);
        let whole = drive.force(&state, 0.2);
        for part in [0.01, 0.07, 0.15] {
            let mut state = state;
            drive.turn_to(&mut state, part, 40.0);
            // Rounding.
            assert!((drive.force(&state, 0.2) - whole).abs() < 1e-12);
        }
    }
}
