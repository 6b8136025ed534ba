//! Rise of strips per missing force, learnt from corrections.

use nalgebra::DMatrix;

/// `a − b`, entry by entry.
pub(super) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Rise of the strips per newton that is missing, m/N, by Broyden's method [Broyden, Math. Comp. 19 (1965)]; with
/// one strip a secant.
pub(super) struct Compliance {
    rows: Vec<Vec<f64>>,
}

impl Compliance {
    /// Equilibrium of heads that do not see each other, on these stiffnesses (N/m), one matrix per head.
    pub(super) fn of_heads(stiffnesses: &[DMatrix<f64>]) -> Self {
        let size = stiffnesses.iter().map(DMatrix::nrows).sum();
        let mut rows = Vec::with_capacity(size);
        let mut first = 0;
        for stiffness in stiffnesses {
            let compliance = match stiffness.as_slice() {
                [only] => DMatrix::from_element(1, 1, 1.0 / only),
                // A matrix without an inverse stands still, and is told of as one that does not settle.
                _ => stiffness.clone().try_inverse().unwrap_or_else(|| stiffness * 0.0),
            };
            for own in compliance.row_iter() {
                let mut row = vec![0.0; size];
                for (entry, value) in row[first..].iter_mut().zip(own.iter()) {
                    *entry = *value;
                }
                rows.push(row);
            }
            first += stiffness.nrows();
        }
        Self { rows }
    }

    /// Rises, m, that take away these missing forces, N.
    pub(super) fn times(&self, forces: &[f64]) -> Vec<f64> {
        let product = |row: &Vec<f64>| row.iter().zip(forces).map(|(a, b)| a * b).sum();
        self.rows.iter().map(product).collect()
    }

    /// Takes in that a rise (m) has changed the missing forces by `change` (N), where that tells more than rounding and
    /// more than a contact that has just closed.
    pub(super) fn learn(&mut self, rise: &[f64], change: &[f64]) {
        let square: f64 = rise.iter().map(|s| s * s).sum();
        let expected = self.times(change);
        let along: f64 = rise.iter().zip(&expected).map(|(s, y)| s * y).sum();
        if square < 1e-18 || along > -0.1 * square {
            return;
        }
        let left: Vec<f64> = (0..rise.len())
            .map(|j| rise.iter().zip(&self.rows).map(|(s, row)| s * row[j]).sum())
            .collect();
        for (row, (s, y)) in self.rows.iter_mut().zip(rise.iter().zip(&expected)) {
            for (entry, left) in row.iter_mut().zip(&left) {
                *entry -= (s + y) * left / along;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_that_see_each_other_come_to_rest_by_what_is_learnt() {
        // Missing forces b − K x of two springs that are coupled as strongly as two strips in one span.
        let (stiffness, b) = ([[2000.0, 1700.0], [1700.0, 2100.0]], [110.0, 120.0]);
        let missing = |x: &[f64]| -> Vec<f64> {
            (0..2)
                .map(|i| b[i] - stiffness[i][0] * x[0] - stiffness[i][1] * x[1])
                .collect()
        };
        let mut compliance =
            Compliance::of_heads(&[2000.0, 2100.0].map(|stiffness| DMatrix::from_element(1, 1, stiffness)));
        let mut x = vec![0.0, 0.0];
        let mut last = missing(&x);
        let mut steps = 0;
        while last.iter().any(|force| force.abs() > 1e-9) {
            let rise = compliance.times(&last);
            x = x.iter().zip(&rise).map(|(x, s)| x + s).collect();
            let now = missing(&x);
            compliance.learn(&rise, &difference(&now, &last));
            last = now;
            steps += 1;
            assert!(steps <= 8, "{last:?}");
        }
    }

    #[test]
    fn one_strip_is_a_secant() {
        let mut compliance = Compliance::of_heads(&[DMatrix::from_element(1, 1, 1000.0)]);
        compliance.learn(&[0.01], &[-20.0]);
        assert!((compliance.times(&[4.0])[0] - 0.002).abs() < 1e-15);
    }
}
