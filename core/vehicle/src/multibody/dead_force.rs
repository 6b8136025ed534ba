//! Constant forces on points of bodies.
use super::BodyMarker;
use dynamics::{Blocks, Columns, Force, Marker, Motion, Weights};
use nalgebra::Vector3;

/// A force of constant size and direction on a point fixed in a body.
///
/// The potential is `−F · r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadForce {
    /// Point of action.
    pub marker: BodyMarker,
    /// Force in world axes, N.
    pub force: Vector3<f64>,
}

impl Force for DeadForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        columns.add_force(&self.force, &Vector3::zeros(), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        // Only the lever turns with the body: −∂(F · t_k)/∂φ_l = −F · (c_l × t_k).
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        let rotations = &columns.as_slice()[3..6];
        let mut block = [0.0; 9];
        for (k, of) in rotations.iter().enumerate() {
            for (l, by) in rotations.iter().enumerate() {
                block[3 * k + l] = -weights.q * self.force.dot(&by.rotation.cross(&of.translation));
            }
        }
        let indices = [rotations[0].index, rotations[1].index, rotations[2].index];
        blocks.add(&indices, &indices, &block);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self.force.dot(&self.marker.frame(motion).position)
    }
}
