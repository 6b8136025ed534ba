//! Lateral pull of droppers whose force is known.
use crate::Attachment;
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::{Matrix3, Vector3};

/// Lateral forces of droppers that hang between two wires and pull with known vertical force: those of springs of
/// `F/height`.
#[derive(Clone, Debug, Default)]
pub(super) struct LateralPull {
    /// Upper and lower node, and the stiffness between them, N/m.
    pub ties: Vec<(Attachment, Attachment, f64)>,
}

impl Force for LateralPull {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for (upper, lower, stiffness) in &self.ties {
            let distance = upper.position(motion).y - lower.position(motion).y;
            let pull = Vector3::new(0.0, stiffness * distance, 0.0);
            upper.add_force(&-pull, force);
            lower.add_force(&pull, force);
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for (upper, lower, stiffness) in &self.ties {
            let matrix = Matrix3::from_diagonal(&Vector3::new(0.0, weights.q * stiffness, 0.0));
            upper.add_relative_block(lower, &matrix, blocks);
        }
    }
}
