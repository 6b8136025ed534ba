//! Coordinates of the spans of a section of the line.
use crate::line::WireCoordinates;
use crate::{NodeOfWire, Topology};
use std::ops::Range;

/// Positions of the coordinates of some spans.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct SpanPlaces {
    /// For each support, the coordinates of the nodes there, in the order of [`Topology::nodes_at`].
    pub supports: Vec<Vec<usize>>,
    /// For each support, its bending layers.
    pub layers: Vec<Vec<usize>>,
    /// Coordinates between the supports of each span, with those of wires that end at a mast which others pass.
    pub inner: Vec<Range<usize>>,
    /// Coordinates of each node where such a wire ends.
    pub ends: Vec<Vec<usize>>,
    /// Number of coordinates.
    pub count: usize,
}

impl SpanPlaces {
    /// Positions of `count` coordinates of a section, numbered along the track and shifted by `first`.
    pub fn new(section: &Topology, coordinates: &[WireCoordinates], first: usize, count: usize) -> Self {
        let supports = 0..section.masts().len();
        let of_node = |at: NodeOfWire| {
            let indices = coordinates[at.wire].nodes[at.node].indices();
            indices.map(|index| first + index)
        };
        let at = |support: usize| section.nodes_at(support).flat_map(of_node).collect::<Vec<_>>();
        let layers = |support: usize| {
            let layers = section.nodes_at(support).flat_map(|at| {
                let of_wire = coordinates[at.wire].layers.iter();
                of_wire.filter(move |layer| layer.node == at.node)
            });
            layers.map(|layer| first + layer.index).collect::<Vec<_>>()
        };
        let (supports, layers): (Vec<_>, Vec<_>) = supports.map(|support| (at(support), layers(support))).unzip();
        let inner = (1..supports.len()).map(|right| {
            let of_left = supports[right - 1].iter().chain(&layers[right - 1]);
            let begin = of_left.max().map_or(first, |last| last + 1);
            begin..supports[right].iter().copied().min().unwrap_or(begin).max(begin)
        });
        Self {
            inner: inner.collect(),
            ends: section.inner_ends().map(|at| of_node(at).collect()).collect(),
            supports,
            layers,
            count,
        }
    }
}
