//! Cubic Hermite polynomials.
use nalgebra::{Matrix4, Vector4};

/// Values of the four Hermite polynomials and of their derivatives at one point of an element.
///
/// ```text
/// r(x) = Σᵢ sᵢ(x) eᵢ,   e = (r₁, r₁,ₓ, r₂, r₂,ₓ)                                    [Thesis, Eq. (1), (2)]
/// ```
///
/// The source writes the polynomials in `2x/L − 1`; here `xi = x/L`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFunctions {
    /// `s(x)`, 4 entries (–, m, –, m).
    pub s: Vector4<f64>,
    /// `ds/dx`, 4 entries (1/m, –, 1/m, –).
    pub s_x: Vector4<f64>,
    /// `d²s/dx²`, 4 entries (1/m², 1/m, 1/m², 1/m).
    pub s_xx: Vector4<f64>,
}

impl ShapeFunctions {
    /// Evaluates the functions at `xi = x / length`, for an element of `length` in m. Outside `0 ≤ xi ≤ 1` the cubics
    /// continue. At `xi = 0` and `xi = 1` the values are exact zeros and ones.
    #[must_use]
    pub fn at(xi: f64, length: f64) -> Self {
        debug_assert!(xi.is_finite() && length > 0.0, "xi = {xi}, length = {length} m");
        let (l, xi2, xi3) = (length, xi * xi, xi * xi * xi);
        let rate = (6.0 * xi - 6.0 * xi2) / l;
        let curvature = (6.0 - 12.0 * xi) / (l * l);
        Self {
            s: Vector4::new(
                1.0 - 3.0 * xi2 + 2.0 * xi3,
                l * (xi - 2.0 * xi2 + xi3),
                3.0 * xi2 - 2.0 * xi3,
                l * (xi3 - xi2),
            ),
            s_x: Vector4::new(-rate, 1.0 - 4.0 * xi + 3.0 * xi2, rate, 3.0 * xi2 - 2.0 * xi),
            s_xx: Vector4::new(-curvature, (6.0 * xi - 4.0) / l, curvature, (6.0 * xi - 2.0) / l),
        }
    }
}

/// `∫ s sᵀ dx` over an element of `length` in m (m, m², m³): the mass matrix per mass per length [Thesis, Eq. (3)].
#[must_use]
pub fn mass_matrix(length: f64) -> Matrix4<f64> {
    let l = length;
    let (a, b) = (l * l, l);
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        156.0,     22.0 * b,  54.0,      -13.0 * b,
        22.0 * b,  4.0 * a,   13.0 * b,  -3.0 * a,
        54.0,      13.0 * b,  156.0,     -22.0 * b,
        -13.0 * b, -3.0 * a,  -22.0 * b, 4.0 * a,
    );
    matrix * (l / 420.0)
}

/// `∫ s,ₓ s,ₓᵀ dx` over an element of `length` in m (1/m, –, m): the transverse stiffness per tension.
#[must_use]
pub fn tension_matrix(length: f64) -> Matrix4<f64> {
    let l = length;
    let a = l * l;
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        36.0,     3.0 * l,  -36.0,    3.0 * l,
        3.0 * l,  4.0 * a,  -3.0 * l, -a,
        -36.0,    -3.0 * l, 36.0,     -3.0 * l,
        3.0 * l,  -a,       -3.0 * l, 4.0 * a,
    );
    matrix / (30.0 * l)
}

/// `∫ s,ₓₓ s,ₓₓᵀ dx` over an element of `length` in m (1/m³, 1/m², 1/m): the transverse stiffness per bending
/// stiffness.
#[must_use]
pub fn bending_matrix(length: f64) -> Matrix4<f64> {
    let l = length;
    let a = l * l;
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        12.0,    6.0 * l,  -12.0,    6.0 * l,
        6.0 * l, 4.0 * a,  -6.0 * l, 2.0 * a,
        -12.0,   -6.0 * l, 12.0,     -6.0 * l,
        6.0 * l, 2.0 * a,  -6.0 * l, 4.0 * a,
    );
    matrix / (l * a)
}
