//! The forces of a wire's enrichments.
use super::enrichment::{Enrichment, LayerIntegrals, Products, pair_integrals};
use super::force::Constants;
use super::geometry::WireGeometry;
use dynamics::{Blocks, Motion};
use nalgebra::{Vector3, Vector4};
use std::ops::Range;

/// Contribution of all enrichments of a wire, linearised at the static tension `T` of each element:
///
/// ```text
/// U = Σ a kᵀ (d·e) + ½ a² K,   k = ∫ T ψ,ₓ s,ₓ + EI ψ,ₓₓ s,ₓₓ dx,   K = ∫ T ψ,ₓ² + EI ψ,ₓₓ² dx
/// ```
///
/// with products of two layers that share an element; mass and damping likewise.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    layers: Vec<ElementLayer>,
    pairs: Vec<LayerPair>,
    rows: Vec<LayerRow>,
    entries: Vec<Entry>,
}

/// Stiffness, damping and mass between two coordinates.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    index: usize,
    /// Stiffness, damping and mass: N/m, N·s/m and kg for two coordinates in m.
    weights: [f64; 3],
}

/// Row of one enrichment, with its entries up to `end`.
#[derive(Clone, Copy, Debug)]
struct LayerRow {
    /// Reference value of the enrichment, –.
    reference: f64,
    /// Generalised force on the enrichment at zero coordinates, without its own part `K a`, N·m.
    load: f64,
    own: Entry,
    end: usize,
    /// Smallest and largest of all coordinates concerned.
    span: [usize; 2],
}

/// One enrichment on one of its elements.
#[derive(Clone, Debug)]
struct ElementLayer {
    element: usize,
    index: usize,
    reference: f64,
    direction: Vector3<f64>,
    /// Reference of the element, relative to its first node, along `direction`.
    element_reference: Vector4<f64>,
    integrals: LayerIntegrals,
}

/// Two enrichments on the same element.
#[derive(Clone, Debug)]
struct LayerPair {
    indices: [usize; 2],
    references: [f64; 2],
    /// Integrals times the scalar product of the directions.
    products: Products<f64>,
}

impl ElementLayer {
    /// The element's four coordinates along the direction of the layer.
    fn along(&self, geometry: &WireGeometry, values: &[f64]) -> Vector4<f64> {
        let nodes = geometry.nodes();
        let (r1, r1_x) = nodes[self.element].map.gather(values);
        let (r2, r2_x) = nodes[self.element + 1].map.gather(values);
        let d = &self.direction;
        Vector4::new(d.dot(&r1), d.dot(&r1_x), d.dot(&r2), d.dot(&r2_x))
    }

    /// Coordinates of the element that the layer couples to: number of the polynomial, axis, index. Axes across the
    /// layer's direction are left out, because an exact zero belongs to no pattern.
    fn coordinates(&self, geometry: &WireGeometry) -> impl Iterator<Item = (usize, usize, usize)> + use<'_> {
        let nodes = geometry.nodes();
        let (a, b) = (nodes[self.element].map, nodes[self.element + 1].map);
        (0..3).flat_map(move |axis| {
            let index = [a.position(axis), a.slope(axis), b.position(axis), b.slope(axis)];
            let known = index.map(|index| index.filter(|_| self.direction[axis] != 0.0));
            let numbered = known.into_iter().enumerate();
            numbered.filter_map(move |(function, index)| Some((function, axis, index?)))
        })
    }
}

/// Adds to the entry of the same coordinate from number `first` on, or a new one.
fn add_entry(entries: &mut Vec<Entry>, first: usize, entry: Entry) {
    match entries[first..].iter_mut().find(|known| known.index == entry.index) {
        Some(known) => {
            for (sum, weight) in known.weights.iter_mut().zip(entry.weights) {
                *sum += weight;
            }
        }
        None => entries.push(entry),
    }
}

impl Layers {
    pub fn new(geometry: &WireGeometry, constants: &Constants) -> Self {
        let (mut layers, mut pairs) = (Vec::new(), Vec::new());
        for (element, &length) in geometry.lengths().iter().enumerate() {
            let reference = geometry.strained_reference(element);
            let here: Vec<_> = geometry.layers(element).collect();
            let tension_share = geometry.tension_shares().get(element).copied().unwrap_or(1.0);
            for (i, (enrichment, end)) in here.iter().enumerate() {
                let mut integrals = LayerIntegrals::new(*end, enrichment.bending_length, length);
                integrals.shape.tension *= tension_share;
                integrals.own.tension *= tension_share;
                layers.push(ElementLayer {
                    element,
                    index: enrichment.index,
                    reference: enrichment.reference,
                    direction: enrichment.direction,
                    element_reference: Vector4::from_fn(|j, _| reference[j].dot(&enrichment.direction)),
                    integrals,
                });
                for (other, other_end) in &here[i + 1..] {
                    let ends = (*end, *other_end);
                    let bending_lengths = (enrichment.bending_length, other.bending_length);
                    let cosine = enrichment.direction.dot(&other.direction);
                    let products = pair_integrals(ends, bending_lengths, length);
                    pairs.push(LayerPair {
                        indices: [enrichment.index, other.index],
                        references: [enrichment.reference, other.reference],
                        products: Products {
                            mass: cosine * products.mass,
                            tension: cosine * tension_share * products.tension,
                            bending: cosine * products.bending,
                        },
                    });
                }
            }
        }
        let mut all = Self {
            layers,
            pairs,
            rows: Vec::new(),
            entries: Vec::new(),
        };
        for enrichment in geometry.enrichments() {
            all.add_row(geometry, enrichment, constants);
        }
        all
    }

    /// Collects the entries of one enrichment.
    fn add_row(&mut self, geometry: &WireGeometry, enrichment: &Enrichment, constants: &Constants) {
        let index = enrichment.index;
        let all = [&constants.stiffness, &constants.damping, &constants.mass];
        let mut own = Entry {
            index,
            weights: [0.0; 3],
        };
        let (first, mut load) = (self.entries.len(), 0.0);
        for layer in self.layers.iter().filter(|layer| layer.index == index) {
            let shape = all.map(|weights| layer.integrals.shape.weighted(weights));
            for (sum, weights) in own.weights.iter_mut().zip(all) {
                *sum += layer.integrals.own.weighted(weights);
            }
            load += shape[0].dot(&layer.element_reference);
            load += constants.weight * layer.direction.z * layer.integrals.area;
            for (function, axis, index) in layer.coordinates(geometry) {
                let weights = shape.map(|shape| shape[function] * layer.direction[axis]);
                add_entry(&mut self.entries, first, Entry { index, weights });
            }
        }
        // Pairs count once, with the enrichment that comes first.
        for pair in self.pairs.iter().filter(|pair| pair.indices[0] == index) {
            let weights = all.map(|weights| pair.products.weighted(weights));
            load += weights[0] * pair.references[1];
            let index = pair.indices[1];
            add_entry(&mut self.entries, first, Entry { index, weights });
        }
        self.rows.push(LayerRow {
            reference: enrichment.reference,
            load,
            own,
            end: self.entries.len(),
            span: [
                self.entries[first..]
                    .iter()
                    .fold(index, |least, entry| least.min(entry.index)),
                self.entries[first..]
                    .iter()
                    .fold(index, |most, entry| most.max(entry.index)),
            ],
        });
    }

    /// Strain energy, J.
    pub fn energy(&self, geometry: &WireGeometry, stiffness: &Products<f64>, q: &[f64]) -> f64 {
        let layers: f64 = (self.layers.iter())
            .map(|layer| {
                let a = layer.reference + q[layer.index];
                let e = layer.element_reference + layer.along(geometry, q);
                let own = layer.integrals.own.weighted(stiffness);
                a * layer.integrals.shape.weighted(stiffness).dot(&e) + 0.5 * own * a * a
            })
            .sum();
        let pairs: f64 = (self.pairs.iter())
            .map(|pair| {
                let [a, b] = [0, 1].map(|i| pair.references[i] + q[pair.indices[i]]);
                pair.products.weighted(stiffness) * a * b
            })
            .sum();
        layers + pairs
    }

    /// `∫ Δz dx` of the layers alone, m²: their rise in weight potential per weight per length.
    pub fn weight_lift(&self, q: &[f64]) -> f64 {
        (self.layers.iter())
            .map(|layer| layer.direction.z * layer.integrals.area * q[layer.index])
            .sum()
    }

    /// Adds the forces of all layers, with inertia if accelerations are given. Only the entries `within` need be right.
    pub fn add_force(&self, within: Range<usize>, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        let mut end = 0;
        for row in &self.rows {
            let first = std::mem::replace(&mut end, row.end);
            if row.span[1] < within.start || row.span[0] >= within.end {
                continue;
            }
            let at = |index: usize| {
                let acceleration = v_dot.map_or(0.0, |v_dot| v_dot[index]);
                [motion.q[index], motion.v[index], acceleration]
            };
            let product = |[k, d, m]: &[f64; 3], [q, v, v_dot]: [f64; 3]| k * q + d * v + m * v_dot;
            let mut own = at(row.own.index);
            own[0] += row.reference;
            let mut sum = row.load + product(&row.own.weights, own);
            for entry in &self.entries[first..row.end] {
                sum += product(&entry.weights, at(entry.index));
                // The references of other coordinates are part of `load`; the layer's own one counts here.
                force[entry.index] -= product(&entry.weights, own);
            }
            force[row.own.index] -= sum;
        }
    }

    /// Adds the matrix with these weights.
    pub fn add_blocks(&self, geometry: &WireGeometry, weights: &Products<f64>, blocks: &mut Blocks<'_>) {
        for layer in &self.layers {
            let own = [layer.integrals.own.weighted(weights)];
            blocks.add(&[layer.index], &[layer.index], &own);
            let coupling = layer.integrals.shape.weighted(weights);
            for (function, axis, index) in layer.coordinates(geometry) {
                let value = [coupling[function] * layer.direction[axis]];
                blocks.add(&[layer.index], &[index], &value);
                blocks.add(&[index], &[layer.index], &value);
            }
        }
        for pair in &self.pairs {
            let ([a, b], value) = (pair.indices, [pair.products.weighted(weights)]);
            blocks.add(&[a], &[b], &value);
            blocks.add(&[b], &[a], &value);
        }
    }
}
