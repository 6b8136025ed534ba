//! Coordinates of the wires of a line.
use super::options::Dimension;
use super::topology::{EndsOfWire, Topology};
use crate::NodeMap;
use dynamics::Layout;
use nalgebra::Vector3;
use scene::WireEnds;

/// The unknowns of one bending layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LayerCoordinate {
    pub node: usize,
    pub index: usize,
    pub direction: Vector3<f64>,
}

/// Coordinates of one wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WireCoordinates {
    pub nodes: Vec<NodeMap>,
    pub layers: Vec<LayerCoordinate>,
    /// First of the six coordinates of the directors of each node; none in a wire of cable elements.
    pub directors: Vec<usize>,
}

impl Topology {
    /// Adds the coordinates of all wires, node after node along the track, so that neighbours are close in the
    /// numbering; the ends of a clamped wire have the positions of the nodes that they are clamped to. Of tension
    /// lengths with nodes at one place come first those that end there, and last those that begin.
    pub(crate) fn register(&self, layout: &mut Layout) -> Vec<WireCoordinates> {
        let mut wires = vec![WireCoordinates::default(); self.wires().len()];
        let nodes = self.wires().iter().enumerate();
        let nodes =
            nodes.flat_map(|(wire, planned)| planned.x.iter().enumerate().map(move |(node, x)| (*x, wire, node)));
        let mut nodes: Vec<(f64, usize, usize)> = nodes.collect();
        let reach = self.reach_of_sections();
        let ends = |&(x, wire, _): &(f64, usize, usize)| {
            let (first, last) = reach[self.wires()[wire].section];
            u8::from(x < last) + u8::from(x <= first)
        };
        nodes.sort_by(|a, b| a.0.total_cmp(&b.0).then(ends(a).cmp(&ends(b))).then(a.1.cmp(&b.1)));
        let mut within = vec![(0, 0); wires.len()];
        for (_, number, node) in nodes {
            let planned = &self.wires()[number];
            let (span, count) = &mut within[number];
            *count = if *span == planned.span[node] { *count + 1 } else { 1 };
            *span = planned.span[node];
            let label = format!("{}, span {span}, node {count}", planned.label);
            let clamp = match planned.ends {
                EndsOfWire::Clamped(clamps) if node == 0 => clamps[0],
                EndsOfWire::Clamped(clamps) if node == planned.last() => clamps[1],
                _ => None,
            };
            let clamp = clamp.map(|clamp| wires[clamp.wire].nodes[clamp.node]);
            let map = self.node_map(layout, clamp, &label);
            let wire = &mut wires[number];
            wire.nodes.push(map);
            if planned.beam {
                wire.directors
                    .push(layout.add_coordinates(6, format!("{label}, directors")));
            }
            for direction in planned.layer_directions(node, self.options()) {
                let index = layout.add_coordinates(1, format!("{label}, bending layer"));
                wire.layers.push(LayerCoordinate { node, index, direction });
            }
        }
        wires
    }

    /// First and last x of each tension length, m.
    fn reach_of_sections(&self) -> Vec<(f64, f64)> {
        let mut reach: Vec<(f64, f64)> = Vec::new();
        for planned in self.wires() {
            if reach.len() <= planned.section {
                reach.resize(planned.section + 1, (f64::INFINITY, f64::NEG_INFINITY));
            }
            let (first, last) = &mut reach[planned.section];
            *first = first.min(planned.x[0]);
            *last = last.max(planned.x[planned.last()]);
        }
        reach
    }

    /// Coordinates of a node; with `clamp` its position is that of another node.
    fn node_map(&self, layout: &mut Layout, clamp: Option<NodeMap>, label: &str) -> NodeMap {
        let mut add = |count: usize| layout.add_coordinates(count, label.to_owned());
        match (self.options().dimension, clamp) {
            (Dimension::Spatial, None) => NodeMap::spatial(add(6)),
            (Dimension::Planar, None) => NodeMap::planar(add(4)),
            (Dimension::Spatial, Some(clamp)) => {
                let first = add(3);
                let slope = |axis: usize| Some(first + axis);
                NodeMap::new([
                    clamp.position(0),
                    clamp.position(1),
                    clamp.position(2),
                    slope(0),
                    slope(1),
                    slope(2),
                ])
            }
            (Dimension::Planar, Some(clamp)) => {
                let first = add(2);
                NodeMap::new([
                    clamp.position(0),
                    None,
                    clamp.position(2),
                    Some(first),
                    None,
                    Some(first + 1),
                ])
            }
        }
    }

    /// Holds the directors while the wires are treated as cables.
    pub(crate) fn hold_directors(wires: &[WireCoordinates], layout: &mut Layout) {
        for &first in wires.iter().flat_map(|wire| &wire.directors) {
            (first..first + 6).for_each(|index| layout.fix(index));
        }
    }

    /// Holds the anchored ends of the wires: y and z always, x for fixed ends; a beam is also held against spinning
    /// about its axis.
    pub(crate) fn fix_ends(&self, wires: &[WireCoordinates], ends: WireEnds, layout: &mut Layout) {
        let anchored = |(planned, _): &(&super::PlannedWire, _)| planned.ends == EndsOfWire::Anchored;
        for (planned, wire) in self.wires().iter().zip(wires).filter(anchored) {
            for directors in wire.directors.first().into_iter().chain(wire.directors.last()) {
                layout.fix(directors + 2);
            }
            for map in [wire.nodes[0], wire.nodes[planned.last()]] {
                for axis in 0..3 {
                    if let Some(index) = map.position(axis)
                        && (axis > 0 || ends == WireEnds::Fixed)
                    {
                        layout.fix(index);
                    }
                }
            }
        }
    }
}
