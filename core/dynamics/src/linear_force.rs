//! A force linear in the motion.
use crate::{Blocks, ByRange, Force, Motion, OnePass, SparseMatrix, Weights};
use std::ops::Range;

/// A force linear in coordinates, velocities and accelerations.
///
/// ```text
/// Q = Q₀ − K q − D v,    inertia M v̇
/// ```
#[derive(Clone, Debug)]
pub struct LinearForce {
    load: Vec<f64>,
    stiffness: SparseMatrix,
    damping: SparseMatrix,
    mass: SparseMatrix,
    /// Rows of the three matrices that have entries.
    rows: Vec<MatrixRow>,
    entries: Vec<MatrixEntry>,
}

/// A row with its entries up to `end`.
#[derive(Clone, Copy, Debug)]
struct MatrixRow {
    row: usize,
    end: usize,
}

/// Entries of `K`, `D` and `M` in one place.
#[derive(Clone, Copy, Debug)]
struct MatrixEntry {
    column: usize,
    weights: [f64; 3],
}

impl LinearForce {
    /// A force of given `Q₀` (N), `K` (N/m), `D` (N·s/m) and `M` (kg).
    #[must_use]
    pub fn new(load: Vec<f64>, stiffness: SparseMatrix, damping: SparseMatrix, mass: SparseMatrix) -> Self {
        let (mut rows, mut entries) = (Vec::new(), Vec::<MatrixEntry>::new());
        for row in 0..load.len() {
            let first = entries.len();
            for (kind, matrix) in [&stiffness, &damping, &mass].into_iter().enumerate() {
                for (column, value) in matrix.row(row) {
                    let known = entries[first..].iter().position(|entry| entry.column == column);
                    let at = known.map_or(entries.len(), |known| first + known);
                    if at == entries.len() {
                        let weights = [0.0; 3];
                        entries.push(MatrixEntry { column, weights });
                    }
                    entries[at].weights[kind] = value;
                }
            }
            if entries.len() > first {
                let end = entries.len();
                rows.push(MatrixRow { row, end });
            }
        }
        Self {
            load,
            stiffness,
            damping,
            mass,
            rows,
            entries,
        }
    }

    /// `Q₀`, N.
    #[must_use]
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// `K`, N/m.
    #[must_use]
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// `D`, N·s/m.
    #[must_use]
    pub fn damping(&self) -> &SparseMatrix {
        &self.damping
    }

    /// `M`, kg.
    #[must_use]
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass
    }

    /// Adds `Q₀ − K q − D v − M a` to the rows in `range`; without `M a` if `a` is none.
    fn add(&self, range: Range<usize>, motion: &Motion<'_>, a: Option<&[f64]>, force: &mut [f64]) {
        // Other contributions may have coordinates behind these.
        let end = range.end.min(self.load.len());
        let range = range.start.min(end)..end;
        for (force, load) in force[range.clone()].iter_mut().zip(&self.load[range.clone()]) {
            *force += load;
        }
        let first = self.rows.partition_point(|row| row.row < range.start);
        let mut begin = first.checked_sub(1).map_or(0, |before| self.rows[before].end);
        for row in self.rows[first..].iter().take_while(|row| row.row < range.end) {
            let entries = &self.entries[begin..row.end];
            begin = row.end;
            let sum = entries.iter().fold(
                0.0,
                |sum,
                 MatrixEntry {
                     column,
                     weights: [k, d, m],
                 }| {
                    let inertia = a.map_or(0.0, |a| m * a[*column]);
                    sum + (k * motion.q[*column] + d * motion.v[*column] + inertia)
                },
            );
            force[row.row] -= sum;
        }
    }

    /// Adds a matrix with a weight.
    fn add_to(&self, matrix: &SparseMatrix, weight: f64, blocks: &mut Blocks<'_>) {
        for &MatrixRow { row, .. } in &self.rows {
            for (column, value) in matrix.row(row) {
                blocks.add(&[row], &[column], &[weight * value]);
            }
        }
    }
}

impl Force for LinearForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..force.len(), motion, None, force);
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.add_to(&self.stiffness, weights.q, blocks);
        self.add_to(&self.damping, weights.v, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        self.add_to(&self.mass, 1.0, blocks);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let work: f64 = self.load.iter().zip(motion.q).map(|(load, q)| load * q).sum();
        0.5 * self.stiffness.quadratic_form(motion.q) - work
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for LinearForce {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(0..force.len(), motion, Some(v_dot), force);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        Some(self)
    }
}

impl ByRange for LinearForce {
    fn is_linear(&self) -> bool {
        true
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(range, motion, Some(v_dot), force);
    }
}
