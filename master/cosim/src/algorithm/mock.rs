//! A slave for tests that is no model of anything.

use crate::slave::{Abilities, Slave, SlaveError};

/// A slave whose outputs are a linear function of the inputs of its last step.
pub(super) struct Gain {
    pub(super) output: fn(&[f64]) -> Vec<f64>,
    pub(super) inputs: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Slave for Gain {
    fn name(&self) -> &str {
        "gain"
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: false,
            input_derivatives: 0,
            variable_step: true,
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs = values.to_vec();
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, _values: &[f64]) -> Result<(), SlaveError> {
        panic!("order {order} was not offered");
    }

    fn do_step(&mut self, _t: f64, _h: f64) -> Result<(), SlaveError> {
        self.values = (self.output)(&self.inputs);
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.copy_from_slice(&self.values);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        panic!("not offered");
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        panic!("not offered");
    }
}
