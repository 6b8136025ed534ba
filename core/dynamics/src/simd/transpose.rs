//! Transposition in registers between consecutive numbers among the coordinates and one array per number.
use super::GROUP;
use pulp::{Interleave, Simd};

/// Transposition between rows of `K` numbers, 2 or 4, and `K` columns; each row belongs to one owner, a node or a
/// dropper.
///
/// The fewest instructions that turn rows into columns permute as many rows as a register has lanes: rows are put in
/// such an order that columns come out in that of the owners.
#[derive(Clone, Copy)]
pub struct Transpose<S: Simd> {
    /// The processor's registers.
    pub simd: S,
    /// Row of each lane's owner.
    of_four: [usize; GROUP],
    of_two: [usize; GROUP],
}

/// The rows or columns of one group.
#[repr(align(64))]
struct Aligned<T>(T);

impl<S: Simd> Transpose<S> {
    /// Transposition in these registers.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let mut order = Self {
            simd,
            of_four: [0; GROUP],
            of_two: [0; GROUP],
        };
        let (mut fours, mut twos) = ([0.0; 4 * GROUP], [0.0; 2 * GROUP]);
        for row in 0..S::F64_LANES {
            fours[4 * row..4 * row + 4].fill(row as f64);
            twos[2 * row..2 * row + 2].fill(row as f64);
        }
        let (mut of_four, mut of_two) = ([[0.0; GROUP]; 4], [[0.0; GROUP]; 2]);
        order.to_columns::<4, GROUP>(S::F64_LANES, &fours, &mut of_four);
        order.to_columns::<2, GROUP>(S::F64_LANES, &twos, &mut of_two);
        for lane in 0..S::F64_LANES {
            order.of_four[lane] = of_four[0][lane] as usize;
            order.of_two[lane] = of_two[0][lane] as usize;
        }
        order
    }

    /// The row of each lane's owner, among rows of `K` numbers of as many owners as a register has lanes.
    #[inline(always)]
    pub fn order<const K: usize>(self) -> [usize; GROUP] {
        const { assert!(K == 2 || K == 4, "rows have two numbers or four") };
        if K == 2 { self.of_two } else { self.of_four }
    }

    /// The columns of the rows of so many `owners`.
    #[inline(always)]
    pub fn to_columns<const K: usize, const N: usize>(self, owners: usize, rows: &[f64], columns: &mut [[f64; N]])
    where
        [S::f64s; K]: Interleave,
    {
        let vectors = S::as_simd_f64s(rows).0.chunks_exact(K);
        for (group, vectors) in vectors.enumerate().take(owners.div_ceil(S::F64_LANES)) {
            let vectors = <[S::f64s; K]>::try_from(vectors).expect("as many as were asked for");
            let vectors = self.simd.deinterleave_shfl_f64s(vectors);
            for (column, vector) in columns.iter_mut().zip(vectors) {
                S::as_mut_simd_f64s(column).0[group] = vector;
            }
        }
    }

    /// Rows of the sums of `TERMS` columns each.
    #[inline(always)]
    pub fn sum_to_rows<const K: usize, const N: usize, const TERMS: usize>(
        self,
        owners: usize,
        terms: [&[[f64; N]]; TERMS],
        rows: &mut [f64],
    ) where
        [S::f64s; K]: Interleave,
    {
        let vectors = S::as_mut_simd_f64s(rows).0.chunks_exact_mut(K);
        for (group, vectors) in vectors.enumerate().take(owners.div_ceil(S::F64_LANES)) {
            let mut sums = [self.simd.splat_f64s(0.0); K];
            for (column, sum) in sums.iter_mut().enumerate() {
                *sum = S::as_simd_f64s(&terms[0][column]).0[group];
                for term in &terms[1..] {
                    *sum = self.simd.add_f64s(*sum, S::as_simd_f64s(&term[column]).0[group]);
                }
            }
            vectors.copy_from_slice(&self.simd.interleave_shfl_f64s(sums));
        }
    }

    /// Differences of the `D` numbers of `values` that begin at each place of `upper` from those of `lower`, one array
    /// per number; rows have `K` numbers, at least `D`.
    #[inline(always)]
    pub fn differences<const D: usize, const K: usize>(
        self,
        [upper, lower]: [&[u32; GROUP]; 2],
        values: &[f64],
    ) -> [[f64; GROUP]; K]
    where
        [S::f64s; K]: Interleave,
    {
        let mut rows = Aligned([[0.0; K]; GROUP]);
        let order = self.order::<K>();
        let groups = rows.0.chunks_exact_mut(S::F64_LANES);
        let places = upper.chunks(S::F64_LANES).zip(lower.chunks(S::F64_LANES));
        for ((upper, lower), rows) in places.zip(groups) {
            for ((&upper, &lower), row) in upper.iter().zip(lower).zip(order) {
                let (upper, lower) = (run::<D>(values, upper as usize), run::<D>(values, lower as usize));
                for (difference, (upper, lower)) in rows[row].iter_mut().zip(upper.iter().zip(lower)) {
                    *difference = upper - lower;
                }
            }
        }
        let mut columns = Aligned([[0.0; GROUP]; K]);
        self.to_columns::<K, GROUP>(GROUP, rows.0.as_flattened(), &mut columns.0);
        columns.0
    }

    /// Subtracts one number of each array from those of `values` that begin at each place of `upper`, and adds it to
    /// those of `lower`.
    #[inline(always)]
    pub fn transfer<const D: usize, const K: usize>(
        self,
        columns: [[f64; GROUP]; K],
        [upper, lower]: [&[u32; GROUP]; 2],
        values: &mut [f64],
    ) where
        [S::f64s; K]: Interleave,
    {
        let columns = Aligned(columns);
        let mut rows = Aligned([[0.0; K]; GROUP]);
        self.sum_to_rows::<K, GROUP, 1>(GROUP, [&columns.0], rows.0.as_flattened_mut());
        let order = self.order::<K>();
        let groups = rows.0.chunks_exact(S::F64_LANES);
        let places = upper.chunks(S::F64_LANES).zip(lower.chunks(S::F64_LANES));
        for ((upper, lower), rows) in places.zip(groups) {
            for ((&upper, &lower), row) in upper.iter().zip(lower).zip(order) {
                change::<D>(values, upper as usize, |value, i| value - rows[row][i]);
                change::<D>(values, lower as usize, |value, i| value + rows[row][i]);
            }
        }
    }
}

/// The `D` numbers that begin at `start`.
#[inline(always)]
pub fn run<const D: usize>(values: &[f64], start: usize) -> &[f64; D] {
    values[start..].first_chunk().expect("owners are within")
}

/// Changes the `D` numbers that begin at `start`; `to` is given each with its place among them.
#[inline(always)]
pub fn change<const D: usize>(values: &mut [f64], start: usize, to: impl Fn(f64, usize) -> f64) {
    let run = values[start..].first_chunk_mut::<D>().expect("owners are within");
    *run = std::array::from_fn(|i| to(run[i], i));
}
