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
//! | `solver` | the factors, and solutions with them |
//! | `sweep` | elimination and substitution |
//! | `kernel` | products of small dense blocks in SIMD lanes |
//! | `number` | numbers in double or single precision |
//!
//! A solution reads all factors and computes little with each: those of a long line do not fit into the caches next to
//! the processor, and it waits for them. [`Precision::Mixed`] keeps such factors in single precision, half as long.

/// Calls one method of the solver, in whichever precision it is.
macro_rules! with_solver {
    ($factors:expr, $solver:ident => $call:expr) => {
        match $factors {
            $crate::linear::block_tridiagonal::Factors::Double($solver) => $call,
            $crate::linear::block_tridiagonal::Factors::Single($solver) => $call,
        }
    };
}

mod factor;
mod kernel;
mod number;
mod solver;
mod structure;
mod sweep;

use crate::linear::buffer::Buffer;
use number::Number;
use pulp::{Arch, Simd, WithSimd};
pub use solver::LocalColumn;
use solver::{Entries, Solver};
use std::ops::Range;

/// Precision of the factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double precision: for solutions that are results.
    Double,
    /// Single precision where the factors are large and become much smaller by it: for solutions that are corrections
    /// of one another, with residuals in double precision. Their limit is the same, and each of them takes the error
    /// down to the rounding of single precision times the condition number [Higham, Accuracy and Stability of Numerical
    /// Algorithms, 2nd ed., section 12.1].
    Mixed,
}

/// Factors up to this size in bytes stay in double precision: a cache of a processor's own holds them.
const CACHED: usize = 1 << 20;

/// Size of single-precision factors, as part of those in double precision, above which they are not worth it: vectors
/// of twice as many numbers may have more of them filled up with zeros.
const SMALLER: f64 = 0.75;

/// A symmetric positive definite matrix whose pattern falls into small blocks along a line.
pub struct BlockTridiagonal {
    /// Block of each unknown.
    block_of: Vec<u32>,
    /// Per entry of the pattern, its target in `assembled`; the upper triangle is not used.
    entries: Vec<EntryTarget>,
    assembled: Assembled,
    factors: Factors,
}

enum Factors {
    Double(Solver<f64>),
    Single(Solver<f32>),
}

/// The matrix in dense blocks, filled up.
#[derive(Debug)]
struct Assembled {
    blocks: Vec<AssembledBlock>,
    /// `Aᵢᵢ`, then `Sᵢ`.
    diagonal: Buffer,
    /// `Aᵢ₊₁,ᵢ`
    down: Buffer,
    /// `Aᵢ,ᵢ₊₁`
    up: Buffer,
    /// `S⁻¹` and `−F` of the block that is eliminated.
    inverse: Buffer,
    forward: Buffer,
}

#[derive(Clone, Copy, Debug)]
struct AssembledBlock {
    /// First unknown of the part.
    first: usize,
    /// Number of unknowns.
    size: usize,
    /// Rows, filled up.
    height: usize,
    /// First number of its block on the diagonal and, if it is not the last, of its couplings with the next block.
    diagonal: usize,
    coupling: usize,
}

#[derive(Clone, Copy, Debug)]
enum EntryTarget {
    Unused,
    /// Both triangles of a block on the diagonal.
    Diagonal(u32, u32),
    /// In `down` and `up`.
    Coupling(u32, u32),
}

/// Number of lanes, to a multiple of which vectors are filled up.
struct Lanes<T>(std::marker::PhantomData<T>);

impl<T: Number> WithSimd for Lanes<T> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        T::lanes::<S>()
    }
}

fn lanes<T: Number>(arch: Arch) -> usize {
    arch.dispatch(Lanes::<T>(std::marker::PhantomData))
}

/// Vector registers for single precision: those of half a cache line if there are any, as most blocks of a line have 8,
/// 12 or 18 unknowns and would leave half of longer ones empty.
fn narrow() -> Arch {
    #[cfg(target_arch = "x86_64")]
    if let Some(registers) = pulp::x86::V3::try_new() {
        return Arch::V3(registers);
    }
    Arch::new()
}

impl Assembled {
    /// Zeros in blocks between the `bounds`.
    fn new(bounds: &[usize], lanes: usize) -> Self {
        let (sizes, heights) = structure::shapes(bounds, lanes);
        let (mut diagonal, mut coupling, mut largest) = (0, 0, 0);
        let mut blocks = Vec::with_capacity(sizes.len());
        for (i, (&size, &height)) in sizes.iter().zip(&heights).enumerate() {
            blocks.push(AssembledBlock {
                first: bounds[i],
                size,
                height,
                diagonal,
                coupling,
            });
            diagonal += height * size;
            largest = largest.max(height);
            if i + 1 < sizes.len() {
                // One start for both couplings: each gets the room of the larger one.
                coupling += (heights[i + 1] * size).max(height * sizes[i + 1]);
            }
        }
        Self {
            blocks,
            diagonal: Buffer::new(diagonal),
            down: Buffer::new(coupling),
            up: Buffer::new(coupling),
            inverse: Buffer::new(largest * largest),
            forward: Buffer::new(largest * largest),
        }
    }
}

impl BlockTridiagonal {
    /// Analyses a symmetric pattern in compressed columns (row indices ascending); `unknowns[i]` is the number of
    /// unknown `i` in the vectors of the whole system. Returns `None` if the pattern does not fall into small blocks.
    #[must_use]
    pub fn analyse(
        unknowns: &[usize],
        column_starts: &[usize],
        row_indices: &[usize],
        precision: Precision,
    ) -> Option<Self> {
        let arch = Arch::new();
        let (bounds, numbers) = structure::cut(column_starts, row_indices, lanes::<f64>(arch))?;
        let bytes = numbers * size_of::<f64>();
        let pattern = (unknowns, column_starts, row_indices);
        if precision == Precision::Mixed && bytes > CACHED {
            let arch = narrow();
            let (bounds, numbers) = structure::cut(column_starts, row_indices, lanes::<f32>(arch))?;
            if ((numbers * size_of::<f32>()) as f64) < SMALLER * bytes as f64 {
                return Some(Self::new(arch, &bounds, pattern, Factors::Single));
            }
        }
        Some(Self::new(arch, &bounds, pattern, Factors::Double))
    }

    fn new<T: Entries>(
        arch: Arch,
        bounds: &[usize],
        (unknowns, column_starts, row_indices): (&[usize], &[usize], &[usize]),
        factors: fn(Solver<T>) -> Factors,
    ) -> Self {
        let mut block_of = vec![0; unknowns.len()];
        for (i, ends) in bounds.windows(2).enumerate() {
            block_of[ends[0]..ends[1]].fill(i as u32);
        }
        let mut this = Self {
            block_of,
            entries: Vec::new(),
            assembled: Assembled::new(bounds, lanes::<f64>(arch)),
            factors: factors(Solver::new(arch, bounds, unknowns)),
        };
        this.entries = this.places(column_starts, row_indices);
        this
    }

    /// Number of blocks, and size of the largest one.
    #[cfg(test)]
    pub fn shape(&self) -> (usize, usize) {
        let blocks = &self.assembled.blocks;
        let largest = blocks.iter().map(|block| block.size).max().unwrap_or(0);
        (blocks.len(), largest)
    }

    /// Takes the right side of the next solution from a vector of the whole system.
    pub fn load(&mut self, right_side: &[f64]) {
        with_solver!(&mut self.factors, solver => solver.load(right_side));
    }

    /// Adds to one entry of the loaded right side.
    pub fn add(&mut self, unknown: usize, value: f64) {
        with_solver!(&mut self.factors, solver => solver.add(unknown, value));
    }

    /// Product of the loaded right side with a local column.
    #[must_use]
    pub fn dot(&self, column: &LocalColumn) -> f64 {
        with_solver!(&self.factors, solver => solver.dot(column))
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
        with_solver!(&mut self.factors, solver => solver.solve(threshold, solution, changed))
    }

    /// Solves for the loaded right side without leaving anything out; `solution` has one entry per unknown.
    pub fn unload(&mut self, solution: &mut [f64]) {
        with_solver!(&mut self.factors, solver => solver.unload(solution));
    }

    /// A column with room for all unknowns.
    #[must_use]
    pub fn new_column(&self) -> LocalColumn {
        with_solver!(&self.factors, solver => solver.new_column())
    }

    /// Solves for a right side of a few `entries` (unknown, value), down to `relative` times the largest entry, as a
    /// force; the rest of the solution is left out.
    pub fn column(&mut self, entries: &[(usize, f64)], relative: f64, column: &mut LocalColumn) {
        let (mut low, mut high, mut largest) = (usize::MAX, 0, 0.0_f64);
        for &(unknown, value) in entries {
            let block = self.block_of[unknown] as usize;
            (low, high) = (low.min(block), high.max(block));
            self.add(unknown, value);
            largest = largest.max(value.abs());
        }
        let loaded = if low > high { 0..0 } else { low..high + 1 };
        with_solver!(&mut self.factors, solver => solver.take_column(loaded, relative * largest, column));
    }

    /// Entry of a local column.
    #[must_use]
    pub fn entry(&self, column: &LocalColumn, unknown: usize) -> f64 {
        with_solver!(&self.factors, solver => solver.entry(column, unknown))
    }
}

#[cfg(test)]
mod tests;
