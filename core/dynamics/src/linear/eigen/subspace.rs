//! The lowest eigenpairs of a small pencil, and those of a subspace.
use super::{BandedFactor, Eigenpairs};
use crate::SparseMatrix;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

/// Additional vectors, which make the iteration converge.
const GUARD: usize = 16;
const ITERATIONS: usize = 8;

/// The lowest `count` eigenpairs of `K φ = λ M φ`, found by subspace iteration [Bathe & Wilson 1973] with the factor
/// of `K`.
///
/// The vectors are shapes to which a motion is restricted and need not be exact: `φᵀ K φ` and `φᵀ M φ` are diagonal
/// whatever the iteration has reached.
///
/// # Panics
/// When `K` or `M` is not positive definite.
#[must_use]
pub fn lowest_eigenpairs(
    (stiffness, factor): (&SparseMatrix, &BandedFactor),
    mass: &SparseMatrix,
    count: usize,
) -> Eigenpairs {
    let n = mass.size();
    let count = count.min(n);
    let size = count + GUARD;
    if 2 * size >= n {
        // Unit vectors for small spaces: random vectors that nearly fill a space become too much alike.
        let mut unit = vec![0.0; n * n];
        unit.iter_mut().step_by(n + 1).for_each(|one| *one = 1.0);
        return restricted(&unit, [stiffness, mass]).first(count);
    }
    // Deterministic numbers without a pattern: a linear congruential generator [Knuth, MMIX].
    let mut seed = 1_u64;
    let random = || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut vectors: Vec<f64> = std::iter::repeat_with(random).take(n * size).collect();
    for _ in 1..ITERATIONS {
        vectors = mass.multiply_columns(&vectors);
        factor.solve_columns(&mut vectors);
        let (lower, scale) = root(gram(&vectors, &mass.multiply_columns(&vectors), n));
        for (column, scale) in vectors.chunks_exact_mut(n).zip(&scale) {
            column.iter_mut().for_each(|x| *x *= scale);
        }
        // Vᵀ M V = L Lᵀ, so that V L⁻ᵀ is orthogonal.
        let columns = MatMut::from_column_major_slice_mut(&mut vectors, n, size);
        solve_lower_triangular_in_place(lower.as_ref(), columns.transpose_mut(), Par::Seq);
    }
    let loads = mass.multiply_columns(&vectors);
    let mut last = loads.clone();
    factor.solve_columns(&mut last);
    // K last = loads, so lastᵀ K last needs no product with K.
    let stiffness = gram(&last, &loads, n);
    let inertia = gram(&last, &mass.multiply_columns(&last), n);
    turned(&last, (stiffness, inertia)).first(count)
}

/// The eigenpairs of a pencil `K`, `M` restricted to vectors, which are given one after the other [Rayleigh & Ritz].
///
/// # Panics
/// When the vectors depend on each other.
#[must_use]
pub fn restricted(vectors: &[f64], [stiffness, mass]: [&SparseMatrix; 2]) -> Eigenpairs {
    let of = |matrix: &SparseMatrix| gram(vectors, &matrix.multiply_columns(vectors), matrix.size());
    turned(vectors, (of(stiffness), of(mass)))
}

/// `Aᵀ B` of columns of `n` numbers, which is symmetric but for rounding.
pub(super) fn gram(a: &[f64], b: &[f64], n: usize) -> Mat<f64> {
    let size = a.len() / n;
    let [a, b] = [a, b].map(|values| MatRef::from_column_major_slice(values, n, size));
    let mut product = Mat::zeros(size, size);
    matmul(product.as_mut(), Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
    Mat::from_fn(size, size, |i, j| 0.5 * (product[(i, j)] + product[(j, i)]))
}

/// `L` with `S M S = L Lᵀ`, and the diagonal of `S`, which makes the diagonal of the product one: vectors may be of
/// very different size.
fn root(inertia: Mat<f64>) -> (Mat<f64>, Vec<f64>) {
    let size = inertia.nrows();
    let scale: Vec<f64> = (0..size).map(|i| 1.0 / inertia[(i, i)].sqrt()).collect();
    let scaled = Mat::from_fn(size, size, |i, j| inertia[(i, j)] * scale[i] * scale[j]);
    let lower = scaled
        .llt(Side::Lower)
        .expect("the vectors of a subspace are independent");
    (lower.L().to_owned(), scale)
}

/// The eigenpairs within the space of some vectors, from the pencil restricted to them.
pub(super) fn turned(vectors: &[f64], (stiffness, inertia): (Mat<f64>, Mat<f64>)) -> Eigenpairs {
    let size = stiffness.nrows();
    let n = vectors.len() / size;
    let (lower, scale) = root(inertia);
    let mut whole = Mat::from_fn(size, size, |i, j| stiffness[(i, j)] * scale[i] * scale[j]);
    solve_lower_triangular_in_place(lower.as_ref(), whole.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(lower.as_ref(), whole.transpose_mut(), Par::Seq);
    let eigen = whole
        .self_adjoint_eigen(Side::Lower)
        .expect("a symmetric matrix has eigenvectors");
    let mut turn = eigen.U().to_owned();
    solve_upper_triangular_in_place(lower.transpose(), turn.as_mut(), Par::Seq);
    let turn = Mat::from_fn(size, size, |i, j| turn[(i, j)] * scale[i]);
    let mut found = vec![0.0; vectors.len()];
    matmul(
        MatMut::from_column_major_slice_mut(&mut found, n, size),
        Accum::Replace,
        MatRef::from_column_major_slice(vectors, n, size),
        turn.as_ref(),
        1.0,
        Par::Seq,
    );
    Eigenpairs {
        values: eigen.S().column_vector().iter().copied().collect(),
        vectors: found.chunks_exact(n).map(<[f64]>::to_vec).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::BandedMatrix;
    use crate::testing::string_of_masses;

    #[test]
    fn the_modes_of_a_string_of_masses_have_their_closed_form() {
        let n = 60;
        let [stiffness, mass] = string_of_masses(n);
        let factor = BandedFactor::new(&BandedMatrix::from(&stiffness));
        for (count, accuracy) in [(12, 1e-4), (60, 1e-12)] {
            let found = lowest_eigenpairs((&stiffness, &factor), &mass, count);
            assert_eq!((found.values.len(), found.vectors.len()), (count, count));
            for (k, square) in found.values.iter().enumerate() {
                let angle = (k + 1) as f64 * std::f64::consts::PI / f64::from(2 * n + 2);
                let exact = 4.0 * angle.sin().powi(2);
                assert!((square / exact - 1.0).abs() < accuracy, "mode {k}: {square} {exact}");
            }
            let flat = found.vectors.concat();
            let across = gram(&flat, &mass.multiply_columns(&flat), n as usize);
            let wrong = across - Mat::<f64>::identity(count, count);
            assert!(wrong.norm_max() < 1e-12);
        }
    }
}
