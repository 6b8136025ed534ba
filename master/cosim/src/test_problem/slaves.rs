//! The two sides of the coupling test problem as slaves that leave no error but the coupling's.

use component::Work;

use crate::algorithm::Polynomial;
use crate::slave::{Abilities, Slave, SlaveError};
use component::exchange::{contact, load, strip};

use super::system::{PantographState, Parameters, WireState, rk4};

/// Longest step of the fourth-order Runge-Kutta method inside a slave, s: ω h < 0.006.
const SUBSTEP: f64 = 5e-5;

/// Abilities that a slave shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switches {
    /// Highest order of input derivatives that it follows.
    pub input_derivatives: usize,
    /// True where the slave can go back.
    pub rollback: bool,
}

impl Switches {
    /// Can do everything.
    pub const ALL: Self = Self {
        input_derivatives: 3,
        rollback: true,
    };

    pub(crate) fn abilities(self) -> Abilities {
        Abilities {
            rollback: self.rollback,
            input_derivatives: self.input_derivatives,
            variable_step: true,
        }
    }
}

/// The two-mass pantograph.
#[derive(Clone, Debug)]
pub struct Pantograph {
    parameters: Parameters,
    switches: Switches,
    inputs: Polynomial,
    state: PantographState,
    work: f64,
    kept: (PantographState, f64),
    steps: u64,
}

impl Pantograph {
    /// At rest in balance.
    #[must_use]
    pub fn new(parameters: Parameters, switches: Switches) -> Self {
        let state = parameters.start().0;
        Self {
            parameters,
            switches,
            inputs: Polynomial::zeros(load::COUNT),
            state,
            work: 0.0,
            kept: (state, 0.0),
            steps: 0,
        }
    }
}

impl Slave for Pantograph {
    fn name(&self) -> &str {
        "two-mass pantograph"
    }

    fn abilities(&self) -> Abilities {
        self.switches.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.hold(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.follow(order, values);
        Ok(())
    }

    fn do_step(&mut self, _t: f64, h: f64) -> Result<(), SlaveError> {
        let steps = (h / SUBSTEP - 1e-9).ceil().max(1.0);
        let (d, parameters, inputs) = (h / steps, self.parameters, &self.inputs);
        for k in 0..steps as usize {
            let t = k as f64 * d;
            let mut all = [0.0; 5];
            all[..4].copy_from_slice(&self.state);
            // The fifth is the work done on the head.
            let all = rk4(all, t, d, &|t, y: &[f64; 5]| {
                let force = inputs.at(load::FZ, t);
                let [z1, v1, z2, v2, _] = *y;
                let rate = parameters.pantograph_rate(&[z1, v1, z2, v2], -force);
                [rate[0], rate[1], rate[2], rate[3], force * v1]
            });
            self.state.copy_from_slice(&all[..4]);
            self.work += all[4];
        }
        self.steps += 1;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.fill(0.0);
        values[strip::Z] = self.state[0];
        values[strip::VZ] = self.state[1];
        values[strip::WORK] = self.work;
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = (self.state, self.work);
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        (self.state, self.work) = self.kept;
        Ok(())
    }

    /// The steps done, those taken back included.
    fn work(&mut self) -> Work {
        Work {
            micro_steps: self.steps,
            ..Work::default()
        }
    }
}

/// The wire: one mode, with the contact on its side.
#[derive(Clone, Debug)]
pub struct Wire {
    parameters: Parameters,
    switches: Switches,
    inputs: Polynomial,
    now: WireNow,
    kept: WireNow,
}

#[derive(Clone, Copy, Debug)]
struct WireNow {
    state: WireState,
    strip: f64,
    force: f64,
    mean: f64,
    samples: [f64; contact::SAMPLE_COUNT],
    work: f64,
}

impl Wire {
    /// At rest in balance.
    #[must_use]
    pub fn new(parameters: Parameters, switches: Switches) -> Self {
        let (pantograph, state) = parameters.start();
        let force = parameters.force(pantograph[0] - state[0]);
        let now = WireNow {
            state,
            strip: pantograph[0],
            force,
            mean: force,
            samples: [force; contact::SAMPLE_COUNT],
            work: 0.0,
        };
        Self {
            parameters,
            switches,
            inputs: Polynomial::zeros(strip::MOTION),
            now,
            kept: now,
        }
    }
}

impl Slave for Wire {
    fn name(&self) -> &str {
        "one-mode wire"
    }

    fn abilities(&self) -> Abilities {
        self.switches.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.hold(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.follow(order, values);
        Ok(())
    }

    fn do_step(&mut self, t0: f64, h: f64) -> Result<(), SlaveError> {
        let per_sample = (h / (contact::SAMPLE_COUNT as f64 * SUBSTEP) - 1e-9).ceil().max(1.0) as usize;
        let d = h / (per_sample * contact::SAMPLE_COUNT) as f64;
        let (parameters, inputs) = (self.parameters, &self.inputs);
        let [first, second, third] = [0, 1, 2].map(|k| inputs.derivatives[k][strip::Z]);
        let velocity = |t: f64| first + t * (second + t * third / 2.0);
        let mut impulse = 0.0;
        for j in 0..contact::SAMPLE_COUNT {
            for k in 0..per_sample {
                let t = (j * per_sample + k) as f64 * d;
                let [z, v] = self.now.state;
                // The third is the impulse, the fourth the work done by the strip.
                let [z, v, part, work] = rk4([z, v, 0.0, 0.0], t, d, &|t, y: &[f64; 4]| {
                    let force = parameters.force(inputs.at(strip::Z, t) - y[0]);
                    let [zr, vr] = parameters.wire_rate(t0 + t, &[y[0], y[1]], force);
                    [zr, vr, force, force * velocity(t)]
                });
                self.now.state = [z, v];
                impulse += part;
                self.now.work += work;
            }
            let t = if j + 1 == contact::SAMPLE_COUNT {
                h
            } else {
                ((j + 1) * per_sample) as f64 * d
            };
            self.now.strip = inputs.at(strip::Z, t);
            self.now.force = parameters.force(self.now.strip - self.now.state[0]);
            self.now.samples[j] = self.now.force;
        }
        self.now.mean = impulse / h;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.fill(0.0);
        values[contact::FZ] = -self.now.force;
        values[contact::MEAN_FZ] = -self.now.mean;
        values[contact::FORCE] = self.now.force;
        values[contact::SAMPLES..contact::SAMPLES + contact::SAMPLE_COUNT].copy_from_slice(&self.now.samples);
        values[contact::WIRE_Z] = self.now.state[0];
        values[contact::GAP] = self.now.state[0] - self.now.strip;
        values[contact::WORK] = self.now.work;
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = self.now;
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.now = self.kept;
        Ok(())
    }
}
