//! One part of the iteration matrix: unknowns that nothing but low-rank terms couples with others.
use crate::linear::block_tridiagonal::{BlockTridiagonal, LocalColumn, Precision};
use crate::linear::condensed::Condensed;
use crate::linear::dense_lu::Lu;
use crate::linear::sparse_factor::{Shape, SparseFactor};
use std::ops::Range;

/// A line and a pantograph are two parts, because contact enters as a low-rank term: each is factored and solved by
/// itself.
pub(crate) struct Part {
    /// Unknowns in ascending order: coordinates first, then multipliers (numbered after all coordinates).
    pub unknowns: Vec<usize>,
    /// Number of coordinates among the unknowns.
    coordinates: usize,
    /// Pattern in compressed columns, and the factorisations made of it on first use.
    column_starts: Vec<usize>,
    row_indices: Vec<usize>,
    shape: Shape,
    blocks: Option<BlockTridiagonal>,
    /// Unknowns that are condensed before the blocks; no low-rank term acts on them.
    condensed: Option<Condensed>,
    sparse: Option<SparseFactor>,
    /// Used in place of `sparse` for up to [`DENSE`] unknowns, for which a search through indices takes longer than the
    /// sums.
    dense: Option<Lu>,
    /// `true` if the last factors are those of the blocks.
    in_blocks: bool,
    /// Right side, then solution, unless the blocks hold it.
    local: Vec<f64>,
}

/// `A⁻¹ u` of one part.
#[derive(Debug)]
pub(crate) enum PartColumn {
    /// Entries above the decay limit.
    Local(LocalColumn),
    /// All entries.
    Whole(Vec<f64>),
}

/// Absolute values of force and of (scaled) constraint entries below which a right side is not worth a solution.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Thresholds {
    pub force: f64,
    pub constraint: f64,
}

/// Parts up to this size are factored by LU without a look at their shape: it costs nothing there.
const SMALL: usize = 64;

/// Parts up to this size are factored as dense matrices: a pantograph.
const DENSE: usize = 16;

/// A column is kept down to this part of its largest entry, as a force; the remainder enters corrections with its
/// square.
const DECAYED: f64 = 1e-9;

/// Calls `see(positions, unknowns)` for each run of consecutive unknowns, with the range of its positions in the list.
fn for_each_run(unknowns: &[usize], mut see: impl FnMut(Range<usize>, Range<usize>)) {
    let mut first = 0;
    for run in unknowns.chunk_by(|a, b| b - a == 1) {
        see(first..first + run.len(), run[0]..run[0] + run.len());
        first += run.len();
    }
}

/// Writes the values of these unknowns into a vector of all; returns `true` if they are finite.
fn write(unknowns: &[usize], values: &[f64], all: &mut [f64]) -> bool {
    for_each_run(unknowns, |own, of_all| all[of_all].copy_from_slice(&values[own]));
    values.iter().all(|value| value.is_finite())
}

impl Part {
    /// A part from its pattern in compressed columns, local row indices ascending; unknowns below `coordinates` are
    /// coordinates.
    pub fn new(
        unknowns: Vec<usize>,
        column_starts: Vec<usize>,
        row_indices: Vec<usize>,
        coordinates: usize,
        precision: Precision,
    ) -> Self {
        let coordinates = unknowns.partition_point(|&unknown| unknown < coordinates);
        // Multipliers make a matrix indefinite, turning bodies make it unsymmetric; structures are neither.
        let shape = if coordinates == unknowns.len() && unknowns.len() > SMALL {
            Shape::Definite
        } else {
            Shape::General
        };
        let mut blocks = (shape == Shape::Definite)
            .then(|| BlockTridiagonal::analyse(&unknowns, &column_starts, &row_indices, precision))
            .flatten();
        let mut condensed = None;
        if blocks.is_none()
            && shape == Shape::Definite
            && let Some((found, starts, rows)) = Condensed::analyse(&column_starts, &row_indices)
        {
            blocks = BlockTridiagonal::analyse(&unknowns[..found.core], &starts, &rows, precision);
            condensed = blocks.is_some().then_some(found);
        }
        Self {
            local: vec![0.0; unknowns.len()],
            coordinates,
            column_starts,
            row_indices,
            shape,
            in_blocks: blocks.is_some(),
            blocks,
            condensed,
            sparse: None,
            dense: (unknowns.len() <= DENSE).then(Lu::default),
            unknowns,
        }
    }

    /// Number of entries of its pattern.
    pub fn entries(&self) -> usize {
        self.row_indices.len()
    }

    /// Factors the matrix with these values. The error is an unknown that has no stiffness, or one of those that depend
    /// on each other.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), usize> {
        self.in_blocks = match (&mut self.blocks, &mut self.condensed) {
            (Some(blocks), Some(condensed)) => condensed.reduce(values).is_some_and(|values| blocks.factor(values)),
            (Some(blocks), None) => blocks.factor(values),
            (None, _) => false,
        };
        match &mut self.dense {
            _ if self.in_blocks => {}
            Some(dense) => {
                let size = self.unknowns.len();
                let matrix = dense.matrix(size);
                for (column, ends) in self.column_starts.windows(2).enumerate() {
                    for k in ends[0]..ends[1] {
                        matrix[self.row_indices[k] * size + column] = values[k];
                    }
                }
                dense.factor().map_err(|column| self.unknowns[column])?;
            }
            None => {
                // A matrix that is not definite in blocks is not in faer's Cholesky either.
                let shape = if self.blocks.is_some() {
                    Shape::General
                } else {
                    self.shape
                };
                let sparse = self.sparse.get_or_insert_with(|| {
                    SparseFactor::analyse(
                        self.unknowns.len(),
                        self.column_starts.clone(),
                        self.row_indices.clone(),
                        shape,
                    )
                });
                if !sparse.factor(values) {
                    return Err(self.unknowns[0]);
                }
            }
        }
        // faer divides by a zero pivot without complaint: a right side without symmetry shows it.
        for (i, value) in self.local.iter_mut().enumerate() {
            *value = 1.0 + 0.1 * ((i * 7 % 11) as f64);
        }
        self.solve_local();
        let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
        if self.local.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        let worst = (0..self.local.len()).max_by(|&i, &j| size(self.local[i]).total_cmp(&size(self.local[j])));
        Err(self.unknowns[worst.unwrap_or(0)])
    }

    /// Solves in place of `local`.
    fn solve_local(&mut self) {
        if self.in_blocks {
            let Some(blocks) = &mut self.blocks else { return };
            let core = self
                .condensed
                .as_ref()
                .map_or(self.local.len(), |condensed| condensed.core);
            let (core, rest) = self.local.split_at_mut(core);
            core.iter().enumerate().for_each(|(i, &value)| blocks.add(i, value));
            if let Some(condensed) = &mut self.condensed {
                condensed.loaded.copy_from_slice(rest);
                condensed.eliminate(|unknown, value| blocks.add(unknown, value));
            }
            blocks.unload(core);
            if let Some(condensed) = &mut self.condensed {
                rest.fill(0.0);
                condensed.substitute(
                    |unknown| core[unknown],
                    |unknowns, values| rest[unknowns].copy_from_slice(values),
                    |_| (),
                );
            }
        } else if let Some(dense) = &self.dense {
            dense.solve(&mut self.local);
        } else if let Some(sparse) = &mut self.sparse {
            sparse.solve(&mut self.local);
        }
    }

    /// Returns `true` if the factored matrix is taken as symmetric, so that `uᵀ A⁻¹ b = (A⁻¹ u)ᵀ b`.
    fn is_symmetric(&self) -> bool {
        self.in_blocks || self.sparse.as_ref().is_some_and(SparseFactor::is_symmetric)
    }

    /// Takes the right side of the next solution out of that of the whole system. The right side of a matrix that is
    /// not symmetric is solved for right away.
    pub fn load(&mut self, right_side: &[f64], thresholds: Thresholds) {
        if self.in_blocks {
            if let Some(blocks) = &mut self.blocks {
                blocks.load(right_side);
                if let Some(condensed) = &mut self.condensed {
                    // No threshold: hundreds of small loads add up on the same few unknowns.
                    for_each_run(&self.unknowns[condensed.core..], |own, of_all| {
                        condensed.loaded[own].copy_from_slice(&right_side[of_all]);
                    });
                    condensed.eliminate(|unknown, value| blocks.add(unknown, value));
                }
            }
            return;
        }
        for_each_run(&self.unknowns, |own, of_all| {
            self.local[own].copy_from_slice(&right_side[of_all]);
        });
        if !self.is_symmetric() {
            self.solve_above(thresholds);
        }
    }

    /// `uᵀ A⁻¹ b` for the loaded right side `b`, from `y = A⁻¹ u` or `u` itself (local numbers).
    pub fn product(&self, y: &PartColumn, u: &[(usize, f64)]) -> f64 {
        match (y, &self.blocks) {
            (PartColumn::Local(column), Some(blocks)) => blocks.dot(column),
            (PartColumn::Whole(y), _) if self.is_symmetric() => y.iter().zip(&self.local).map(|(y, b)| y * b).sum(),
            _ => u.iter().map(|&(unknown, value)| value * self.local[unknown]).sum(),
        }
    }

    /// Takes the force `z u` out of the loaded right side, or `z y` out of its solution.
    pub fn subtract(&mut self, z: f64, y: &PartColumn, u: &[(usize, f64)]) {
        match y {
            PartColumn::Whole(y) if !self.is_symmetric() => {
                self.local.iter_mut().zip(y).for_each(|(value, y)| *value -= z * y);
            }
            _ => u.iter().for_each(|&(unknown, value)| match &mut self.blocks {
                Some(blocks) if self.in_blocks => blocks.add(unknown, -z * value),
                _ => self.local[unknown] -= z * value,
            }),
        }
    }

    /// Writes the solution into that of the whole system, which holds the last one or zeros; `changed` sees the ranges
    /// of unknowns with a solution and of those whose equations it enters. Returns `true` if all is finite.
    pub fn solve(
        &mut self,
        thresholds: Thresholds,
        solution: &mut [f64],
        changed: &mut dyn FnMut(Range<usize>, Range<usize>),
    ) -> bool {
        if self.in_blocks {
            let Some(blocks) = &mut self.blocks else { return true };
            let mut finite = blocks.solve(thresholds.force, solution, &mut |inner, outer| {
                let whole = |range: Range<usize>| self.unknowns[range.start]..self.unknowns[range.end - 1] + 1;
                changed(whole(inner), whole(outer));
            });
            if let Some(condensed) = &mut self.condensed {
                let (others, own) = self.unknowns.split_at(condensed.core);
                let mut range: Option<Range<usize>> = None;
                let found = &mut self.local[..own.len()];
                found.fill(0.0);
                let set = |solved: Range<usize>, values: &[f64]| {
                    found[solved.clone()].copy_from_slice(values);
                    let first = range.as_ref().map_or(solved.start, |range| range.start);
                    range = Some(first..solved.end);
                };
                let mut touched = |range: Range<usize>| {
                    // Report the neighbours: their equations change, though their values do not.
                    let outer = others[range.start]..others[range.end - 1] + 1;
                    changed(outer.start..outer.start, outer);
                };
                condensed.substitute(|unknown| solution[others[unknown]], set, &mut touched);
                finite &= write(own, found, solution);
                if let Some(range) = range {
                    let range = own[range.start]..own[range.end - 1] + 1;
                    changed(range.clone(), range);
                }
            }
            return finite;
        }
        if self.is_symmetric() {
            self.solve_above(thresholds);
        }
        if self.local.iter().any(|&value| value != 0.0) {
            for_each_run(&self.unknowns, |_, of_all| changed(of_all.clone(), of_all));
        }
        write(&self.unknowns, &self.local, solution)
    }

    /// Solves in place of `local`, unless it is nowhere above the thresholds: then it becomes zero.
    fn solve_above(&mut self, thresholds: Thresholds) {
        let (forces, constraints) = self.local.split_at(self.coordinates);
        let above = |values: &[f64], threshold: f64| !values.iter().all(|value| value.abs() <= threshold);
        if above(forces, thresholds.force) || above(constraints, thresholds.constraint) {
            self.solve_local();
        } else {
            self.local.fill(0.0);
        }
    }

    /// An empty column with room for all it may hold.
    pub fn new_column(&self) -> PartColumn {
        match &self.blocks {
            Some(blocks) if self.in_blocks => PartColumn::Local(blocks.new_column()),
            _ => PartColumn::Whole(vec![0.0; self.unknowns.len()]),
        }
    }

    /// `A⁻¹ u`; nothing may be loaded.
    pub fn column(&mut self, u: &[(usize, f64)], column: &mut PartColumn) {
        let fits = matches!(column, PartColumn::Local(_)) == self.in_blocks;
        if !fits {
            *column = self.new_column();
        }
        match (column, &mut self.blocks) {
            (PartColumn::Local(column), Some(blocks)) => blocks.column(u, DECAYED, column),
            (PartColumn::Whole(y), _) => {
                self.local.fill(0.0);
                u.iter().for_each(|&(unknown, value)| self.local[unknown] += value);
                self.solve_local();
                y.copy_from_slice(&self.local);
            }
            (PartColumn::Local(_), None) => unreachable!("only blocks make local columns"),
        }
    }

    /// Entry of a column.
    pub fn entry(&self, column: &PartColumn, unknown: usize) -> f64 {
        match (column, &self.blocks) {
            (PartColumn::Local(column), Some(blocks)) => blocks.entry(column, unknown),
            (PartColumn::Whole(y), _) => y[unknown],
            (PartColumn::Local(_), None) => unreachable!("only blocks make local columns"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_two_unknowns_is_solved_without_symmetry_and_names_the_one_without_stiffness() {
        let mut part = Part::new(vec![5, 9], vec![0, 2, 4], vec![0, 1, 0, 1], 20, Precision::Double);
        // Columns (4, 1) and (2, 3): 4 x + 2 y = 2, x + 3 y = 8.
        assert_eq!(part.factor(&[4.0, 1.0, 2.0, 3.0]), Ok(()));
        let (mut right_side, mut solution, mut seen) = (vec![0.0; 20], vec![0.0; 20], Vec::new());
        (right_side[5], right_side[9]) = (2.0, 8.0);
        part.load(&right_side, Thresholds::default());
        part.solve(Thresholds::default(), &mut solution, &mut |inner, _| seen.push(inner));
        assert!(
            (solution[5] + 1.0).abs() < 1e-15 && (solution[9] - 3.0).abs() < 1e-15,
            "{solution:?}"
        );
        assert_eq!(seen, [5..6, 9..10]);
        assert_eq!(part.factor(&[4.0, 1.0, 2.0, 0.5]), Err(9));
        assert_eq!(part.factor(&[4.0, 1.0, 2.0, f64::NAN]), Err(9));
    }
}
