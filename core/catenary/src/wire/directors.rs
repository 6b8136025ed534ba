//! What turns a wire of cable elements into one of beam elements: two directors per node.
use super::geometry::WireGeometry;
use crate::ancf::{BeamCoordinates, BeamSection, BeamTangent};
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::{SMatrix, SVector, Vector3};
use std::sync::Arc;

/// The directors of a node: the gradients `r,ᵧ` and `r,𝓏` of the fully parameterised beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directors {
    /// Their references, –.
    pub reference: [Vector3<f64>; 2],
    /// First of six consecutive coordinates: `x, y, z` of the change of `r,ᵧ`, then of `r,𝓏`.
    pub first: usize,
}

impl Directors {
    /// Unit directors across the direction `along` of the wire, `r,𝓏` as upright as can be.
    #[must_use]
    pub fn across(along: &Vector3<f64>, first: usize) -> Self {
        let along = along.normalize();
        let y = Vector3::z().cross(&along).normalize();
        Self {
            reference: [y, along.cross(&y)],
            first,
        }
    }

    /// The same with their present values as the reference.
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

/// Shear, torsion, bending and strain of the cross-section of a wire of beam elements, with the inertia of its directors, as a
/// contribution beside a [`crate::Wire`] without bending stiffness: the axis is that wire, so contact, droppers and supports see
/// what they see of a cable.
#[derive(Clone, Debug)]
pub struct WireDirectors {
    geometry: Arc<WireGeometry>,
    directors: Vec<Directors>,
    inertia: DirectorInertia,
    elements: Vec<Element>,
}

#[derive(Clone, Debug)]
struct Element {
    section: BeamSection,
    /// Where the 24 coordinates stand.
    index: [usize; 24],
    /// Coordinates of the reference, positions relative to the first node.
    reference: BeamCoordinates,
    damping: BeamTangent,
}

impl WireDirectors {
    /// The directors of the nodes of `geometry`, in space; `section` makes an element of a length in m.
    ///
    /// # Panics
    /// When the nodes are not spatial, or there are not as many directors.
    #[must_use]
    pub fn new(
        geometry: Arc<WireGeometry>,
        directors: Vec<Directors>,
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
            let (section, axes) = (section(length), nalgebra::Matrix3::identity());
            let mut straight = BeamCoordinates::zeros();
            straight[(0, 4)] = length;
            for end in 0..2 {
                straight.fixed_columns_mut::<3>(4 * end + 1).copy_from(&axes);
            }
            Element {
                damping: section.tangent(&straight) * inertia.beta,
                section,
                index,
                reference,
            }
        });
        Self {
            elements: elements.collect(),
            geometry: Arc::clone(&geometry),
            directors,
            inertia,
        }
    }

    /// The directors, node after node.
    #[must_use]
    pub fn directors(&self) -> &[Directors] {
        &self.directors
    }

    /// `∫ n nᵀ dm` for the linear polynomials of a director, kg·m².
    fn mass(&self, element: usize) -> [f64; 2] {
        let mass = self.inertia.section * self.geometry.lengths()[element] / 6.0;
        [2.0 * mass, mass]
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
        for (i, element) in self.elements.iter().enumerate() {
            let strain = element.section.force(&element.coordinates(motion.q));
            let rates = SVector::<f64, 24>::from_column_slice(element.gather(motion.v).as_slice());
            let damping = element.damping * rates;
            for ((&index, strain), damping) in element.index.iter().zip(strain.as_slice()).zip(&damping) {
                force[index] -= strain + damping;
            }
            let [own, other] = self.mass(i).map(|mass| self.inertia.alpha * mass);
            for [a, b] in element.directors() {
                force[a] -= own * motion.v[a] + other * motion.v[b];
                force[b] -= other * motion.v[a] + own * motion.v[b];
            }
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for (i, element) in self.elements.iter().enumerate() {
            let strain = element.section.tangent(&element.coordinates(motion.q));
            let mut tangent: SMatrix<f64, 24, 24> = strain * weights.q + element.damping * weights.v;
            let [own, other] = self.mass(i).map(|mass| weights.v * self.inertia.alpha * mass);
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
        for (i, element) in self.elements.iter().enumerate() {
            let [own, other] = self.mass(i);
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
