//! Geometry of a wire: nodes, element lengths, and the curve between them.
use super::enrichment::{End, Enrichment, Layer};
use super::node::{NodeMap, WireNode};
use crate::{CurveColumns, CurvePoint, WireCurve};
use ancf::ShapeFunctions;
use nalgebra::{Vector3, Vector4};

/// Reference and coordinates of a wire; immutable and shared by all that touch the wire.
///
/// The parameter `s` accumulates the element parameters: the arc length from the first node at nominal tension, m. The
/// coordinates of the system are displacements `u` from the reference, `r = S (e₀ + u)`, so that digits are kept far
/// from the origin and close to equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct WireGeometry {
    nodes: Vec<WireNode>,
    lengths: Vec<f64>,
    /// `s` of each node.
    starts: Vec<f64>,
    /// Ordered by node.
    enrichments: Vec<Enrichment>,
    /// The enrichments of node `i` are `first_enrichment[i] .. first_enrichment[i + 1]`.
    first_enrichment: Vec<usize>,
    /// Static tension of each element in units of the nominal one, –; empty where all have the nominal one.
    tension_shares: Vec<f64>,
    /// True where a node has a lateral coordinate.
    moves_sideways: bool,
}

/// A point of a wire, with its element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Location {
    pub element: usize,
    pub shape: ShapeFunctions,
    /// `x` from the element's first node, m.
    pub x: f64,
}

impl WireGeometry {
    /// A wire through `nodes` with elements of `lengths` (m, at nominal tension), one fewer than nodes. The enrichments
    /// are ordered by node.
    ///
    /// # Panics
    /// When the numbers do not fit, a length is not positive, or an enrichment has no node.
    #[must_use]
    pub fn new(nodes: Vec<WireNode>, lengths: Vec<f64>, enrichments: Vec<Enrichment>) -> Self {
        assert!(
            !lengths.is_empty() && nodes.len() == lengths.len() + 1,
            "{} nodes do not fit {} elements",
            nodes.len(),
            lengths.len()
        );
        for (element, &length) in lengths.iter().enumerate() {
            assert!(
                length > 0.0 && length.is_finite(),
                "element {element} has length {length} m"
            );
        }
        let mut starts = Vec::with_capacity(nodes.len());
        let mut s = 0.0;
        starts.push(s);
        for length in &lengths {
            s += length;
            starts.push(s);
        }
        assert!(
            enrichments.is_sorted_by_key(|enrichment| enrichment.node),
            "enrichments must be ordered by node"
        );
        for enrichment in &enrichments {
            let (node, layer) = (enrichment.node, enrichment.bending_length);
            assert!(
                node < nodes.len(),
                "no node {node} to enrich, there are {}",
                nodes.len()
            );
            assert!(layer >= 0.0, "bending length {layer} m at node {node}");
        }
        let moves_sideways = nodes
            .iter()
            .any(|node| node.map.position(1).or(node.map.slope(1)).is_some());
        let first_enrichment = (0..=nodes.len())
            .map(|node| enrichments.partition_point(|enrichment| enrichment.node < node))
            .collect();
        Self {
            nodes,
            lengths,
            starts,
            enrichments,
            first_enrichment,
            tension_shares: Vec::new(),
            moves_sideways,
        }
    }

    /// Wire with these static tensions of its elements in units of the nominal one, –; empty for the nominal one.
    ///
    /// # Panics
    /// When the numbers do not fit.
    #[must_use]
    pub fn with_tension_shares(self, tension_shares: Vec<f64>) -> Self {
        assert!(tension_shares.is_empty() || tension_shares.len() == self.lengths.len());
        Self { tension_shares, ..self }
    }

    /// Static tensions of the elements, as in [`WireGeometry::with_tension_shares`].
    #[must_use]
    pub fn tension_shares(&self) -> &[f64] {
        &self.tension_shares
    }

    /// A straight wire from `start` along the unit vector `direction`; `map` gives the coordinates of each node.
    #[must_use]
    pub fn straight(
        start: Vector3<f64>,
        direction: Vector3<f64>,
        lengths: &[f64],
        mut map: impl FnMut(usize) -> NodeMap,
    ) -> Self {
        let mut s = 0.0;
        let nodes = (0..=lengths.len())
            .map(|i| {
                let node = WireNode {
                    position: start + direction * s,
                    slope: direction,
                    map: map(i),
                };
                s += lengths.get(i).copied().unwrap_or(0.0);
                node
            })
            .collect();
        Self::new(nodes, lengths.to_vec(), Vec::new())
    }

    /// Wire with other `enrichments`.
    #[must_use]
    pub fn with_enrichments(&self, enrichments: Vec<Enrichment>) -> Self {
        Self::new(self.nodes.clone(), self.lengths.clone(), enrichments)
    }

    /// Wire with other element `lengths`, m.
    #[must_use]
    pub fn with_lengths(&self, lengths: Vec<f64>) -> Self {
        Self::new(self.nodes.clone(), lengths, self.enrichments.clone())
    }

    /// Wire with its present configuration as the reference: zero coordinates then stand for `q`.
    #[must_use]
    pub fn with_reference(&self, q: &[f64]) -> Self {
        let mut moved = self.clone();
        for node in &mut moved.nodes {
            (node.position, node.slope) = node.at(q);
        }
        for enrichment in &mut moved.enrichments {
            enrichment.reference += q[enrichment.index];
        }
        moved
    }

    /// The nodes.
    #[must_use]
    pub fn nodes(&self) -> &[WireNode] {
        &self.nodes
    }

    /// The elements' lengths at nominal tension, m.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// The enrichments, ordered by node.
    #[must_use]
    pub fn enrichments(&self) -> &[Enrichment] {
        &self.enrichments
    }

    /// `s` of a node, m; a point there has columns of that node only.
    #[must_use]
    pub fn node_s(&self, node: usize) -> f64 {
        self.starts[node]
    }

    /// Element at `s` and `x` from its first node, m. A border belongs to the element that starts there; beyond the
    /// wire the element at that end is taken.
    #[must_use]
    pub fn element_at(&self, s: f64) -> (usize, f64) {
        let element = element_between(&self.starts, s);
        (element, s - self.starts[element])
    }

    /// The reference of element `element`, relative to the reference position of its first node.
    pub(super) fn local_reference(&self, element: usize) -> [Vector3<f64>; 4] {
        let (a, b) = (&self.nodes[element], &self.nodes[element + 1]);
        [Vector3::zeros(), a.slope, b.position - a.position, b.slope]
    }

    /// Reference of element `element` as strain has it: the side view of a wire without lateral coordinates, wherever
    /// its nodes lie. A stagger of 0.2 m makes a span of 55 m longer by 3e-5 of it.
    pub(super) fn strained_reference(&self, element: usize) -> [Vector3<f64>; 4] {
        let side = if self.moves_sideways { 1.0 } else { 0.0 };
        self.local_reference(element)
            .map(|r| Vector3::new(r.x, side * r.y, r.z))
    }

    /// True for a wire that has lateral coordinates somewhere.
    pub(super) fn moves_sideways(&self) -> bool {
        self.moves_sideways
    }

    /// Layers of element `element`: each enrichment, and the end at which it is centred.
    pub(super) fn layers(&self, element: usize) -> impl Iterator<Item = (&Enrichment, End)> {
        let of = |node: usize| &self.enrichments[self.first_enrichment[node]..self.first_enrichment[node + 1]];
        let start = of(element).iter().map(|enrichment| (enrichment, End::Start));
        let finish = of(element + 1).iter().map(|enrichment| (enrichment, End::Finish));
        start.chain(finish)
    }

    pub(super) fn locate(&self, s: f64) -> Location {
        let (element, x) = self.element_at(s);
        let length = self.lengths[element];
        // At the last node x/length must be exactly one.
        let xi = if s == self.starts[element + 1] { 1.0 } else { x / length };
        Location {
            element,
            shape: ShapeFunctions::at(xi, length),
            x: xi * length,
        }
    }

    /// `ψ` of one layer at a location; zero outside the element.
    pub(super) fn layer(&self, at: &Location, enrichment: &Enrichment, end: End) -> Layer {
        Layer::at(at, end, enrichment.bending_length, self.lengths[at.element])
    }

    pub(super) fn point_at(&self, at: &Location, q: &[f64], v: &[f64]) -> CurvePoint {
        let (a, b) = (&self.nodes[at.element], &self.nodes[at.element + 1]);
        let reference = self.local_reference(at.element);
        let (r1, r1_x) = a.map.gather(q);
        let (r2, r2_x) = b.map.gather(q);
        let e = [r1, reference[1] + r1_x, reference[2] + r2, reference[3] + r2_x];
        let (v1, v1_x) = a.map.gather(v);
        let (v2, v2_x) = b.map.gather(v);
        let rate = [v1, v1_x, v2, v2_x];
        let shape = &at.shape;
        let mut point = CurvePoint {
            r: a.position + combination(&shape.s, &e),
            r_s: combination(&shape.s_x, &e),
            r_ss: combination(&shape.s_xx, &e),
            velocity: combination(&shape.s, &rate),
            velocity_s: combination(&shape.s_x, &rate),
        };
        for (enrichment, end) in self.layers(at.element) {
            let layer = self.layer(at, enrichment, end);
            let (d, index) = (&enrichment.direction, enrichment.index);
            let value = enrichment.reference + q[index];
            point.r += d * (layer.psi * value);
            point.r_s += d * (layer.psi_x * value);
            point.r_ss += d * (layer.psi_xx * value);
            point.velocity += d * (layer.psi * v[index]);
            point.velocity_s += d * (layer.psi_x * v[index]);
        }
        point
    }

    pub(super) fn columns_at(&self, at: &Location, mut push: impl FnMut(usize, Vector3<f64>, Vector3<f64>)) {
        for (end, node) in [at.element, at.element + 1].into_iter().enumerate() {
            let map = &self.nodes[node].map;
            for slope in [0, 1] {
                let function = 2 * end + slope;
                let (s, s_x) = (at.shape.s[function], at.shape.s_x[function]);
                for axis in 0..3 {
                    let index = if slope == 0 {
                        map.position(axis)
                    } else {
                        map.slope(axis)
                    };
                    if let Some(index) = index {
                        let unit = Vector3::ith(axis, 1.0);
                        push(index, unit * s, unit * s_x);
                    }
                }
            }
        }
        for (enrichment, end) in self.layers(at.element) {
            let layer = self.layer(at, enrichment, end);
            let d = enrichment.direction;
            push(enrichment.index, d * layer.psi, d * layer.psi_x);
        }
    }
}

/// `Σᵢ wᵢ eᵢ`.
fn combination(weights: &Vector4<f64>, e: &[Vector3<f64>; 4]) -> Vector3<f64> {
    e[0] * weights[0] + e[1] * weights[1] + e[2] * weights[2] + e[3] * weights[3]
}

/// Element at `s` of a wire whose nodes are at `nodes`, m; beyond the wire the one at that end.
///
/// Elements of a line are about as long as each other, so that few of them are searched.
///
/// # Panics
/// With fewer than two nodes.
#[must_use]
pub fn element_between(nodes: &[f64], s: f64) -> usize {
    /// Elements on either side of the one that would be at `s` if all were of the same length.
    const NEAR: usize = 8;
    let last = nodes.len() - 2;
    let share = (s - nodes[0]) / (nodes[last + 1] - nodes[0]);
    let about = ((share * (last + 1) as f64) as usize).min(last);
    let (low, high) = (about.saturating_sub(NEAR), (about + NEAR).min(last));
    let within = (low == 0 || nodes[low] <= s) && (high == last || nodes[high + 1] > s);
    let (low, high) = if within { (low, high) } else { (0, last) };
    low + nodes[low + 1..=high].partition_point(|&node| node <= s)
}

impl WireCurve for WireGeometry {
    fn length(&self) -> f64 {
        self.starts[self.lengths.len()]
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        self.point_at(&self.locate(s), q, v)
    }

    fn columns(&self, s: f64, columns: &mut CurveColumns) {
        self.columns_at(&self.locate(s), |index, n, n_s| columns.push(index, n, n_s));
    }
}
