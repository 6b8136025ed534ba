//! Elimination towards the middle block and substitution back to both ends.
use super::kernel::{Term, any_above, any_product_above, combine, load, square};
use super::number::Number;
use super::solver::{Block, Solver};
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Turns the right side in `work` into the solution. Blocks outside of `right_side` hold zeros. Returns the range of
/// blocks outside of which the solution is zero; within it `active` marks the blocks with a solution, and the others
/// hold zeros.
pub(super) struct Sweep<'a, T> {
    pub solver: &'a mut Solver<T>,
    pub threshold: T,
    pub right_side: Range<usize>,
}

struct Pass<'a, S, T> {
    simd: S,
    threshold: T,
    blocks: &'a [Block],
    forward: &'a [T],
    backward: &'a [T],
    diagonal: &'a [T],
    work: &'a mut [T],
    active: &'a mut [bool],
    lanes: usize,
}

impl<S: Simd, T: Number> Pass<'_, S, T> {
    /// Returns `true` if the right side of block `i` is worth solving; else the right side becomes zero.
    #[inline(always)]
    fn decide(&mut self, i: usize) -> bool {
        let block = &self.blocks[i];
        let own = &mut self.work[block.at..block.at + block.height];
        let active = any_above(self.simd, own, self.threshold);
        if !active {
            own.fill(T::default());
        }
        self.active[i] = active;
        active
    }

    /// `c_next −= F c`; returns `true` if there was anything to eliminate.
    #[inline(always)]
    fn eliminate(&mut self, i: usize, next: usize) -> bool {
        let own = &self.blocks[i];
        match own.square / T::lanes::<S>() {
            1 => self.eliminate_square::<1>(i, next),
            2 => self.eliminate_square::<2>(i, next),
            _ => self.simd.vectorize(Eliminate { pass: self, i, next }),
        }
    }

    /// [`Pass::eliminate`] of blocks that both have `V` vectors, without any to fill up.
    #[inline(always)]
    fn eliminate_square<const V: usize>(&mut self, i: usize, next: usize) -> bool {
        let width = V * T::lanes::<S>();
        let (own, next) = (&self.blocks[i], &self.blocks[next]);
        let c = &mut self.work[own.at..own.at + width];
        if !any_above(self.simd, c, self.threshold) {
            c.fill(T::default());
            self.active[i] = false;
            return false;
        }
        self.active[i] = true;
        let (at, end) = (next.at, next.at + width);
        let sum = square::<S, T, V>(
            self.simd,
            &self.forward[own.forward..],
            &self.work[own.at..],
            load::<S, T, V>(&self.work[at..end]),
        );
        T::vectors_mut::<S>(&mut self.work[at..end]).copy_from_slice(&sum);
        true
    }

    /// [`Pass::eliminate`] of any blocks.
    #[inline(always)]
    fn eliminate_any(&mut self, i: usize, next: usize) -> bool {
        if !self.decide(i) {
            return false;
        }
        let (own, next) = (&self.blocks[i], &self.blocks[next]);
        let length = next.height * own.size;
        let first = Term {
            block: &self.forward[own.forward..own.forward + length],
            at: own.at,
            columns: own.size,
        };
        let nothing = Term {
            block: &[],
            at: 0,
            columns: 0,
        };
        combine::<S, T, true>(
            self.simd,
            self.work,
            (next.at, next.height / self.lanes),
            [nothing, first],
        );
        true
    }

    /// `x = S⁻¹ c − Fᵀ x_next`; `has_right_side` and `has_next` select the terms that exist. Returns `true` if `x` is
    /// kept.
    #[inline(always)]
    fn substitute(&mut self, i: usize, next: usize, has_right_side: bool, has_next: bool) -> bool {
        match self.blocks[i].square / T::lanes::<S>() {
            1 if has_right_side && has_next => self.substitute_square::<1>(i, next),
            2 if has_right_side && has_next => self.substitute_square::<2>(i, next),
            _ => self.simd.vectorize(Substitute {
                pass: self,
                i,
                next: Some(next),
                has_right_side,
                has_next,
            }),
        }
    }

    /// [`Pass::substitute`] with both terms, of blocks that both have `V` vectors, without any to fill up.
    #[inline(always)]
    fn substitute_square<const V: usize>(&mut self, i: usize, next: usize) -> bool {
        let width = V * T::lanes::<S>();
        let (own, next) = (&self.blocks[i], &self.blocks[next]);
        let blocks = &self.backward[own.backward..own.backward + 2 * width * width];
        let (at, end) = (own.at, own.at + width);
        let start = [T::splat(self.simd, T::default()); V];
        // The chain of blocks hangs on the second term: the first is summed before it.
        let sum = square::<S, T, V>(self.simd, blocks, &self.work[at..end], start);
        let sum = square::<S, T, V>(self.simd, &blocks[width * width..], &self.work[next.at..], sum);
        T::vectors_mut::<S>(&mut self.work[at..end]).copy_from_slice(&sum);
        true
    }

    /// [`Pass::substitute`] of any blocks and terms; without a `next` for the middle block.
    #[inline(always)]
    fn substitute_any(&mut self, i: usize, next: Option<usize>, has_right_side: bool, has_next: bool) -> bool {
        let block = &self.blocks[i];
        if !has_right_side && !has_next {
            self.active[i] = false;
            return false;
        }
        let inverse = if has_right_side { block.height * block.size } else { 0 };
        let skipped = block.backward + block.height * block.size;
        let own = Term {
            block: &self.backward[block.backward..block.backward + inverse],
            at: block.at,
            columns: if has_right_side { block.size } else { 0 },
        };
        let columns = next.filter(|_| has_next).map_or(0, |next| self.blocks[next].size);
        let following = Term {
            block: &self.backward[skipped..skipped + block.height * columns],
            at: next.map_or(0, |next| self.blocks[next].at),
            columns,
        };
        combine::<S, T, false>(
            self.simd,
            self.work,
            (block.at, block.height / self.lanes),
            [own, following],
        );
        if !has_right_side {
            let range = block.at..block.at + block.height;
            let (x, diagonal) = (&self.work[range.clone()], &self.diagonal[range.clone()]);
            if !any_product_above(self.simd, x, diagonal, self.threshold) {
                self.work[range].fill(T::default());
                self.active[i] = false;
                return false;
            }
        }
        self.active[i] = true;
        true
    }
}

/// [`Pass::eliminate_any`], not inlined: the code of the common blocks keeps its registers.
struct Eliminate<'p, 'a, S, T> {
    pass: &'p mut Pass<'a, S, T>,
    i: usize,
    next: usize,
}

impl<P: Simd, T: Number> WithSimd for Eliminate<'_, '_, P, T> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        self.pass.eliminate_any(self.i, self.next)
    }
}

/// [`Pass::substitute_any`], not inlined.
struct Substitute<'p, 'a, S, T> {
    pass: &'p mut Pass<'a, S, T>,
    i: usize,
    next: Option<usize>,
    has_right_side: bool,
    has_next: bool,
}

impl<P: Simd, T: Number> WithSimd for Substitute<'_, '_, P, T> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        self.pass
            .substitute_any(self.i, self.next, self.has_right_side, self.has_next)
    }
}

impl<T: Number> WithSimd for Sweep<'_, T> {
    type Output = Range<usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Range<usize> {
        let Solver {
            blocks,
            middle,
            forward,
            backward,
            diagonal,
            work,
            active,
            ..
        } = self.solver;
        let (middle, count) = (*middle, blocks.len());
        let (low, high) = (self.right_side.start, self.right_side.end - 1);
        let mut pass = Pass {
            simd,
            threshold: self.threshold,
            blocks,
            forward,
            backward,
            diagonal,
            work: &mut *work,
            active,
            lanes: T::lanes::<S>(),
        };

        let (mut top, mut top_carries) = (low, false);
        let (mut bottom, mut bottom_carries) = (high, false);
        loop {
            let top_runs = top < middle && (top_carries || top <= high);
            let bottom_runs = bottom > middle && (bottom_carries || bottom >= low);
            if !top_runs && !bottom_runs {
                break;
            }
            if top_runs {
                top_carries = pass.eliminate(top, top + 1);
                top += 1;
            }
            if bottom_runs {
                bottom_carries = pass.eliminate(bottom, bottom - 1);
                bottom -= 1;
            }
        }
        let reached =
            (low..=high).contains(&middle) || (top == middle && top_carries) || (bottom == middle && bottom_carries);
        let has_middle = reached && pass.decide(middle);

        let (mut first, mut last) = (usize::MAX, 0);
        let mut include = |i: usize| {
            first = first.min(i);
            last = last.max(i + 1);
        };
        if has_middle {
            pass.substitute_any(middle, None, true, false);
            include(middle);
        }
        // Blocks of the two halves that elimination has visited: `low..top` and `bottom + 1..=high`.
        let top_visited = low..top.max(low);
        let bottom_visited = (bottom + 1).min(high + 1)..high + 1;
        let mut top = if has_middle {
            middle
        } else {
            top_visited.end.min(middle)
        };
        let mut bottom = if has_middle {
            middle
        } else {
            (bottom_visited.start.max(middle + 1)) - 1
        };
        let (mut top_carries, mut bottom_carries) = (has_middle, has_middle);
        loop {
            let top_runs = top > 0 && (top_carries || top > low);
            let bottom_runs = bottom + 1 < count && (bottom_carries || bottom < high);
            if !top_runs && !bottom_runs {
                break;
            }
            if top_runs {
                let (i, next) = (top - 1, top);
                let own = top_visited.contains(&i) && i < middle && pass.active[i];
                top_carries = pass.substitute(i, next, own, top_carries);
                if top_carries {
                    include(i);
                }
                top = i;
            }
            if bottom_runs {
                let (i, next) = (bottom + 1, bottom);
                let own = bottom_visited.contains(&i) && i > middle && pass.active[i];
                bottom_carries = pass.substitute(i, next, own, bottom_carries);
                if bottom_carries {
                    include(i);
                }
                bottom = i;
            }
        }
        if first > last { 0..0 } else { first..last }
    }
}
