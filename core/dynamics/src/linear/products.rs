//! Products of whole cache lines in the vector registers of the processor.
use pulp::{Simd, WithSimd};

/// `Σ a b` of whole cache lines.
pub(super) struct Product<'a>(pub &'a [f64], pub &'a [f64]);

impl WithSimd for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (x, y) = (S::as_simd_f64s(self.0).0, S::as_simd_f64s(self.1).0);
        let mut sum = simd.splat_f64s(0.0);
        for (&x, &y) in x.iter().zip(y) {
            sum = simd.mul_add_e_f64s(x, y, sum);
        }
        simd.reduce_sum_f64s(sum)
    }
}

/// `sums[j] = Σ rows[j] x` of whole cache lines, four rows side by side: one sum after the other would wait for its
/// additions.
pub(super) struct Products<'a> {
    pub rows: &'a [f64],
    pub x: &'a [f64],
    pub sums: &'a mut [f64],
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let stride = self.x.len();
        let x = S::as_simd_f64s(self.x).0;
        for (rows, sums) in self.rows.chunks(4 * stride).zip(self.sums.chunks_mut(4)) {
            if let [a, b, c, d] = sums {
                let row = |j: usize| &S::as_simd_f64s(&rows[j * stride..(j + 1) * stride]).0[..x.len()];
                let rows = [row(0), row(1), row(2), row(3)];
                let mut totals = [simd.splat_f64s(0.0); 4];
                for (i, &x) in x.iter().enumerate() {
                    for (total, row) in totals.iter_mut().zip(rows) {
                        *total = simd.mul_add_e_f64s(row[i], x, *total);
                    }
                }
                for (sum, total) in [a, b, c, d].into_iter().zip(totals) {
                    *sum = simd.reduce_sum_f64s(total);
                }
            } else {
                for (row, sum) in rows.chunks_exact(stride).zip(sums) {
                    *sum = Product(row, self.x).with_simd(simd);
                }
            }
        }
    }
}

/// `forces −= Σ aⱼ xⱼ`
pub(super) struct Subtract<'a> {
    pub rows: &'a [f64],
    pub x: &'a [f64],
    pub forces: &'a mut [f64],
}

impl WithSimd for Subtract<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (row, x) in self.rows.chunks_exact(self.forces.len()).zip(self.x) {
            for (force, a) in self.forces.iter_mut().zip(row) {
                *force -= a * x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::buffer::LINE;
    use pulp::Arch;

    #[test]
    fn products_side_by_side_are_those_of_one_row_after_the_other() {
        // Rows beyond fours.
        let (rows, count) = (7, 3 * LINE);
        let values: Vec<f64> = (0..rows * count)
            .map(|i| f64::from((i * 37 % 19) as u8) - 9.0)
            .collect();
        let x: Vec<f64> = (0..count).map(|i| f64::from((i * 5 % 7) as u8) - 3.0).collect();
        let mut sums = vec![0.0; rows];
        Arch::new().dispatch(Products {
            rows: &values,
            x: &x,
            sums: &mut sums,
        });
        for (row, sum) in values.chunks_exact(count).zip(sums) {
            let exact: f64 = row.iter().zip(&x).map(|(a, b)| a * b).sum();
            // Whole numbers: nothing is rounded.
            assert_eq!(sum, exact);
        }
    }
}
