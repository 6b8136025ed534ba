//! Inputs followed inside a communication step.
use serde::{Deserialize, Serialize};

/// Highest order of input derivatives that is followed.
pub const MAX_ORDER: usize = 3;

/// One input: its value at the start of the step and its derivatives there.
///
/// A later value clears the derivatives; after a step the value is the one reached and the derivatives are zero
/// (FMI 2.0, 4.2.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FollowedInput {
    value: f64,
    derivatives: [f64; MAX_ORDER],
    given: bool,
}

impl FollowedInput {
    /// An input that is held.
    #[must_use]
    pub fn held(value: f64) -> Self {
        Self {
            value,
            ..Self::default()
        }
    }

    /// Sets the value and clears the derivatives.
    pub fn set(&mut self, value: f64) {
        *self = Self::held(value);
    }

    /// Sets the derivative of `order` 1 to [`MAX_ORDER`] (unit of the input per s^order) at the start of the next step.
    ///
    /// # Panics
    /// When the order is outside that range.
    pub fn set_derivative(&mut self, order: usize, value: f64) {
        assert!(
            (1..=MAX_ORDER).contains(&order),
            "order {order} of an input derivative is outside 1…{MAX_ORDER}"
        );
        self.derivatives[order - 1] = value;
        self.given = true;
    }

    /// The value set, or reached by the last step.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Returns `true` if derivatives were given since the value was set.
    #[must_use]
    pub fn has_derivatives(&self) -> bool {
        self.given
    }

    /// Value `tau` s after the start of the step: `u + u̇ τ + ü τ²/2 + …`.
    #[must_use]
    pub fn at(&self, tau: f64) -> f64 {
        let [first, second, third] = self.derivatives;
        self.value + tau * (first + tau * (second / 2.0 + tau * third / 6.0))
    }

    /// Rate of [`FollowedInput::at`]: `u̇ + ü τ + …`.
    #[must_use]
    pub fn rate(&self, tau: f64) -> f64 {
        let [first, second, third] = self.derivatives;
        first + tau * (second + tau * third / 2.0)
    }

    /// Integral of [`FollowedInput::at`] from 0 to `tau`: how far a position moves whose velocity this is.
    #[must_use]
    pub fn integral(&self, tau: f64) -> f64 {
        let [first, second, third] = self.derivatives;
        tau * (self.value + tau * (first / 2.0 + tau * (second / 6.0 + tau * third / 24.0)))
    }

    /// Ends a step: `value` is what the input reached.
    pub fn finish(&mut self, value: f64) {
        self.set(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_is_the_taylor_series_and_the_integral_its_primitive() {
        let mut input = FollowedInput::held(2.0);
        for (order, value) in [(1, 3.0), (2, -4.0), (3, 6.0)] {
            input.set_derivative(order, value);
        }
        assert!((input.at(0.5) - (2.0 + 1.5 - 0.5 + 0.125)).abs() < 1e-15);
        assert!((input.rate(0.5) - (3.0 - 2.0 + 0.75)).abs() < 1e-15);
        let h = 1e-5;
        let slope = (input.integral(0.5 + h) - input.integral(0.5 - h)) / (2.0 * h);
        assert!(
            (slope - input.at(0.5)).abs() < 1e-9,
            "central difference, error of order h²"
        );
    }

    #[test]
    fn a_later_value_clears_the_derivatives() {
        let mut input = FollowedInput::held(1.0);
        input.set_derivative(1, 5.0);
        input.set(2.0);
        assert_eq!(input.at(1.0), 2.0);
        assert!(!input.has_derivatives());
    }
}
