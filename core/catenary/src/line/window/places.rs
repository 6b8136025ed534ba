//! Coordinates of the spans of a section of the line.
use crate::Topology;
use crate::line::WireCoordinates;
use std::ops::Range;

/// Positions of the coordinates of some spans.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct SpanPlaces {
    /// For each support, the coordinates of the nodes there, in the order of [`Topology::nodes_at`].
    pub supports: Vec<Vec<usize>>,
    /// For each support, its bending layers.
    pub layers: Vec<Vec<usize>>,
    /// Coordinates between the supports of each span.
    pub inner: Vec<Range<usize>>,
    /// Number of coordinates.
    pub count: usize,
}

impl SpanPlaces {
    /// Positions of `count` coordinates of a section, numbered along the track and shifted by `first`.
    pub fn new(section: &Topology, coordinates: &[WireCoordinates], first: usize, count: usize) -> Self {
        let supports = 0..section.support_places().len();
        let at = |support: usize| {
            let nodes = section.nodes_at(support);
            let indices = nodes.flat_map(|at| coordinates[at.wire].nodes[at.node].indices());
            indices.map(|index| first + index).collect::<Vec<_>>()
        };
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
            supports,
            layers,
            count,
        }
    }
}
