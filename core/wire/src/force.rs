//! The forces of a wire: strain, weight, damping, inertia.
use super::batch::Batch;
use super::enrichment::Products;
use super::geometry::WireGeometry;
use super::layer::Layers;
use ancf::{AxialLaw, BendingLaw, CableSection, Length, Slopes, Tangent, bending_matrix, mass_matrix, tension_matrix};
use dynamics::{Blocks, ByRange, Force, Motion, OnePass, Weights};
use nalgebra::Matrix4;
use std::ops::Range;
use std::sync::Arc;

/// Parameters of a wire's cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireSection {
    /// `EA`, N.
    pub axial_stiffness: f64,
    /// `EI`, N·m²; 0 is a string.
    pub bending_stiffness: f64,
    /// `m`, kg per metre of the tensioned wire.
    pub mass_per_length: f64,
    /// `T`, the nominal tension that element lengths belong to, N.
    pub tension: f64,
}

/// Rayleigh damping on the static transverse tangent, for all components of the motion:
///
/// ```text
/// D = α M + β (T ∫ s,ₓ s,ₓᵀ dx + EI ∫ s,ₓₓ s,ₓₓᵀ dx)
/// ```
///
/// The axial stiffness is left out: `β EA` would damp longitudinal waves a thousandfold more than transverse ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh {
    /// `α`, 1/s.
    pub alpha: f64,
    /// `β`, s.
    pub beta: f64,
}

/// A wire as a contribution to a system: strain, weight, Rayleigh damping and mass of all its elements and enrichments.
#[derive(Clone, Debug)]
pub struct Wire {
    geometry: Arc<WireGeometry>,
    section: WireSection,
    laws: (AxialLaw, BendingLaw),
    damping: Rayleigh,
    gravity: f64,
    /// `h²/6 · T`, N·s²: see [`Wire::with_mass_correction`].
    correction: f64,
    pub(super) constants: Constants,
    /// True for strain of first order, see [`Wire::linearised`].
    linear: bool,
    elements: Vec<Element>,
    pub(super) batch: Batch,
    pub(super) layers: Layers,
}

/// Constants of all elements of a wire.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    pub cable: CableSection,
    /// Weight per length at nominal tension, N/m.
    pub weight: f64,
    /// `T` and `EI` as weights of the integrals.
    pub stiffness: Products<f64>,
    /// The weights of `D`.
    pub damping: Products<f64>,
    /// The weights of `M′`.
    pub mass: Products<f64>,
}

impl Constants {
    /// The weights of `D` and `M′` together.
    pub fn rates(&self, of_damping: f64, of_mass: f64) -> Products<f64> {
        let sum = |part: fn(&Products<f64>) -> f64| of_damping * part(&self.damping) + of_mass * part(&self.mass);
        Products {
            mass: sum(|weights| weights.mass),
            tension: sum(|weights| weights.tension),
            bending: sum(|weights| weights.bending),
        }
    }
}

/// Reference of one element.
#[derive(Clone, Copy, Debug)]
struct Element {
    length: f64,
    reference: Slopes,
}

/// All coordinates.
const EVERYWHERE: Range<usize> = 0..usize::MAX;

impl Wire {
    /// A wire of `section` along `geometry` in the gravity field `gravity` (m/s², downwards).
    #[must_use]
    pub fn new(
        section: WireSection,
        damping: Rayleigh,
        laws: (AxialLaw, BendingLaw),
        gravity: f64,
        geometry: Arc<WireGeometry>,
    ) -> Self {
        Self::assembled(section, damping, laws, gravity, 0.0, geometry)
    }

    fn assembled(
        section: WireSection,
        damping: Rayleigh,
        laws: (AxialLaw, BendingLaw),
        gravity: f64,
        correction: f64,
        geometry: Arc<WireGeometry>,
    ) -> Self {
        let elements = (geometry.lengths().iter().enumerate())
            .map(|(i, &length)| Element {
                length,
                reference: Slopes::new(geometry.strained_reference(i), Length::new(length)),
            })
            .collect();
        let constants = Constants {
            cable: CableSection::new(
                section.axial_stiffness,
                section.bending_stiffness,
                section.tension,
                laws,
            ),
            weight: section.mass_per_length * gravity,
            stiffness: Products {
                mass: 0.0,
                tension: section.tension,
                bending: section.bending_stiffness,
            },
            damping: Products {
                mass: damping.alpha * section.mass_per_length,
                tension: damping.beta * section.tension,
                bending: damping.beta * section.bending_stiffness,
            },
            mass: Products {
                mass: section.mass_per_length,
                tension: -correction,
                bending: 0.0,
            },
        };
        Self {
            batch: Batch::new(&geometry, &constants),
            layers: Layers::new(&geometry, &constants),
            geometry,
            section,
            laws,
            damping,
            gravity,
            correction,
            constants,
            linear: false,
            elements,
        }
    }

    /// Wire of the same section on another geometry: other element lengths, or another configuration as the reference.
    #[must_use]
    pub fn with_geometry(&self, geometry: Arc<WireGeometry>) -> Self {
        let Self {
            section,
            damping,
            laws,
            gravity,
            correction,
            ..
        } = *self;
        Self::assembled(section, damping, laws, gravity, correction, geometry)
    }

    /// Corrects the inertia for the time step `h` (s):
    ///
    /// ```text
    /// M′ = M − (h²/6) ∫ T s,ₓ s,ₓᵀ dx
    /// ```
    ///
    /// `M′` cancels the leading dispersion error of the trapezoidal rule for transverse waves, which makes `ω` too low
    /// by `(ω h)²/12` with `ω² M = K`. Weight and damping keep `M`. `M′` is positive definite for `h` below 0.378
    /// element lengths per wave speed along a wire held at its ends, and below 0.2565 along one with freely moving
    /// ends.
    #[must_use]
    pub fn with_mass_correction(self, h: f64) -> Self {
        let correction = h * h / 6.0 * self.section.tension;
        let Self {
            section,
            damping,
            laws,
            gravity,
            ..
        } = self;
        Self::assembled(section, damping, laws, gravity, correction, self.geometry)
    }

    /// Wire without bending stiffness, for bending by other contributions.
    #[must_use]
    pub fn without_bending(&self) -> Self {
        let section = WireSection {
            bending_stiffness: 0.0,
            ..self.section
        };
        let geometry = Arc::clone(&self.geometry);
        Self::assembled(
            section,
            self.damping,
            self.laws,
            self.gravity,
            self.correction,
            geometry,
        )
    }

    /// Linearised wire: strain linear in the displacements from the reference, no strain force there; none if the laws
    /// are not in closed form.
    #[must_use]
    pub fn linearised(&self) -> Option<Self> {
        self.constants.cable.is_beam().then(|| {
            let mut wire = self.clone();
            wire.linear = true;
            wire.batch.linearise();
            wire
        })
    }

    /// The geometry.
    #[must_use]
    pub fn geometry(&self) -> &Arc<WireGeometry> {
        &self.geometry
    }

    /// The section.
    #[must_use]
    pub fn section(&self) -> &WireSection {
        &self.section
    }

    /// Axial force of an element, N, the mean over the element.
    #[must_use]
    pub fn tension(&self, element: usize, q: &[f64]) -> f64 {
        self.constants.cable.axial.tension(&self.slopes(element, q))
    }

    /// Strain energy, J, enrichments included.
    #[must_use]
    pub fn strain_energy(&self, q: &[f64]) -> f64 {
        let Constants { cable, stiffness, .. } = &self.constants;
        let energy = |i: usize| {
            let Element { length, reference } = &self.elements[i];
            if self.linear {
                let change = self.change(i, q);
                0.5 * change.dot(&cable.slope_force_about(Length::new(*length), reference, &change))
            } else {
                cable.slope_energy(*length, &self.slopes(i, q))
            }
        };
        let elements: f64 = (0..self.elements.len()).map(energy).sum();
        elements + self.layers.energy(&self.geometry, stiffness, q)
    }

    fn slopes(&self, element: usize, q: &[f64]) -> Slopes {
        self.elements[element].reference.and(&self.change(element, q))
    }

    /// Change of the slopes from the reference.
    fn change(&self, element: usize, q: &[f64]) -> Slopes {
        let nodes = self.geometry.nodes();
        let (r1, r1_x) = nodes[element].map.gather(q);
        let (r2, r2_x) = nodes[element + 1].map.gather(q);
        Slopes::new([r1, r1_x, r2, r2_x], Length::new(self.elements[element].length))
    }

    /// Adds one component-wise matrix (equal for x, y, z) per element, and its layers.
    pub(super) fn add_constant(&self, weights: &Products<f64>, blocks: &mut Blocks<'_>) {
        let nodes = self.geometry.nodes();
        for (i, element) in self.elements.iter().enumerate() {
            let matrix = element_matrix(element.length, weights);
            let (a, b) = (&nodes[i].map, &nodes[i + 1].map);
            for axis in 0..3 {
                let index = [a.position(axis), a.slope(axis), b.position(axis), b.slope(axis)];
                add_selected(blocks, &index, |row, column| matrix[(row, column)]);
            }
        }
        self.layers.add_blocks(&self.geometry, weights, blocks);
    }

    /// Adds the tangent of the strain with `weight` and constant matrices with the weights `rates`, for any laws and
    /// coordinates.
    pub(super) fn add_tangents_of_elements(
        &self,
        motion: &Motion<'_>,
        weight: f64,
        rates: &Products<f64>,
        blocks: &mut Blocks<'_>,
    ) {
        let nodes = self.geometry.nodes();
        for (i, element) in self.elements.iter().enumerate() {
            let slopes = self.slopes(i, motion.q);
            let mut tangent: Tangent = self.constants.cable.node_tangent(element.length, &slopes) * weight;
            let rates = element_matrix(element.length, rates);
            for row in 0..4 {
                for column in 0..4 {
                    for axis in 0..3 {
                        tangent[(3 * row + axis, 3 * column + axis)] += rates[(row, column)];
                    }
                }
            }
            let (a, b) = (&nodes[i].map, &nodes[i + 1].map);
            let index: [Option<usize>; 12] = std::array::from_fn(|k| {
                let (map, axis) = (if k < 6 { a } else { b }, k % 3);
                if k % 6 < 3 { map.position(axis) } else { map.slope(axis) }
            });
            if index.iter().all(Option::is_some) {
                // Symmetric: column by column is row by row.
                blocks.add(
                    &index.map(Option::unwrap_or_default),
                    &index.map(Option::unwrap_or_default),
                    tangent.as_slice(),
                );
            } else {
                add_selected(blocks, &index, |row, column| tangent[(row, column)]);
            }
        }
    }
}

/// Adds the entries of a matrix whose row and column exist.
pub(super) fn add_selected(blocks: &mut Blocks<'_>, index: &[Option<usize>], value: impl Fn(usize, usize) -> f64) {
    let (mut kept, mut indices, mut count) = ([0; 12], [0; 12], 0);
    for (i, index) in index.iter().enumerate() {
        if let Some(index) = index {
            (kept[count], indices[count]) = (i, *index);
            count += 1;
        }
    }
    let mut values = [0.0; 144];
    for row in 0..count {
        for column in 0..count {
            values[row * count + column] = value(kept[row], kept[column]);
        }
    }
    blocks.add(&indices[..count], &indices[..count], &values[..count * count]);
}

/// The integrals with these weights over an element of `length` in m.
pub(super) fn element_matrix(length: f64, weights: &Products<f64>) -> Matrix4<f64> {
    mass_matrix(length) * weights.mass
        + tension_matrix(length) * weights.tension
        + bending_matrix(length) * weights.bending
}

impl Force for Wire {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.batch.add_force(EVERYWHERE, motion, None, force);
        self.layers.add_force(EVERYWHERE, motion, None, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.add_dynamic_tangent(motion, weights, 0.0, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        self.add_constant(&self.constants.mass, blocks);
    }

    /// Strain energy and the weight's potential relative to the reference, J.
    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let (nodes, weight) = (self.geometry.nodes(), self.constants.weight);
        let elements: f64 = self
            .elements
            .iter()
            .enumerate()
            .map(|(i, element)| {
                let l = element.length;
                let (r1, r1_x) = nodes[i].map.gather(motion.q);
                let (r2, r2_x) = nodes[i + 1].map.gather(motion.q);
                0.5 * l * (r1.z + r2.z) + l * l / 12.0 * (r1_x.z - r2_x.z)
            })
            .sum();
        self.strain_energy(motion.q) + weight * (elements + self.layers.weight_lift(motion.q))
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for Wire {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_dynamic_force_within(EVERYWHERE, motion, v_dot, force);
    }

    fn add_dynamic_tangent(
        &mut self,
        motion: &Motion<'_>,
        weights: Weights,
        mass_weight: f64,
        blocks: &mut Blocks<'_>,
    ) {
        let stiffness = self.constants.stiffness;
        let rates = self.constants.rates(weights.v, mass_weight);
        // The tangent of a linear wire is that of its reference.
        let reference = vec![0.0; if self.linear { motion.q.len() } else { 0 }];
        let motion = &Motion {
            q: if self.linear { &reference } else { motion.q },
            ..*motion
        };
        if !self.batch.add_tangent(motion, (weights, mass_weight), blocks) {
            self.add_tangents_of_elements(motion, weights.q, &rates, blocks);
        }
        let weights = Products {
            mass: rates.mass,
            tension: weights.q * stiffness.tension + rates.tension,
            bending: weights.q * stiffness.bending + rates.bending,
        };
        self.layers.add_blocks(&self.geometry, &weights, blocks);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        if self.batch.ascends() { Some(self) } else { None }
    }
}

impl ByRange for Wire {
    fn is_linear(&self) -> bool {
        self.linear
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.batch.add_force(range.clone(), motion, Some(v_dot), force);
        self.layers.add_force(range, motion, Some(v_dot), force);
    }
}
