//! What the strain of an element depends on.
use nalgebra::{Matrix3, SMatrix, Vector3};

/// The shape of an element without its place: every strain is a function of these three vectors (–).
///
/// ```text
/// p = (r₂ − r₁)/L,  a₁ = r₁,ₓ − p,  a₂ = r₂,ₓ − p
/// r,ₓ  = p + (1 − 4ξ + 3ξ²) a₁ + (3ξ² − 2ξ) a₂
/// r,ₓₓ = ((6ξ − 4) a₁ + (6ξ − 2) a₂)/L
/// ```
///
/// derived here from the Hermite polynomials; a wire that hardly bends has `a₁, a₂ ≈ 0`, so no digits cancel. The same type
/// holds gradients with respect to the three vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes {
    /// `p`, slope of the chord.
    pub chord: Vector3<f64>,
    /// `a₁`, deviation of the start slope from the chord's.
    pub start: Vector3<f64>,
    /// `a₂`, deviation of the end slope.
    pub end: Vector3<f64>,
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

impl Slopes {
    /// Slopes of the node coordinates; `length` of the element in m.
    #[inline(always)]
    #[must_use]
    pub fn new(r1: &Vector3<f64>, r1_x: &Vector3<f64>, r2: &Vector3<f64>, r2_x: &Vector3<f64>, length: f64) -> Self {
        let chord = (r2 - r1) * (1.0 / length);
        Self {
            chord,
            start: r1_x - chord,
            end: r2_x - chord,
        }
    }

    /// No force.
    #[must_use]
    pub fn zeros() -> Self {
        Self {
            chord: Vector3::zeros(),
            start: Vector3::zeros(),
            end: Vector3::zeros(),
        }
    }

    /// `r,ₓ`, with the weights of `p, a₁, a₂` at a point.
    #[inline(always)]
    pub(super) fn r_x(&self, weights: &[f64; 3]) -> Vector3<f64> {
        self.chord * weights[0] + self.start * weights[1] + self.end * weights[2]
    }

    /// `L r,ₓₓ`, with the weights of `a₁, a₂` at a point.
    #[inline(always)]
    pub(super) fn bend(&self, weights: &[f64; 2]) -> Vector3<f64> {
        self.start * weights[0] + self.end * weights[1]
    }

    /// The mean of `|r,ₓ|²` over the element: `|p|² + (2/15)(|a₁|² + |a₂|²) − a₁·a₂/15`.
    #[inline(always)]
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.chord.norm_squared() + (2.0 / 15.0) * (self.start.norm_squared() + self.end.norm_squared())
            - (1.0 / 15.0) * self.start.dot(&self.end)
    }

    /// Half the gradient of [`Slopes::mean_square`]: the transverse force per tension and length.
    #[inline(always)]
    #[must_use]
    pub fn tension_gradient(&self) -> Self {
        Self {
            chord: self.chord,
            start: (self.start * 4.0 - self.end) * (1.0 / 30.0),
            end: (self.end * 4.0 - self.start) * (1.0 / 30.0),
        }
    }

    /// Gradient of `½ L ∫ |r,ₓₓ|² dx = 2 (|a₁|² + a₁·a₂ + |a₂|²)`: the force per bending stiffness, times the length.
    #[inline(always)]
    #[must_use]
    pub fn bending_gradient(&self) -> Self {
        Self {
            chord: Vector3::zeros(),
            start: self.start * 4.0 + self.end * 2.0,
            end: self.end * 4.0 + self.start * 2.0,
        }
    }

    /// `self + factor · other`.
    #[inline(always)]
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self {
            chord: self.chord + other.chord * factor,
            start: self.start + other.start * factor,
            end: self.end + other.end * factor,
        }
    }

    /// Adds `f` times the weights of a point: the gradient of a function of `r,ₓ` there.
    #[inline(always)]
    pub(super) fn add_r_x(&mut self, weights: &[f64; 3], f: &Vector3<f64>) {
        self.chord += f * weights[0];
        self.start += f * weights[1];
        self.end += f * weights[2];
    }

    /// Adds `f` times the weights of a point: the gradient of a function of `L r,ₓₓ` there.
    #[inline(always)]
    pub(super) fn add_bend(&mut self, weights: &[f64; 2], f: &Vector3<f64>) {
        self.start += f * weights[0];
        self.end += f * weights[1];
    }

    /// The gradient with respect to the node coordinates `r₁, r₁,ₓ, r₂, r₂,ₓ` (N, N·m, N, N·m for an energy's gradient).
    #[inline(always)]
    #[must_use]
    pub fn on_nodes(&self, length: f64) -> [Vector3<f64>; 4] {
        let pull = (self.chord - self.start - self.end) * (1.0 / length);
        [-pull, self.start, pull, self.end]
    }
}

/// Adds the block `m` between the vectors `i` and `j` (0 chord, 1 start, 2 end).
pub(super) fn add_block(tangent: &mut SlopeTangent, i: usize, j: usize, m: &Matrix3<f64>) {
    let mut view = tangent.fixed_view_mut::<3, 3>(3 * i, 3 * j);
    view += m;
}

/// The constant tangent of [`Slopes::tension_gradient`], as weights of identity blocks.
pub(super) const TENSION: [[f64; 3]; 3] = [
    [1.0, 0.0, 0.0],
    [0.0, 4.0 / 30.0, -1.0 / 30.0],
    [0.0, -1.0 / 30.0, 4.0 / 30.0],
];

/// The constant tangent of [`Slopes::bending_gradient`], as weights of identity blocks.
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
