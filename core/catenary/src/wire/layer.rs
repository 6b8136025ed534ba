//! The forces of a wire's enrichments.
use super::enrichment::{LayerIntegrals, Products, pair_integrals};
use super::geometry::WireGeometry;
use dynamics::{Blocks, Motion};
use nalgebra::{Vector3, Vector4};

/// What all enrichments of a wire contribute, linearised at the nominal tension:
///
/// ```text
/// U = Σ a kᵀ (d·e) + ½ a² K,   k = ∫ T ψ,ₓ s,ₓ + EI ψ,ₓₓ s,ₓₓ dx,   K = ∫ T ψ,ₓ² + EI ψ,ₓₓ² dx
/// ```
///
/// with products of two layers where they share an element; mass and damping likewise.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    layers: Vec<ElementLayer>,
    pairs: Vec<LayerPair>,
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
    /// With the scalar product of the directions.
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
}

impl Layers {
    pub fn new(geometry: &WireGeometry) -> Self {
        let (mut layers, mut pairs) = (Vec::new(), Vec::new());
        for (element, &length) in geometry.lengths().iter().enumerate() {
            let reference = geometry.local_reference(element);
            let here: Vec<_> = geometry.layers(element).collect();
            for (i, (enrichment, end)) in here.iter().enumerate() {
                layers.push(ElementLayer {
                    element,
                    index: enrichment.index,
                    reference: enrichment.reference,
                    direction: enrichment.direction,
                    element_reference: Vector4::from_fn(|j, _| reference[j].dot(&enrichment.direction)),
                    integrals: LayerIntegrals::new(*end, enrichment.bending_length, length),
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
                            tension: cosine * products.tension,
                            bending: cosine * products.bending,
                        },
                    });
                }
            }
        }
        Self { layers, pairs }
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

    /// `∫ Δz dx` of the layers alone, m²: what their weight has gained, per weight per length.
    pub fn weight_lift(&self, q: &[f64]) -> f64 {
        (self.layers.iter())
            .map(|layer| layer.direction.z * layer.integrals.area * q[layer.index])
            .sum()
    }

    /// Adds the forces of strain and damping (`weights` in this order) and of the weight per length `load` in N/m.
    pub fn add_forces(
        &self,
        geometry: &WireGeometry,
        weights: (&Products<f64>, &Products<f64>),
        load: f64,
        motion: &Motion<'_>,
        force: &mut [f64],
    ) {
        let (stiffness, damping) = weights;
        let nodes = geometry.nodes();
        for layer in &self.layers {
            let (shape, own) = (&layer.integrals.shape, &layer.integrals.own);
            let (a, rate) = (layer.reference + motion.q[layer.index], motion.v[layer.index]);
            let e = layer.element_reference + layer.along(geometry, motion.q);
            let e_rate = layer.along(geometry, motion.v);
            let (k, d) = (shape.weighted(stiffness), shape.weighted(damping));
            let on_nodes = -(k * a + d * rate);
            let [f1, m1, f2, m2] = [0, 1, 2, 3].map(|i| layer.direction * on_nodes[i]);
            nodes[layer.element].map.scatter(&f1, &m1, force);
            nodes[layer.element + 1].map.scatter(&f2, &m2, force);
            let elastic = k.dot(&e) + own.weighted(stiffness) * a;
            let damped = d.dot(&e_rate) + own.weighted(damping) * rate;
            let weight = load * layer.direction.z * layer.integrals.area;
            force[layer.index] -= elastic + damped + weight;
        }
        for pair in &self.pairs {
            let (k, d) = (pair.products.weighted(stiffness), pair.products.weighted(damping));
            for (to, from) in [(0, 1), (1, 0)] {
                let source = pair.indices[from];
                let (a, rate) = (pair.references[from] + motion.q[source], motion.v[source]);
                force[pair.indices[to]] -= k * a + d * rate;
            }
        }
    }

    /// Adds the matrix with these weights.
    pub fn add_blocks(&self, geometry: &WireGeometry, weights: &Products<f64>, blocks: &mut Blocks<'_>) {
        let nodes = geometry.nodes();
        for layer in &self.layers {
            let own = [layer.integrals.own.weighted(weights)];
            blocks.add(&[layer.index], &[layer.index], &own);
            let coupling = layer.integrals.shape.weighted(weights);
            let (a, b) = (&nodes[layer.element].map, &nodes[layer.element + 1].map);
            for axis in 0..3 {
                let index = [a.position(axis), a.slope(axis), b.position(axis), b.slope(axis)];
                for (i, index) in index.into_iter().enumerate() {
                    // An exact zero stays in no pattern: a vertical layer knows no x.
                    let value = [coupling[i] * layer.direction[axis]];
                    if let Some(index) = index.filter(|_| layer.direction[axis] != 0.0) {
                        blocks.add(&[layer.index], &[index], &value);
                        blocks.add(&[index], &[layer.index], &value);
                    }
                }
            }
        }
        for pair in &self.pairs {
            let ([a, b], value) = (pair.indices, [pair.products.weighted(weights)]);
            blocks.add(&[a], &[b], &value);
            blocks.add(&[b], &[a], &value);
        }
    }
}
