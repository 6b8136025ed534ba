//! The forces of a wire: strain, weight, damping, inertia.
use super::enrichment::Products;
use super::geometry::WireGeometry;
use super::layer::Layers;
use crate::ancf::{AxialLaw, BendingLaw, CableSection, Slopes, Tangent, bending_matrix, mass_matrix, tension_matrix};
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::{Matrix4, Vector3};
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
    cable: CableSection,
    damping: Rayleigh,
    gravity: f64,
    /// `h²/6 · T`, N·s²: see [`Wire::with_mass_correction`].
    correction: f64,
    elements: Vec<Element>,
    layers: Layers,
}

/// Reference of one element.
#[derive(Clone, Copy, Debug)]
struct Element {
    length: f64,
    reference: Slopes,
}

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
        let cable = CableSection::new(
            section.axial_stiffness,
            section.bending_stiffness,
            section.tension,
            laws,
        );
        let count = geometry.lengths().len();
        let elements = (0..count)
            .map(|i| {
                let length = geometry.lengths()[i];
                let [r1, r1_x, r2, r2_x] = geometry.local_reference(i);
                Element {
                    length,
                    reference: Slopes::new(&r1, &r1_x, &r2, &r2_x, length),
                }
            })
            .collect();
        let layers = Layers::new(&geometry);
        Self {
            geometry,
            section,
            laws,
            cable,
            damping,
            gravity,
            correction: 0.0,
            elements,
            layers,
        }
    }

    /// The same wire on another geometry: other element lengths, or another configuration as the reference.
    #[must_use]
    pub fn with_geometry(&self, geometry: Arc<WireGeometry>) -> Self {
        let wire = Self::new(self.section, self.damping, self.laws, self.gravity, geometry);
        Self {
            correction: self.correction,
            ..wire
        }
    }

    /// The same wire with its inertia corrected for the time step `h` (s):
    ///
    /// ```text
    /// M′ = M − (h²/6) ∫ T s,ₓ s,ₓᵀ dx
    /// ```
    ///
    /// which cancels the leading dispersion error of the trapezoidal rule for transverse waves. (The rule makes `ω` too low
    /// by `(ω h)²/12`, and `ω² M = K`.) Weight and damping keep `M`. `M′` is positive definite for `h` below about 0.31 element
    /// lengths per wave speed.
    #[must_use]
    pub fn with_mass_correction(self, h: f64) -> Self {
        Self {
            correction: h * h / 6.0 * self.section.tension,
            ..self
        }
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

    /// Axial force of an element, N; its mean over the element.
    #[must_use]
    pub fn tension(&self, element: usize, q: &[f64]) -> f64 {
        self.cable.axial.tension(&self.slopes(element, q))
    }

    /// Strain energy, J, enrichments included.
    #[must_use]
    pub fn strain_energy(&self, q: &[f64]) -> f64 {
        let stiffness = self.stiffness_weights();
        let elements: f64 = (0..self.elements.len())
            .map(|i| self.cable.slope_energy(self.elements[i].length, &self.slopes(i, q)))
            .sum();
        elements + self.layers.energy(&self.geometry, &stiffness, q)
    }

    /// `T` and `EI` as weights of the integrals.
    pub(super) fn stiffness_weights(&self) -> Products<f64> {
        Products {
            mass: 0.0,
            tension: self.section.tension,
            bending: self.section.bending_stiffness,
        }
    }

    /// The weights of `D`.
    fn damping_weights(&self) -> Products<f64> {
        Products {
            mass: self.damping.alpha * self.section.mass_per_length,
            tension: self.damping.beta * self.section.tension,
            bending: self.damping.beta * self.section.bending_stiffness,
        }
    }

    /// The weights of `M′`.
    fn mass_weights(&self) -> Products<f64> {
        Products {
            mass: self.section.mass_per_length,
            tension: -self.correction,
            bending: 0.0,
        }
    }

    fn slopes(&self, element: usize, q: &[f64]) -> Slopes {
        let Element { length, reference } = &self.elements[element];
        let nodes = self.geometry.nodes();
        let (r1, r1_x) = nodes[element].map.gather(q);
        let (r2, r2_x) = nodes[element + 1].map.gather(q);
        reference.plus(1.0, &Slopes::new(&r1, &r1_x, &r2, &r2_x, *length))
    }

    /// Adds one component-wise matrix (the same for x, y, z) per element, and its layers.
    pub(super) fn add_constant(&self, weights: &Products<f64>, blocks: &mut Blocks<'_>) {
        let nodes = self.geometry.nodes();
        for (i, element) in self.elements.iter().enumerate() {
            let matrix = mass_matrix(element.length) * weights.mass
                + tension_matrix(element.length) * weights.tension
                + bending_matrix(element.length) * weights.bending;
            let (a, b) = (&nodes[i].map, &nodes[i + 1].map);
            for axis in 0..3 {
                let index = [a.position(axis), a.slope(axis), b.position(axis), b.slope(axis)];
                add_selected(blocks, &index, |row, column| matrix[(row, column)]);
            }
        }
        self.layers.add_blocks(&self.geometry, weights, blocks);
    }
}

/// Adds the entries of a matrix whose row and column exist.
fn add_selected(blocks: &mut Blocks<'_>, index: &[Option<usize>], value: impl Fn(usize, usize) -> f64) {
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

/// The consistent mass of an element of length `l` times four node vectors, per mass per length.
#[inline(always)]
fn mass_times(l: f64, [r1, r1_x, r2, r2_x]: [&Vector3<f64>; 4]) -> [Vector3<f64>; 4] {
    let (y1, y2, c) = (r1_x * l, r2_x * l, l / 420.0);
    [
        (r1 * 156.0 + y1 * 22.0 + r2 * 54.0 - y2 * 13.0) * c,
        (r1 * 22.0 + y1 * 4.0 + r2 * 13.0 - y2 * 3.0) * (c * l),
        (r1 * 54.0 + y1 * 13.0 + r2 * 156.0 - y2 * 22.0) * c,
        (r1 * -13.0 - y1 * 3.0 - r2 * 22.0 + y2 * 4.0) * (c * l),
    ]
}

impl Force for Wire {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let nodes = self.geometry.nodes();
        let weight = self.section.mass_per_length * self.gravity;
        let damping = self.damping_weights();
        let (mut r1, mut r1_x) = nodes[0].map.gather(motion.q);
        let (mut v1, mut v1_x) = nodes[0].map.gather(motion.v);
        let (mut f1, mut m1) = (Vector3::zeros(), Vector3::zeros());
        for (i, element) in self.elements.iter().enumerate() {
            let next = &nodes[i + 1].map;
            let (r2, r2_x) = next.gather(motion.q);
            let (v2, v2_x) = next.gather(motion.v);
            let l = element.length;
            let slopes = element.reference.plus(1.0, &Slopes::new(&r1, &r1_x, &r2, &r2_x, l));
            let rates = Slopes::new(&v1, &v1_x, &v2, &v2_x, l);
            let total = self
                .cable
                .slope_force(l, &slopes)
                .plus(damping.tension * l, &rates.tension_gradient())
                .plus(damping.bending / l, &rates.bending_gradient());
            let mut e = total.on_nodes(l);
            let inertia = mass_times(l, [&v1, &v1_x, &v2, &v2_x]);
            for (e, inertia) in e.iter_mut().zip(&inertia) {
                *e += inertia * damping.mass;
            }
            // ∫ m g s dx
            let (half, moment) = (0.5 * weight * l, weight * l * l / 12.0);
            e[0].z += half;
            e[1].z += moment;
            e[2].z += half;
            e[3].z -= moment;
            nodes[i].map.scatter(&(f1 - e[0]), &(m1 - e[1]), force);
            (f1, m1) = (-e[2], -e[3]);
            (r1, r1_x, v1, v1_x) = (r2, r2_x, v2, v2_x);
        }
        nodes[self.elements.len()].map.scatter(&f1, &m1, force);
        let load = self.section.mass_per_length * self.gravity;
        let weights = (&self.stiffness_weights(), &damping);
        self.layers.add_forces(&self.geometry, weights, load, motion, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let damping = self.damping_weights();
        let nodes = self.geometry.nodes();
        for (i, element) in self.elements.iter().enumerate() {
            let slopes = self.slopes(i, motion.q);
            let mut tangent: Tangent = self.cable.node_tangent(element.length, &slopes) * weights.q;
            let rates: Matrix4<f64> = mass_matrix(element.length) * (weights.v * damping.mass)
                + tension_matrix(element.length) * (weights.v * damping.tension)
                + bending_matrix(element.length) * (weights.v * damping.bending);
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
        let stiffness = self.stiffness_weights();
        let weights = Products {
            mass: weights.v * damping.mass,
            tension: weights.q * stiffness.tension + weights.v * damping.tension,
            bending: weights.q * stiffness.bending + weights.v * damping.bending,
        };
        self.layers.add_blocks(&self.geometry, &weights, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        self.add_constant(&self.mass_weights(), blocks);
    }

    /// Strain energy and the weight's potential relative to the reference, J.
    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let nodes = self.geometry.nodes();
        let weight = self.section.mass_per_length * self.gravity;
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
}
