//! A small sparse matrix for products.
use super::buffer::Buffer;
use pulp::{Arch, Simd, WithSimd};

/// Columns that are worked on side by side, one in each lane of the registers.
const ABREAST: usize = 4;

/// A square sparse matrix in compressed rows, for `y += A x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseMatrix {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
    /// Rows with entries: matrices of a few contributions are empty in most rows.
    occupied: Vec<u32>,
}

impl SparseMatrix {
    /// Sums entries (row, column, value) that may repeat; sums that are exactly zero are left out.
    #[must_use]
    pub fn from_entries(size: usize, entries: Vec<(u32, u32, f64)>) -> Self {
        let mut firsts = vec![0; size + 1];
        for &(row, _, _) in &entries {
            firsts[row as usize + 1] += 1;
        }
        for row in 0..size {
            firsts[row + 1] += firsts[row];
        }
        let mut by_row = vec![(0, 0.0); entries.len()];
        let mut next = firsts.clone();
        for (row, column, value) in entries {
            by_row[next[row as usize]] = (column, value);
            next[row as usize] += 1;
        }
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for range in firsts.windows(2) {
            let of_row = &mut by_row[range[0]..range[1]];
            // Stable sort: repeated entries are summed in their order.
            of_row.sort_by_key(|&(column, _)| column);
            for repeated in of_row.chunk_by(|a, b| a.0 == b.0) {
                let sum = repeated.iter().map(|&(_, value)| value).sum::<f64>();
                if sum != 0.0 {
                    columns.push(repeated[0].0);
                    values.push(sum);
                }
            }
            starts.push(columns.len());
        }
        let occupied = (0..size as u32).filter(|&row| starts[row as usize] < starts[row as usize + 1]);
        Self {
            occupied: occupied.collect(),
            starts,
            columns,
            values,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The rows that have entries, ascending.
    pub fn occupied(&self) -> impl Iterator<Item = usize> + '_ {
        self.occupied.iter().map(|&row| row as usize)
    }

    /// The entries of one row as (column, value).
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()]
            .iter()
            .map(|&column| column as usize)
            .zip(self.values[range].iter().copied())
    }

    /// `y += A x`.
    pub fn multiply_add(&self, x: &[f64], y: &mut [f64]) {
        for row in self.occupied() {
            y[row] += self.row_product(row, x);
        }
    }

    /// `y −= A x`.
    pub fn multiply_subtract(&self, x: &[f64], y: &mut [f64]) {
        for row in self.occupied() {
            y[row] -= self.row_product(row, x);
        }
    }

    /// `A x` of columns one after the other.
    #[must_use]
    pub fn multiply_columns(&self, x: &[f64]) -> Vec<f64> {
        let mut columns = x.to_vec();
        let mut product = Buffer::new(self.size() * ABREAST);
        let product = product.as_chunks_mut().0;
        by_groups(self.size(), &mut columns, |group| {
            Arch::new().dispatch(Multiply {
                matrix: self,
                x: group,
                y: product,
            });
            group.copy_from_slice(product);
        });
        columns
    }

    /// One entry of `A x`.
    #[inline]
    #[must_use]
    pub fn row_product(&self, row: usize, x: &[f64]) -> f64 {
        let range = self.starts[row]..self.starts[row + 1];
        let entries = self.columns[range.clone()].iter().zip(&self.values[range]);
        entries.map(|(&column, value)| value * x[column as usize]).sum()
    }

    /// `Tᵀ A T`: the rows of `T` are those of the unit matrix except for `changed` ones, given with their entries
    /// (column, value).
    #[must_use]
    pub fn congruent(&self, changed: &[(usize, Vec<(usize, f64)>)]) -> Self {
        let mut rows: Vec<Vec<(usize, f64)>> = (0..self.size()).map(|i| vec![(i, 1.0)]).collect();
        for (row, entries) in changed {
            rows[*row].clone_from(entries);
        }
        let mut entries = Vec::new();
        for (i, of_row) in rows.iter().enumerate() {
            for (j, value) in self.row(i) {
                for &(row, left) in of_row {
                    let of_column = rows[j].iter();
                    entries.extend(of_column.map(|&(column, right)| (row as u32, column as u32, left * value * right)));
                }
            }
        }
        Self::from_entries(self.size(), entries)
    }

    /// `xᵀ A x`.
    #[must_use]
    pub fn quadratic_form(&self, x: &[f64]) -> f64 {
        self.occupied().map(|row| x[row] * self.row_product(row, x)).sum()
    }
}

/// Changes columns of `size` numbers, one after the other, in groups side by side; the last group is filled up with
/// zeros.
pub(crate) fn by_groups(size: usize, columns: &mut [f64], mut change: impl FnMut(&mut [[f64; ABREAST]])) {
    let mut group = Buffer::new(size * ABREAST);
    let group = group.as_chunks_mut().0;
    for columns in columns.chunks_mut((size * ABREAST).max(1)) {
        group.fill([0.0; ABREAST]);
        for (lane, column) in columns.chunks_exact(size).enumerate() {
            group.iter_mut().zip(column).for_each(|(row, value)| row[lane] = *value);
        }
        change(group);
        for (lane, column) in columns.chunks_exact_mut(size).enumerate() {
            group.iter().zip(column).for_each(|(row, value)| *value = row[lane]);
        }
    }
}

/// `Y = A X` of columns side by side.
struct Multiply<'a> {
    matrix: &'a SparseMatrix,
    x: &'a [[f64; ABREAST]],
    y: &'a mut [[f64; ABREAST]],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (row, y) in self.y.iter_mut().enumerate() {
            let mut sums = [0.0; ABREAST];
            for (column, value) in self.matrix.row(row) {
                for (sum, x) in sums.iter_mut().zip(&self.x[column]) {
                    *sum += value * x;
                }
            }
            *y = sums;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_entries_are_summed_and_empty_rows_stay_empty() {
        let a = SparseMatrix::from_entries(
            3,
            vec![
                (2, 0, 1.0),
                (0, 1, 2.0),
                (2, 0, 3.0),
                (2, 2, 5.0),
                (0, 0, 1.0),
                (0, 0, -1.0),
            ],
        );
        let mut y = [1.0; 3];
        a.multiply_add(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [21.0, 1.0, 505.0]);
        a.multiply_subtract(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [1.0; 3]);
        assert_eq!(a.row(0).count(), 1, "a sum of zero takes no place");
        assert_eq!(a.quadratic_form(&[1.0, 10.0, 100.0]), 20.0 + 400.0 + 50000.0);
    }
}
