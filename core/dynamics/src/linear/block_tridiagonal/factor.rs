//! Assembly into blocks and their factorisation, in double precision.
use super::kernel::add_product;
use super::{Assembled, AssembledBlock, BlockTridiagonal, EntryTarget, Factors};
use pulp::{Simd, WithSimd};

impl BlockTridiagonal {
    /// Targets of the entries of the pattern.
    pub(super) fn places(&self, column_starts: &[usize], row_indices: &[usize]) -> Vec<EntryTarget> {
        let blocks = &self.assembled.blocks;
        let mut places = Vec::with_capacity(row_indices.len());
        for column in 0..column_starts.len() - 1 {
            let of_column = self.block_of[column] as usize;
            let block = &blocks[of_column];
            let c = column - block.first;
            for &row in &row_indices[column_starts[column]..column_starts[column + 1]] {
                let of_row = self.block_of[row] as usize;
                places.push(if row < column {
                    EntryTarget::Unused
                } else if of_row == of_column {
                    let r = row - block.first;
                    let place = |r: usize, c: usize| (block.diagonal + c * block.height + r) as u32;
                    EntryTarget::Diagonal(place(r, c), place(c, r))
                } else {
                    let next = &blocks[of_row];
                    let r = row - next.first;
                    let (down, up) = (c * next.height + r, r * block.height + c);
                    EntryTarget::Coupling((block.coupling + down) as u32, (block.coupling + up) as u32)
                });
            }
        }
        places
    }

    /// Factors the matrix with these values, one per entry of the pattern; of each pair of entries that mirror each
    /// other the lower one counts. Returns `false` if the matrix is not positive definite.
    #[must_use]
    pub fn factor(&mut self, values: &[f64]) -> bool {
        let assembled = &mut self.assembled;
        for buffer in [&mut assembled.diagonal, &mut assembled.down, &mut assembled.up] {
            buffer.fill(0.0);
        }
        for (place, &value) in self.entries.iter().zip(values) {
            match *place {
                EntryTarget::Unused => {}
                EntryTarget::Diagonal(lower, upper) => {
                    assembled.diagonal[lower as usize] = value;
                    assembled.diagonal[upper as usize] = value;
                }
                EntryTarget::Coupling(down, up) => {
                    assembled.down[down as usize] = value;
                    assembled.up[up as usize] = value;
                }
            }
        }
        let diagonal = assembled.blocks.iter().flat_map(|block| {
            let of_block = &assembled.diagonal[block.diagonal..block.diagonal + block.height * block.size];
            of_block.iter().step_by(block.height + 1).copied()
        });
        let (arch, middle) = with_solver!(&mut self.factors, solver => {
            solver.begin_factors(diagonal);
            (solver.arch, solver.middle)
        });
        arch.dispatch(Factor {
            assembled: &mut self.assembled,
            factors: &mut self.factors,
            middle,
        })
    }
}

struct Factor<'a> {
    assembled: &'a mut Assembled,
    factors: &'a mut Factors,
    middle: usize,
}

impl WithSimd for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> bool {
        let middle = self.middle;
        let last = self.assembled.blocks.len() - 1;
        for i in 0..middle {
            if !self.eliminate(simd, i, i + 1) {
                return false;
            }
        }
        for i in (middle + 1..=last).rev() {
            if !self.eliminate(simd, i, i - 1) {
                return false;
            }
        }
        if !invert(self.assembled, middle) {
            return false;
        }
        let Assembled { blocks, inverse, .. } = &*self.assembled;
        with_solver!(&mut *self.factors, solver => solver.set_inverse(middle, inverse, blocks[middle].height));
        true
    }
}

impl Factor<'_> {
    /// Inverts the Schur complement of block `i`, stores the factors for solutions, and takes it out of the next block.
    #[inline(always)]
    fn eliminate<S: Simd>(&mut self, simd: S, i: usize, next: usize) -> bool {
        if !invert(self.assembled, i) {
            return false;
        }
        let Assembled {
            blocks,
            diagonal,
            down,
            up,
            inverse,
            forward,
        } = &mut *self.assembled;
        let start = blocks[i.min(next)].coupling;
        // A_next,i and its transpose.
        let (down, up) = (&down[start..], &up[start..]);
        let (coupling, transposed) = if next > i { (down, up) } else { (up, down) };
        let (own, next) = (blocks[i], blocks[next]);
        let coupling = &coupling[..next.height * own.size];
        let transposed = &transposed[..own.height * next.size];
        let inverse = &inverse[..own.height * own.size];
        let forward = &mut forward[..next.height * own.size];
        forward.fill(0.0);
        for (target, column) in forward
            .chunks_exact_mut(next.height)
            .zip(inverse.chunks_exact(own.height))
        {
            add_product(simd, coupling, &column[..own.size], target);
            target.iter_mut().for_each(|value| *value = -*value);
        }
        let schur = &mut diagonal[next.diagonal..next.diagonal + next.height * next.size];
        for (target, column) in schur
            .chunks_exact_mut(next.height)
            .zip(transposed.chunks_exact(own.height))
        {
            add_product(simd, forward, &column[..own.size], target);
        }
        with_solver!(&mut *self.factors, solver => {
            solver.set_inverse(i, inverse, own.height);
            solver.set_coupling(i, forward, next.height);
        });
        true
    }
}

/// Computes the inverse of the block on the diagonal; returns `false` if the block is not positive definite.
#[inline(always)]
fn invert(assembled: &mut Assembled, i: usize) -> bool {
    let AssembledBlock {
        size, height, diagonal, ..
    } = assembled.blocks[i];
    let a = &mut assembled.diagonal[diagonal..diagonal + height * size];
    let inverse = &mut assembled.inverse[..height * size];
    // A = L Lᵀ, with the reciprocals of the diagonal of L.
    for k in 0..size {
        let diagonal = a[k * height + k];
        let mut pivot = diagonal;
        for j in 0..k {
            pivot -= a[j * height + k] * a[j * height + k];
        }
        if !pivot.is_finite() || pivot <= 4.0 * f64::EPSILON * diagonal {
            return false;
        }
        let scale = 1.0 / pivot.sqrt();
        a[k * height + k] = scale;
        for row in k + 1..size {
            let mut value = a[k * height + row];
            for j in 0..k {
                value -= a[j * height + row] * a[j * height + k];
            }
            a[k * height + row] = value * scale;
        }
    }
    inverse.fill(0.0);
    for (unit, x) in inverse.chunks_exact_mut(height).enumerate() {
        x[unit] = 1.0;
        for k in unit..size {
            let value = x[k] * a[k * height + k];
            x[k] = value;
            for row in k + 1..size {
                x[row] -= a[k * height + row] * value;
            }
        }
        for k in (0..size).rev() {
            let mut value = x[k];
            for row in k + 1..size {
                value -= a[k * height + row] * x[row];
            }
            x[k] = value * a[k * height + k];
        }
    }
    true
}
