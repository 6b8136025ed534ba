//! Numbers with their derivatives by the arguments of a creep force.
use std::ops::{Add, Mul, Neg, Sub};

/// Number of arguments of a creep force: ξ_x, ξ_y, φ, a, b, N.
pub(super) const INPUTS: usize = 6;

/// Numbers in which a creep law is written: values alone for a force, with derivatives for a tangent. The values of
/// both are the same to the last bit.
pub(super) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Add<f64, Output = Self>
{
    fn constant(value: f64) -> Self;
    /// Input with the given number.
    fn input(value: f64, number: usize) -> Self;
    fn value(self) -> f64;
    /// `f(self)` from the value of f and its derivative here.
    fn map(self, value: f64, derivative: f64) -> Self;
    /// The derivatives alone.
    fn change(self) -> Self;

    /// Square root; the derivative counts as zero at zero.
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.map(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn inverse(self) -> Self {
        let value = self.value();
        self.map(1.0 / value, -1.0 / (value * value))
    }

    fn exp(self) -> Self {
        let value = self.value().exp();
        self.map(value, value)
    }

    fn atan(self) -> Self {
        let value = self.value();
        self.map(value.atan(), 1.0 / (1.0 + value * value))
    }

    fn abs(self) -> Self {
        self * self.value().signum()
    }
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn input(value: f64, _number: usize) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn map(self, value: f64, _derivative: f64) -> Self {
        value
    }

    fn change(self) -> Self {
        0.0
    }
}

/// Value and derivatives: the tangent of a creep law follows from the law by the chain rule, step by step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dual {
    pub value: f64,
    pub slopes: [f64; INPUTS],
}

impl Number for Dual {
    fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; INPUTS],
        }
    }

    fn input(value: f64, number: usize) -> Self {
        let mut input = Self::constant(value);
        input.slopes[number] = 1.0;
        input
    }

    fn value(self) -> f64 {
        self.value
    }

    fn map(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            slopes: self.slopes.map(|slope| slope * derivative),
        }
    }

    fn change(mut self) -> Self {
        self.value = 0.0;
        self
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        for (slope, other) in self.slopes.iter_mut().zip(other.slopes) {
            *slope += other;
        }
        self
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut product = Self::constant(self.value * other.value);
        for (k, slope) in product.slopes.iter_mut().enumerate() {
            *slope = self.slopes[k] * other.value + self.value * other.slopes[k];
        }
        product
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.map(self.value * factor, factor)
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(mut self, term: f64) -> Self {
        self.value += term;
        self
    }
}
