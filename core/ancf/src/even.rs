//! Constant matrices of an element that are the same from either end.
use dynamics::simd::{Number, Space};
use nalgebra::Matrix4;

/// A symmetric 4 × 4 matrix `A` on `e = (r₁, r₁,ₓ, r₂, r₂,ₓ)` that is equal for an element seen from its other end, as
/// all integrals of products of the Hermite polynomials are: sums and differences of the two ends do not mix, six
/// coefficients remain.
///
/// ```text
/// f = A e,   s = r₁ + r₂,  d = r₁ − r₂,  s′ = r₁,ₓ + r₂,ₓ,  d′ = r₁,ₓ − r₂,ₓ
/// ½ (f₁ + f₂) = c₀ s + c₁ d′      ½ (m₁ + m₂) = c₃ d + c₄ s′
/// ½ (f₁ − f₂) = c₂ d + c₃ s′      ½ (m₁ − m₂) = c₁ s + c₅ d′
/// ```
///
/// derived here; `f` are the forces and `m` the moments on the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenMatrix<N = f64>(pub [N; 6]);

/// `A e` before the sums and differences of the two ends are taken apart, so that products can be added up.
#[derive(Clone, Copy, Debug)]
pub struct EvenProduct<V> {
    sum: [V; 2],
    difference: [V; 2],
}

impl EvenMatrix {
    /// The coefficients of a matrix.
    pub fn new(matrix: &Matrix4<f64>) -> Self {
        debug_assert!(
            (matrix[(1, 2)] + matrix[(0, 3)]).abs() <= 1e-12 * matrix.amax()
                && (matrix[(2, 2)] - matrix[(0, 0)]).abs() <= 1e-12 * matrix.amax(),
            "{matrix} is not the same from either end"
        );
        let m = |column: usize| matrix[(0, column)];
        Self([
            0.5 * (m(0) + m(2)),
            0.5 * (m(1) - m(3)),
            0.5 * (m(0) - m(2)),
            0.5 * (m(1) + m(3)),
            0.5 * (matrix[(1, 1)] + matrix[(1, 3)]),
            0.5 * (matrix[(1, 1)] - matrix[(1, 3)]),
        ])
    }
}

impl<N: Number> EvenMatrix<N> {
    /// `A e`.
    #[inline(always)]
    pub fn times<V: Space<Number = N>>(&self, [r1, r1_x, r2, r2_x]: [V; 4]) -> EvenProduct<V> {
        let c = &self.0;
        let (s, d) = (r1 + r2, r1 - r2);
        let (s_x, d_x) = (r1_x + r2_x, r1_x - r2_x);
        EvenProduct {
            sum: [(s * c[0]).plus(c[1], d_x), (d * c[3]).plus(c[4], s_x)],
            difference: [(d * c[2]).plus(c[3], s_x), (s * c[1]).plus(c[5], d_x)],
        }
    }
}

impl EvenMatrix {
    /// The sixteen entries, row by row.
    #[inline(always)]
    pub fn entries(&self) -> [[f64; 4]; 4] {
        let c = &self.0;
        [
            [c[0] + c[2], c[1] + c[3], c[0] - c[2], c[3] - c[1]],
            [c[3] + c[1], c[4] + c[5], c[1] - c[3], c[4] - c[5]],
            [c[0] - c[2], c[1] - c[3], c[0] + c[2], -c[1] - c[3]],
            [c[3] - c[1], c[4] - c[5], -c[1] - c[3], c[4] + c[5]],
        ]
    }
}

impl<V: Space> EvenProduct<V> {
    /// The sum of two products.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        let ([f, m], [f_other, m_other]) = (self.sum, other.sum);
        let ([g, n], [g_other, n_other]) = (self.difference, other.difference);
        Self {
            sum: [f + f_other, m + m_other],
            difference: [g + g_other, n + n_other],
        }
    }

    /// The four parts.
    #[inline(always)]
    pub fn on_nodes(self) -> [V; 4] {
        let ([f, m], [g, n]) = (self.sum, self.difference);
        [f + g, m + n, f - g, m - n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bending_matrix, mass_matrix, tension_matrix};
    use nalgebra::{Vector3, Vector4};

    #[test]
    fn six_coefficients_multiply_like_the_sixteen_entries() {
        let length = 1.7;
        for matrix in [mass_matrix(length), tension_matrix(length), bending_matrix(length)] {
            let e = Vector4::new(0.3, -1.1, 0.7, 0.45);
            let [x, y, z] = [0.0, 1.0, -2.0].map(|factor| e * factor);
            let nodes = [0, 1, 2, 3].map(|i| Vector3::new(x[i], y[i], z[i]));
            let entries = EvenMatrix::new(&matrix).entries();
            let back = Matrix4::from_fn(|row, column| entries[row][column]);
            assert!((back - matrix).amax() < 1e-15 * matrix.amax());
            let product = EvenMatrix::new(&matrix).times(nodes).on_nodes();
            let expected = matrix * e;
            for (part, expected) in product.iter().zip(expected.iter()) {
                let error = (part - Vector3::new(0.0, 1.0, -2.0) * *expected).amax();
                assert!(error < 1e-14 * matrix.amax(), "{part} against {expected}");
            }
        }
    }
}
