//! A driven oscillator as an FMU: the smallest complete user of the export runtime, and the subject of its tests.
//!
//! ```text
//! m a = F − k x − c v
//! ```
#![deny(unsafe_code)]

mod variables;

use fmi2::model_description::Variable;
use fmi2::slave::{Model, ModelError, ModelResult};
use std::path::Path;
pub use variables::at;

/// Failure that a test asks for, the value of `trouble`.
mod trouble {
    pub const PANIC: i32 = 1;
    pub const NO_CONVERGENCE_ABOVE_1_MS: i32 = 2;
    pub const SINGULAR: i32 = 3;
    pub const NAN: i32 = 4;
}

/// The model.
#[derive(Clone, Debug)]
pub struct Oscillator {
    /// kg, N/m, N·s/m, m.
    parameters: [f64; 4],
    label: String,
    use_derivatives: bool,
    trouble: i32,
    /// N and N/s.
    force: [f64; 2],
    /// m, m/s.
    state: [f64; 2],
    initialised: bool,
    steps: i32,
}

impl Oscillator {
    fn new() -> Self {
        Self {
            parameters: [2.0, 800.0, 1.0, 0.1],
            label: "oscillator".into(),
            use_derivatives: true,
            trouble: 0,
            force: [0.0; 2],
            state: [0.0; 2],
            initialised: false,
            steps: 0,
        }
    }

    fn acceleration(&self, force: f64, [x, v]: [f64; 2]) -> f64 {
        let [m, k, c, _] = self.parameters;
        (force - k * x - c * v) / m
    }

    /// m, m/s; before the end of the initialisation the start values.
    fn present(&self) -> [f64; 2] {
        if self.initialised {
            self.state
        } else {
            [self.parameters[3], 0.0]
        }
    }
}

impl Model for Oscillator {
    type State = Self;

    fn instantiate(_resources: Option<&Path>) -> ModelResult<Self> {
        Ok(Self::new())
    }

    fn variables(&self) -> Vec<Variable> {
        variables::table()
    }

    fn reset(&mut self) -> ModelResult<()> {
        *self = Self::new();
        Ok(())
    }

    fn exit_initialization(&mut self) -> ModelResult<()> {
        self.state = self.present();
        self.initialised = true;
        Ok(())
    }

    fn real(&mut self, position: usize) -> ModelResult<f64> {
        Ok(match position {
            at::FORCE => self.force[0],
            at::X if self.trouble == trouble::NAN => f64::NAN,
            at::X => self.present()[0],
            at::V => self.present()[1],
            at::A => self.acceleration(self.force[0], self.present()),
            _ => self.parameters[position - at::MASS],
        })
    }

    fn integer(&mut self, position: usize) -> ModelResult<i32> {
        Ok(if position == at::STEPS {
            self.steps
        } else {
            self.trouble
        })
    }

    fn boolean(&mut self, position: usize) -> ModelResult<bool> {
        Ok(if position == at::ABOVE {
            self.present()[0] > 0.0
        } else {
            self.use_derivatives
        })
    }

    fn string(&mut self, _position: usize) -> ModelResult<String> {
        Ok(self.label.clone())
    }

    fn set_real(&mut self, position: usize, value: f64) -> ModelResult<()> {
        if position == at::FORCE {
            self.force = [value, 0.0];
            return Ok(());
        }
        let negative = matches!(position, at::STIFFNESS | at::DAMPING) && value < 0.0;
        if negative || position == at::MASS && value <= 0.0 {
            return Err(ModelError::unusable(format!(
                "parameter {position} = {value}: must be positive"
            )));
        }
        self.parameters[position - at::MASS] = value;
        Ok(())
    }

    fn set_integer(&mut self, position: usize, value: i32) -> ModelResult<()> {
        assert_eq!(position, at::TROUBLE);
        self.trouble = value;
        Ok(())
    }

    fn set_boolean(&mut self, position: usize, value: bool) -> ModelResult<()> {
        assert_eq!(position, at::USE_DERIVATIVES);
        self.use_derivatives = value;
        Ok(())
    }

    fn set_string(&mut self, position: usize, value: &str) -> ModelResult<()> {
        assert_eq!(position, at::LABEL);
        value.clone_into(&mut self.label);
        Ok(())
    }

    fn set_input_derivative(&mut self, _position: usize, order: u32, value: f64) -> ModelResult<()> {
        if order == 1 && self.use_derivatives {
            self.force[1] = value;
        }
        Ok(())
    }

    fn output_derivative(&mut self, position: usize, order: u32) -> ModelResult<f64> {
        Ok(match (position, order) {
            (at::X, 1) => self.state[1],
            (at::X, 2) | (at::V, 1) => self.acceleration(self.force[0], self.state),
            _ => 0.0,
        })
    }

    fn directional_derivative(&mut self, output: usize, _input: usize) -> ModelResult<f64> {
        Ok(if output == at::A { 1.0 / self.parameters[0] } else { 0.0 })
    }

    /// Classical Runge-Kutta steps of at most 1 ms.
    fn do_step(&mut self, time: f64, step: f64) -> ModelResult<()> {
        match self.trouble {
            trouble::PANIC => panic!("no luck at t = {time} s"),
            trouble::NO_CONVERGENCE_ABOVE_1_MS if step > 1e-3 + 1e-12 => {
                return Err(ModelError::retryable(format!(
                    "no equilibrium at t = {time} s, h = {step} s"
                )));
            }
            trouble::SINGULAR => return Err(ModelError::unusable("the matrix is singular")),
            _ => {}
        }
        let count = (step / 1e-3 - 1e-9).ceil().max(1.0);
        let h = step / count;
        for n in 0..count as usize {
            let rate = |offset: f64, [x, v]: [f64; 2]| {
                let force = self.force[0] + self.force[1] * (n as f64 * h + offset);
                [v, self.acceleration(force, [x, v])]
            };
            let moved = |[dx, dv]: [f64; 2], by: f64| [self.state[0] + by * dx, self.state[1] + by * dv];
            let k1 = rate(0.0, self.state);
            let k2 = rate(h / 2.0, moved(k1, h / 2.0));
            let k3 = rate(h / 2.0, moved(k2, h / 2.0));
            let k4 = rate(h, moved(k3, h));
            let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            self.state = moved([mean(0), mean(1)], h);
        }
        self.force = [self.force[0] + self.force[1] * step, 0.0];
        self.steps += 1;
        Ok(())
    }

    fn save(&mut self) -> Self {
        self.clone()
    }

    fn restore(&mut self, state: &Self) -> ModelResult<()> {
        self.clone_from(state);
        Ok(())
    }

    fn serialize(state: &Self) -> ModelResult<Vec<u8>> {
        let mut bytes = Vec::new();
        for number in state.parameters.iter().chain(&state.force).chain(&state.state) {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for number in [
            i32::from(state.initialised),
            i32::from(state.use_derivatives),
            state.trouble,
            state.steps,
        ] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(state.label.as_bytes());
        Ok(bytes)
    }

    fn deserialize(bytes: &[u8]) -> ModelResult<Self> {
        let wrong = || ModelError::unusable("the bytes are no oscillator");
        let (reals, rest) = bytes.split_at_checked(64).ok_or_else(wrong)?;
        let (integers, label) = rest.split_at_checked(16).ok_or_else(wrong)?;
        let r: Vec<f64> = reals
            .chunks(8)
            .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
            .collect();
        let i: Vec<i32> = integers
            .chunks(4)
            .map(|c| i32::from_le_bytes(c.try_into().unwrap()))
            .collect();
        Ok(Self {
            parameters: [r[0], r[1], r[2], r[3]],
            force: [r[4], r[5]],
            state: [r[6], r[7]],
            initialised: i[0] != 0,
            use_derivatives: i[1] != 0,
            trouble: i[2],
            steps: i[3],
            label: String::from_utf8(label.to_vec()).map_err(ModelError::unusable)?,
        })
    }
}

fmi2::export_fmu!(Oscillator);
