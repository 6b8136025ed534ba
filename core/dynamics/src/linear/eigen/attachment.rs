//! Eigenpairs of what a pencil answers to given forces beyond eigenpairs that are known.
use super::subspace::{gram, turned};
use super::{BandedFactor, Eigenpairs};
use crate::SparseMatrix;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

/// Eigenvectors that are taken off at a time.
const BLOCK: usize = 64;
/// Least compliance beyond the eigenpairs that is more than rounding, in units of the largest whole one.
const LEAST: f64 = 1e-7;

/// Eigenpairs of a pencil `K`, `M` restricted to its residual attachment modes `(K⁻¹ − Σ φ φᵀ/λ) g`, for all forces `g`
/// that are given by their entries (row, value), with the eigenpairs `(λ, φ)` of `known`; `factor` is that of `K`.
///
/// `known` and these together answer the forces at rest as the whole pencil does, and in motion with the inertia of all
/// that is left out [MacNeal 1971; Rubin 1975; Craig & Chang 1977]. A force that `known` answers by itself adds none.
///
/// # Panics
/// When `K` or `M` is not positive definite.
#[must_use]
pub fn attachment_pairs(
    (factor, mass): (&BandedFactor, &SparseMatrix),
    known: &Eigenpairs,
    forces: &[Vec<(usize, f64)>],
) -> Eigenpairs {
    let (n, count) = (mass.size(), forces.len());
    if count == 0 {
        return Eigenpairs::default();
    }
    let work = |force: &[(usize, f64)], shape: &[f64]| -> f64 { force.iter().map(|&(at, g)| g * shape[at]).sum() };
    let answers = forces.iter().map(|force| factor.solve(force.iter().copied()));
    let mut shapes: Vec<f64> = answers.flatten().collect();
    let whole = forces.iter().zip(shapes.chunks_exact(n));
    let whole = whole.map(|(force, shape)| work(force, shape)).fold(0.0, f64::max);
    for (values, vectors) in known.values.chunks(BLOCK).zip(known.vectors.chunks(BLOCK)) {
        let parts = Mat::from_fn(vectors.len(), count, |k, j| work(&forces[j], &vectors[k]) / values[k]);
        let vectors = vectors.concat();
        matmul(
            MatMut::from_column_major_slice_mut(&mut shapes, n, count),
            Accum::Add,
            MatRef::from_column_major_slice(&vectors, n, values.len()),
            parts.as_ref(),
            -1.0,
            Par::Seq,
        );
    }
    // `gᵢᵀ vⱼ = vᵢᵀ K vⱼ`.
    let stiffness = Mat::from_fn(count, count, |i, j| work(&forces[i], &shapes[j * n..][..n]));
    let shapes = orthonormal(&shapes, &stiffness, LEAST * whole);
    if shapes.is_empty() {
        return Eigenpairs::default();
    }
    let inertia = gram(&shapes, &mass.multiply_columns(&shapes), n);
    let size = inertia.nrows();
    turned(&shapes, (Mat::identity(size, size), inertia))
}

/// Combinations of shapes that are orthonormal in a product, of which the shapes have these `products` between them;
/// those that have `least` or less are left out.
fn orthonormal(shapes: &[f64], products: &Mat<f64>, least: f64) -> Vec<f64> {
    let size = products.nrows();
    let n = shapes.len() / size;
    let eigen = products
        .self_adjoint_eigen(Side::Lower)
        .expect("a symmetric matrix has eigenvectors");
    let all = eigen.S().column_vector().iter().copied().enumerate();
    let (kept, values): (Vec<usize>, Vec<f64>) = all.filter(|(_, value)| *value > least).unzip();
    let turn = Mat::from_fn(size, kept.len(), |i, k| eigen.U()[(i, kept[k])] / values[k].sqrt());
    let mut found = vec![0.0; n * kept.len()];
    matmul(
        MatMut::from_column_major_slice_mut(&mut found, n, kept.len()),
        Accum::Replace,
        MatRef::from_column_major_slice(shapes, n, size),
        turn.as_ref(),
        1.0,
        Par::Seq,
    );
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::{BandedMatrix, eigenpairs_below};
    use crate::testing::string_of_masses;

    /// A string of masses, its eigenpairs up to `most`, and those of forces on the masses `at` beyond.
    fn of_string(n: u32, most: f64, at: &[usize]) -> ([SparseMatrix; 2], Eigenpairs, Eigenpairs) {
        let [stiffness, mass] = string_of_masses(n);
        let banded = BandedMatrix::from(&stiffness);
        // Both of one band.
        let of_mass: Vec<_> = (0..n).map(|i| (i, i, 1.0)).collect();
        let known = eigenpairs_below(&banded, &BandedMatrix::from_entries(n as usize, 1, &of_mass), most);
        let known = known.expect("a string has modes");
        let forces: Vec<_> = at.iter().map(|&at| vec![(at, 1.0)]).collect();
        let more = attachment_pairs((&BandedFactor::new(&banded), &mass), &known, &forces);
        ([stiffness, mass], known, more)
    }

    #[test]
    fn a_string_answers_forces_with_a_quarter_of_its_modes_as_with_all() {
        let at = [7, 19, 20, 41];
        let ([stiffness, mass], known, more) = of_string(60, 0.6, &at);
        assert!(known.values.len() < 16 && more.values.len() == at.len());
        assert!(more.values[0] > *known.values.last().unwrap() && more.values.is_sorted());
        for (value, vector) in more.values.iter().zip(&more.vectors) {
            assert!((stiffness.quadratic_form(vector) / value - 1.0).abs() < 1e-10);
            assert!((mass.quadratic_form(vector) - 1.0).abs() < 1e-10);
        }
        // Slowly shaken with `ω`, `(K − ω² M)⁻¹`: at rest exactly, then with an error of the order of `ω⁴`.
        let answer = |pairs: [&Eigenpairs; 2], [a, b]: [usize; 2], square: f64| -> f64 {
            let all = pairs.iter().flat_map(|pairs| pairs.values.iter().zip(&pairs.vectors));
            all.map(|(value, vector)| vector[a] * vector[b] / (value - square))
                .sum()
        };
        let (_, every, none) = of_string(60, 4.1, &at);
        assert_eq!((every.values.len(), none.values.len()), (60, 0));
        for a in at {
            for b in at {
                let error = |square| {
                    let whole = answer([&every, &none], [a, b], square);
                    (answer([&known, &more], [a, b], square) - whole).abs()
                };
                assert!(error(0.0) < 1e-10, "{a} {b}: {}", error(0.0));
                let ratio = error(0.11) / error(0.11 / 4.0);
                assert!(ratio > 12.0, "{a} {b}: {ratio}");
            }
        }
    }

    #[test]
    fn forces_that_depend_on_each_other_add_what_is_new() {
        let (_, _, once) = of_string(60, 0.6, &[7, 20]);
        let (_, _, twice) = of_string(60, 0.6, &[7, 20, 7]);
        assert_eq!(once.values.len(), 2);
        assert_eq!(twice.values.len(), 2);
        assert!((once.values[0] / twice.values[0] - 1.0).abs() < 1e-10);
    }
}
