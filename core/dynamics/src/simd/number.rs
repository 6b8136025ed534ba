//! Numbers and vectors for laws: those of one element, or of several elements side by side.
use nalgebra::Vector3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number per element.
pub trait Number:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// `self · factor + term`; fused if the processor does so at no cost.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The larger one of `self` and `limit`.
    fn at_least(self, limit: f64) -> Self;

    /// `value` for each of the elements that `self` belongs to.
    fn constant(self, value: f64) -> Self;
}

/// Vector per element.
pub trait Space:
    Copy + Neg<Output = Self> + Add<Output = Self> + Sub<Output = Self> + Mul<Self::Number, Output = Self>
{
    /// Number that multiplies a vector.
    type Number: Number;

    /// The scalar product.
    fn dot(self, other: Self) -> Self::Number;

    /// `self + other · factor`.
    fn plus(self, factor: Self::Number, other: Self) -> Self;

    /// `self · factor` with one factor for all elements.
    fn scaled(self, factor: f64) -> Self;

    /// `|self × other|²`.
    fn cross_square(self, other: Self) -> Self::Number;
}

impl Number for f64 {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        // The fused product is a function call where the processor does not have it.
        self * factor + term
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn at_least(self, limit: f64) -> Self {
        self.max(limit)
    }

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        value
    }
}

impl Space for Vector3<f64> {
    type Number = f64;

    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        nalgebra::Matrix::dot(&self, &other)
    }

    #[inline(always)]
    fn plus(self, factor: f64, other: Self) -> Self {
        self + other * factor
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }

    #[inline(always)]
    fn cross_square(self, other: Self) -> f64 {
        self.cross(&other).norm_squared()
    }
}
