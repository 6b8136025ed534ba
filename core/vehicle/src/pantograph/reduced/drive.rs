//! Drive of a reduced linkage.
use super::point::ReducedPoint;
use dynamics::{Blocks, Columns, Force, Marker, Motion, Power, Weights};
use nalgebra::Vector3;

/// The vertical force of a drive on a point of a reduced linkage, as the input `u[input]`, N: that of
/// [`crate::multibody::DriveForce`] in the two coordinates.
#[derive(Clone, Debug)]
pub(super) struct ReducedDrive {
    pub point: ReducedPoint,
    pub input: usize,
}

impl Force for ReducedDrive {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let mut columns = Columns::default();
        self.point.columns(motion, &mut columns);
        columns.add_force(&Vector3::new(0.0, 0.0, motion.u[self.input]), &Vector3::zeros(), force);
    }

    /// `−u ∂²z/∂σ²`
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let i = self.point.coordinate;
        let stiffness = -weights.q * motion.u[self.input] * self.point.height_curvature(motion);
        blocks.add(&[i, i + 1], &[i, i + 1], &[stiffness, 0.0, 0.0, 0.0]);
    }

    /// The drive brings in all of its power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        Some(Power {
            driven: motion.u[self.input] * self.point.frame(motion).velocity.z,
            dissipated: 0.0,
        })
    }
}
