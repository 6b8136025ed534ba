//! Numbers of nodes, consecutive among the coordinates, as the rows that elements take.
use super::places::{NODES, NodeArrays};
use dynamics::simd::{GROUP, Transpose, change, run};
use pulp::Simd;

/// Numbers of each node of a block, in the order of [`dynamics::simd::Transpose`]: the first four, then the rest.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct NodeRows {
    fours: [f64; 4 * NODES],
    twos: [f64; 2 * NODES],
}

impl NodeRows {
    pub const ZERO: Self = Self {
        fours: [0.0; 4 * NODES],
        twos: [0.0; 2 * NODES],
    };
}

/// Copies `K` numbers of each node to its row, from `offset` after the node's first number on.
#[inline(always)]
fn fill<S: Simd, const K: usize>(
    rows: &mut [f64],
    lanes: [usize; GROUP],
    starts: &[u32],
    (values, offset): (&[f64], usize),
) {
    let groups = rows.as_chunks_mut::<K>().0.chunks_exact_mut(S::F64_LANES);
    for (starts, rows) in starts.chunks(S::F64_LANES).zip(groups) {
        for (&start, lane) in starts.iter().zip(lanes) {
            rows[lane] = *run(values, start as usize + offset);
        }
    }
}

/// Subtracts the row of each node from its `K` numbers.
#[inline(always)]
fn subtract<S: Simd, const K: usize>(
    rows: &[f64],
    lanes: [usize; GROUP],
    starts: &[u32],
    (values, offset): (&mut [f64], usize),
) {
    let groups = rows.as_chunks::<K>().0.chunks_exact(S::F64_LANES);
    for (starts, rows) in starts.chunks(S::F64_LANES).zip(groups) {
        for (&start, lane) in starts.iter().zip(lanes) {
            change::<K>(values, start as usize + offset, |value, i| value - rows[lane][i]);
        }
    }
}

/// Copies the `2 D` numbers that begin at each of `starts` to the arrays.
#[inline(always)]
pub(super) fn gather<S: Simd, const D: usize>(
    transpose: Transpose<S>,
    starts: &[u32],
    values: &[f64],
    (rows, arrays): (&mut NodeRows, &mut NodeArrays<D>),
) {
    let nodes = starts.len();
    let (fours, twos) = arrays.as_flattened_mut().split_at_mut(4);
    fill::<S, 4>(&mut rows.fours, transpose.order::<4>(), starts, (values, 0));
    transpose.to_columns::<4, NODES>(nodes, &rows.fours, fours);
    if D == 3 {
        fill::<S, 2>(&mut rows.twos, transpose.order::<2>(), starts, (values, 4));
        transpose.to_columns::<2, NODES>(nodes, &rows.twos, twos);
    }
}

/// Subtracts the sums of both arrays from the numbers that begin at each of `starts`.
#[inline(always)]
pub(super) fn scatter<S: Simd, const D: usize>(
    transpose: Transpose<S>,
    starts: &[u32],
    ([a, b], rows): ([&NodeArrays<D>; 2], &mut NodeRows),
    values: &mut [f64],
) {
    let nodes = starts.len();
    let (a, b) = (a.as_flattened().split_at(4), b.as_flattened().split_at(4));
    transpose.sum_to_rows::<4, NODES, 2>(nodes, [a.0, b.0], &mut rows.fours);
    subtract::<S, 4>(&rows.fours, transpose.order::<4>(), starts, (values, 0));
    if D == 3 {
        transpose.sum_to_rows::<2, NODES, 2>(nodes, [a.1, b.1], &mut rows.twos);
        subtract::<S, 2>(&rows.twos, transpose.order::<2>(), starts, (values, 4));
    }
}
