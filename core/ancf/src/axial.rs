//! Axial laws.
//!
//! `X` is the arc length of the unstressed wire, `x = λ X` that at nominal tension: `r,_X = λ r,ₓ`.
use super::slopes::{Length, SlopeTangent, Slopes, TENSION, add_block, add_identity_blocks, weights};
use dynamics::simd::{Number, Space};
use nalgebra::{Matrix3, SVector};

/// Five Gauss points on `0 ≤ ξ ≤ 1` with their weights: exact to degree nine.
pub const FIVE_POINTS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_24),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Measure of the axial strain.
///
/// ```text
/// Mean         U = ½ EA (L/λ) ε²,      ε = ½ (λ² (1/L) ∫ |r,ₓ|² dx − 1)
/// Full         U = ½ EA ∫ ε² dx/λ,     ε = ½ (λ² |r,ₓ|² − 1)           [Gerstmayr & Shabana 2006]
/// Engineering  U = ½ EA ∫ ε² dx/λ,     ε = λ |r,ₓ| − 1
/// ```
///
/// `ε` is zero in the unstressed wire, whatever the reference is. The mean lets an element of a sagging wire bend
/// without stretching, which the cubic field of the full strain cannot. The mean leaves the size of the end slopes to
/// tension and to [`crate::BendingLaw::Constant`]: a slack wire with mean strain and exact curvature has a singular
/// tangent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxialLaw {
    /// Element mean of the Green–Lagrange strain, closed form.
    Mean,
    /// Green–Lagrange strain at five Gauss points.
    Full,
    /// Change of length per unstressed length, at five Gauss points.
    Engineering,
}

/// Stretch `λ` (–) at which a wire of `axial_stiffness` (N) that follows `law` carries `tension` (N, not negative).
///
/// ```text
/// Mean, Full   EA ½ (λ² − 1) λ = T
/// Engineering  EA (λ − 1) = T
/// ```
#[must_use]
pub fn nominal_stretch(law: AxialLaw, tension: f64, axial_stiffness: f64) -> f64 {
    let strain = tension / axial_stiffness;
    match law {
        AxialLaw::Engineering => 1.0 + strain,
        AxialLaw::Mean | AxialLaw::Full => {
            // λ³ − λ = 2 T/EA is convex for λ ≥ 1 and 1 + T/EA lies above the root: Newton's method descends to it.
            let mut stretch = 1.0 + strain;
            for _ in 0..60 {
                let change = (stretch * (stretch * stretch - 1.0) - 2.0 * strain) / (3.0 * stretch * stretch - 1.0);
                stretch -= change;
                if change.abs() <= f64::EPSILON {
                    break;
                }
            }
            stretch
        }
    }
}

/// An axial law with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axial {
    pub law: AxialLaw,
    /// `EA`, N.
    pub stiffness: f64,
    /// `λ`, –.
    pub stretch: f64,
}

impl Axial {
    /// `τ`, N, with gradient `τ r,ₓ` of the energy per `x` where `|r,ₓ|²` is `square`: at a point, or the mean of the
    /// element.
    #[inline(always)]
    fn tau<N: Number>(&self, square: N) -> N {
        let (ea, stretch) = (self.stiffness, self.stretch);
        if self.law == AxialLaw::Engineering {
            // ∂U/∂b = EA ε b/|b|
            let norm = square.sqrt();
            (norm * stretch - 1.0) * ea / norm
        } else {
            (square * (stretch * stretch) - 1.0) * (0.5 * ea * stretch)
        }
    }

    /// `∂τ/∂(|r,ₓ|²)`, N.
    fn tau_rate(&self, square: f64) -> f64 {
        if self.law == AxialLaw::Engineering {
            // τ = EA (λ − 1/|b|)
            0.5 * self.stiffness / (square * square.sqrt())
        } else {
            0.5 * self.stiffness * self.stretch.powi(3)
        }
    }

    /// Energy per `x`, N.
    fn energy_density(&self, square: f64) -> f64 {
        let strain = if self.law == AxialLaw::Engineering {
            self.stretch * square.sqrt() - 1.0
        } else {
            0.5 * (self.stretch * self.stretch * square - 1.0)
        };
        0.5 * self.stiffness / self.stretch * strain * strain
    }

    /// Strain energy, J, of an element of `length` in m.
    pub fn energy(&self, length: f64, slopes: &Slopes) -> f64 {
        if self.law == AxialLaw::Mean {
            return length * self.energy_density(slopes.mean_square());
        }
        FIVE_POINTS
            .iter()
            .map(|&(xi, w)| w * length * self.energy_density(slopes.r_x(&weights(xi).0).norm_squared()))
            .sum()
    }

    /// Tension `τ` (N) that acts throughout the element; zero for strains measured in points, see
    /// [`Axial::add_point_forces`].
    #[inline(always)]
    pub fn common_tau<V: Space>(&self, slopes: &Slopes<V>) -> V::Number {
        let square = slopes.mean_square();
        if self.law == AxialLaw::Mean {
            self.tau(square)
        } else {
            square.constant(0.0)
        }
    }

    /// Adds the gradient of the energy, J per unit slope, of strains that are measured in points.
    #[inline(always)]
    pub fn add_point_forces<V: Space>(&self, length: Length<V::Number>, slopes: &Slopes<V>, force: &mut Slopes<V>) {
        if self.law == AxialLaw::Mean {
            return;
        }
        for (xi, w) in FIVE_POINTS {
            let (at, _) = weights(xi);
            let b = slopes.r_x(&at);
            force.add_r_x(&at, b * (self.tau(b.dot(b)) * length.value * w));
        }
    }

    /// Second derivatives of the energy.
    pub fn tangent(&self, length: f64, slopes: &Slopes) -> SlopeTangent {
        let mut tangent = SlopeTangent::zeros();
        if self.law == AxialLaw::Mean {
            let square = slopes.mean_square();
            add_identity_blocks(&mut tangent, self.tau(square) * length, &TENSION);
            // ∂τ = 2 τ′ · (half gradient of the mean square)
            let half = slopes.beam_gradient(1.0, 0.0);
            let mut g = SVector::<f64, 9>::zeros();
            for (i, part) in [half.chord, half.start, half.end].iter().enumerate() {
                g.fixed_rows_mut::<3>(3 * i).copy_from(part);
            }
            return tangent + g * g.transpose() * (2.0 * self.tau_rate(square) * length);
        }
        for (xi, w) in FIVE_POINTS {
            let (at, _) = weights(xi);
            let b = slopes.r_x(&at);
            let square = b.norm_squared();
            let rate = b * b.transpose() * (2.0 * self.tau_rate(square));
            let block = (Matrix3::identity() * self.tau(square) + rate) * (w * length);
            for i in 0..3 {
                for j in 0..3 {
                    add_block(&mut tangent, i, j, &(block * (at[i] * at[j])));
                }
            }
        }
        tangent
    }

    /// Axial force, N, the mean over the element.
    pub fn tension(&self, slopes: &Slopes) -> f64 {
        let at = |square: f64| self.tau(square) * square.sqrt();
        if self.law == AxialLaw::Mean {
            return at(slopes.mean_square());
        }
        FIVE_POINTS
            .iter()
            .map(|&(xi, w)| w * at(slopes.r_x(&weights(xi).0).norm_squared()))
            .sum()
    }
}
