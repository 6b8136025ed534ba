//! The contact force on a strip, as an input of the system.
use dynamics::{Blocks, Column, Columns, Force, Marker, Motion, Weights};
use nalgebra::Vector3;

/// Force on a collector strip, set through the inputs: `u[first..first + 4]` = (f_x, f_y, f_z) in N, world axes, and
/// the lateral position y of the point of action, m.
///
/// The point of action is the point of the strip's lateral axis at y; a strip that can only rise takes up the vertical
/// force alone.
pub struct AppliedForce {
    /// Middle of the strip; the second axis runs along the strip.
    pub marker: Box<dyn Marker>,
    /// Index of `f_x` in the inputs.
    pub first: usize,
}

/// The force at one instant.
struct Load {
    force: Vector3<f64>,
    /// Direction of the strip.
    lateral: Vector3<f64>,
    /// Distance of the point along the strip, m.
    distance: f64,
    columns: Columns,
}

impl AppliedForce {
    /// Number of inputs.
    pub const INPUTS: usize = 4;

    fn load(&self, motion: &Motion<'_>) -> Load {
        let u = &motion.u[self.first..self.first + Self::INPUTS];
        let frame = self.marker.frame(motion);
        let lateral = frame.axes.column(1).into_owned();
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        Load {
            force: Vector3::new(u[0], u[1], u[2]),
            distance: (u[3] - frame.position.y) / lateral.y,
            lateral,
            columns,
        }
    }
}

impl Force for AppliedForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let load = self.load(motion);
        load.columns
            .add_force(&load.force, &(load.lateral * load.distance), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let load = self.load(motion);
        let columns = load.columns.as_slice();
        let mut values = [0.0; Columns::CAPACITY * Columns::CAPACITY];
        let mut indices = [0; Columns::CAPACITY];
        let n = columns.len();
        for (k, of) in columns.iter().enumerate() {
            indices[k] = of.index;
            for (l, by) in columns.iter().enumerate() {
                values[k * n + l] = -weights.q * load.derivative(of, by);
            }
        }
        blocks.add(&indices[..n], &indices[..n], &values[..n * n]);
    }
}

impl Load {
    /// Derivative of the generalised force of the column `of` in the direction `by`; both belong to one rigid body.
    fn derivative(&self, of: &Column, by: &Column) -> f64 {
        if of.rotation == Vector3::zeros() {
            return 0.0; // The force is constant and so is the column of a displacement.
        }
        let lever = of.translation + of.rotation.cross(&(self.lateral * self.distance));
        let lateral_rate = by.rotation.cross(&self.lateral);
        // The point stays at the same y while the strip slides under it.
        let distance_rate = -(by.translation.y + self.distance * lateral_rate.y) / self.lateral.y;
        let sliding = of.rotation.cross(&self.lateral) * distance_rate;
        self.force.dot(&(by.rotation.cross(&lever) + sliding))
    }
}
