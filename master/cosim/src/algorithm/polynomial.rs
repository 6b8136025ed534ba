//! Inputs as polynomials over one macro step.

use crate::slave::{Slave, SlaveError};

/// Highest degree.
pub const MAX_DEGREE: usize = 3;

/// A vector of inputs over a step: values and derivatives at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Values at the start of the step, in the inputs' own units.
    pub value: Vec<f64>,
    /// `derivatives[k - 1]` has order k, unit per s^k.
    pub derivatives: [Vec<f64>; MAX_DEGREE],
    /// Degree: derivatives above it are zero.
    pub degree: usize,
    /// Working copy of what is sent.
    sent: Vec<f64>,
}

impl Polynomial {
    /// `size` inputs that are zero.
    #[must_use]
    pub fn zeros(size: usize) -> Self {
        let zeros = || vec![0.0; size];
        Self {
            value: zeros(),
            derivatives: [zeros(), zeros(), zeros()],
            degree: 0,
            sent: zeros(),
        }
    }

    /// Makes all derivatives zero and sets the degree.
    pub fn clear(&mut self, degree: usize) {
        for derivative in &mut self.derivatives {
            derivative.fill(0.0);
        }
        self.degree = degree;
    }

    /// Takes `values` at the start of a step and holds them, as a slave does when its inputs are set.
    pub fn hold(&mut self, values: &[f64]) {
        self.clear(0);
        self.value.copy_from_slice(values);
    }

    /// Takes the derivatives of `order` (from 1), as a slave does when its input derivatives are set.
    pub fn follow(&mut self, order: usize, values: &[f64]) {
        self.derivatives[order - 1].copy_from_slice(values);
    }

    /// Writes the same polynomial as seen from `tau` s after the start into `part`, which has as many inputs.
    pub fn shift_to(&self, tau: f64, part: &mut Self) {
        part.degree = self.degree;
        let [first, second, third] = &self.derivatives;
        for i in 0..self.value.len() {
            part.value[i] = self.at(i, tau);
            part.derivatives[0][i] = first[i] + tau * (second[i] + tau * third[i] / 2.0);
            part.derivatives[1][i] = second[i] + tau * third[i];
            part.derivatives[2][i] = third[i];
        }
    }

    /// Value of input `i` at `tau` s after the start.
    #[must_use]
    pub fn at(&self, i: usize, tau: f64) -> f64 {
        let [first, second, third] = &self.derivatives;
        self.value[i] + tau * (first[i] + tau * (second[i] / 2.0 + tau * third[i] / 6.0))
    }

    /// Mean of input `i` over the first `h` s.
    #[must_use]
    pub fn mean(&self, i: usize, h: f64) -> f64 {
        let [first, second, third] = &self.derivatives;
        self.value[i] + h * (first[i] / 2.0 + h * (second[i] / 6.0 + h * third[i] / 24.0))
    }

    /// Sets the inputs of `slave` for a step of `h` s.
    ///
    /// A slave that takes derivatives of a lower order than the degree is given the polynomial of that order that
    /// reaches the same end, or the mean where it takes none.
    ///
    /// # Errors
    /// Error reported by the slave.
    pub fn send(&mut self, slave: &mut dyn Slave, h: f64) -> Result<(), SlaveError> {
        let able = slave.abilities().input_derivatives;
        if able >= self.degree {
            slave.set_inputs(&self.value)?;
            for order in 1..=self.degree {
                slave.set_input_derivatives(order, &self.derivatives[order - 1])?;
            }
            return Ok(());
        }
        if able == 0 {
            for i in 0..self.value.len() {
                self.sent[i] = self.mean(i, h);
            }
            return slave.set_inputs(&self.sent);
        }
        slave.set_inputs(&self.value)?;
        for order in 1..able {
            slave.set_input_derivatives(order, &self.derivatives[order - 1])?;
        }
        // The highest derivative that is taken makes up for those that are not: p(h) is reached.
        for i in 0..self.value.len() {
            let (mut reached, mut power) = (self.value[i], 1.0);
            for order in 1..able {
                power *= h / order as f64;
                reached += self.derivatives[order - 1][i] * power;
            }
            power *= h / able as f64;
            self.sent[i] = (self.at(i, h) - reached) / power;
        }
        slave.set_input_derivatives(able, &self.sent)
    }
}
