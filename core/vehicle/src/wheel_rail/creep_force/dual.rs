//! Numbers with their derivatives by the arguments of a creep force.
use std::ops::{Add, Mul, Neg, Sub};

/// Number of arguments of a creep force: ξ_x, ξ_y, φ, a, b, N.
pub(super) const INPUTS: usize = 6;

/// Value and derivatives: the tangent of a creep law follows from the law by the chain rule, step by step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dual {
    pub value: f64,
    pub slopes: [f64; INPUTS],
}

impl Dual {
    pub fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; INPUTS],
        }
    }

    /// Input with the given number.
    pub fn input(value: f64, number: usize) -> Self {
        let mut input = Self::constant(value);
        input.slopes[number] = 1.0;
        input
    }

    /// `f(self)` from the value of f and its derivative here.
    pub fn map(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            slopes: self.slopes.map(|slope| slope * derivative),
        }
    }

    /// Square root; the derivative counts as zero at zero.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    pub fn inverse(self) -> Self {
        self.map(1.0 / self.value, -1.0 / (self.value * self.value))
    }

    pub fn exp(self) -> Self {
        let value = self.value.exp();
        self.map(value, value)
    }

    pub fn atan(self) -> Self {
        self.map(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }

    pub fn abs(self) -> Self {
        self * self.value.signum()
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
