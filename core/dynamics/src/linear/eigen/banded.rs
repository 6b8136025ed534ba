//! Symmetric banded matrices.
/// Lower half of a symmetric banded matrix: each row from the first entry of its band to the diagonal.
#[derive(Clone, Debug, PartialEq)]
pub struct BandedMatrix {
    size: usize,
    /// Entries left of the diagonal.
    band: usize,
    /// Rows of `band + 1` entries, the diagonal last.
    values: Vec<f64>,
}

impl BandedMatrix {
    /// A matrix of `size` rows from its entries (row, column, value) that may repeat; those above the diagonal are
    /// taken as the mirror images of others and left out. The band is as narrow as the entries allow, not below `band`.
    #[must_use]
    pub fn from_entries(size: usize, band: usize, entries: &[(u32, u32, f64)]) -> Self {
        let lower = || entries.iter().filter(|(row, column, _)| row >= column);
        let widest = lower().map(|(row, column, _)| (row - column) as usize).max();
        let band = widest.unwrap_or(0).max(band);
        let mut values = vec![0.0; size * (band + 1)];
        for &(row, column, value) in lower() {
            let (row, column) = (row as usize, column as usize);
            values[row * (band + 1) + band + column - row] += value;
        }
        Self { size, band, values }
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Entries left of the diagonal.
    #[must_use]
    pub fn band(&self) -> usize {
        self.band
    }

    /// Rows of the lower half, each of `band` entries and the diagonal.
    #[must_use]
    pub fn entries(&self) -> &[f64] {
        &self.values
    }

    /// `y = A x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (row, values) in self.values.chunks_exact(self.band + 1).enumerate() {
            let first = row.saturating_sub(self.band);
            let values = &values[self.band + first - row..];
            let (left, diagonal) = values.split_at(row - first);
            let mut sum = diagonal[0] * x[row];
            for ((value, x_left), y_left) in left.iter().zip(&x[first..row]).zip(&mut y[first..row]) {
                sum += value * x_left;
                *y_left += value * x[row];
            }
            y[row] += sum;
        }
    }

    /// `xᵀ A x`.
    #[must_use]
    pub fn quadratic_form(&self, x: &[f64]) -> f64 {
        let mut product = vec![0.0; self.size];
        self.multiply(x, &mut product);
        product.iter().zip(x).map(|(a, b)| a * b).sum()
    }
}

/// `L D Lᵀ` without exchange of rows: exact signs of the pivots for almost every shift.
#[derive(Clone, Debug)]
pub struct BandedFactor {
    size: usize,
    band: usize,
    /// Rows of `L` without the diagonal of ones, `band` entries each.
    lower: Vec<f64>,
    diagonal: Vec<f64>,
}

impl BandedFactor {
    /// Factors a matrix.
    #[must_use]
    pub fn new(matrix: &BandedMatrix) -> Self {
        Self::of(matrix.size, matrix.band, matrix.values.clone())
    }

    /// Factors `A − λ B` of two matrices of one size and band.
    ///
    /// # Panics
    /// When sizes or bands differ.
    #[must_use]
    pub fn shifted(a: &BandedMatrix, lambda: f64, b: &BandedMatrix) -> Self {
        assert_eq!((a.size, a.band), (b.size, b.band), "matrices of one shape");
        let values = a.values.iter().zip(&b.values).map(|(a, b)| a - lambda * b);
        Self::of(a.size, a.band, values.collect())
    }

    fn of(size: usize, band: usize, mut values: Vec<f64>) -> Self {
        let width = band + 1;
        let mut diagonal = vec![0.0; size];
        for row in 0..size {
            let first = row.saturating_sub(band);
            let (above, own) = values.split_at_mut(row * width);
            let own = &mut own[..width];
            // `own` holds `L D` until the row is done.
            for column in first..row {
                let from = first.max(column.saturating_sub(band));
                let other = &above[column * width + band + from - column..column * width + band];
                let mine = &own[band + from - row..band + column - row];
                let sum: f64 = mine.iter().zip(other).map(|(a, b)| a * b).sum();
                own[band + column - row] -= sum;
            }
            let mut pivot = own[band];
            for column in first..row {
                let entry = &mut own[band + column - row];
                let scaled = *entry / diagonal[column];
                pivot -= *entry * scaled;
                *entry = scaled;
            }
            // A pivot of exactly zero is a shift on an eigenvalue of a leading part.
            diagonal[row] = if pivot == 0.0 { f64::MIN_POSITIVE.sqrt() } else { pivot };
        }
        let rows = values.chunks_exact(width);
        let lower = rows.flat_map(|row| row[..band].iter().copied()).collect();
        Self {
            size,
            band,
            lower,
            diagonal,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Number of negative pivots: that of the negative eigenvalues (Sylvester's law of inertia).
    #[must_use]
    pub fn negative(&self) -> usize {
        self.diagonal.iter().filter(|pivot| **pivot < 0.0).count()
    }

    /// Solves for `N` right sides at once, in place; `x[row]` holds their entries of a row.
    pub fn solve_many<const N: usize>(&self, x: &mut [[f64; N]]) {
        let band = self.band;
        for row in 0..self.size {
            let first = row.saturating_sub(band);
            let left = &self.lower[row * band + band + first - row..(row + 1) * band];
            let (done, rest) = x.split_at_mut(row);
            let own = &mut rest[0];
            for (value, other) in left.iter().zip(&done[first..]) {
                for (own, other) in own.iter_mut().zip(other) {
                    *own -= value * other;
                }
            }
        }
        for (x, pivot) in x.iter_mut().zip(&self.diagonal) {
            x.iter_mut().for_each(|x| *x /= pivot);
        }
        for row in (0..self.size).rev() {
            let first = row.saturating_sub(band);
            let left = &self.lower[row * band + band + first - row..(row + 1) * band];
            let (before, rest) = x.split_at_mut(row);
            let own = rest[0];
            for (value, other) in left.iter().zip(&mut before[first..]) {
                for (other, own) in other.iter_mut().zip(own) {
                    *other -= value * own;
                }
            }
        }
    }

    /// Solves for one right side.
    #[must_use]
    pub fn solve(&self, right_side: impl IntoIterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut x = vec![[0.0]; self.size];
        for (row, value) in right_side {
            x[row][0] += value;
        }
        self.solve_many(&mut x);
        x.into_iter().map(|[x]| x).collect()
    }
}
