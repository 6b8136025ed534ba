//! Block-tridiagonal Cholesky factorisation with inverted diagonal blocks.
//!
//! A line is long and thin: its coordinates, taken along the track, fall into blocks of one node pair of which only
//! neighbours couple. With `S` the Schur complements of block Cholesky the factored matrix is kept as
//!
//! ```text
//! S₀ = A₀₀,   Fᵢ = Aᵢ₊₁,ᵢ Sᵢ⁻¹,   Sᵢ₊₁ = Aᵢ₊₁,ᵢ₊₁ − Fᵢ Aᵢ,ᵢ₊₁
//! cᵢ₊₁ = bᵢ₊₁ − Fᵢ cᵢ,           xᵢ = Sᵢ⁻¹ cᵢ − Fᵢᵀ xᵢ₊₁
//! ```
//!
//! so that a solution consists of products of small dense blocks in SIMD lanes. Elimination runs from both ends to the
//! middle block: two chains of dependent products that hide each other's latency.
//!
//! | file | subject |
//! | --- | --- |
//! | `structure` | cut of the unknowns into blocks |
//! | `factor` | assembly into blocks and their factorisation |
//! | `sweep` | elimination and substitution |
//! | `kernel` | products of small dense blocks in SIMD lanes |
mod factor;
mod kernel;
mod structure;
mod sweep;

use crate::linear::buffer::Buffer;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// A symmetric positive definite matrix whose pattern falls into small blocks along a line.
pub struct BlockTridiagonal {
    arch: Arch,
    blocks: Vec<Block>,
    middle: usize,
    runs: Vec<Run>,
    /// Position of each unknown in the filled-up vectors.
    positions: Vec<u32>,
    /// Block of each unknown.
    block_of: Vec<u32>,
    /// Per entry of the pattern, its target in `assembled`; the upper triangle is not used.
    entries: Vec<EntryTarget>,
    assembled: Assembled,
    /// `−F` of each block but the middle one.
    forward: Buffer,
    /// `S⁻¹` and `−Fᵀ` side by side.
    backward: Buffer,
    /// Diagonal of the matrix, by which a change of an unknown becomes a force.
    diagonal: Buffer,
    /// Right side, then solution; zero between two solutions.
    work: Buffer,
    /// Range of the filled-up vectors in which the last solution may not be zero.
    solved: Range<usize>,
    active: Vec<bool>,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    /// First unknown of the part.
    first: usize,
    /// Number of unknowns.
    size: usize,
    /// First entry in filled-up vectors.
    at: usize,
    /// Rows, filled up.
    height: usize,
    /// The size of the block if it fills its vectors and the one it is eliminated into is as large; else 0.
    square: usize,
    /// First number of its forward and backward blocks.
    forward: usize,
    backward: usize,
    /// First number of its block on the diagonal and, if it is not the last, of its couplings with the next block.
    assembled: usize,
    coupling: usize,
}

/// Numbers that follow one another both in the filled-up vectors and in those of the whole system.
#[derive(Clone, Copy, Debug)]
struct Run {
    at: usize,
    whole: usize,
    len: usize,
}

/// The matrix in dense blocks, filled up.
#[derive(Debug, Default)]
struct Assembled {
    /// `Aᵢᵢ`, then `Sᵢ`.
    diagonal: Buffer,
    /// `Aᵢ₊₁,ᵢ`
    down: Buffer,
    /// `Aᵢ,ᵢ₊₁`
    up: Buffer,
}

#[derive(Clone, Copy, Debug)]
enum EntryTarget {
    Unused,
    /// Both triangles of a block on the diagonal.
    Diagonal(u32, u32),
    /// In `down` and `up`.
    Coupling(u32, u32),
}

/// `y = A⁻¹ u` of one local right side, without the blocks in which it has decayed.
#[derive(Debug, Default)]
pub struct LocalColumn {
    /// First entry in filled-up vectors.
    first: usize,
    values: Vec<f64>,
}

impl LocalColumn {
    /// Number of entries that are kept, those that fill up the blocks included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns `true` if the column has no entry: the right side was zero.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
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

/// Number of lanes, to a multiple of which vectors are filled up.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

impl BlockTridiagonal {
    /// Analyses a symmetric pattern in compressed columns (row indices ascending); `unknowns[i]` is the number of
    /// unknown `i` in the vectors of the whole system. Returns `None` if the pattern does not fall into small blocks.
    #[must_use]
    pub fn analyse(unknowns: &[usize], column_starts: &[usize], row_indices: &[usize]) -> Option<Self> {
        let arch = Arch::new();
        let lanes = arch.dispatch(Lanes);
        let bounds = structure::cut(column_starts, row_indices, lanes)?;
        let middle = (bounds.len() - 1) / 2;
        let sizes: Vec<usize> = bounds.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let heights: Vec<usize> = sizes.iter().map(|size| size.next_multiple_of(lanes)).collect();
        let (mut at, mut assembled, mut coupling) = (0, 0, 0);
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
                assembled,
                coupling,
            });
            at += height;
            assembled += height * size;
            if i + 1 < sizes.len() {
                // One start for both couplings: each gets the room of the larger one.
                coupling += (heights[i + 1] * size).max(height * sizes[i + 1]);
            }
        }
        let (down, up) = (coupling, coupling);
        let (mut forward, mut backward) = (0, 0);
        for (i, next) in inwards(blocks.len(), middle) {
            if sizes[i] == heights[i] && sizes[next] == sizes[i] {
                blocks[i].square = sizes[i];
            }
            blocks[i].forward = forward;
            forward += heights[next] * sizes[i];
        }
        for (i, next) in outwards(blocks.len(), middle) {
            blocks[i].backward = backward;
            backward += heights[i] * (sizes[i] + next.map_or(0, |next| sizes[next]));
        }
        let mut block_of = vec![0; unknowns.len()];
        let mut positions = vec![0; unknowns.len()];
        for (i, block) in blocks.iter().enumerate() {
            for k in 0..block.size {
                block_of[block.first + k] = i as u32;
                positions[block.first + k] = (block.at + k) as u32;
            }
        }
        let mut runs: Vec<Run> = Vec::new();
        for (&at, &whole) in positions.iter().zip(unknowns) {
            let at = at as usize;
            match runs.last_mut() {
                Some(run) if run.at + run.len == at && run.whole + run.len == whole => run.len += 1,
                _ => runs.push(Run { at, whole, len: 1 }),
            }
        }
        let mut this = Self {
            arch,
            runs,
            middle,
            positions,
            block_of,
            entries: Vec::new(),
            assembled: Assembled {
                diagonal: Buffer::new(assembled),
                down: Buffer::new(down),
                up: Buffer::new(up),
            },
            forward: Buffer::new(forward),
            backward: Buffer::new(backward),
            diagonal: Buffer::new(at),
            work: Buffer::new(at),
            solved: 0..0,
            active: vec![false; blocks.len()],
            blocks,
        };
        this.entries = this.places(column_starts, row_indices);
        Some(this)
    }

    /// Number of blocks, and size of the largest one.
    #[cfg(test)]
    pub fn shape(&self) -> (usize, usize) {
        let largest = self.blocks.iter().map(|block| block.size).max().unwrap_or(0);
        (self.blocks.len(), largest)
    }

    /// Takes the right side of the next solution from a vector of the whole system.
    pub fn load(&mut self, right_side: &[f64]) {
        for run in &self.runs {
            self.work[run.at..run.at + run.len].copy_from_slice(&right_side[run.whole..run.whole + run.len]);
        }
    }

    /// Adds to one entry of the loaded right side.
    pub fn add(&mut self, unknown: usize, value: f64) {
        self.work[self.positions[unknown] as usize] += value;
    }

    /// Product of the loaded right side with a local column.
    #[must_use]
    pub fn dot(&self, column: &LocalColumn) -> f64 {
        struct Dot<'a>(&'a [f64], &'a [f64]);
        impl WithSimd for Dot<'_> {
            type Output = f64;

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) -> f64 {
                kernel::dot(simd, self.0, self.1)
            }
        }
        let work = &self.work[column.first..column.first + column.values.len()];
        self.arch.dispatch(Dot(work, &column.values))
    }

    /// Solves for the loaded right side and writes the solution into a vector of the whole system, except for zeros
    /// that the last solution had as well: `solution` holds that one, or zeros. `changed` sees the unknowns of every
    /// run of blocks that were solved, and those with the neighbours they couple with. Returns `true` if all is finite.
    ///
    /// Blocks whose right side, after elimination, is nowhere above `threshold` are left out, as are those that a
    /// solution next to them would change by a force below it: the remainder of the right side there is of that order.
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
            self.work.fill(0.0);
        }
        finite
    }

    /// Solves for the loaded right side without leaving anything out; `solution` has one entry per unknown.
    pub fn unload(&mut self, solution: &mut [f64]) {
        let hull = self.sweep(0.0, 0..self.blocks.len());
        for (value, &position) in solution.iter_mut().zip(&self.positions) {
            *value = self.work[position as usize];
        }
        self.clear(&hull);
    }

    fn unknowns_of(&self, blocks: Range<usize>) -> Range<usize> {
        let last = &self.blocks[blocks.end - 1];
        self.blocks[blocks.start].first..last.first + last.size
    }

    /// A column with room for all unknowns.
    #[must_use]
    pub fn new_column(&self) -> LocalColumn {
        LocalColumn {
            first: 0,
            values: Vec::with_capacity(self.work.len()),
        }
    }

    /// Solves for a right side of a few `entries` (unknown, value), down to `relative` times the largest entry, as a
    /// force; the rest of the solution is left out.
    pub fn column(&mut self, entries: impl Iterator<Item = (usize, f64)>, relative: f64, column: &mut LocalColumn) {
        let (mut low, mut high, mut largest) = (usize::MAX, 0, 0.0_f64);
        for (unknown, value) in entries {
            let block = self.block_of[unknown] as usize;
            (low, high) = (low.min(block), high.max(block));
            self.add(unknown, value);
            largest = largest.max(value.abs());
        }
        column.values.clear();
        if low > high {
            column.first = 0;
            return;
        }
        let hull = self.sweep(relative * largest, low..high + 1);
        let span = self.span(&hull);
        column.first = span.start;
        column.values.extend_from_slice(&self.work[span]);
        self.clear(&hull);
    }

    /// Entry of a local column.
    #[must_use]
    pub fn entry(&self, column: &LocalColumn, unknown: usize) -> f64 {
        let position = self.positions[unknown] as usize;
        position
            .checked_sub(column.first)
            .and_then(|place| column.values.get(place))
            .copied()
            .unwrap_or(0.0)
    }

    fn sweep(&mut self, threshold: f64, right_side: Range<usize>) -> Range<usize> {
        let arch = self.arch;
        arch.dispatch(sweep::Sweep {
            matrix: self,
            threshold,
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
        self.work[span].fill(0.0);
    }
}

/// Moves a solution into a vector of the whole system, and leaves zeros. Returns `true` if all is finite.
struct TakeOut<'a> {
    runs: &'a [Run],
    /// Range of the filled-up vectors.
    range: Range<usize>,
    work: &'a mut [f64],
    solution: &'a mut [f64],
}

impl WithSimd for TakeOut<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self {
            runs,
            range,
            work,
            solution,
        } = self;
        let mut spoilt = simd.splat_f64s(0.0);
        let begin = runs.partition_point(|run| run.at + run.len <= range.start);
        for run in runs[begin..].iter().take_while(|run| run.at < range.end) {
            let (from, to) = (run.at.max(range.start), (run.at + run.len).min(range.end));
            let whole = run.whole + (from - run.at);
            let target = &mut solution[whole..whole + (to - from)];
            kernel::take_out(simd, &mut work[from..to], target, &mut spoilt);
        }
        simd.reduce_sum_f64s(spoilt) == 0.0
    }
}

#[cfg(test)]
mod tests;
