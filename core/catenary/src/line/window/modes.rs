//! The lowest modes of a span held at its supports.
use dynamics::SparseMatrix;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

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

/// Modes of a span of one tension length along the track, and as many across it, that are kept whatever their
/// frequency: the first two of each wire.
pub(super) const APART: usize = 4;

/// Share of its mass with which a direction stays behind while the modes of others are searched: none, but for a mass
/// matrix that stays definite.
const FOLLOWS: f64 = 1e-6;

/// Choice of the modes of a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Number of modes that are kept.
    pub count: usize,
    /// Lowest modes among which they are found, no fewer.
    pub searched: usize,
    /// Modes along, and modes across the track that are kept whatever their frequency.
    pub apart: usize,
}

impl Kept {
    /// The choice of a part of several such spans beside each other.
    pub fn times(self, beside: usize) -> Self {
        Self {
            count: beside * self.count,
            searched: beside * self.searched,
            apart: beside * self.apart,
        }
    }

    /// Modes of `K φ = ω² M φ` in their order, columns `φ` with `φᵀ M φ = 1`, and `ω²`: the first ones along the track,
    /// then the others by ascending frequency. `along` and `across` are one at the coordinates of the direction, zero
    /// elsewhere.
    ///
    /// Tension changes run along the line at kilometres per second, as waves longer than the spans far beyond the
    /// frequencies of the contact force. With the quasi-static shape alone the mass of a span would stand at its
    /// supports, and these waves would be too fast.
    ///
    /// Waves across the track hardly lift a wire, so that the modes up and along the track are those of a line whose
    /// wires follow across the track without inertia; the first modes across join them, and all together are made
    /// modes of the span [Rayleigh & Ritz]. Modes of the whole span would not do: a wire swings equally fast up and
    /// across, so that each of its modes is both.
    pub fn modes(
        self,
        (stiffness, factor): (&SparseMatrix, &Envelope),
        mass: &SparseMatrix,
        [along, across]: [&DVector<f64>; 2],
    ) -> (DMatrix<f64>, Vec<f64>) {
        let is_spatial = across.amax() > 0.0;
        let of_others = if is_spatial { self.apart } else { 0 };
        let searched = self.searched - of_others;
        let one_after_another = |(modes, squares): (DMatrix<f64>, Vec<f64>), count: usize| {
            let shares = modes.component_mul(&product(mass, &modes)).tr_mul(along);
            let first = (0..shares.len()).filter(|&mode| shares[mode] > 0.5).take(self.apart);
            let first: Vec<usize> = first.collect();
            let others = (0..shares.len()).filter(|mode| !first.contains(mode));
            let order: Vec<usize> = first.iter().copied().chain(others).take(count).collect();
            let squares = order.iter().map(|&mode| squares[mode]).collect();
            (modes.select_columns(&order), squares)
        };
        if !is_spatial {
            let found = lowest_modes((stiffness, factor), mass, searched);
            return one_after_another(found, self.count);
        }
        let weighted = |weight: &dyn Fn(usize) -> f64| {
            let entries = (0..mass.size()).flat_map(|row| {
                let entries = mass.row(row);
                entries.map(move |(column, value)| (row as u32, column as u32, value * weight(row) * weight(column)))
            });
            SparseMatrix::from_entries(mass.size(), entries.collect())
        };
        let still = FOLLOWS.sqrt();
        let up = weighted(&|index| if across[index] > 0.0 { still } else { 1.0 });
        let sideways = weighted(&|index| if across[index] > 0.0 { 1.0 } else { still });
        let up = lowest_modes((stiffness, factor), &up, searched);
        let (up, _) = one_after_another(up, self.count - of_others);
        let (sideways, _) = lowest_modes((stiffness, factor), &sideways, of_others);
        let all = DMatrix::from_columns(&up.column_iter().chain(sideways.column_iter()).collect::<Vec<_>>());
        let turned = all.transpose();
        let (turn, squares) = diagonalise(&(&turned * product(stiffness, &all)), &(&turned * product(mass, &all)));
        one_after_another((all * turn, squares), self.count)
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

    /// A string that swings equally fast up and across, whose modes are therefore any mixture of both.
    #[test]
    fn of_a_string_in_space_all_modes_up_and_the_first_across_are_kept() {
        let n = 60;
        let in_space = |plane: &SparseMatrix| {
            let entries = (0..n).flat_map(|row| plane.row(row).map(move |(column, value)| (row, column, value)));
            // Coordinate 2 i is across and 2 i + 1 up; a weak coupling mixes them.
            let entries = entries.flat_map(|(i, j, value)| {
                let mixed = 1e-9 * value;
                let place = |i: usize, axis: usize| (2 * i + axis) as u32;
                [(0, 0, value), (1, 1, value), (0, 1, mixed), (1, 0, mixed)]
                    .map(|(a, b, value)| (place(i, a), place(j, b), value))
            });
            SparseMatrix::from_entries(2 * n, entries.collect())
        };
        let (stiffness, mass) = string(n as u32);
        let (stiffness, mass) = (in_space(&stiffness), in_space(&mass));
        let factor = Envelope::factor(&stiffness).unwrap();
        let across = DVector::from_fn(2 * n, |i, _| f64::from(u8::from(i % 2 == 0)));
        let kept = Kept {
            count: 12,
            searched: 12,
            apart: 4,
        };
        let along = DVector::zeros(2 * n);
        let (shapes, squares) = kept.modes((&stiffness, &factor), &mass, [&along, &across]);
        // The first four both up and across, then four more up.
        let order = [1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 7, 8];
        for (k, square) in order.into_iter().zip(&squares) {
            let angle = f64::from(k) * std::f64::consts::PI / (2 * n + 2) as f64;
            let exact = 4.0 * angle.sin().powi(2);
            assert!((square / exact - 1.0).abs() < 1e-4, "mode {k}: {square} {exact}");
        }
        let shares = shapes.component_mul(&shapes).tr_mul(&across);
        assert!(shares.rows(8, 4).amax() < 1e-6, "{shares}");
    }

    #[test]
    fn a_matrix_that_is_not_definite_has_no_factor() {
        let matrix = SparseMatrix::from_entries(2, vec![(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, 1.0)]);
        assert!(Envelope::factor(&matrix).is_none());
    }
}
