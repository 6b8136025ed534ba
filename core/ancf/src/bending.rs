//! Bending laws.
use super::slopes::{BENDING, Length, SlopeTangent, Slopes, add_block, add_identity_blocks, weights};
use dynamics::simd::{Number, Space};
use nalgebra::{Matrix3, Vector3};

/// Three Gauss points on `0 ≤ ξ ≤ 1` with their weights, as the published cable elements use them.
const POINTS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Measure of the curvature; `U = ½ EI ∫ κ² dx`.
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
pub struct Bending {
    pub law: BendingLaw,
    /// `EI`, N·m².
    pub stiffness: f64,
}

/// `κ² = C/A − B²/A²` and its first derivatives with respect to `A = b·b`, `B = b·c`, `C = c·c`; `b = r,ₓ`, `c = L
/// r,ₓₓ`.
struct Curvature<N = f64> {
    square: N,
    a: N,
    b: N,
    c: N,
}

impl<N: Number> Curvature<N> {
    #[inline(always)]
    fn new<V: Space<Number = N>>(b: V, c: V) -> Self {
        let (bc, cc) = (b.dot(c), c.dot(c));
        let square = b.dot(b);
        let i = square.constant(1.0) / square;
        let i2 = i * i;
        Self {
            square: b.cross_square(c) * i2,
            a: bc * bc * i2 * i * 2.0 - cc * i2,
            b: bc * i2 * -2.0,
            c: i,
        }
    }
}

/// Second derivatives of `κ²` with respect to `A`, `B`, `C`, see [`Curvature`].
struct CurvatureRates {
    aa: f64,
    ab: f64,
    ac: f64,
    bb: f64,
}

impl CurvatureRates {
    fn new(b: &Vector3<f64>, c: &Vector3<f64>) -> Self {
        let (bc, cc, i) = (b.dot(c), c.norm_squared(), 1.0 / b.norm_squared());
        let (i2, i3, i4) = (i * i, i * i * i, i * i * i * i);
        Self {
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
                    factor * w * Curvature::new(slopes.r_x(&at), slopes.bend(&bend)).square
                })
                .sum(),
        }
    }

    /// `EI` of a quadratic energy; zero for a curvature measured in points, see [`Bending::add_point_forces`].
    #[inline(always)]
    pub fn common_stiffness(&self) -> f64 {
        match self.law {
            BendingLaw::Constant => self.stiffness,
            BendingLaw::Exact => 0.0,
        }
    }

    /// Adds the gradient of the energy, J per unit slope, of a curvature that is measured in points.
    #[inline(always)]
    pub fn add_point_forces<V: Space>(&self, length: Length<V::Number>, slopes: &Slopes<V>, force: &mut Slopes<V>) {
        if self.law == BendingLaw::Constant {
            return;
        }
        for (xi, w) in POINTS {
            let (at, bend) = weights(xi);
            let (b, c) = (slopes.r_x(&at), slopes.bend(&bend));
            let k = Curvature::new(b, c);
            let factor = length.inverse * (self.stiffness * w);
            let cross = k.b * factor * 0.5;
            force.add_r_x(&at, (b * (k.a * factor)).plus(cross, c));
            force.add_bend(&bend, (c * (k.c * factor)).plus(cross, b));
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
            let (k, rates) = (Curvature::new(b, c), CurvatureRates::new(&b, &c));
            let factor = 0.5 * self.stiffness / length * w;
            let (one, bb, bc, cc) = (
                Matrix3::identity(),
                b * b.transpose(),
                b * c.transpose(),
                c * c.transpose(),
            );
            // Second derivatives of κ² with respect to (b, b), (b, c), (c, c).
            let w_bb =
                one * (2.0 * k.a) + bb * (4.0 * rates.aa) + (bc + bc.transpose()) * (2.0 * rates.ab) + cc * rates.bb;
            let w_bc = one * k.b + bb * (2.0 * rates.ab) + bc * (4.0 * rates.ac) + bc.transpose() * rates.bb;
            let w_cc = one * (2.0 * k.c) + bb * rates.bb;
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
