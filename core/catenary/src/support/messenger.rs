//! Supports of the messenger wire at the masts.
use crate::Anchor;
use dynamics::{Blocks, Force, Motion, Weights};

/// The supports of the messenger wire as one contribution: each an [`Anchor`] with vertical, lateral and longitudinal
/// stiffness about the static position, massless.
#[derive(Clone, Debug)]
pub struct Supports {
    supports: Vec<Anchor>,
}

impl Supports {
    /// A batch of supports.
    #[must_use]
    pub fn new(supports: Vec<Anchor>) -> Self {
        Self { supports }
    }

    /// The supports in their order.
    #[must_use]
    pub fn as_slice(&self) -> &[Anchor] {
        &self.supports
    }
}

impl Force for Supports {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for support in &self.supports {
            support.node.add_force(&support.force(motion), force);
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for support in &self.supports {
            support.add_tangent(weights, blocks);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.supports.iter().map(|support| support.energy(motion)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Attachment;
    use dynamics::State;
    use dynamics::testing::{assert_law, plain_layout};
    use nalgebra::Vector3;

    fn supports() -> Supports {
        Supports::new(vec![Anchor {
            node: Attachment::new(Vector3::new(60.0, 0.2, 6.5), [Some(1), Some(2), Some(3)]),
            reaction: Vector3::new(3.0, -250.0, 1500.0),
            stiffness: Vector3::new(10.0, 2.0e5, 5.0e5),
        }])
    }

    fn state() -> State {
        let mut state = State::at_rest(4, 0, Vec::new());
        state.q.copy_from_slice(&[9.0, 0.01, -0.02, 0.03]);
        state
    }

    #[test]
    fn the_static_reaction_is_carried_without_displacement() {
        let mut out = [0.0; 4];
        let rest = State::at_rest(4, 0, Vec::new());
        supports().add_force(&rest.motion(&[]), &mut out);
        assert_eq!(out, [0.0, 3.0, -250.0, 1500.0]);
    }

    #[test]
    fn force_is_the_gradient_of_the_energy_and_the_tangent_its_jacobian() {
        assert_law(&mut supports(), &plain_layout(4), &state());
    }
}
