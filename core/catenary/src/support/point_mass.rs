//! Clamps, insulators and splices: masses on the wires.
use crate::Attachment;
use dynamics::{Blocks, Force, Motion};
use nalgebra::Matrix3;

/// Masses at nodes of the wires, with their weight.
#[derive(Clone, Debug, Default)]
pub struct PointMasses {
    /// Nodes, each with its mass in kg.
    masses: Vec<(Attachment, f64)>,
    gravity: f64,
}

impl PointMasses {
    /// Masses (kg) at nodes under `gravity` in m/s².
    #[must_use]
    pub fn new(masses: Vec<(Attachment, f64)>, gravity: f64) -> Self {
        Self { masses, gravity }
    }

    /// True without any mass.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty()
    }
}

impl Force for PointMasses {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        for (node, mass) in &self.masses {
            if let Some(index) = node.coordinate(2) {
                force[index] -= mass * self.gravity;
            }
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for (node, mass) in &self.masses {
            node.add_block(&Matrix3::from_diagonal_element(*mass), blocks);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let height = |(node, mass): &(Attachment, f64)| mass * self.gravity * node.displacement(motion).z;
        self.masses.iter().map(height).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::testing::{assert_law, plain_layout};
    use nalgebra::Vector3;

    #[test]
    fn force_is_the_gradient_of_the_energy_and_the_mass_is_that_of_the_node() {
        let node = Attachment::new(Vector3::new(3.0, 0.0, 5.3), [Some(0), None, Some(1)]);
        let mut masses = PointMasses::new(vec![(node, 7.0)], 9.81);
        let layout = plain_layout(2);
        assert_law(&mut masses, &layout, &layout.state_at_rest());
        let mut entries = Vec::new();
        masses.add_mass(&mut Blocks::add_to(&[0, 0], &mut [0.0; 2]));
        entries.extend(Blocks::collect(|blocks| masses.add_mass(blocks)));
        let diagonal = entries.iter().filter(|(row, column, _)| row == column);
        assert!(diagonal.clone().count() == 2 && diagonal.clone().all(|(_, _, value)| *value == 7.0));
    }
}
