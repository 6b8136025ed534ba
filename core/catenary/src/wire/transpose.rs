//! The numbers of nodes, as they follow each other among the coordinates and as elements take them.
use super::places::{NODES, NodeArrays};
use crate::ancf::GROUP;
use pulp::{Interleave, Simd};

/// The numbers of each node of a block one after the other, in the order of [`Transpose`]: the first four, then those after them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Rows {
    fours: [f64; 4 * NODES],
    twos: [f64; 2 * NODES],
}

impl Rows {
    pub const ZERO: Self = Self {
        fours: [0.0; 4 * NODES],
        twos: [0.0; 2 * NODES],
    };
}

/// Between rows of four or of two numbers per node and one array per number.
///
/// What turns rows into columns with the fewest instructions changes the order of as many nodes as a register has lanes: rows are
/// put in such an order that columns come out in that of the nodes.
#[derive(Clone, Copy)]
pub(super) struct Transpose<S: Simd> {
    simd: S,
    /// Row of each lane's node.
    of_four: [usize; GROUP],
    of_two: [usize; GROUP],
}

impl<S: Simd> Transpose<S> {
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
        let (mut of_four, mut of_two) = ([[0.0; NODES]; 4], [[0.0; NODES]; 2]);
        order.to_columns::<4>(S::F64_LANES, &fours, &mut of_four);
        order.to_columns::<2>(S::F64_LANES, &twos, &mut of_two);
        for lane in 0..S::F64_LANES {
            order.of_four[lane] = of_four[0][lane] as usize;
            order.of_two[lane] = of_two[0][lane] as usize;
        }
        order
    }

    #[inline(always)]
    fn to_columns<const K: usize>(self, nodes: usize, rows: &[f64], columns: &mut [[f64; NODES]])
    where
        [S::f64s; K]: Interleave,
    {
        let vectors = S::as_simd_f64s(rows).0.chunks_exact(K);
        for (group, vectors) in vectors.enumerate().take(nodes.div_ceil(S::F64_LANES)) {
            let vectors = <[S::f64s; K]>::try_from(vectors).expect("as many as were asked for");
            let vectors = self.simd.deinterleave_shfl_f64s(vectors);
            for (column, vector) in columns.iter_mut().zip(vectors) {
                S::as_mut_simd_f64s(column).0[group] = vector;
            }
        }
    }

    /// Rows of the sums of two columns each.
    #[inline(always)]
    fn sum_to_rows<const K: usize>(self, nodes: usize, [a, b]: [&[[f64; NODES]]; 2], rows: &mut [f64])
    where
        [S::f64s; K]: Interleave,
    {
        let vectors = S::as_mut_simd_f64s(rows).0.chunks_exact_mut(K);
        for (group, vectors) in vectors.enumerate().take(nodes.div_ceil(S::F64_LANES)) {
            let mut sums = [self.simd.splat_f64s(0.0); K];
            for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
                let (a, b) = (S::as_simd_f64s(a).0[group], S::as_simd_f64s(b).0[group]);
                *sum = self.simd.add_f64s(a, b);
            }
            vectors.copy_from_slice(&self.simd.interleave_shfl_f64s(sums));
        }
    }

    /// Copies `K` numbers of each node to its row, from the place `offset` on of those that begin at its start.
    #[inline(always)]
    fn rows<const K: usize>(lanes: [usize; GROUP], starts: &[u32], values: &[f64], offset: usize, rows: &mut [f64]) {
        let groups = rows.as_chunks_mut::<K>().0.chunks_exact_mut(S::F64_LANES);
        for (starts, rows) in starts.chunks(S::F64_LANES).zip(groups) {
            for (&start, lane) in starts.iter().zip(lanes) {
                rows[lane] = *values[start as usize + offset..]
                    .first_chunk()
                    .expect("nodes are within");
            }
        }
    }

    /// Takes the row of each node off its `K` numbers.
    #[inline(always)]
    fn subtract<const K: usize>(
        lanes: [usize; GROUP],
        starts: &[u32],
        rows: &[f64],
        offset: usize,
        values: &mut [f64],
    ) {
        let groups = rows.as_chunks::<K>().0.chunks_exact(S::F64_LANES);
        for (starts, rows) in starts.chunks(S::F64_LANES).zip(groups) {
            for (&start, lane) in starts.iter().zip(lanes) {
                let run = values[start as usize + offset..]
                    .first_chunk_mut::<K>()
                    .expect("nodes are within");
                let (mut left, row) = (*run, rows[lane]);
                for (left, row) in left.iter_mut().zip(row) {
                    *left -= row;
                }
                *run = left;
            }
        }
    }

    /// Copies the `2 D` numbers that begin at each of `starts` to the arrays.
    #[inline(always)]
    pub fn gather<const D: usize>(self, starts: &[u32], values: &[f64], rows: &mut Rows, arrays: &mut NodeArrays<D>) {
        let (fours, twos) = arrays.as_flattened_mut().split_at_mut(4);
        Self::rows::<4>(self.of_four, starts, values, 0, &mut rows.fours);
        self.to_columns::<4>(starts.len(), &rows.fours, fours);
        if D == 3 {
            Self::rows::<2>(self.of_two, starts, values, 4, &mut rows.twos);
            self.to_columns::<2>(starts.len(), &rows.twos, twos);
        }
    }

    /// Takes the sums of both arrays off the numbers that begin at each of `starts`.
    #[inline(always)]
    pub fn scatter<const D: usize>(
        self,
        starts: &[u32],
        [a, b]: [&NodeArrays<D>; 2],
        rows: &mut Rows,
        values: &mut [f64],
    ) {
        let (a, b) = (a.as_flattened().split_at(4), b.as_flattened().split_at(4));
        self.sum_to_rows::<4>(starts.len(), [a.0, b.0], &mut rows.fours);
        Self::subtract::<4>(self.of_four, starts, &rows.fours, 0, values);
        if D == 3 {
            self.sum_to_rows::<2>(starts.len(), [a.1, b.1], &mut rows.twos);
            Self::subtract::<2>(self.of_two, starts, &rows.twos, 4, values);
        }
    }
}
