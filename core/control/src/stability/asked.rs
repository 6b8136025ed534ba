//! Delay that a loop bears whose rule is known by its answers alone.

use dynamics::OutsideError;
use nalgebra::DVector;

use super::SampledLoop;
use crate::controller::{Asked, Reading, Rule};
use crate::linear::Delayed;

/// Longest delay that is tried, in samples.
const LONGEST: f64 = 8.0;

/// Halvings of a quarter of a sample that the margin lies in.
const HALVINGS: usize = 6;

/// Most samples of a trial.
const MOST: usize = 900;

/// Fewest samples of a trial that tell growth from decay.
pub const FEWEST_SAMPLES: usize = 450;

/// Deviation of the force at the start of a trial by the desired force, –: within the limits of any drive.
const SMALL: f64 = 1e-3;

/// Samples at the start of a trial whose largest change is compared with later ones.
const EARLY: usize = 20;

/// Growth beyond which a motion is not one of the start that dies out; what is limited grows no further.
const GROWN: f64 = 5.0;

/// Change by that at the start below which a motion has died out.
const DIED_OUT: f64 = 1e-9;

impl SampledLoop {
    /// Delay of sensors and actuator together beyond which the loop with `rule` is unstable, s, by trials of at most
    /// `samples` samples of the linear pantograph from a small motion: 0 for a loop that is unstable without any,
    /// infinite for one that is stable with 8 samples; none where the samples are too few. The rule of the scene has no
    /// part in it; `rule` begins anew in each trial, and is left at its start.
    ///
    /// # Errors
    /// A rule that gives no command or does not go back to its start.
    pub fn delay_margin_of(
        &self,
        rule: &mut dyn Rule,
        desired: f64,
        samples: usize,
    ) -> Result<Option<f64>, OutsideError> {
        let samples = samples.min(MOST);
        if samples < FEWEST_SAMPLES {
            return Ok(None);
        }
        let margin = self.margin_in(&mut |delay| self.dies_out(rule, desired, delay, samples))?;
        rule.ask_again(&Asked::default())?;
        Ok(Some(margin))
    }

    fn margin_in(&self, stable: &mut dyn FnMut(f64) -> Result<bool, OutsideError>) -> Result<f64, OutsideError> {
        if !stable(0.0)? {
            return Ok(0.0);
        }
        let quarter = 0.25 * self.sample;
        for number in 1..=(4.0 * LONGEST) as usize {
            let mut beyond = quarter * number as f64;
            if stable(beyond)? {
                continue;
            }
            let mut below = beyond - quarter;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (below + beyond);
                if stable(middle)? {
                    below = middle;
                } else {
                    beyond = middle;
                }
            }
            return Ok(0.5 * (below + beyond));
        }
        Ok(f64::INFINITY)
    }

    /// True where a small motion dies out. Changes of the force from sample to sample are looked at: a command that
    /// stays moves the place of rest only.
    fn dies_out(&self, rule: &mut dyn Rule, desired: f64, delay: f64, samples: usize) -> Result<bool, OutsideError> {
        rule.ask_again(&Asked::default())?;
        let delayed = Delayed::new(&self.plant, self.sample, delay);
        let stiffness = self.plant.wire_stiffness();
        let mut state = DVector::zeros(delayed.size());
        state
            .rows_mut(0, self.plant.masses())
            .copy_from(&self.plant.raised(SMALL * desired / stiffness));
        let (mut force, mut command) = (stiffness * self.plant.rise(&state), 0.0);
        let (mut early, mut windows) = (0.0_f64, [0.0_f64; 3]);
        for number in 0..samples {
            let reading = self.reading(&state, command, desired);
            command = rule.command(number as i64, &reading, desired)?;
            state = &delayed.state * state + &delayed.input * command;
            let change = (stiffness * self.plant.rise(&state) - force).abs();
            force = stiffness * self.plant.rise(&state);
            if !change.is_finite() {
                return Ok(false);
            }
            if number < EARLY {
                early = early.max(change);
            }
            let window = &mut windows[3 * number / samples];
            *window = window.max(change);
        }
        let [_, middle, last] = windows;
        Ok(last <= DIED_OUT * early || (last < middle && middle < GROWN * early))
    }

    /// Reading of the instruments: deviations from rest, but for the force.
    fn reading(&self, state: &DVector<f64>, command: f64, desired: f64) -> Reading {
        let masses = self.plant.masses();
        let [driven_place, driven] = self.plant.driven_way(state);
        Reading {
            force: desired + self.plant.wire_stiffness() * self.plant.rise(state),
            driven,
            driven_place,
            head_height: self.plant.rise(state),
            head_velocity: self.plant.head_velocity(state),
            head_acceleration: self.plant.head_acceleration(state, command),
            rises: state.rows(0, masses).iter().copied().collect(),
            velocities: state.rows(masses, masses).iter().copied().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Actuator, Control, ControlLaw, Sensors};

    /// PID without derivative, limited, as a rule from outside.
    struct Proportional {
        kp: f64,
        ki_by_sample: f64,
        limit: f64,
        integral: f64,
        offset: f64,
    }

    impl Rule for Proportional {
        fn command(&mut self, _: i64, shown: &Reading, desired: f64) -> Result<f64, OutsideError> {
            let error = desired - shown.force;
            let command = self.offset + self.kp * error + self.integral;
            self.integral += self.ki_by_sample * error;
            Ok(command.clamp(-self.limit, self.limit))
        }

        fn asked(&self) -> Asked {
            Asked::default()
        }

        fn ask_again(&mut self, _: &Asked) -> Result<(), OutsideError> {
            self.integral = 0.0;
            Ok(())
        }
    }

    fn control(law: ControlLaw) -> Control {
        Control {
            law,
            sample_time: 0.01,
            force: None,
            actuator: Actuator::default(),
            sensors: Sensors::default(),
        }
    }

    #[test]
    fn the_margin_of_a_rule_that_is_asked_is_that_of_the_same_rule_by_its_poles() {
        let lumped = scene::Lumped::new(1.0, 100.0, &[7.2, 15.0], &[4200.0, 50.0], &[10.0, 90.0]);
        let mut finite = 0;
        for (kp, ki) in [
            (0.3, 1.0),
            (1.0, 0.0),
            (1.0, 2.0),
            (1.5, 0.0),
            (2.0, 1.0),
            (3.0, 0.0),
            (30.0, 0.0),
        ] {
            let pid = ControlLaw::Pid {
                kp,
                ki,
                kd: 0.0,
                derivative_lag: 0.0,
            };
            let expected = SampledLoop::new(&control(pid), &lumped, 2500.0).unwrap().delay_margin();
            let given = SampledLoop::new(&control(ControlLaw::Given), &lumped, 2500.0).unwrap();
            for (samples, offset) in [(900, 0.0), (450, 5.0)] {
                let mut rule = Proportional {
                    kp,
                    ki_by_sample: 0.01 * ki,
                    limit: 60.0,
                    integral: 0.0,
                    offset,
                };
                let found = given.delay_margin_of(&mut rule, 120.0, samples).unwrap().unwrap();
                println!("kp {kp}, ki {ki}: {found} s, {expected} s");
                finite += usize::from(found.is_finite() && found > 0.0);
                let both_long = expected > LONGEST * 0.01 && found.is_infinite();
                assert!(
                    both_long || (found - expected).abs() <= 0.03 * expected,
                    "kp {kp}, ki {ki}: {found} {expected}"
                );
                assert_eq!(given.delay_margin_of(&mut rule, 120.0, 50).unwrap(), None);
            }
        }
        assert!(finite >= 2, "{finite}");
    }
}
