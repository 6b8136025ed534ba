//! A small sparse matrix for products.

/// A square sparse matrix in compressed rows, for `y += A x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseMatrix {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl SparseMatrix {
    /// Sums entries (row, column, value) that may repeat.
    #[must_use]
    pub fn from_entries(size: usize, mut entries: Vec<(u32, u32, f64)>) -> Self {
        entries.sort_by_key(|&(row, column, _)| (row, column));
        let mut matrix = Self {
            starts: vec![0; size + 1],
            ..Self::default()
        };
        let mut last = None;
        for (row, column, value) in entries {
            if last == Some((row, column)) {
                *matrix.values.last_mut().expect("an entry stands before its repetition") += value;
            } else {
                matrix.columns.push(column);
                matrix.values.push(value);
                last = Some((row, column));
            }
            matrix.starts[row as usize + 1] = matrix.columns.len();
        }
        for row in 0..size {
            matrix.starts[row + 1] = matrix.starts[row + 1].max(matrix.starts[row]);
        }
        matrix
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.starts.len().saturating_sub(1)
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
        for (row, target) in y.iter_mut().enumerate().take(self.size()) {
            *target += self.row(row).map(|(column, value)| value * x[column]).sum::<f64>();
        }
    }

    /// `xᵀ A x`.
    #[must_use]
    pub fn quadratic_form(&self, x: &[f64]) -> f64 {
        (0..self.size())
            .map(|row| x[row] * self.row(row).map(|(column, value)| value * x[column]).sum::<f64>())
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_entries_are_summed_and_empty_rows_stay_empty() {
        let a = SparseMatrix::from_entries(3, vec![(2, 0, 1.0), (0, 1, 2.0), (2, 0, 3.0), (2, 2, 5.0)]);
        let mut y = [1.0; 3];
        a.multiply_add(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [21.0, 1.0, 505.0]);
        assert_eq!(a.quadratic_form(&[1.0, 10.0, 100.0]), 20.0 + 400.0 + 50000.0);
    }
}
