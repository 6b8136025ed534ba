//! Symmetric banded matrices.
use crate::SparseMatrix;
use crate::linear::sparse::by_groups;
use pulp::{Arch, Simd, WithSimd};

/// Parts of a sum, whatever the registers: all machines find the same bits.
const PARTS: usize = 8;

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
}

impl From<&SparseMatrix> for BandedMatrix {
    /// The lower half of a symmetric matrix.
    fn from(matrix: &SparseMatrix) -> Self {
        let of_row = |row: usize| {
            matrix
                .row(row)
                .map(move |(column, value)| (row as u32, column as u32, value))
        };
        let entries: Vec<_> = (0..matrix.size()).flat_map(of_row).collect();
        Self::from_entries(matrix.size(), 0, &entries)
    }
}

impl From<&BandedMatrix> for SparseMatrix {
    fn from(matrix: &BandedMatrix) -> Self {
        let band = matrix.band;
        let rows = matrix.values.chunks_exact(band + 1).enumerate();
        let entries = rows.flat_map(|(row, values)| {
            let first = row.saturating_sub(band);
            let own = (first..=row).zip(&values[band + first - row..]);
            own.filter(|(_, value)| **value != 0.0)
                .flat_map(move |(column, &value)| {
                    let mirrored = (row != column).then_some((column as u32, row as u32, value));
                    std::iter::once((row as u32, column as u32, value)).chain(mirrored)
                })
        });
        Self::from_entries(matrix.size, entries.collect())
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
        let mut diagonal = vec![0.0; size];
        Arch::new().dispatch(Factor {
            band,
            values: &mut values,
            diagonal: &mut diagonal,
        });
        let rows = values.chunks_exact(band + 1);
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
        Arch::new().dispatch(Solve { factor: self, x });
    }

    /// Solves for right sides one after the other, in place.
    pub fn solve_columns(&self, columns: &mut [f64]) {
        by_groups(self.size, columns, |group| self.solve_many(group));
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

/// `Σ a b`, with the instructions of the caller.
#[inline(always)]
fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<PARTS>(), b.as_chunks::<PARTS>());
    let mut sums = [0.0; PARTS];
    for (a, b) in a.iter().zip(b) {
        for k in 0..PARTS {
            sums[k] += a[k] * b[k];
        }
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum += a * b;
    }
    sums.iter().sum()
}

/// `Σ a b`.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    struct Dot<'a>(&'a [f64], &'a [f64]);
    impl WithSimd for Dot<'_> {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> f64 {
            sum_of_products(self.0, self.1)
        }
    }
    Arch::new().dispatch(Dot(a, b))
}

/// Rows of a matrix to those of its factor.
struct Factor<'a> {
    band: usize,
    values: &'a mut [f64],
    diagonal: &'a mut [f64],
}

impl WithSimd for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { band, values, diagonal } = self;
        let width = band + 1;
        for row in 0..diagonal.len() {
            let first = row.saturating_sub(band);
            let (above, own) = values.split_at_mut(row * width);
            let own = &mut own[..width];
            // `own` holds `L D` until the row is done.
            for column in first..row {
                let from = first.max(column.saturating_sub(band));
                let other = &above[column * width + band + from - column..column * width + band];
                let mine = &own[band + from - row..band + column - row];
                own[band + column - row] -= sum_of_products(mine, other);
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
    }
}

/// Right sides to solutions.
struct Solve<'a, const N: usize> {
    factor: &'a BandedFactor,
    x: &'a mut [[f64; N]],
}

impl<const N: usize> WithSimd for Solve<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        /// Sums of terms apart, which need not wait for each other.
        const APART: usize = 4;
        let Self { factor, x } = self;
        let band = factor.band;
        for row in 0..factor.size {
            let first = row.saturating_sub(band);
            let left = &factor.lower[row * band + band + first - row..(row + 1) * band];
            let (done, rest) = x.split_at_mut(row);
            let ((values, values_rest), (others, others_rest)) =
                (left.as_chunks::<APART>(), done[first..].as_chunks::<APART>());
            let mut sums = [[0.0; N]; APART];
            for (values, others) in values.iter().zip(others) {
                for k in 0..APART {
                    for n in 0..N {
                        sums[k][n] += values[k] * others[k][n];
                    }
                }
            }
            for (sum, (value, other)) in sums.iter_mut().zip(values_rest.iter().zip(others_rest)) {
                for n in 0..N {
                    sum[n] += value * other[n];
                }
            }
            for n in 0..N {
                rest[0][n] -= (sums[0][n] + sums[1][n]) + (sums[2][n] + sums[3][n]);
            }
        }
        for (x, pivot) in x.iter_mut().zip(&factor.diagonal) {
            let inverse = 1.0 / pivot;
            x.iter_mut().for_each(|x| *x *= inverse);
        }
        for row in (0..factor.size).rev() {
            let first = row.saturating_sub(band);
            let left = &factor.lower[row * band + band + first - row..(row + 1) * band];
            let (before, rest) = x.split_at_mut(row);
            let own = rest[0];
            for (value, other) in left.iter().zip(&mut before[first..]) {
                for n in 0..N {
                    other[n] -= value * own[n];
                }
            }
        }
    }
}
