//! A force linear in the motion.
use dynamics::{Blocks, Force, Motion, SparseMatrix, Weights};
use std::ops::Range;

/// A force linear in coordinates, velocities and accelerations.
///
/// ```text
/// Q = Q₀ − K q − D v,    inertia M v̇
/// ```
#[derive(Clone, Debug)]
pub struct LinearForce {
    load: Vec<f64>,
    stiffness: FewRows,
    damping: FewRows,
    mass: FewRows,
}

impl LinearForce {
    /// A force of given `Q₀` (N), `K` (N/m), `D` (N·s/m) and `M` (kg).
    #[must_use]
    pub fn new(load: Vec<f64>, stiffness: SparseMatrix, damping: SparseMatrix, mass: SparseMatrix) -> Self {
        Self {
            load,
            stiffness: FewRows::of(stiffness),
            damping: FewRows::of(damping),
            mass: FewRows::of(mass),
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
        &self.stiffness.matrix
    }

    /// `D`, N·s/m.
    #[must_use]
    pub fn damping(&self) -> &SparseMatrix {
        &self.damping.matrix
    }

    /// `M`, kg.
    #[must_use]
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass.matrix
    }

    /// Adds `Q₀ − K q − D v − M a` to the rows in `range`, `a` being left out where there is none; rows beyond may get a part.
    fn add(&self, range: Range<usize>, motion: &Motion<'_>, a: Option<&[f64]>, force: &mut [f64]) {
        // Others may have coordinates behind these.
        let end = range.end.min(self.load.len());
        let range = range.start.min(end)..end;
        for (force, load) in force[range.clone()].iter_mut().zip(&self.load[range.clone()]) {
            *force += load;
        }
        for (matrix, vector) in [
            (&self.stiffness, Some(motion.q)),
            (&self.damping, Some(motion.v)),
            (&self.mass, a),
        ] {
            if let Some(vector) = vector {
                matrix.subtract(range.clone(), vector, force);
            }
        }
    }
}

impl Force for LinearForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..force.len(), motion, None, force);
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.stiffness.add_to(weights.q, blocks);
        self.damping.add_to(weights.v, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        self.mass.add_to(1.0, blocks);
    }

    fn multiplies_mass(&self) -> bool {
        true
    }

    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(0..force.len(), motion, Some(v_dot), force);
    }

    fn evaluates_ranges(&self) -> bool {
        true
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(range, motion, Some(v_dot), force);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let work: f64 = self.load.iter().zip(motion.q).map(|(load, q)| load * q).sum();
        0.5 * self.stiffness.matrix.quadratic_form(motion.q) - work
    }
}

/// The rows of a matrix that have entries.
#[derive(Clone, Debug, Default)]
struct FewRows {
    rows: Vec<usize>,
    matrix: SparseMatrix,
}

impl FewRows {
    fn of(matrix: SparseMatrix) -> Self {
        Self {
            rows: (0..matrix.size())
                .filter(|&row| matrix.row(row).next().is_some())
                .collect(),
            matrix,
        }
    }

    fn add_to(&self, weight: f64, blocks: &mut Blocks<'_>) {
        for &row in &self.rows {
            for (column, value) in self.matrix.row(row) {
                blocks.add(&[row], &[column], &[weight * value]);
            }
        }
    }

    /// Subtracts the product with `x` from the rows in `range`.
    fn subtract(&self, range: Range<usize>, x: &[f64], y: &mut [f64]) {
        let first = self.rows.partition_point(|&row| row < range.start);
        for &row in self.rows[first..].iter().take_while(|&&row| row < range.end) {
            y[row] -= self
                .matrix
                .row(row)
                .map(|(column, value)| value * x[column])
                .sum::<f64>();
        }
    }
}
