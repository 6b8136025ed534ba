//! Assembly into blocks and their factorisation.
use super::kernel::add_product;
use super::{Block, BlockTridiagonal, EntryTarget};
use pulp::{Simd, WithSimd};

impl BlockTridiagonal {
    /// Targets of the entries of the pattern.
    pub(super) fn places(&self, column_starts: &[usize], row_indices: &[usize]) -> Vec<EntryTarget> {
        let mut places = Vec::with_capacity(row_indices.len());
        for column in 0..column_starts.len() - 1 {
            let of_column = self.block_of[column] as usize;
            let block = &self.blocks[of_column];
            let c = column - block.first;
            for &row in &row_indices[column_starts[column]..column_starts[column + 1]] {
                let of_row = self.block_of[row] as usize;
                places.push(if row < column {
                    EntryTarget::Unused
                } else if of_row == of_column {
                    let r = row - block.first;
                    let place = |r: usize, c: usize| (block.assembled + c * block.height + r) as u32;
                    EntryTarget::Diagonal(place(r, c), place(c, r))
                } else {
                    let next = &self.blocks[of_row];
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
        // Assume the last solution everywhere: it may come from earlier factors.
        self.solved = 0..self.work.len();
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
        for block in &self.blocks {
            for k in 0..block.size {
                self.diagonal[block.at + k] = assembled.diagonal[block.assembled + k * (block.height + 1)];
            }
        }
        let arch = self.arch;
        arch.dispatch(Factor(self))
    }
}

struct Factor<'a>(&'a mut BlockTridiagonal);

impl WithSimd for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let matrix = self.0;
        let middle = matrix.middle;
        let last = matrix.blocks.len() - 1;
        for i in 0..middle {
            if !eliminate(simd, matrix, i, i + 1) {
                return false;
            }
        }
        for i in (middle + 1..=last).rev() {
            if !eliminate(simd, matrix, i, i - 1) {
                return false;
            }
        }
        invert(matrix, middle)
    }
}

/// Inverts the Schur complement of block `i`, stores the factors for solutions, and takes it out of the next block.
#[inline(always)]
fn eliminate<S: Simd>(simd: S, matrix: &mut BlockTridiagonal, i: usize, next: usize) -> bool {
    if !invert(matrix, i) {
        return false;
    }
    let start = matrix.blocks[i.min(next)].coupling;
    // A_next,i and its transpose.
    let (down, up) = (&matrix.assembled.down[start..], &matrix.assembled.up[start..]);
    let (coupling, transposed) = if next > i { (down, up) } else { (up, down) };
    let (own, next) = (matrix.blocks[i], matrix.blocks[next]);
    let coupling = &coupling[..next.height * own.size];
    let transposed = &transposed[..own.height * next.size];

    let (inverse, mirrored) =
        matrix.backward[own.backward..][..own.height * (own.size + next.size)].split_at_mut(own.height * own.size);
    let forward = &mut matrix.forward[own.forward..own.forward + next.height * own.size];
    forward.fill(0.0);
    for (target, column) in forward
        .chunks_exact_mut(next.height)
        .zip(inverse.chunks_exact(own.height))
    {
        add_product(simd, coupling, &column[..own.size], target);
        target.iter_mut().for_each(|value| *value = -*value);
    }
    mirrored.fill(0.0);
    for (r, target) in mirrored.chunks_exact_mut(own.height).enumerate() {
        for (c, value) in target[..own.size].iter_mut().enumerate() {
            *value = forward[c * next.height + r];
        }
    }
    let schur = &mut matrix.assembled.diagonal[next.assembled..next.assembled + next.height * next.size];
    for (target, column) in schur
        .chunks_exact_mut(next.height)
        .zip(transposed.chunks_exact(own.height))
    {
        add_product(simd, forward, &column[..own.size], target);
    }
    true
}

/// Writes the inverse of the block on the diagonal in front of the backward block; returns `false` if the block is not
/// positive definite.
#[inline(always)]
fn invert(matrix: &mut BlockTridiagonal, i: usize) -> bool {
    let Block {
        size,
        height,
        assembled,
        backward,
        ..
    } = matrix.blocks[i];
    let a = &mut matrix.assembled.diagonal[assembled..assembled + height * size];
    let inverse = &mut matrix.backward[backward..backward + height * size];
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
