//! Several elements side by side in the vector registers of the processor.
use super::number::{Number, Space};
use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Elements per group in memory; a vector register holds 1, 4 or 8 of their numbers.
pub const GROUP: usize = 8;

/// Number of each element of a group in a register.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// Registers that a group fills.
    pub const PARTS: usize = GROUP / S::F64_LANES;

    /// Reads the register number `part` of `values`.
    #[inline(always)]
    pub fn load(simd: S, values: &[f64], part: usize) -> Self {
        Self {
            simd,
            values: S::as_simd_f64s(values).0[part],
        }
    }

    /// Writes to the register number `part` of `values`.
    #[inline(always)]
    pub fn store(self, values: &mut [f64], part: usize) {
        S::as_mut_simd_f64s(values).0[part] = self.values;
    }

    #[inline(always)]
    fn with(self, values: S::f64s) -> Self {
        Self { values, ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.values))
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.simd.add_f64s(self.values, other.values))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.simd.sub_f64s(self.values, other.values))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.simd.mul_f64s(self.values, other.values))
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(self.simd.div_f64s(self.values, other.values))
    }
}

impl<S: Simd> Sub<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        self - self.constant(other)
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * self.constant(other)
    }
}

impl<S: Simd> Number for Lanes<S> {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.with(self.simd.mul_add_e_f64s(self.values, factor.values, term.values))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.values))
    }

    #[inline(always)]
    fn at_least(self, limit: f64) -> Self {
        self.with(self.simd.max_f64s(self.values, self.simd.splat_f64s(limit)))
    }

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        self.with(self.simd.splat_f64s(value))
    }
}

/// A vector of `D` components: x, y, z or, in a plane, x and z.
#[derive(Clone, Copy, Debug)]
pub struct Components<N, const D: usize>(pub [N; D]);

impl<N: Number, const D: usize> Components<N, D> {
    /// Applies `operation` to every component. Iterators are avoided: code that is not inlined cannot use vector
    /// registers.
    #[inline(always)]
    fn each(mut self, other: Self, operation: impl Fn(N, N) -> N) -> Self {
        for axis in 0..D {
            self.0[axis] = operation(self.0[axis], other.0[axis]);
        }
        self
    }
}

impl<N: Number, const D: usize> Neg for Components<N, D> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.each(self, |a, _| -a)
    }
}

impl<N: Number, const D: usize> Add for Components<N, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }
}

impl<N: Number, const D: usize> Sub for Components<N, D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }
}

impl<N: Number, const D: usize> Mul<N> for Components<N, D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: N) -> Self {
        self.each(self, |a, _| a * factor)
    }
}

impl<N: Number, const D: usize> Space for Components<N, D> {
    type Number = N;

    #[inline(always)]
    fn dot(self, other: Self) -> N {
        let mut sum = self.0[0] * other.0[0];
        for axis in 1..D {
            sum = self.0[axis].mul_add(other.0[axis], sum);
        }
        sum
    }

    #[inline(always)]
    fn plus(self, factor: N, other: Self) -> Self {
        self.each(other, |a, b| b.mul_add(factor, a))
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self.each(self, |a, _| a * factor)
    }

    #[inline(always)]
    fn cross_square(self, other: Self) -> N {
        let (a, b) = (self.0, other.0);
        let mut sum = a[0].constant(0.0);
        for i in 0..D {
            for j in i + 1..D {
                let part = a[i] * b[j] - a[j] * b[i];
                sum = part.mul_add(part, sum);
            }
        }
        sum
    }
}
