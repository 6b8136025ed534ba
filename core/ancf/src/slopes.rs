//! Slopes: the variables that the strain of an element depends on.
use dynamics::simd::{Number, Space};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Length of an element, m, and its inverse for divisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length<N = f64> {
    /// `L`, m.
    pub value: N,
    /// `1/L`, 1/m.
    pub inverse: N,
}

impl<N: Number> Length<N> {
    /// Length of an element of `length` in m.
    #[inline(always)]
    pub fn new(length: N) -> Self {
        Self {
            value: length,
            inverse: length.constant(1.0) / length,
        }
    }
}

/// The shape of an element without its place: every strain is a function of these three vectors (–).
///
/// ```text
/// p = (r₂ − r₁)/L,  a₁ = r₁,ₓ − p,  a₂ = r₂,ₓ − p
/// r,ₓ  = p + (1 − 4ξ + 3ξ²) a₁ + (3ξ² − 2ξ) a₂
/// r,ₓₓ = ((6ξ − 4) a₁ + (6ξ − 2) a₂)/L
/// ```
///
/// derived here from the Hermite polynomials; a wire that hardly bends has `a₁, a₂ ≈ 0`, so no digits cancel. The same
/// type holds gradients with respect to the three vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes<V = Vector3<f64>> {
    /// `p`, slope of the chord.
    pub chord: V,
    /// `a₁`, deviation of the start slope from the chord's.
    pub start: V,
    /// `a₂`, deviation of the end slope.
    pub end: V,
}

/// Second derivatives with respect to [`Slopes`], 9 × 9, symmetric: chord, start, end, three axes each.
pub type SlopeTangent = SMatrix<f64, 9, 9>;

/// Weights of `p, a₁, a₂` in `r,ₓ` and of `a₁, a₂` in `L r,ₓₓ` at `xi`.
#[inline(always)]
pub(super) fn weights(xi: f64) -> ([f64; 3], [f64; 2]) {
    (
        [1.0, 1.0 - 4.0 * xi + 3.0 * xi * xi, 3.0 * xi * xi - 2.0 * xi],
        [6.0 * xi - 4.0, 6.0 * xi - 2.0],
    )
}

impl<V: Space> Slopes<V> {
    /// Slopes of the node coordinates `r₁, r₁,ₓ, r₂, r₂,ₓ`.
    #[inline(always)]
    #[must_use]
    pub fn new([r1, r1_x, r2, r2_x]: [V; 4], length: Length<V::Number>) -> Self {
        let chord = (r2 - r1) * length.inverse;
        Self {
            chord,
            start: r1_x - chord,
            end: r2_x - chord,
        }
    }

    /// `r,ₓ`, with the weights of `p, a₁, a₂` at a point; the first is one.
    #[inline(always)]
    pub(super) fn r_x(&self, weights: &[f64; 3]) -> V {
        self.chord + self.start.scaled(weights[1]) + self.end.scaled(weights[2])
    }

    /// `L r,ₓₓ`, with the weights of `a₁, a₂` at a point.
    #[inline(always)]
    pub(super) fn bend(&self, weights: &[f64; 2]) -> V {
        self.start.scaled(weights[0]) + self.end.scaled(weights[1])
    }

    /// The mean of `|r,ₓ|²` over the element: `|p|² + (2/15)(|a₁|² + |a₂|²) − a₁·a₂/15`.
    #[inline(always)]
    #[must_use]
    pub fn mean_square(&self) -> V::Number {
        self.chord.dot(self.chord)
            + ((self.start.dot(self.start) + self.end.dot(self.end)) * (2.0 / 15.0)
                - self.start.dot(self.end) * (1.0 / 15.0))
    }

    /// Gradient of `½ t · mean |r,ₓ|² + ½ b · L ∫ |r,ₓₓ|² dx`, see [`Slopes::mean_square`]; the second is `2 b (|a₁|² +
    /// a₁·a₂ + |a₂|²)`. With `t` a tension times `L` and `b` a bending stiffness over `L` the transverse force of a
    /// tensioned beam.
    #[inline(always)]
    #[must_use]
    pub fn beam_gradient(&self, t: V::Number, b: V::Number) -> Self {
        let same = t * (4.0 / 30.0) + b * 4.0;
        let other = b * 2.0 - t * (1.0 / 30.0);
        Self {
            chord: self.chord * t,
            start: (self.start * same).plus(other, self.end),
            end: (self.end * same).plus(other, self.start),
        }
    }

    /// The product with a number.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, factor: V::Number) -> Self {
        Self {
            chord: self.chord * factor,
            start: self.start * factor,
            end: self.end * factor,
        }
    }

    /// The scalar product of all three vectors.
    #[inline(always)]
    #[must_use]
    pub fn dot(&self, other: &Self) -> V::Number {
        self.chord.dot(other.chord) + self.start.dot(other.start) + self.end.dot(other.end)
    }

    /// The sum.
    #[inline(always)]
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            chord: self.chord + other.chord,
            start: self.start + other.start,
            end: self.end + other.end,
        }
    }

    /// Adds `f` times the weights of a point: the gradient of a function of `r,ₓ` there. The first weight is one.
    #[inline(always)]
    pub(super) fn add_r_x(&mut self, weights: &[f64; 3], f: V) {
        self.chord = self.chord + f;
        self.start = self.start + f.scaled(weights[1]);
        self.end = self.end + f.scaled(weights[2]);
    }

    /// Adds `f` times the weights of a point: the gradient of a function of `L r,ₓₓ` there.
    #[inline(always)]
    pub(super) fn add_bend(&mut self, weights: &[f64; 2], f: V) {
        self.start = self.start + f.scaled(weights[0]);
        self.end = self.end + f.scaled(weights[1]);
    }

    /// The gradient with respect to the node coordinates `r₁, r₁,ₓ, r₂, r₂,ₓ` (N, N·m, N, N·m for an energy's
    /// gradient).
    #[inline(always)]
    #[must_use]
    pub fn on_nodes(&self, length: Length<V::Number>) -> [V; 4] {
        let pull = (self.chord - self.start - self.end) * length.inverse;
        [-pull, self.start, pull, self.end]
    }
}

/// Adds the block `m` between the vectors `i` and `j` (0 chord, 1 start, 2 end).
pub(super) fn add_block(tangent: &mut SlopeTangent, i: usize, j: usize, m: &Matrix3<f64>) {
    let mut view = tangent.fixed_view_mut::<3, 3>(3 * i, 3 * j);
    view += m;
}

/// The constant tangent of [`Slopes::beam_gradient`] for `t = 1`, as weights of identity blocks.
pub(super) const TENSION: [[f64; 3]; 3] = [
    [1.0, 0.0, 0.0],
    [0.0, 4.0 / 30.0, -1.0 / 30.0],
    [0.0, -1.0 / 30.0, 4.0 / 30.0],
];

/// The constant tangent of [`Slopes::beam_gradient`] for `b = 1`, as weights of identity blocks.
pub(super) const BENDING: [[f64; 3]; 3] = [[0.0; 3], [0.0, 4.0, 2.0], [0.0, 2.0, 4.0]];

/// Adds `factor · weights ⊗ I`.
pub(super) fn add_identity_blocks(tangent: &mut SlopeTangent, factor: f64, weights: &[[f64; 3]; 3]) {
    for i in 0..3 {
        for j in 0..3 {
            for axis in 0..3 {
                tangent[(3 * i + axis, 3 * j + axis)] += factor * weights[i][j];
            }
        }
    }
}
