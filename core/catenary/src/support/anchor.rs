//! A node held by springs about its static position.
use crate::Attachment;
use dynamics::{Blocks, Motion, Weights};
use nalgebra::{Matrix3, Vector3};

/// Springs along x, y and z between a node and the ground, with the static reaction as preload.
///
/// ```text
/// F = R − k ∘ u        u displacement from the static position
/// ```
///
/// In the static state the force is exactly the reaction `R`. Derived here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The node.
    pub node: Attachment,
    /// `R`, the force on the wire in the static state, N.
    pub reaction: Vector3<f64>,
    /// `k` along x, y, z, N/m.
    pub stiffness: Vector3<f64>,
}

impl Anchor {
    /// Force on the wire, N.
    #[must_use]
    pub fn force(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.reaction - self.stiffness.component_mul(&self.node.displacement(motion))
    }

    /// Potential energy, J; zero in the static state.
    #[must_use]
    pub fn energy(&self, motion: &Motion<'_>) -> f64 {
        let u = self.node.displacement(motion);
        0.5 * u.dot(&self.stiffness.component_mul(&u)) - self.reaction.dot(&u)
    }

    pub(crate) fn add_tangent(&self, weights: Weights, blocks: &mut Blocks<'_>) {
        let block = Matrix3::from_diagonal(&(weights.q * self.stiffness));
        self.node.add_block(&block, blocks);
    }
}
