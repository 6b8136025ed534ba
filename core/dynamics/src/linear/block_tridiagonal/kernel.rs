//! Products of small dense blocks in SIMD lanes.
//!
//! A block is stored column by column, its rows filled up with zeros to whole vectors.
use super::structure::LARGEST;
use pulp::Simd;

/// `start + Σ columns[k] x[k]` for columns of `V` vectors, summed in `U` independent chains that hide the latency of
/// the additions.
#[inline(always)]
fn chains<S: Simd, const V: usize, const U: usize>(
    simd: S,
    columns: &[S::f64s],
    x: &[f64],
    start: [S::f64s; V],
) -> [S::f64s; V] {
    let mut sums = [[simd.splat_f64s(0.0); V]; U];
    sums[0] = start;
    let mut groups = columns.chunks_exact(V * U);
    let mut factors = x.chunks_exact(U);
    for (columns, x) in groups.by_ref().zip(factors.by_ref()) {
        for u in 0..U {
            let factor = simd.splat_f64s(x[u]);
            for v in 0..V {
                sums[u][v] = simd.mul_add_e_f64s(columns[u * V + v], factor, sums[u][v]);
            }
        }
    }
    let rest = groups.remainder().chunks_exact(V).zip(factors.remainder());
    for (sums, (column, &x)) in sums.iter_mut().zip(rest) {
        let factor = simd.splat_f64s(x);
        for (sum, &entry) in sums.iter_mut().zip(column) {
            *sum = simd.mul_add_e_f64s(entry, factor, *sum);
        }
    }
    let mut width = U;
    while width > 1 {
        width /= 2;
        let (low, high) = sums.split_at_mut(width);
        for (low, high) in low.iter_mut().zip(high) {
            for (sum, &mut other) in low.iter_mut().zip(high) {
                *sum = simd.add_f64s(*sum, other);
            }
        }
    }
    sums[0]
}

/// `start + B x` for a square block of `V` vectors' width: its length is known, so that there is no loop.
#[inline(always)]
pub(super) fn square<S: Simd, const V: usize>(simd: S, block: &[f64], x: &[f64], start: [S::f64s; V]) -> [S::f64s; V] {
    let width = V * S::F64_LANES;
    let columns = S::as_simd_f64s(&block[..width * width]).0;
    let x = &x[..width];
    if V == 1 {
        chains::<S, V, 4>(simd, columns, x, start)
    } else {
        chains::<S, V, 2>(simd, columns, x, start)
    }
}

/// The first `V` vectors of `x`.
#[inline(always)]
pub(super) fn load<S: Simd, const V: usize>(x: &[f64]) -> [S::f64s; V] {
    let vectors = S::as_simd_f64s(&x[..V * S::F64_LANES]).0;
    std::array::from_fn(|v| vectors[v])
}

/// A block and the first entry of the vector that it multiplies.
#[derive(Clone, Copy)]
pub(super) struct Term<'a> {
    /// Columns, rows filled up.
    pub block: &'a [f64],
    /// First entry of the factor in the common vector.
    pub at: usize,
    /// Columns of the block.
    pub columns: usize,
}

impl Term<'_> {
    #[inline(always)]
    fn factors<'w>(&self, work: &'w [f64]) -> &'w [f64] {
        &work[self.at..self.at + self.columns]
    }
}

/// Writes to the `height` vectors from `target` on in `work` the sum of the products of two blocks with other parts of
/// `work`, plus their old values if `KEEP`.
#[inline(always)]
pub(super) fn combine<S: Simd, const KEEP: bool>(
    simd: S,
    work: &mut [f64],
    (target, height): (usize, usize),
    terms: [Term<'_>; 2],
) {
    match height {
        1 => in_registers::<S, KEEP, 1, 4>(simd, work, target, terms),
        2 => in_registers::<S, KEEP, 2, 2>(simd, work, target, terms),
        3 => in_registers::<S, KEEP, 3, 2>(simd, work, target, terms),
        4 => in_registers::<S, KEEP, 4, 2>(simd, work, target, terms),
        _ => {
            let mut sum = [0.0; LARGEST];
            let length = height * S::F64_LANES;
            let sum = &mut sum[..length];
            if KEEP {
                sum.copy_from_slice(&work[target..target + length]);
            }
            for term in terms {
                add_product(simd, term.block, term.factors(work), sum);
            }
            work[target..target + length].copy_from_slice(sum);
        }
    }
}

#[inline(always)]
fn in_registers<S: Simd, const KEEP: bool, const V: usize, const U: usize>(
    simd: S,
    work: &mut [f64],
    target: usize,
    [first, second]: [Term<'_>; 2],
) {
    let range = target..target + V * S::F64_LANES;
    let mut sum = [simd.splat_f64s(0.0); V];
    if KEEP {
        sum.copy_from_slice(S::as_simd_f64s(&work[range.clone()]).0);
    }
    // The chain of blocks hangs on the second term: the first is summed before it.
    for term in [first, second] {
        sum = chains::<S, V, U>(simd, S::as_simd_f64s(term.block).0, term.factors(work), sum);
    }
    S::as_mut_simd_f64s(&mut work[range]).0.copy_from_slice(&sum);
}

/// `y += block · x`; the length of `y` is that of the filled-up columns.
#[inline(always)]
pub(super) fn add_product<S: Simd>(simd: S, block: &[f64], x: &[f64], y: &mut [f64]) {
    let block = S::as_simd_f64s(block).0;
    let y = S::as_mut_simd_f64s(y).0;
    for (column, &x) in block.chunks_exact(y.len()).zip(x) {
        let factor = simd.splat_f64s(x);
        for (y, &entry) in y.iter_mut().zip(column) {
            *y = simd.mul_add_e_f64s(entry, factor, *y);
        }
    }
}

/// Returns `true` if any absolute value is above a threshold, or no number.
#[inline(always)]
pub(super) fn any_above<S: Simd>(simd: S, x: &[f64], threshold: f64) -> bool {
    let threshold = simd.splat_f64s(threshold);
    S::as_simd_f64s(x).0.iter().any(|&x| {
        let below = simd.less_than_or_equal_f64s(simd.abs_f64s(x), threshold);
        simd.first_true_m64s(simd.not_m64s(below)) < S::F64_LANES
    })
}

/// Returns `true` if any absolute value of the products of entries is above a threshold.
#[inline(always)]
pub(super) fn any_product_above<S: Simd>(simd: S, x: &[f64], weights: &[f64], threshold: f64) -> bool {
    let threshold = simd.splat_f64s(threshold);
    let mut pairs = S::as_simd_f64s(x).0.iter().zip(S::as_simd_f64s(weights).0);
    pairs.any(|(&x, &weight)| {
        let above = simd.greater_than_f64s(simd.abs_f64s(simd.mul_f64s(x, weight)), threshold);
        simd.first_true_m64s(above) < S::F64_LANES
    })
}

/// Dot product of two vectors of whole lanes.
#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, x: &[f64], y: &[f64]) -> f64 {
    let (x, y) = (S::as_simd_f64s(x).0, S::as_simd_f64s(y).0);
    let mut sums = [simd.splat_f64s(0.0); 4];
    let (xs, ys) = (x.chunks_exact(4), y.chunks_exact(4));
    for (sum, (&x, &y)) in sums.iter_mut().zip(xs.remainder().iter().zip(ys.remainder())) {
        *sum = simd.mul_f64s(x, y);
    }
    for (x, y) in xs.zip(ys) {
        for i in 0..4 {
            sums[i] = simd.mul_add_e_f64s(x[i], y[i], sums[i]);
        }
    }
    let [a, b, c, d] = sums;
    simd.reduce_sum_f64s(simd.add_f64s(simd.add_f64s(a, b), simd.add_f64s(c, d)))
}

/// `to` becomes `from`, which becomes zero; `spoilt` stays zero as long as all numbers are finite.
#[inline(always)]
pub(super) fn take_out<S: Simd>(simd: S, from: &mut [f64], to: &mut [f64], spoilt: &mut S::f64s) {
    let zero = simd.splat_f64s(0.0);
    to.copy_from_slice(from);
    let (vectors, rest) = S::as_simd_f64s(from);
    // Product with zero: 0 · ∞ is not a number. Several sums do not wait for each other.
    let mut sums = [zero; 4];
    let groups = vectors.chunks_exact(4);
    for &x in groups.remainder() {
        sums[0] = simd.mul_add_e_f64s(x, zero, sums[0]);
    }
    for group in groups {
        for (sum, &x) in sums.iter_mut().zip(group) {
            *sum = simd.mul_add_e_f64s(x, zero, *sum);
        }
    }
    sums[1] = simd.mul_add_e_f64s(simd.partial_load_f64s(rest), zero, sums[1]);
    for sum in sums {
        *spoilt = simd.add_f64s(*spoilt, sum);
    }
    from.fill(0.0);
}
