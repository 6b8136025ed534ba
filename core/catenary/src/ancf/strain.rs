//! Generalised strains of the beam element beyond the stretch of its axis.
//!
//! ```text
//! shear           Γ₂ = r,ₓ·r,ᵧ             Γ₃ = r,ₓ·r,𝓏
//! torsion         κ₁ = ½ (r,𝓏·r,ₓᵧ − r,ᵧ·r,ₓ𝓏)
//! bending         κ₂ = r,ₓ·r,ₓ𝓏 − c r,𝓏·r,ₓₓₓ     κ₃ = −r,ₓ·r,ₓᵧ + c r,ᵧ·r,ₓₓₓ,    c = x − L/2
//! cross-section   E₂ = ½ (|r,ᵧ|² − 1)      E₃ = ½ (|r,𝓏|² − 1)      E₂₃ = r,ᵧ·r,𝓏
//! ```
//!
//! All but the terms in `c` are those of Reissner's rod for orthonormal directors `r,ᵧ, r,𝓏` and small shear, written without a
//! frame: each is a sum of scalar products of vectors that are linear in the coordinates, so a rigid motion leaves it exactly as it
//! is, and its derivatives are exact and short.
//!
//! Against locking:
//! - Directors are linear along the element, slopes of the axis quadratic: in a bend the shear of one cannot vanish everywhere.
//!   Shear is taken at the two Gauss points, where the quadratic Legendre polynomial is zero, so that part of the slope makes none
//!   [Nachbagauer, Gruber & Gerstmayr 2013].
//! - That part would then have no stiffness at all, and curvature, the change of linear directors, would be constant. The terms in
//!   `c` take it for what it is, the bend that the directors cannot follow. Derived here: in a beam without shear, the director
//!   turns by the slope `w,ₓ`; interpolated linearly its rate is the mean of `w,ₓₓ`, and `w,ₓₓ` less its mean is `c w,ₓₓₓ`. With
//!   them a cubic deflection, that of a tip force, is exact, and the small deflections of a thin beam are those of the cable element.
//!   In an arc the same terms cancel the leading error of the others: turning by `θ` within an element, `−r,ₓ·r,ₓᵧ` is
//!   `κ (1 − θ²/12)`, and `c r,ᵧ·r,ₓₓₓ = c² κ³ = κ θ²/12` in the Gauss points.
//! - Linear directors that turn are shorter between the nodes. The cross-section is measured at the nodes only, so turning is not
//!   taken for thickness strain; no Poisson's ratio couples it with the axis.
use super::beam::{BeamCoordinates, BeamStiffness};
use super::shape::ShapeFunctions;
use nalgebra::{SMatrix, SVector, Vector3};

/// Number of strains of an element: four at each of two Gauss points, the torsion, and three at each node.
pub(super) const STRAINS: usize = 15;

/// Position of the Gauss points, from the middle: `c² = L²/12`.
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// Weights of the eight vectors of [`BeamCoordinates`] in another vector.
type Weights = SVector<f64, 8>;

/// One strain in one point: `(a·b)` summed over two pairs of vectors, less its value without strain.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Strain {
    pairs: [[Weights; 2]; 2],
    /// Of the undeformed beam, –.
    offset: f64,
    /// Stiffness times the length the point stands for: J per squared strain.
    stiffness: f64,
}

impl Strain {
    fn value(&self, e: &BeamCoordinates) -> f64 {
        let pair = |[a, b]: &[Weights; 2]| (e * a).dot(&(e * b));
        pair(&self.pairs[0]) + pair(&self.pairs[1]) - self.offset
    }

    /// Energy per squared strain, doubled, J.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Energy, J.
    pub fn energy(&self, e: &BeamCoordinates) -> f64 {
        0.5 * self.stiffness * self.value(e).powi(2)
    }

    /// Derivative of the energy with respect to the strain, J.
    pub fn stress(&self, e: &BeamCoordinates) -> f64 {
        self.stiffness * self.value(e)
    }

    /// Derivative of the strain with respect to the coordinates.
    pub fn gradient(&self, e: &BeamCoordinates) -> BeamCoordinates {
        let mut gradient = BeamCoordinates::zeros();
        for [a, b] in &self.pairs {
            let (at_a, at_b): (Vector3<f64>, Vector3<f64>) = (e * a, e * b);
            gradient.ger(1.0, &at_a, b, 1.0);
            gradient.ger(1.0, &at_b, a, 1.0);
        }
        gradient
    }

    /// Adds `factor` times the second derivative, which is the same for each axis.
    pub fn add_second_derivative(&self, factor: f64, weights: &mut SMatrix<f64, 8, 8>) {
        for [a, b] in &self.pairs {
            weights.ger(factor, a, b, 1.0);
            weights.ger(factor, b, a, 1.0);
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

    let at_gauss_point = |side: f64| {
        let (xi, c) = (0.5 + side * GAUSS, side * GAUSS * length);
        let slope = on_axis(&ShapeFunctions::at(xi, length).s_x);
        let [y, z] = directors(xi);
        let strain = |pairs, stiffness: f64| Strain {
            pairs,
            offset: 0.0,
            stiffness: stiffness * 0.5 * length,
        };
        [
            strain([[slope, y], none], stiffness.shear[0]),
            strain([[slope, z], none], stiffness.shear[1]),
            strain([[slope, turns[1]], [-c * z, third]], stiffness.bending[0]),
            strain([[slope, -turns[0]], [c * y, third]], stiffness.bending[1]),
        ]
    };
    // The same in all points: linear directors.
    let torsion = {
        let [y, z] = directors(0.5);
        Strain {
            pairs: [[0.5 * z, turns[0]], [-0.5 * y, turns[1]]],
            offset: 0.0,
            stiffness: stiffness.torsion * length,
        }
    };
    let at_node = |xi: f64| {
        let [y, z] = directors(xi);
        let strain = |pair, offset, stiffness: f64| Strain {
            pairs: [pair, none],
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
