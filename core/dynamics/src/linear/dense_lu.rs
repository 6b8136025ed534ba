//! Gaussian elimination of a small dense matrix.

/// `P A = L U` with partial pivoting, row by row in one array.
#[derive(Clone, Debug, Default)]
pub struct Lu {
    size: usize,
    values: Vec<f64>,
    /// Row that was exchanged with each row.
    pivots: Vec<usize>,
}

impl Lu {
    /// The matrix to be filled, all zeros.
    pub fn matrix(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.values.clear();
        self.values.resize(size * size, 0.0);
        &mut self.values
    }

    /// Factors the matrix that was filled in.
    ///
    /// # Errors
    /// The first column that depends on those before it.
    pub fn factor(&mut self) -> Result<(), usize> {
        let (n, a) = (self.size, &mut self.values);
        self.pivots.clear();
        for column in 0..n {
            let pivot = (column..n)
                .max_by(|&i, &j| a[i * n + column].abs().total_cmp(&a[j * n + column].abs()))
                .unwrap_or(column);
            if a[pivot * n + column] == 0.0 || !a[pivot * n + column].is_finite() {
                return Err(column);
            }
            self.pivots.push(pivot);
            if pivot != column {
                for k in 0..n {
                    a.swap(pivot * n + k, column * n + k);
                }
            }
            let (upper, lower) = a.split_at_mut((column + 1) * n);
            let pivot_row = &upper[column * n + column..];
            for row in lower.chunks_exact_mut(n) {
                let row = &mut row[column..];
                let factor = row[0] / pivot_row[0];
                row[0] = factor;
                if factor != 0.0 {
                    for (value, &above) in row[1..].iter_mut().zip(&pivot_row[1..]) {
                        *value -= factor * above;
                    }
                }
            }
        }
        Ok(())
    }

    /// Solves in place with the last factors.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.size;
        for (row, &pivot) in self.pivots.iter().enumerate() {
            b.swap(row, pivot);
        }
        for row in 0..n {
            let (done, rest) = b.split_at_mut(row);
            let sum: f64 = self.values[row * n..].iter().zip(&*done).map(|(l, b)| l * b).sum();
            rest[0] -= sum;
        }
        for row in (0..n).rev() {
            let values = &self.values[row * n..(row + 1) * n];
            let sum: f64 = (row + 1..n).map(|k| values[k] * b[k]).sum();
            b[row] = (b[row] - sum) / values[row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn solutions_agree_with_nalgebra_and_need_pivots() {
        for n in [1, 2, 5, 40] {
            // Zeros on the diagonal: without exchanges of rows there is no solution.
            let entry = |i: usize, j: usize| {
                if i == j && n > 1 {
                    0.0
                } else {
                    ((7 * i + 13 * j + 3) % 17) as f64 - 8.5
                }
            };
            let a = DMatrix::from_fn(n, n, entry);
            let b = DVector::from_fn(n, |i, _| 1.0 + i as f64);
            let mut lu = Lu::default();
            lu.matrix(n).copy_from_slice(a.transpose().as_slice());
            assert_eq!(lu.factor(), Ok(()));
            let mut x = b.clone();
            lu.solve(x.as_mut_slice());
            let exact = a.lu().solve(&b).unwrap();
            assert!((&x - &exact).amax() < 1e-10 * exact.amax(), "{n}: {x} {exact}");
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut lu = Lu::default();
        lu.matrix(3)
            .copy_from_slice(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0]);
        assert_eq!(lu.factor(), Err(2));
        lu.matrix(3)
            .copy_from_slice(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0]);
        assert_eq!(lu.factor(), Err(1));
        lu.matrix(2).copy_from_slice(&[f64::NAN, 1.0, 1.0, 1.0]);
        assert_eq!(lu.factor(), Err(0));
    }
}
