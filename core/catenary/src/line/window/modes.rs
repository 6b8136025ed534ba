//! The lowest modes of a span held at its supports.
use dynamics::SparseMatrix;
use nalgebra::{DMatrix, SymmetricEigen};

/// Factor `A = L Lᵀ` of a symmetric positive definite matrix, each row stored from its first entry on: a span numbered
/// along the track has a narrow band.
pub(super) struct Envelope {
    /// First column of each row.
    first: Vec<usize>,
    /// Index in `values` at which each row begins.
    start: Vec<usize>,
    values: Vec<f64>,
}

impl Envelope {
    /// Factors; `None` where the matrix is not positive definite.
    pub fn factor(matrix: &SparseMatrix) -> Option<Self> {
        let n = matrix.size();
        let (mut first, mut start, mut values) = (Vec::with_capacity(n), vec![0], Vec::new());
        for row in 0..n {
            let lowest = matrix.row(row).map(|(column, _)| column).min().unwrap_or(row).min(row);
            first.push(lowest);
            let begin = values.len();
            values.resize(begin + row - lowest + 1, 0.0);
            for (column, value) in matrix.row(row).filter(|&(column, _)| column <= row) {
                values[begin + column - lowest] = value;
            }
            start.push(values.len());
        }
        let mut factor = Self { first, start, values };
        for row in 0..n {
            for column in factor.first[row]..=row {
                let common = factor.first[row].max(factor.first[column]);
                let (mine, other) = (factor.row(row, common, column), factor.row(column, common, column));
                let sum: f64 = mine.iter().zip(other).map(|(a, b)| a * b).sum();
                let place = factor.start[row] + column - factor.first[row];
                let rest = factor.values[place] - sum;
                factor.values[place] = if column < row {
                    rest / factor.values[factor.start[column + 1] - 1]
                } else if rest > 0.0 {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
        }
        Some(factor)
    }

    /// Entries `from..to` of a row.
    fn row(&self, row: usize, from: usize, to: usize) -> &[f64] {
        let begin = self.start[row] - self.first[row];
        &self.values[begin + from..begin + to]
    }

    /// Solves in place.
    pub fn solve(&self, x: &mut [f64]) {
        let n = x.len();
        for i in 0..n {
            let row = self.row(i, self.first[i], i);
            let sum: f64 = row.iter().zip(&x[self.first[i]..i]).map(|(l, x)| l * x).sum();
            x[i] = (x[i] - sum) / self.values[self.start[i + 1] - 1];
        }
        for i in (0..n).rev() {
            x[i] /= self.values[self.start[i + 1] - 1];
            let value = x[i];
            let row = &self.values[self.start[i]..self.start[i + 1] - 1];
            for (l, x) in row.iter().zip(&mut x[self.first[i]..i]) {
                *x -= l * value;
            }
        }
    }
}

/// Additional vectors, which make the iteration converge.
const GUARD: usize = 16;
const ITERATIONS: usize = 8;

/// The lowest `count` modes of `K φ = ω² M φ` by subspace iteration [Bathe & Wilson 1973]: columns `φ` with `φᵀ M φ =
/// 1`, and `ω²` (1/s²), ascending.
///
/// The modes are shapes to which a motion is restricted and need not be exact: the restricted stiffness and mass are
/// diagonal whatever the iteration has reached.
pub(super) fn lowest_modes(
    (stiffness, factor): (&SparseMatrix, &Envelope),
    mass: &SparseMatrix,
    count: usize,
) -> (DMatrix<f64>, Vec<f64>) {
    let n = mass.size();
    let count = count.min(n);
    let size = count + GUARD;
    if 2 * size >= n {
        // Unit vectors for small spaces: random vectors that nearly fill a space become too much alike.
        let unit = DMatrix::identity(n, n);
        let (modes, mut squares) = diagonalise(&product(stiffness, &unit), &product(mass, &unit));
        squares.truncate(count);
        return (modes.columns(0, count).into_owned(), squares);
    }
    // Deterministic numbers without a pattern: a linear congruential generator [Knuth, MMIX].
    let mut seed = 1_u64;
    let mut vectors = DMatrix::from_fn(n, size, |_, _| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    });
    for _ in 1..ITERATIONS {
        let mut next = product(mass, &vectors);
        for column in 0..size {
            factor.solve(next.column_mut(column).as_mut_slice());
        }
        // Products of matrices are several times faster than `tr_mul`, which is not blocked, and than solutions of many
        // right sides.
        let inertia = next.transpose() * product(mass, &next);
        let (lower, scale) = scaled_root(&inertia);
        for (mut column, scale) in next.column_iter_mut().zip(&scale) {
            column *= *scale;
        }
        let turn = lower
            .solve_lower_triangular(&DMatrix::identity(size, size))
            .expect("a regular factor");
        vectors = next * turn.transpose();
    }
    let loads = product(mass, &vectors);
    let mut last = loads.clone();
    for column in 0..size {
        factor.solve(last.column_mut(column).as_mut_slice());
    }
    // K last = loads, so lastᵀ K last needs no product with K.
    let stiffness = last.transpose() * &loads;
    let inertia = last.transpose() * product(mass, &last);
    let (turn, mut squares) = diagonalise(&stiffness, &inertia);
    squares.truncate(count);
    (last * turn.columns(0, count), squares)
}

/// `A X`, column by column.
pub(super) fn product(matrix: &SparseMatrix, x: &DMatrix<f64>) -> DMatrix<f64> {
    let mut y = DMatrix::zeros(x.nrows(), x.ncols());
    for column in 0..x.ncols() {
        matrix.multiply_add(x.column(column).as_slice(), y.column_mut(column).as_mut_slice());
    }
    y
}

/// `L` with `S M S = L Lᵀ`, and the diagonal of `S`, which makes the diagonal of the product one: vectors may be of
/// very different size.
fn scaled_root(inertia: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let scale: Vec<f64> = inertia.diagonal().iter().map(|value| 1.0 / value.sqrt()).collect();
    let lower = scaled(inertia, &scale)
        .cholesky()
        .expect("the vectors of a subspace are independent")
        .unpack();
    (lower, scale)
}

fn scaled(matrix: &DMatrix<f64>, scale: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        0.5 * (matrix[(i, j)] + matrix[(j, i)]) * scale[i] * scale[j]
    })
}

/// `T` with `Tᵀ M T = 1` and `Tᵀ K T` diagonal, and that diagonal, ascending.
fn diagonalise(stiffness: &DMatrix<f64>, inertia: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let size = stiffness.nrows();
    let (lower, scale) = scaled_root(inertia);
    let half = lower
        .solve_lower_triangular(&scaled(stiffness, &scale))
        .expect("a regular factor");
    let whole = lower
        .solve_lower_triangular(&half.transpose())
        .expect("a regular factor");
    let eigen = SymmetricEigen::new((&whole + whole.transpose()) * 0.5);
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
    let vectors = DMatrix::from_fn(size, size, |i, j| eigen.eigenvectors[(i, order[j])]);
    let back = lower.tr_solve_lower_triangular(&vectors).expect("a regular factor");
    let turn = DMatrix::from_fn(size, size, |i, j| back[(i, j)] * scale[i]);
    (turn, order.iter().map(|&i| eigen.eigenvalues[i]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A string of `n` masses 1 kg and springs 1 N/m: ω² = 4 sin²(k π / (2 n + 2)).
    fn string(n: u32) -> (SparseMatrix, SparseMatrix) {
        let mut entries = Vec::new();
        for i in 0..n {
            entries.push((i, i, 2.0));
            if i > 0 {
                entries.push((i, i - 1, -1.0));
                entries.push((i - 1, i, -1.0));
            }
        }
        let mass = (0..n).map(|i| (i, i, 1.0)).collect();
        (
            SparseMatrix::from_entries(n as usize, entries),
            SparseMatrix::from_entries(n as usize, mass),
        )
    }

    #[test]
    fn the_modes_of_a_string_of_masses_have_their_closed_form() {
        let n = 60;
        let (stiffness, mass) = string(n);
        let factor = Envelope::factor(&stiffness).unwrap();
        for (count, accuracy) in [(12, 1e-4), (60, 1e-12)] {
            let (shapes, squares) = lowest_modes((&stiffness, &factor), &mass, count);
            assert_eq!(squares.len(), count);
            for (k, square) in squares.iter().enumerate() {
                let angle = (k + 1) as f64 * std::f64::consts::PI / f64::from(2 * n + 2);
                let exact = 4.0 * angle.sin().powi(2);
                assert!((square / exact - 1.0).abs() < accuracy, "mode {k}: {square} {exact}");
            }
            let gram = shapes.tr_mul(&product(&mass, &shapes));
            assert!((gram - DMatrix::identity(count, count)).amax() < 1e-12);
        }
    }

    #[test]
    fn a_matrix_that_is_not_definite_has_no_factor() {
        let matrix = SparseMatrix::from_entries(2, vec![(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, 1.0)]);
        assert!(Envelope::factor(&matrix).is_none());
    }
}
