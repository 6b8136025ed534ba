//! Bending laws.
use super::slopes::{BENDING, SlopeTangent, Slopes, add_block, add_identity_blocks, weights};
use nalgebra::{Matrix3, Vector3};

/// Three Gauss points on `0 ≤ ξ ≤ 1` with their weights, as the published cable elements use them.
const POINTS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// How the curvature is measured; `U = ½ EI ∫ κ² dx`.
///
/// ```text
/// Constant  κ² = |r,ₓₓ|²                            a quadratic energy; exact where |r,ₓ| = 1
/// Exact     κ = |r,ₓ × r,ₓₓ|/|r,ₓ|²                 [Gerstmayr & Shabana 2006]
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendingLaw {
    /// Second derivative, closed form.
    Constant,
    /// The rotation of the tangent per parameter, at three Gauss points.
    Exact,
}

/// A bending law with its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bending {
    pub law: BendingLaw,
    /// `EI`, N·m².
    pub stiffness: f64,
}

/// `κ² = C/A − B²/A²` and its derivatives with respect to `A = b·b`, `B = b·c`, `C = c·c`; `b = r,ₓ`, `c = L r,ₓₓ`.
struct Curvature {
    square: f64,
    a: f64,
    b: f64,
    c: f64,
    aa: f64,
    ab: f64,
    ac: f64,
    bb: f64,
}

impl Curvature {
    #[inline(always)]
    fn new(b: &Vector3<f64>, c: &Vector3<f64>) -> Self {
        let (aa, bc, cc) = (b.norm_squared(), b.dot(c), c.norm_squared());
        let i = 1.0 / aa;
        let (i2, i3, i4) = (i * i, i * i * i, i * i * i * i);
        Self {
            square: b.cross(c).norm_squared() * i2,
            a: -cc * i2 + 2.0 * bc * bc * i3,
            b: -2.0 * bc * i2,
            c: i,
            aa: 2.0 * cc * i3 - 6.0 * bc * bc * i4,
            ab: 4.0 * bc * i3,
            ac: -i2,
            bb: -2.0 * i2,
        }
    }
}

impl Bending {
    /// Strain energy, J, of an element of `length` in m.
    pub fn energy(&self, length: f64, slopes: &Slopes) -> f64 {
        // c = L r,ₓₓ everywhere: κ² carries 1/L², the integral L.
        let factor = 0.5 * self.stiffness / length;
        match self.law {
            BendingLaw::Constant => {
                let (a1, a2) = (&slopes.start, &slopes.end);
                factor * 4.0 * (a1.norm_squared() + a1.dot(a2) + a2.norm_squared())
            }
            BendingLaw::Exact => POINTS
                .iter()
                .map(|&(xi, w)| {
                    let (at, bend) = weights(xi);
                    factor * w * Curvature::new(&slopes.r_x(&at), &slopes.bend(&bend)).square
                })
                .sum(),
        }
    }

    /// Gradient of the energy, J per unit slope.
    #[inline(always)]
    pub fn force(&self, length: f64, slopes: &Slopes) -> Slopes {
        match self.law {
            BendingLaw::Constant => Slopes::zeros().plus(self.stiffness / length, &slopes.bending_gradient()),
            BendingLaw::Exact => {
                let mut force = Slopes::zeros();
                for (xi, w) in POINTS {
                    let (at, bend) = weights(xi);
                    let (b, c) = (slopes.r_x(&at), slopes.bend(&bend));
                    let k = Curvature::new(&b, &c);
                    let factor = 0.5 * self.stiffness / length * w;
                    force.add_r_x(&at, &((b * (2.0 * k.a) + c * k.b) * factor));
                    force.add_bend(&bend, &((b * k.b + c * (2.0 * k.c)) * factor));
                }
                force
            }
        }
    }

    /// Second derivatives of the energy.
    pub fn tangent(&self, length: f64, slopes: &Slopes) -> SlopeTangent {
        let mut tangent = SlopeTangent::zeros();
        if self.law == BendingLaw::Constant {
            add_identity_blocks(&mut tangent, self.stiffness / length, &BENDING);
            return tangent;
        }
        for (xi, w) in POINTS {
            let (at, bend) = weights(xi);
            let (b, c) = (slopes.r_x(&at), slopes.bend(&bend));
            let k = Curvature::new(&b, &c);
            let factor = 0.5 * self.stiffness / length * w;
            let (one, bb, bc, cc) = (
                Matrix3::identity(),
                b * b.transpose(),
                b * c.transpose(),
                c * c.transpose(),
            );
            // Second derivatives of κ² with respect to (b, b), (b, c), (c, c).
            let w_bb = one * (2.0 * k.a) + bb * (4.0 * k.aa) + (bc + bc.transpose()) * (2.0 * k.ab) + cc * k.bb;
            let w_bc = one * k.b + bb * (2.0 * k.ab) + bc * (4.0 * k.ac) + bc.transpose() * k.bb;
            let w_cc = one * (2.0 * k.c) + bb * k.bb;
            let bend = [0.0, bend[0], bend[1]];
            for i in 0..3 {
                for j in 0..3 {
                    let block = w_bb * (at[i] * at[j])
                        + w_bc * (at[i] * bend[j])
                        + w_bc.transpose() * (bend[i] * at[j])
                        + w_cc * (bend[i] * bend[j]);
                    add_block(&mut tangent, i, j, &(block * factor));
                }
            }
        }
        tangent
    }
}
