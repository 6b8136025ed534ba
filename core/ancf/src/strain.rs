//! Generalised strains of the beam element beyond the stretch of its axis.
//!
//! ```text
//! shear           Γ₂ = (r,ₓ + c² r,ₓₓₓ)·r,ᵧ                           Γ₃ = (r,ₓ + c² r,ₓₓₓ)·r,𝓏
//! torsion         κ₁ = ½ (r,𝓏·r,ₓᵧ − r,ᵧ·r,ₓ𝓏)
//! bending         κ₂ = (r,ₓ·r,ₓ𝓏 − c r̄,𝓏·r,ₓₓₓ)/(|r,ₓ| |r,𝓏|)          κ₃ = (−r,ₓ·r,ₓᵧ + c r̄,ᵧ·r,ₓₓₓ)/(|r,ₓ| |r,ᵧ|)
//! cross-section   E₂ = ½ (|r,ᵧ|² − 1)    E₃ = ½ (|r,𝓏|² − 1)          E₂₃ = r,ᵧ·r,𝓏
//! ```
//!
//! with `c = x − L/2` and `r̄` in the middle of the element. All but the terms in `c` are those of Reissner's rod with
//! the directors `r,ᵧ/|r,ᵧ|, r,𝓏/|r,𝓏|`, for small shear, written without a frame: scalar products of vectors that are
//! linear in the coordinates, so a rigid motion leaves them exactly as they are, and their derivatives are exact and
//! short.
//!
//! Against locking:
//! - Directors are linear along the element, slopes of the axis quadratic: in a bend that is not uniform shear cannot
//!   vanish everywhere. Shear is taken at the two Gauss points [Nachbagauer, Gruber & Gerstmayr 2013], where the
//!   quadratic Legendre polynomial is zero. Alone, that would leave a part of the slope without stiffness, and
//!   curvature, the turning of linear directors, constant. The terms in `c` let the directors bulge between the nodes
//!   as the axis does. Derived here: in a thin beam the director turns by the slope `w,ₓ`; linear interpolation misses
//!   `½ w,ₓₓₓ (c² − L²/4)` of it. The rate `c w,ₓₓₓ` of this belongs to the curvature, and in the Gauss points, `c² =
//!   L²/12`, it takes `−c² w,ₓₓₓ` off the director and off the shear `w,ₓ − θ`. With the terms in `c` a cubic
//!   deflection, that of a tip force, is exact, and the small deflections of a thin beam are those of the cable
//!   element.
//! - Divided by the lengths, curvature is the rate at which the directions turn: bending neither shortens the axis (by
//!   `κ² EI/EA`) nor does it feel that linear directors which turn are shorter between the nodes. With the directors of
//!   the middle, which stand across the chord, a stretch of the axis that varies within the element makes no curvature.
//! - The cross-section is measured at the nodes only, so that turning is not taken for thickness strain either; no
//!   Poisson's ratio couples it with the axis.
//!
//! An arc is then exact to the fourth power of the angle that an element spans, whatever the slenderness.
use super::beam::{BeamCoordinates, BeamStiffness, BeamTangent};
use super::shape::ShapeFunctions;
use nalgebra::{SMatrix, SVector, Vector3};

/// Number of strains of an element: four at each of two Gauss points, the torsion, and three at each node.
pub(super) const STRAINS: usize = 15;

/// Position of the Gauss points, from the middle: `c² = L²/12`.
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// Weights of the eight vectors of [`BeamCoordinates`] in another vector.
type Weights = SVector<f64, 8>;

/// Strain in one point: `(a·b)` summed over two pairs of vectors, divided by the lengths of two more if given, less its
/// value without strain.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Strain {
    pairs: [[Weights; 2]; 2],
    divisors: Option<[Weights; 2]>,
    /// Value of the undeformed beam, –.
    offset: f64,
    /// Stiffness times the length the point stands for: J per squared strain.
    stiffness: f64,
}

/// A strain and its derivatives at some coordinates.
pub(super) struct Evaluated<'a> {
    strain: &'a Strain,
    value: f64,
    gradient: BeamCoordinates,
    divisors: [Divisor; 2],
}

/// The length of a vector and its gradient.
#[derive(Clone, Copy)]
struct Divisor {
    length: f64,
    gradient: BeamCoordinates,
}

impl Divisor {
    const NONE: Self = Self {
        length: 1.0,
        gradient: BeamCoordinates::from_array_storage(nalgebra::ArrayStorage([[0.0; 3]; 8])),
    };

    fn new(weights: &Weights, e: &BeamCoordinates) -> Self {
        let vector: Vector3<f64> = e * weights;
        let length = vector.norm();
        Self {
            length,
            gradient: vector / length * weights.transpose(),
        }
    }
}

impl Strain {
    /// Energy, J.
    pub fn energy(&self, e: &BeamCoordinates) -> f64 {
        let pair = |[a, b]: &[Weights; 2]| (e * a).dot(&(e * b));
        let lengths = self.divisors.map_or(1.0, |[a, b]| (e * a).norm() * (e * b).norm());
        let sum = pair(&self.pairs[0]) + pair(&self.pairs[1]);
        0.5 * self.stiffness * (sum / lengths - self.offset).powi(2)
    }

    /// The strain at `e` with its first derivatives.
    pub fn at(&self, e: &BeamCoordinates) -> Evaluated<'_> {
        let (mut sum, mut gradient) = (0.0, BeamCoordinates::zeros());
        for [a, b] in &self.pairs {
            let (at_a, at_b): (Vector3<f64>, Vector3<f64>) = (e * a, e * b);
            sum += at_a.dot(&at_b);
            gradient.ger(1.0, &at_a, b, 1.0);
            gradient.ger(1.0, &at_b, a, 1.0);
        }
        let mut divisors = [Divisor::NONE; 2];
        if let Some(weights) = &self.divisors {
            divisors = weights.each_ref().map(|weights| Divisor::new(weights, e));
            for Divisor { length, gradient: rate } in divisors {
                sum /= length;
                gradient = (gradient - rate * sum) / length;
            }
        }
        Evaluated {
            strain: self,
            value: sum - self.offset,
            gradient,
            divisors,
        }
    }
}

impl Evaluated<'_> {
    /// Derivative of the energy with respect to the coordinates, N (N·m).
    pub fn force(&self) -> BeamCoordinates {
        self.gradient * (self.strain.stiffness * self.value)
    }

    /// Adds the second derivative of the energy; the part that is the same for each axis to `weights`. With `n, m` the
    /// lengths of `w·e` and `u·e`:
    ///
    /// ```text
    /// ε = S/(n m),   n m ∇∇ε = ∇∇S − ∇ε ∇(n m)ᵀ − ∇(n m) ∇εᵀ − ε ∇∇(n m),   ∇∇n = (w wᵀ ⊗ I − ∇n ∇nᵀ)/n
    /// ```
    pub fn add_tangent(&self, tangent: &mut BeamTangent, weights: &mut SMatrix<f64, 8, 8>) {
        let column = |e: &BeamCoordinates| SVector::<f64, 24>::from_column_slice(e.as_slice());
        let gradient = column(&self.gradient);
        tangent.ger(self.strain.stiffness, &gradient, &gradient, 1.0);
        let stress = self.strain.stiffness * self.value;
        let [n, m] = &self.divisors;
        let scale = stress / (n.length * m.length);
        for [a, b] in &self.strain.pairs {
            weights.ger(scale, a, b, 1.0);
            weights.ger(scale, b, a, 1.0);
        }
        if let Some(divisors) = &self.strain.divisors {
            let rest = stress * (self.value + self.strain.offset);
            let mut relative = [n, m].map(|divisor| column(&divisor.gradient) / divisor.length);
            for ((weight, divisor), relative) in divisors.iter().zip([n, m]).zip(&mut relative) {
                weights.ger(-rest / divisor.length.powi(2), weight, weight, 1.0);
                tangent.ger(rest, relative, relative, 1.0);
            }
            let [n, m] = relative;
            let sum = n + m;
            tangent.ger(-stress, &gradient, &sum, 1.0);
            tangent.ger(-stress, &sum, &gradient, 1.0);
            tangent.ger(-rest, &n, &m, 1.0);
            tangent.ger(-rest, &m, &n, 1.0);
        }
    }
}

/// The strains of an element of `length` in m.
pub(super) fn strains(stiffness: &BeamStiffness, length: f64) -> [Strain; STRAINS] {
    let none = [Weights::zeros(); 2];
    let directors = |xi: f64| [2, 3].map(|i| weights(&[(i, 1.0 - xi), (i + 4, xi)]));
    let turns = [2, 3].map(|i| weights(&[(i, -1.0 / length), (i + 4, 1.0 / length)]));
    // r,ₓₓₓ is the change of r,ₓₓ from node to node over the length.
    let bends = [0.0, 1.0].map(|xi| ShapeFunctions::at(xi, length).s_xx);
    let third = on_axis(&((bends[1] - bends[0]) / length));

    let middle = directors(0.5);
    let at_gauss_point = |side: f64| {
        let (xi, c) = (0.5 + side * GAUSS, side * GAUSS * length);
        let slope = on_axis(&ShapeFunctions::at(xi, length).s_x);
        let [y, z] = directors(xi);
        let strain = |pairs, divisors, stiffness: f64| Strain {
            pairs,
            divisors,
            offset: 0.0,
            stiffness: stiffness * 0.5 * length,
        };
        let [bulge_y, bulge_z] = [y, z].map(|director| [director, third * (c * c)]);
        let [bend_y, bend_z] = middle.map(|director| [c * director, third]);
        [
            strain([[slope, y], bulge_y], None, stiffness.shear[0]),
            strain([[slope, z], bulge_z], None, stiffness.shear[1]),
            strain(
                [[slope, turns[1]], [-bend_z[0], third]],
                Some([slope, z]),
                stiffness.bending[0],
            ),
            strain([[slope, -turns[0]], bend_y], Some([slope, y]), stiffness.bending[1]),
        ]
    };
    // Torsion is the same in all points: linear directors.
    let torsion = {
        let [y, z] = middle;
        Strain {
            pairs: [[0.5 * z, turns[0]], [-0.5 * y, turns[1]]],
            divisors: None,
            offset: 0.0,
            stiffness: stiffness.torsion * length,
        }
    };
    let at_node = |xi: f64| {
        let [y, z] = directors(xi);
        let strain = |pair, offset, stiffness: f64| Strain {
            pairs: [pair, none],
            divisors: None,
            offset,
            stiffness: stiffness * 0.5 * length,
        };
        [
            strain([0.5 * y, y], 0.5, stiffness.section[0]),
            strain([0.5 * z, z], 0.5, stiffness.section[1]),
            strain([y, z], 0.0, stiffness.section[2]),
        ]
    };
    let [g0, g1, g2, g3] = at_gauss_point(-1.0);
    let [h0, h1, h2, h3] = at_gauss_point(1.0);
    let [n0, n1, n2] = at_node(0.0);
    let [m0, m1, m2] = at_node(1.0);
    [g0, g1, g2, g3, h0, h1, h2, h3, torsion, n0, n1, n2, m0, m1, m2]
}

fn weights(entries: &[(usize, f64)]) -> Weights {
    let mut weights = Weights::zeros();
    for &(i, weight) in entries {
        weights[i] = weight;
    }
    weights
}

/// The weights of the cable's coordinates among those of the beam.
fn on_axis(s: &nalgebra::Vector4<f64>) -> Weights {
    weights(&[(0, s[0]), (1, s[1]), (4, s[2]), (5, s[3])])
}
