//! Forces of constant direction on points of bodies.
use super::BodyMarker;
use dynamics::{Blocks, Columns, Force, Marker, Motion, Power, Weights};
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

/// The vertical force of a drive on a point fixed in a body, as the input `u[input]`, N.
///
/// The frame that bears the drive is not loaded by the reaction, as with the force that raises a linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveForce {
    force: DeadForce,
    input: usize,
}

impl DriveForce {
    /// Drive at `marker` by the input `input`.
    #[must_use]
    pub fn new(marker: BodyMarker, input: usize) -> Self {
        let force = Vector3::zeros();
        Self {
            force: DeadForce { marker, force },
            input,
        }
    }

    /// Height of its point above the top of rail, m.
    #[must_use]
    pub fn height(&self, motion: &Motion<'_>) -> f64 {
        self.force.marker.frame(motion).position.z
    }

    /// Vertical velocity of its point, m/s.
    #[must_use]
    pub fn velocity(&self, motion: &Motion<'_>) -> f64 {
        self.force.marker.frame(motion).velocity.z
    }
}

impl Force for DriveForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.force.force.z = motion.u[self.input];
        self.force.add_force(motion, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.force.force.z = motion.u[self.input];
        self.force.add_tangent(motion, weights, blocks);
    }

    /// The drive brings in all of its power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        Some(Power {
            driven: motion.u[self.input] * self.velocity(motion),
            dissipated: 0.0,
        })
    }
}
