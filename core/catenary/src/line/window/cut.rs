//! Sections of a line cut out of its static state.
use super::places::SpanPlaces;
use crate::line::{Equilibrium, Part, WireCoordinates, layers};
use crate::{BendingLayers, Enrichment, Line, NodeOfWire, ResidualCompliance, Topology, WireGeometry, WireNode};
use dynamics::Layout;
use nalgebra::Vector3;
use scene::{Catenary, WireEnds};
use std::ops::Range;
use std::sync::Arc;

/// Distance of a support from a mast that is not its own, at least, m: far above rounding, far below a span.
const APART: f64 = 1e-3;

/// A line with known static state, to be cut at its supports.
pub(crate) struct Source<'a> {
    pub catenary: &'a Catenary,
    pub topology: &'a Topology,
    pub equilibrium: &'a Equilibrium,
}

impl Source<'_> {
    /// Spans `spans` (from 0) as a line of their own that starts at x = 0, with coordinates numbered from `first`. The
    /// action of the rest of the line is missing: the ends are neither held nor pulled, and have no bending layers.
    pub fn cut(&self, spans: Range<usize>, first: usize) -> (Line, SpanPlaces) {
        self.cut_with(self.topology.options().layers, spans, first)
    }

    /// [`Source::cut`] with coordinates from 0, each end with its half of the bending layers there.
    pub fn cut_with_end_layers(&self, spans: Range<usize>) -> (Line, SpanPlaces) {
        let layers = match self.topology.options().layers {
            BendingLayers::Absent => BendingLayers::Absent,
            BendingLayers::AtAttachments | BendingLayers::AtAttachmentsAndEnds => BendingLayers::AtAttachmentsAndEnds,
        };
        self.cut_with(layers, spans, 0)
    }

    /// Positions of the coordinates of [`Source::cut`].
    pub fn places(&self, spans: &Range<usize>, first: usize) -> SpanPlaces {
        let Part { topology, .. } = self.topology.part(spans, self.topology.options().layers);
        let mut layout = Layout::new();
        let coordinates = topology.register(&mut layout);
        SpanPlaces::new(&topology, &coordinates, first, layout.coordinates())
    }

    fn cut_with(&self, layers: BendingLayers, spans: Range<usize>, first: usize) -> (Line, SpanPlaces) {
        let catenary = Catenary {
            // No forces of tensioning devices.
            wire_ends: WireEnds::Fixed,
            ..self.catenary.part(spans.start, spans.end)
        };
        let Part { topology, origins } = self.topology.part(&spans, layers);
        let topology = Arc::new(topology);
        let mut layout = Layout::new();
        let coordinates = topology.register(&mut layout);
        let equilibrium = self.equilibrium_of(&spans, (&topology, &origins), &coordinates);
        let line = Line::new(&catenary, &topology, &equilibrium, first);
        let line = match topology.options().mass_correction {
            None => line,
            Some(correction) => line.with_mass_correction(correction),
        };
        let places = SpanPlaces::new(&topology, &coordinates, first, layout.coordinates());
        (line, places)
    }

    /// [`Source::cut`] with the residual compliance of the contact wires, which only contact needs. Patches `known`
    /// from another section of the line are reused.
    pub fn cut_for_contact(
        &self,
        spans: Range<usize>,
        first: usize,
        known: &mut Vec<Option<Arc<ResidualCompliance>>>,
    ) -> (Line, SpanPlaces) {
        let (line, places) = self.cut(spans, first);
        if let Some(speed) = self.topology.options().contact_compliance {
            let before = std::mem::take(known);
            for number in 0..line.contact_wires() {
                let wire = line.contact_wire(number);
                // All contact wires are alike: where a tension length begins, another one's patches serve.
                let found = match before.get(number).or(before.first()) {
                    Some(Some(known)) => Some(known.along(wire.geometry())),
                    _ => ResidualCompliance::new(wire.geometry(), wire.section(), speed),
                };
                known.push(found.map(Arc::new));
            }
        }
        (line.with_contact_compliance(known.clone()), places)
    }

    fn equilibrium_of(
        &self,
        spans: &Range<usize>,
        (part, origins): (&Topology, &[(usize, Range<usize>)]),
        coordinates: &[WireCoordinates],
    ) -> Equilibrium {
        let start = Vector3::x() * self.topology.mast_x(spans.start);
        let droppers = self.topology.droppers();
        let droppers = droppers
            .iter()
            .zip(&self.equilibrium.dropper_lengths)
            .filter(|(place, _)| spans.contains(&self.topology.span_of(place)));
        let wire = |(own, ((number, nodes), coordinates)): (usize, (&(usize, Range<usize>), &WireCoordinates))| {
            let geometry = &self.equilibrium.wires[*number];
            let cut = geometry.nodes()[nodes.clone()].iter().zip(&coordinates.nodes);
            let cut = cut.map(|(node, &map)| WireNode {
                position: node.position - start,
                map,
                ..*node
            });
            let lengths = geometry.lengths()[nodes.start..nodes.end - 1].to_vec();
            let layers = layers(&self.topology.wires()[*number].parameters, coordinates)
                .into_iter()
                .map(|layer| {
                    let same = |other: &&Enrichment| {
                        other.node == nodes.start + layer.node && other.direction == layer.direction
                    };
                    // True ends have none, because the whole line has no layer there.
                    let known = geometry.enrichments().iter().find(same);
                    Enrichment {
                        reference: known.map_or(0.0, |known| known.reference),
                        ..layer
                    }
                });
            WireGeometry::new(cut.collect(), lengths, layers.collect()).with_tension_shares(part.tension_shares(own))
        };
        // Reactions stand at inner supports, in the order of the supports.
        let inside = self.topology.mast_x(spans.start) + APART..self.topology.mast_x(spans.end) - APART;
        let inner = |reactions: &[Vector3<f64>], held: &mut dyn Iterator<Item = NodeOfWire>| {
            let held = held.map(|at| self.topology.x_of(at)).zip(reactions);
            let held = held.filter(|(x, _)| inside.contains(x));
            held.map(|(_, reaction)| *reaction).collect()
        };
        Equilibrium {
            wires: origins.iter().zip(coordinates).enumerate().map(wire).collect(),
            // Empty: windows are cut from lines of cables only.
            directors: Vec::new(),
            dropper_lengths: droppers.map(|(_, &length)| length).collect(),
            support_reactions: inner(
                &self.equilibrium.support_reactions,
                &mut self.topology.held_by_supports(),
            ),
            arm_reactions: inner(&self.equilibrium.arm_reactions, &mut self.topology.held_by_arms()),
        }
    }

    /// Largest difference between two spans in the static state, m (–): shapes, lengths, droppers. Infinite where the
    /// wires have nodes of their own: such lines seldom repeat themselves.
    pub fn difference(&self, a: usize, b: usize) -> f64 {
        if !self.topology.has_common_nodes() {
            return f64::INFINITY;
        }
        let supports = self.topology.supports();
        let count = supports[a + 1] - supports[a];
        if supports[b + 1] - supports[b] != count {
            return f64::INFINITY;
        }
        let x = self.topology.x();
        let shift = Vector3::x() * (x[supports[b]] - x[supports[a]]);
        let mut largest = 0.0_f64;
        for wire in &self.equilibrium.wires {
            for i in 0..=count {
                let (mine, other) = (&wire.nodes()[supports[a] + i], &wire.nodes()[supports[b] + i]);
                largest = largest.max((mine.position + shift - other.position).amax());
                largest = largest.max((mine.slope - other.slope).amax());
                if i < count {
                    let lengths = wire.lengths();
                    largest = largest.max((lengths[supports[a] + i] - lengths[supports[b] + i]).abs());
                }
            }
        }
        let lengths = |span: usize| {
            let droppers = self.topology.droppers().iter().zip(&self.equilibrium.dropper_lengths);
            droppers
                .filter(move |(place, _)| place.span == span + 1)
                .map(|(_, length)| *length)
        };
        if lengths(a).count() != lengths(b).count() {
            return f64::INFINITY;
        }
        for (mine, other) in lengths(a).zip(lengths(b)) {
            largest = largest.max((mine - other).abs());
        }
        largest
    }
}
