//! The factors of a block-tridiagonal matrix, and solutions with them.
use super::number::Number;
use super::sweep::Sweep;
use super::{kernel, structure};
use crate::linear::buffer::Buffer;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Factors and vectors in numbers `T`, their blocks filled up to whole vectors.
pub(super) struct Solver<T> {
    pub arch: Arch,
    pub blocks: Vec<Block>,
    pub middle: usize,
    runs: Vec<Run>,
    /// Position of each unknown in the filled-up vectors.
    positions: Vec<u32>,
    /// `−F` of each block but the middle one.
    pub forward: Buffer<T>,
    /// `S⁻¹` and `−Fᵀ` side by side.
    pub backward: Buffer<T>,
    /// Diagonal of the matrix, by which a change of an unknown becomes a force.
    pub diagonal: Buffer<T>,
    /// Right side, then solution; zero between two solutions.
    pub work: Buffer<T>,
    /// Range of the filled-up vectors in which the last solution may not be zero.
    solved: Range<usize>,
    pub active: Vec<bool>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// First unknown of the part.
    first: usize,
    /// Number of unknowns.
    pub size: usize,
    /// First entry in filled-up vectors.
    pub at: usize,
    /// Rows, filled up.
    pub height: usize,
    /// The size of the block if it fills its vectors and the one it is eliminated into is as large; else 0.
    pub square: usize,
    /// First number of its forward and backward blocks.
    pub forward: usize,
    pub backward: usize,
    /// The block that it is eliminated into; its own number for the middle one.
    next: usize,
}

/// Numbers that follow one another both in the filled-up vectors and in those of the whole system.
#[derive(Clone, Copy, Debug)]
struct Run {
    at: usize,
    whole: usize,
    len: usize,
}

/// `y = A⁻¹ u` of one local right side, without the blocks in which it has decayed.
#[derive(Debug, Default)]
pub struct LocalColumn {
    /// First entry in filled-up vectors.
    first: usize,
    /// Entries, in the numbers of the factors.
    double: Vec<f64>,
    single: Vec<f32>,
}

impl LocalColumn {
    /// Number of entries that are kept, those that fill up the blocks included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.double.len() + self.single.len()
    }

    /// Returns `true` if the column has no entry: the right side was zero.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Numbers that a [`LocalColumn`] is made of.
pub(super) trait Entries: Number {
    fn of(column: &LocalColumn) -> &Vec<Self>;
    fn of_mut(column: &mut LocalColumn) -> &mut Vec<Self>;
}

impl Entries for f64 {
    fn of(column: &LocalColumn) -> &Vec<Self> {
        &column.double
    }

    fn of_mut(column: &mut LocalColumn) -> &mut Vec<Self> {
        &mut column.double
    }
}

impl Entries for f32 {
    fn of(column: &LocalColumn) -> &Vec<Self> {
        &column.single
    }

    fn of_mut(column: &mut LocalColumn) -> &mut Vec<Self> {
        &mut column.single
    }
}

/// The blocks in the order in which they are eliminated, each with the one it is taken out of: from both ends in turn
/// to the `middle` one.
///
/// Factors stand in memory in the order of their use: a processor fetches only one of two streams ahead if the other
/// one runs backwards.
fn inwards(count: usize, middle: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |k| {
        let top = (k < middle).then(|| (k, k + 1));
        let bottom = (count - 1 - k > middle).then(|| (count - 1 - k, count - 2 - k));
        top.into_iter().chain(bottom)
    })
}

/// Order of the substitution back: from the middle block in turn to both ends, each block with the one before it.
fn outwards(count: usize, middle: usize) -> impl Iterator<Item = (usize, Option<usize>)> {
    let pairs = (1..count).flat_map(move |k| {
        let top = (k <= middle).then(|| (middle - k, Some(middle + 1 - k)));
        let bottom = (middle + k < count).then(|| (middle + k, Some(middle + k - 1)));
        top.into_iter().chain(bottom)
    });
    std::iter::once((middle, None)).chain(pairs)
}

impl<T: Entries> Solver<T> {
    /// Room for the factors of blocks between the `bounds`.
    pub fn new(arch: Arch, bounds: &[usize], unknowns: &[usize]) -> Self {
        let (sizes, heights) = structure::shapes(bounds, super::lanes::<T>(arch));
        let middle = (bounds.len() - 1) / 2;
        let mut at = 0;
        let mut blocks = Vec::with_capacity(sizes.len());
        for (i, (&size, &height)) in sizes.iter().zip(&heights).enumerate() {
            blocks.push(Block {
                first: bounds[i],
                size,
                at,
                height,
                square: 0,
                forward: 0,
                backward: 0,
                next: i,
            });
            at += height;
        }
        let (mut forward, mut backward) = (0, 0);
        for (i, next) in inwards(blocks.len(), middle) {
            if sizes[i] == heights[i] && sizes[next] == sizes[i] {
                blocks[i].square = sizes[i];
            }
            blocks[i].next = next;
            blocks[i].forward = forward;
            forward += heights[next] * sizes[i];
        }
        for (i, next) in outwards(blocks.len(), middle) {
            blocks[i].backward = backward;
            backward += heights[i] * (sizes[i] + next.map_or(0, |next| sizes[next]));
        }
        let positions: Vec<u32> = (blocks.iter())
            .flat_map(|block| (block.at..block.at + block.size).map(|position| position as u32))
            .collect();
        let mut runs: Vec<Run> = Vec::new();
        for (&at, &whole) in positions.iter().zip(unknowns) {
            let at = at as usize;
            match runs.last_mut() {
                Some(run) if run.at + run.len == at && run.whole + run.len == whole => run.len += 1,
                _ => runs.push(Run { at, whole, len: 1 }),
            }
        }
        Self {
            arch,
            runs,
            middle,
            positions,
            forward: Buffer::new(forward),
            backward: Buffer::new(backward),
            diagonal: Buffer::new(at),
            work: Buffer::new(at),
            solved: 0..0,
            active: vec![false; blocks.len()],
            blocks,
        }
    }

    /// Takes the `diagonal` of a matrix that is about to be factored.
    pub fn begin_factors(&mut self, diagonal: impl Iterator<Item = f64>) {
        // Assume the last solution everywhere: it may come from earlier factors.
        self.solved = 0..self.work.len();
        for (&position, value) in self.positions.iter().zip(diagonal) {
            self.diagonal[position as usize] = T::rounded(value);
        }
    }

    /// Takes `S⁻¹` of block `i` in columns of the given height.
    #[inline(always)]
    pub fn set_inverse(&mut self, i: usize, inverse: &[f64], height: usize) {
        let Block {
            size,
            height: own,
            backward,
            ..
        } = self.blocks[i];
        let target = &mut self.backward[backward..backward + own * size];
        round_columns(target, own, inverse, height, size);
    }

    /// Takes `−F` of block `i` in columns of the given height.
    #[inline(always)]
    pub fn set_coupling(&mut self, i: usize, forward: &[f64], height: usize) {
        let own = self.blocks[i];
        let next = self.blocks[own.next];
        let target = &mut self.forward[own.forward..own.forward + next.height * own.size];
        round_columns(target, next.height, forward, height, next.size);
        let mirrored = &mut self.backward[own.backward + own.height * own.size..][..own.height * next.size];
        for (r, target) in mirrored.chunks_exact_mut(own.height).enumerate() {
            for (c, value) in target[..own.size].iter_mut().enumerate() {
                *value = T::rounded(forward[c * height + r]);
            }
        }
    }

    /// Takes the right side of the next solution from a vector of the whole system.
    pub fn load(&mut self, right_side: &[f64]) {
        self.arch.dispatch(Load {
            runs: &self.runs,
            right_side,
            work: &mut self.work,
        });
    }

    /// Adds to one entry of the loaded right side.
    pub fn add(&mut self, unknown: usize, value: f64) {
        let entry = &mut self.work[self.positions[unknown] as usize];
        *entry = T::rounded(entry.widened() + value);
    }

    /// Product of the loaded right side with a local column.
    #[inline]
    pub fn dot(&self, column: &LocalColumn) -> f64 {
        struct Dot<'a, T>(&'a [T], &'a [T]);
        impl<T: Number> WithSimd for Dot<'_, T> {
            type Output = T;

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) -> T {
                kernel::dot(simd, self.0, self.1)
            }
        }
        let values = T::of(column);
        let work = &self.work[column.first..column.first + values.len()];
        self.arch.dispatch(Dot(work, values)).widened()
    }

    /// See [`super::BlockTridiagonal::solve`].
    pub fn solve(
        &mut self,
        threshold: f64,
        solution: &mut [f64],
        changed: &mut dyn FnMut(Range<usize>, Range<usize>),
    ) -> bool {
        let hull = self.sweep(threshold, 0..self.blocks.len());
        let active = &self.active[hull.clone()];
        // Test for the common case that all are solved: it takes a few registers, a walk over the blocks as long as the
        // elimination of ten.
        let all = active.iter().fold(true, |all, &active| all & active);
        let mut from = hull.start;
        for active in active.chunk_by(|a, b| all || a == b) {
            let to = from + active.len();
            if active[0] {
                let beyond = (to + 1).min(self.blocks.len());
                changed(
                    self.unknowns_of(from..to),
                    self.unknowns_of(from.saturating_sub(1)..beyond),
                );
            }
            from = to;
        }
        let solved = self.span(&hull);
        let before = std::mem::replace(&mut self.solved, solved.clone());
        let finite = self.arch.dispatch(TakeOut {
            runs: &self.runs,
            range: match (before.is_empty(), solved.is_empty()) {
                (true, _) => solved,
                (_, true) => before,
                _ => before.start.min(solved.start)..before.end.max(solved.end),
            },
            work: &mut self.work,
            solution,
        });
        if !finite {
            // Clear all: the numbers that fill up the blocks are spoilt too.
            self.work.fill(T::default());
        }
        finite
    }

    /// Solves for the loaded right side without leaving anything out; `solution` has one entry per unknown.
    pub fn unload(&mut self, solution: &mut [f64]) {
        let hull = self.sweep(0.0, 0..self.blocks.len());
        for (value, &position) in solution.iter_mut().zip(&self.positions) {
            *value = self.work[position as usize].widened();
        }
        self.clear(&hull);
    }

    fn unknowns_of(&self, blocks: Range<usize>) -> Range<usize> {
        let last = &self.blocks[blocks.end - 1];
        self.blocks[blocks.start].first..last.first + last.size
    }

    /// A column with room for all unknowns.
    pub fn new_column(&self) -> LocalColumn {
        let mut column = LocalColumn::default();
        T::of_mut(&mut column).reserve_exact(self.work.len());
        column
    }

    /// Solves for the loaded right side, which is zero outside of the blocks `loaded`, down to a threshold.
    pub fn take_column(&mut self, loaded: Range<usize>, threshold: f64, column: &mut LocalColumn) {
        let hull = if loaded.is_empty() {
            loaded
        } else {
            self.sweep(threshold, loaded)
        };
        let span = self.span(&hull);
        column.first = span.start;
        let values = T::of_mut(column);
        values.clear();
        values.extend_from_slice(&self.work[span]);
        self.clear(&hull);
    }

    /// Entry of a local column.
    pub fn entry(&self, column: &LocalColumn, unknown: usize) -> f64 {
        let position = self.positions[unknown] as usize;
        position
            .checked_sub(column.first)
            .and_then(|place| T::of(column).get(place))
            .map_or(0.0, |value| value.widened())
    }

    fn sweep(&mut self, threshold: f64, right_side: Range<usize>) -> Range<usize> {
        let arch = self.arch;
        arch.dispatch(Sweep {
            solver: self,
            threshold: T::rounded(threshold),
            right_side,
        })
    }

    /// Range of filled-up vectors that a range of blocks takes.
    fn span(&self, blocks: &Range<usize>) -> Range<usize> {
        if blocks.is_empty() {
            return 0..0;
        }
        let last = &self.blocks[blocks.end - 1];
        self.blocks[blocks.start].at..last.at + last.height
    }

    fn clear(&mut self, hull: &Range<usize>) {
        let span = self.span(hull);
        self.work[span].fill(T::default());
    }
}

/// Rounds the first `rows` of columns of the height `from_height` into columns of the height `to_height`; the numbers
/// that fill these up stay zero.
#[inline(always)]
fn round_columns<T: Number>(to: &mut [T], to_height: usize, from: &[f64], from_height: usize, rows: usize) {
    for (to, from) in to.chunks_exact_mut(to_height).zip(from.chunks_exact(from_height)) {
        for (to, &from) in to[..rows].iter_mut().zip(from) {
            *to = T::rounded(from);
        }
    }
}

/// Takes a right side out of a vector of the whole system.
struct Load<'a, T> {
    runs: &'a [Run],
    right_side: &'a [f64],
    work: &'a mut [T],
}

impl<T: Number> WithSimd for Load<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for run in self.runs {
            let from = &self.right_side[run.whole..run.whole + run.len];
            for (to, &from) in self.work[run.at..run.at + run.len].iter_mut().zip(from) {
                *to = T::rounded(from);
            }
        }
    }
}

/// Moves a solution into a vector of the whole system, and leaves zeros. Returns `true` if all is finite.
struct TakeOut<'a, T> {
    runs: &'a [Run],
    /// Range of the filled-up vectors.
    range: Range<usize>,
    work: &'a mut [T],
    solution: &'a mut [f64],
}

impl<T: Number> WithSimd for TakeOut<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self {
            runs,
            range,
            work,
            solution,
        } = self;
        let mut spoilt = T::splat(simd, T::default());
        let begin = runs.partition_point(|run| run.at + run.len <= range.start);
        for run in runs[begin..].iter().take_while(|run| run.at < range.end) {
            let (from, to) = (run.at.max(range.start), (run.at + run.len).min(range.end));
            let whole = run.whole + (from - run.at);
            let target = &mut solution[whole..whole + (to - from)];
            kernel::take_out(simd, &mut work[from..to], target, &mut spoilt);
        }
        T::sum(simd, spoilt).widened() == 0.0
    }
}
