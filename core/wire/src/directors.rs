//! Directors: two per node turn a wire of cable elements into one of beam elements.
use super::geometry::WireGeometry;
use ancf::{BeamCoordinates, BeamInertia, BeamSection, BeamTangent, beam_mass_matrix};
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The directors of a node: the gradients `r,ᵧ` and `r,𝓏` of the fully parameterised beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directors {
    /// References of the two gradients, –.
    pub reference: [Vector3<f64>; 2],
    /// First of six consecutive coordinates: `x, y, z` of the change of `r,ᵧ`, then of `r,𝓏`.
    pub first: usize,
}

impl Directors {
    /// Unit directors across the direction `along` of the wire, `r,𝓏` as upright as possible.
    #[must_use]
    pub fn across(along: &Vector3<f64>, first: usize) -> Self {
        let along = along.normalize();
        let y = Vector3::z().cross(&along).normalize();
        Self {
            reference: [y, along.cross(&y)],
            first,
        }
    }

    /// Directors with their present values as the reference.
    #[must_use]
    pub fn with_reference(&self, q: &[f64]) -> Self {
        let [y, z] = self.reference;
        let change = |i: usize| Vector3::from_column_slice(&q[self.first + 3 * i..][..3]);
        Self {
            reference: [y + change(0), z + change(1)],
            first: self.first,
        }
    }
}

/// Rayleigh damping and inertia of the directors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectorInertia {
    /// `ρ ∫ y² dA = ρ ∫ z² dA`, kg·m.
    pub section: f64,
    /// `α`, 1/s.
    pub alpha: f64,
    /// `β`, s, on the tangent of the straight unstrained beam.
    pub beta: f64,
}

/// Shear, torsion, bending and strain of the cross-section of a wire of beam elements, with the inertia of its
/// directors, as a contribution beside a [`crate::Wire`] without bending stiffness: the axis is that wire, so contact,
/// droppers and supports see the same as of a cable.
#[derive(Clone, Debug)]
pub struct WireDirectors {
    /// `α`, 1/s.
    alpha: f64,
    elements: Vec<Element>,
}

#[derive(Clone, Debug)]
struct Element {
    section: BeamSection,
    /// Positions of the 24 coordinates in the system.
    index: [usize; 24],
    /// Coordinates of the reference, positions relative to the first node.
    reference: BeamCoordinates,
    /// `β` times the tangent of the straight unstrained element.
    damping: BeamTangent,
    /// Mass between a component of a director and itself, and between it and the same one at the other node, kg·m².
    mass: [f64; 2],
}

impl WireDirectors {
    /// The directors of the nodes of `geometry`, in space; `section` makes an element of a length in m.
    ///
    /// # Panics
    /// When the nodes are not spatial, or there are not as many directors.
    #[must_use]
    pub fn new(
        geometry: &WireGeometry,
        directors: &[Directors],
        inertia: DirectorInertia,
        section: impl Fn(f64) -> BeamSection,
    ) -> Self {
        let nodes = geometry.nodes();
        assert_eq!(nodes.len(), directors.len(), "directors at every node");
        let elements = geometry.lengths().iter().enumerate().map(|(i, &length)| {
            let mut index = [0; 24];
            let mut reference = BeamCoordinates::zeros();
            for (end, (node, directors)) in nodes[i..=i + 1].iter().zip(&directors[i..=i + 1]).enumerate() {
                for axis in 0..3 {
                    let place = |index: Option<usize>| index.expect("a beam is spatial");
                    index[12 * end + axis] = place(node.map.position(axis));
                    index[12 * end + 3 + axis] = place(node.map.slope(axis));
                }
                for director in 0..6 {
                    index[12 * end + 6 + director] = directors.first + director;
                }
                let columns = [
                    node.position - nodes[i].position,
                    node.slope,
                    directors.reference[0],
                    directors.reference[1],
                ];
                for (column, vector) in columns.iter().enumerate() {
                    reference.set_column(4 * end + column, vector);
                }
            }
            let section = section(length);
            let mut straight = BeamCoordinates::zeros();
            straight[(0, 4)] = length;
            for end in 0..2 {
                straight
                    .fixed_columns_mut::<3>(4 * end + 1)
                    .copy_from(&Matrix3::identity());
            }
            let gradients = BeamInertia {
                mass: 0.0,
                section: [inertia.section; 2],
            };
            let mass = beam_mass_matrix(&gradients, length);
            Element {
                mass: [mass[(2, 2)], mass[(2, 6)]],
                damping: section.tangent(&straight) * inertia.beta,
                section,
                index,
                reference,
            }
        });
        Self {
            elements: elements.collect(),
            alpha: inertia.alpha,
        }
    }
}

impl Element {
    fn gather(&self, values: &[f64]) -> BeamCoordinates {
        BeamCoordinates::from_fn(|row, column| values[self.index[3 * column + row]])
    }

    fn coordinates(&self, q: &[f64]) -> BeamCoordinates {
        self.reference + self.gather(q)
    }

    /// The coordinates of the directors at the start and at the end, pair by pair.
    fn directors(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        (6..12).map(|i| [self.index[i], self.index[12 + i]])
    }
}

impl Force for WireDirectors {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for element in &self.elements {
            let strain = element.section.force(&element.coordinates(motion.q));
            let rates = SVector::<f64, 24>::from_column_slice(element.gather(motion.v).as_slice());
            let damping = element.damping * rates;
            for ((&index, strain), damping) in element.index.iter().zip(strain.as_slice()).zip(&damping) {
                force[index] -= strain + damping;
            }
            let [own, other] = element.mass.map(|mass| self.alpha * mass);
            for [a, b] in element.directors() {
                force[a] -= own * motion.v[a] + other * motion.v[b];
                force[b] -= other * motion.v[a] + own * motion.v[b];
            }
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for element in &self.elements {
            let strain = element.section.tangent(&element.coordinates(motion.q));
            let mut tangent: SMatrix<f64, 24, 24> = strain * weights.q + element.damping * weights.v;
            let [own, other] = element.mass.map(|mass| weights.v * self.alpha * mass);
            for a in 6..12 {
                let b = a + 12;
                for (row, column, value) in [(a, a, own), (b, b, own), (a, b, other), (b, a, other)] {
                    tangent[(row, column)] += value;
                }
            }
            // Symmetric: column by column is row by row.
            blocks.add(&element.index, &element.index, tangent.as_slice());
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for element in &self.elements {
            let [own, other] = element.mass;
            for index in element.directors() {
                blocks.add(&index, &index, &[own, other, other, own]);
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let energy = |element: &Element| element.section.energy(&element.coordinates(motion.q));
        self.elements.iter().map(energy).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NodeMap;
    use ancf::BeamStiffness;
    use dynamics::State;
    use dynamics::testing::{LawTrio, plain_layout};

    const STIFFNESS: BeamStiffness = BeamStiffness {
        axial: 2.0e3,
        shear: [1.1e3, 0.9e3],
        torsion: 700.0,
        bending: [1.5e3, 800.0],
        section: [2.1e3, 1.8e3, 1.3e3],
    };

    /// Two uneven elements far from the origin.
    fn wire() -> WireDirectors {
        let (start, along) = (
            Vector3::new(900.0, 0.2, 5.3),
            Vector3::new(1.0, 0.02, -0.01).normalize(),
        );
        let geometry = WireGeometry::straight(start, along, &[1.1, 1.4], |node| NodeMap::spatial(12 * node));
        let directors: Vec<Directors> = (0..3).map(|node| Directors::across(&along, 12 * node + 6)).collect();
        let inertia = DirectorInertia {
            section: 0.02,
            alpha: 0.3,
            beta: 0.05,
        };
        WireDirectors::new(&geometry, &directors, inertia, |length| {
            BeamSection::new(&STIFFNESS, length)
        })
    }

    fn state() -> State {
        let mut state = State::at_rest(36, 0, Vec::new());
        for i in 0..36 {
            state.q[i] = 0.1 * (1.7 * i as f64).sin();
            state.v[i] = 0.4 * (2.3 * i as f64 + 1.0).cos();
        }
        state
    }

    /// Rounding 1e-16 U/h against truncation h².
    const TRIO: LawTrio = LawTrio {
        q_step: 1e-5,
        v_step: 1e-5,
        tolerance: 1e-7,
    };

    fn force(wire: &mut WireDirectors, state: &State) -> SVector<f64, 36> {
        let mut force = SVector::<f64, 36>::zeros();
        wire.add_force(&state.motion(&[]), force.as_mut_slice());
        force
    }

    #[test]
    fn the_straight_wire_of_beams_is_without_force() {
        let rest = State::at_rest(36, 0, Vec::new());
        // Rounding of positions, 1e-13 m at 900 m, against 12 EI/l³ and 1e4 N/m.
        assert!(force(&mut wire(), &rest).amax() < 1e-8);
        assert!(wire().energy(&rest.motion(&[])) < 1e-20);
    }

    #[test]
    fn the_force_at_rest_is_the_negative_gradient_of_the_energy() {
        TRIO.assert_energy(&mut wire(), &plain_layout(36), &state());
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_force_by_positions_and_velocities() {
        TRIO.assert(&mut wire(), &plain_layout(36), &state());
    }
}
