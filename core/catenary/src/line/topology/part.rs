//! Sections of a topology cut out at its supports.
use super::{BendingLayers, DropperPlace, EndsOfWire, NodeOfWire, PlannedWire, SupportPlace, Topology, WireName};
use std::ops::Range;

/// Some spans of a line of one tension length as a line of their own.
pub(crate) struct Part {
    /// Wires with the nodes of these spans, the first support at x = 0.
    pub topology: Topology,
    /// For each wire of the part, its number in the whole line and its nodes there.
    pub origins: Vec<(usize, Range<usize>)>,
}

impl Topology {
    /// Nodes that a support (from 0) of a line of one tension length cuts: of the contact wires, of the messenger wire,
    /// and of the stitch wire that passes the support.
    pub(crate) fn nodes_at(&self, support: usize) -> impl Iterator<Item = NodeOfWire> + '_ {
        let place = &self.supports[support];
        let stitch_wires = self.wires.iter().enumerate();
        let stitch_wires = stitch_wires.filter(|(_, planned)| planned.name == WireName::StitchWire);
        let passing = stitch_wires.filter_map(|(wire, planned)| {
            let node = planned.x.binary_search_by(|x| x.total_cmp(&place.x)).ok()?;
            Some(NodeOfWire { wire, node })
        });
        let carried = place.contact_wires.iter().copied().chain(place.messenger_wire);
        carried.chain(passing)
    }

    /// Nodes of a wire in some spans (from 0) of a line of one tension length, supports included; empty for a wire that
    /// has no element there.
    pub(crate) fn nodes_in(&self, wire: usize, spans: &Range<usize>) -> Range<usize> {
        let x = &self.wires[wire].x;
        let [left, right] = [spans.start, spans.end].map(|support| self.supports[support].x);
        let nodes = x.partition_point(|&x| x < left)..x.partition_point(|&x| x <= right);
        if nodes.len() > 1 { nodes } else { 0..0 }
    }

    /// Spans `spans` (from 0) of a line of one tension length, with these bending layers: every wire is cut at the
    /// supports, and masses there are left out.
    pub(crate) fn part(&self, spans: &Range<usize>, layers: BendingLayers) -> Part {
        let start = self.supports[spans.start].x;
        let origins: Vec<(usize, Range<usize>)> = (0..self.wires.len())
            .map(|wire| (wire, self.nodes_in(wire, spans)))
            .filter(|(_, nodes)| !nodes.is_empty())
            .collect();
        let here = |at: NodeOfWire| {
            let wire = origins.iter().position(|(number, _)| *number == at.wire)?;
            let nodes = &origins[wire].1;
            let node = nodes.contains(&at.node).then(|| at.node - nodes.start)?;
            Some(NodeOfWire { wire, node })
        };
        let wires = origins.iter().map(|(number, nodes)| {
            let whole = &self.wires[*number];
            PlannedWire {
                x: whole.x[nodes.clone()].iter().map(|x| x - start).collect(),
                span: whole.span[nodes.clone()]
                    .iter()
                    .map(|span| span.saturating_sub(spans.start).max(1))
                    .collect(),
                fastenings: whole.fastenings[nodes.clone()].to_vec(),
                ends: match whole.ends {
                    EndsOfWire::Anchored => EndsOfWire::Anchored,
                    EndsOfWire::Clamped(clamps) => EndsOfWire::Clamped(clamps.map(|clamp| here(clamp?))),
                },
                label: whole.label.clone(),
                ..*whole
            }
        });
        let wires = wires.collect();
        let ends = [spans.start, spans.end];
        let supports = (spans.start..=spans.end).map(|support| {
            let place = &self.supports[support];
            SupportPlace {
                section: 0,
                x: place.x - start,
                contact_wires: place.contact_wires.iter().copied().filter_map(here).collect(),
                messenger_wire: place.messenger_wire.and_then(here),
                is_end: ends.contains(&support),
            }
        });
        let supports: Vec<SupportPlace> = supports.collect();
        let cut: Vec<NodeOfWire> = ends.into_iter().flat_map(|support| self.nodes_at(support)).collect();
        let masses = self.masses.iter().filter(|(at, _)| !cut.contains(at));
        let masses = masses.filter_map(|&(at, mass)| Some((here(at)?, mass)));
        let droppers = self.droppers.iter().filter(|place| spans.contains(&(place.span - 1)));
        let droppers = droppers.filter_map(|place| {
            Some(DropperPlace {
                span: place.span - spans.start,
                upper: here(place.upper)?,
                lower: here(place.lower)?,
                ..*place
            })
        });
        let topology = Self {
            wires,
            masts: supports.iter().map(|support| support.contact_wires.clone()).collect(),
            supports,
            droppers: droppers.collect(),
            masses: masses.collect(),
            options: crate::LineOptions { layers, ..self.options },
        };
        Part { topology, origins }
    }
}
