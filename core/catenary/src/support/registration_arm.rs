//! Registration arms at the masts, which hold the contact wire laterally.
use crate::Anchor;
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::Matrix3;

/// The registration arms of a line as one contribution.
///
/// An arm carries its static reaction on (vertical, and with stagger lateral), has a stiffness about the static
/// position, and a mass lumped on the contact wire whose weight is part of the static balance:
///
/// ```text
/// F = R − k ∘ u − m g e_z
/// ```
#[derive(Clone, Debug)]
pub struct RegistrationArms {
    arms: Vec<Anchor>,
    mass: f64,
    gravity: f64,
}

impl RegistrationArms {
    /// A batch of arms, each of `mass` in kg under `gravity` in m/s².
    ///
    /// The reaction of an arm includes the support of its own weight.
    #[must_use]
    pub fn new(arms: Vec<Anchor>, mass: f64, gravity: f64) -> Self {
        Self { arms, mass, gravity }
    }

    /// The arms in their order.
    #[must_use]
    pub fn as_slice(&self) -> &[Anchor] {
        &self.arms
    }
}

impl Force for RegistrationArms {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for arm in &self.arms {
            let mut f = arm.force(motion);
            f.z -= self.mass * self.gravity;
            arm.node.add_force(&f, force);
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for arm in &self.arms {
            arm.add_tangent(weights, blocks);
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        if self.mass > 0.0 {
            let block = Matrix3::from_diagonal_element(self.mass);
            for arm in &self.arms {
                arm.node.add_block(&block, blocks);
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.arms
            .iter()
            .map(|arm| arm.energy(motion) + self.mass * self.gravity * arm.node.displacement(motion).z)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Attachment;
    use dynamics::State;
    use dynamics::testing::{assert_law, plain_layout};
    use nalgebra::Vector3;

    fn arms() -> RegistrationArms {
        let arm = Anchor {
            node: Attachment::new(Vector3::new(60.0, 0.2, 5.3), [Some(0), Some(1), Some(2)]),
            reaction: Vector3::new(0.0, 120.0, 40.0 + 9.81),
            stiffness: Vector3::new(0.0, 3.0e4, 300.0),
        };
        RegistrationArms::new(vec![arm], 1.0, 9.81)
    }

    #[test]
    fn the_static_reaction_balances_wire_and_own_weight() {
        let mut out = [0.0; 3];
        arms().add_force(&State::at_rest(3, 0, Vec::new()).motion(&[]), &mut out);
        assert!((out[0], out[1]) == (0.0, 120.0) && (out[2] - 40.0).abs() < 1e-12);
    }

    #[test]
    fn force_is_the_gradient_of_the_energy_and_the_tangent_its_jacobian() {
        let mut state = State::at_rest(3, 0, Vec::new());
        state.q.copy_from_slice(&[0.01, 0.02, 0.05]);
        assert_law(&mut arms(), &plain_layout(3), &state);
    }
}
