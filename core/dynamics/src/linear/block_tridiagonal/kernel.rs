//! Products of small dense blocks in SIMD lanes.
//!
//! A block is stored column by column, its rows filled up with zeros to whole vectors.
use super::number::Number;
use super::structure::LARGEST;
use pulp::Simd;

/// `start + Σ columns[k] x[k]` for columns of `V` vectors, summed in `U` independent chains that hide the latency of
/// the additions.
#[inline(always)]
fn chains<S: Simd, T: Number, const V: usize, const U: usize>(
    simd: S,
    columns: &[T::Vector<S>],
    x: &[T],
    start: [T::Vector<S>; V],
) -> [T::Vector<S>; V] {
    let mut sums = [[T::splat(simd, T::default()); V]; U];
    sums[0] = start;
    let mut groups = columns.chunks_exact(V * U);
    let mut factors = x.chunks_exact(U);
    for (columns, x) in groups.by_ref().zip(factors.by_ref()) {
        for u in 0..U {
            let factor = T::splat(simd, x[u]);
            for v in 0..V {
                sums[u][v] = T::multiply_add(simd, columns[u * V + v], factor, sums[u][v]);
            }
        }
    }
    let rest = groups.remainder().chunks_exact(V).zip(factors.remainder());
    for (sums, (column, &x)) in sums.iter_mut().zip(rest) {
        let factor = T::splat(simd, x);
        for (sum, &entry) in sums.iter_mut().zip(column) {
            *sum = T::multiply_add(simd, entry, factor, *sum);
        }
    }
    let mut width = U;
    while width > 1 {
        width /= 2;
        let (low, high) = sums.split_at_mut(width);
        for (low, high) in low.iter_mut().zip(high) {
            for (sum, &mut other) in low.iter_mut().zip(high) {
                *sum = T::add(simd, *sum, other);
            }
        }
    }
    sums[0]
}

/// `start + B x` for a square block of `V` vectors' width: its length is known, so that there is no loop.
#[inline(always)]
pub(super) fn square<S: Simd, T: Number, const V: usize>(
    simd: S,
    block: &[T],
    x: &[T],
    start: [T::Vector<S>; V],
) -> [T::Vector<S>; V] {
    let width = V * T::lanes::<S>();
    let columns = T::vectors::<S>(&block[..width * width]).0;
    let x = &x[..width];
    if V == 1 {
        chains::<S, T, V, 4>(simd, columns, x, start)
    } else {
        chains::<S, T, V, 2>(simd, columns, x, start)
    }
}

/// The first `V` vectors of `x`.
#[inline(always)]
pub(super) fn load<S: Simd, T: Number, const V: usize>(x: &[T]) -> [T::Vector<S>; V] {
    let vectors = T::vectors::<S>(&x[..V * T::lanes::<S>()]).0;
    std::array::from_fn(|v| vectors[v])
}

/// A block and the first entry of the vector that it multiplies.
#[derive(Clone, Copy)]
pub(super) struct Term<'a, T> {
    /// Columns, rows filled up.
    pub block: &'a [T],
    /// First entry of the factor in the common vector.
    pub at: usize,
    /// Columns of the block.
    pub columns: usize,
}

impl<T> Term<'_, T> {
    #[inline(always)]
    fn factors<'w>(&self, work: &'w [T]) -> &'w [T] {
        &work[self.at..self.at + self.columns]
    }
}

/// Writes to the `height` vectors from `target` on in `work` the sum of the products of two blocks with other parts of
/// `work`, plus their old values if `KEEP`.
#[inline(always)]
pub(super) fn combine<S: Simd, T: Number, const KEEP: bool>(
    simd: S,
    work: &mut [T],
    (target, height): (usize, usize),
    terms: [Term<'_, T>; 2],
) {
    match height {
        1 => in_registers::<S, T, KEEP, 1, 4>(simd, work, target, terms),
        2 => in_registers::<S, T, KEEP, 2, 2>(simd, work, target, terms),
        3 => in_registers::<S, T, KEEP, 3, 2>(simd, work, target, terms),
        4 => in_registers::<S, T, KEEP, 4, 2>(simd, work, target, terms),
        _ => {
            let mut sum = [T::default(); LARGEST];
            let length = height * T::lanes::<S>();
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
fn in_registers<S: Simd, T: Number, const KEEP: bool, const V: usize, const U: usize>(
    simd: S,
    work: &mut [T],
    target: usize,
    [first, second]: [Term<'_, T>; 2],
) {
    let range = target..target + V * T::lanes::<S>();
    let mut sum = [T::splat(simd, T::default()); V];
    if KEEP {
        sum.copy_from_slice(T::vectors::<S>(&work[range.clone()]).0);
    }
    // The chain of blocks hangs on the second term: the first is summed before it.
    for term in [first, second] {
        sum = chains::<S, T, V, U>(simd, T::vectors::<S>(term.block).0, term.factors(work), sum);
    }
    T::vectors_mut::<S>(&mut work[range]).copy_from_slice(&sum);
}

/// `y += block · x`; the length of `y` is that of the filled-up columns.
#[inline(always)]
pub(super) fn add_product<S: Simd, T: Number>(simd: S, block: &[T], x: &[T], y: &mut [T]) {
    let block = T::vectors::<S>(block).0;
    let y = T::vectors_mut::<S>(y);
    for (column, &x) in block.chunks_exact(y.len()).zip(x) {
        let factor = T::splat(simd, x);
        for (y, &entry) in y.iter_mut().zip(column) {
            *y = T::multiply_add(simd, entry, factor, *y);
        }
    }
}

/// Returns `true` if any absolute value is above a threshold, or no number.
#[inline(always)]
pub(super) fn any_above<S: Simd, T: Number>(simd: S, x: &[T], threshold: T) -> bool {
    let threshold = T::splat(simd, threshold);
    (T::vectors::<S>(x).0.iter()).any(|&x| T::any_above(simd, x, threshold))
}

/// Returns `true` if any absolute value of the products of entries is above a threshold, or no number.
#[inline(always)]
pub(super) fn any_product_above<S: Simd, T: Number>(simd: S, x: &[T], weights: &[T], threshold: T) -> bool {
    let threshold = T::splat(simd, threshold);
    let mut pairs = T::vectors::<S>(x).0.iter().zip(T::vectors::<S>(weights).0);
    pairs.any(|(&x, &weight)| T::any_above(simd, T::multiply(simd, x, weight), threshold))
}

/// Dot product of two vectors of whole lanes.
#[inline(always)]
pub(super) fn dot<S: Simd, T: Number>(simd: S, x: &[T], y: &[T]) -> T {
    let (x, y) = (T::vectors::<S>(x).0, T::vectors::<S>(y).0);
    let mut sums = [T::splat(simd, T::default()); 4];
    let (xs, ys) = (x.chunks_exact(4), y.chunks_exact(4));
    for (sum, (&x, &y)) in sums.iter_mut().zip(xs.remainder().iter().zip(ys.remainder())) {
        *sum = T::multiply(simd, x, y);
    }
    for (x, y) in xs.zip(ys) {
        for i in 0..4 {
            sums[i] = T::multiply_add(simd, x[i], y[i], sums[i]);
        }
    }
    let [a, b, c, d] = sums;
    T::sum(simd, T::add(simd, T::add(simd, a, b), T::add(simd, c, d)))
}

/// `to` becomes `from`, which becomes zero; `spoilt` stays zero as long as all numbers are finite.
#[inline(always)]
pub(super) fn take_out<S: Simd, T: Number>(simd: S, from: &mut [T], to: &mut [f64], spoilt: &mut T::Vector<S>) {
    let zero = T::splat(simd, T::default());
    for (to, from) in to.iter_mut().zip(&*from) {
        *to = from.widened();
    }
    let (vectors, rest) = T::vectors::<S>(from);
    // Product with zero: 0 · ∞ is not a number. Several sums do not wait for each other.
    let mut sums = [zero; 4];
    let groups = vectors.chunks_exact(4);
    for &x in groups.remainder() {
        sums[0] = T::multiply_add(simd, x, zero, sums[0]);
    }
    for group in groups {
        for (sum, &x) in sums.iter_mut().zip(group) {
            *sum = T::multiply_add(simd, x, zero, *sum);
        }
    }
    sums[1] = T::multiply_add(simd, T::partial(simd, rest), zero, sums[1]);
    for sum in sums {
        *spoilt = T::add(simd, *spoilt, sum);
    }
    from.fill(T::default());
}
