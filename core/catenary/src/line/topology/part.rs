//! Sections of a topology cut out at its supports.
use super::{
    BendingLayers, DropperPlace, EndsOfWire, Fastening, NodeOfWire, PlannedWire, SupportPlace, Topology, WireName,
};
use std::ops::Range;

/// Some spans of a line as a line of their own.
pub(crate) struct Part {
    /// Wires with the nodes of these spans, the first mast at x = 0.
    pub topology: Topology,
    /// For each wire of the part, its number in the whole line and its nodes there.
    pub origins: Vec<(usize, Range<usize>)>,
}

/// Sections of a line whose tension lengths have common masts where they run side by side.
impl Topology {
    /// x of a mast (from 0), m.
    pub(crate) fn mast_x(&self, mast: usize) -> f64 {
        self.supports[self.supports_at[mast][0]].x
    }

    /// x of the support that a tension length has at a mast, m; infinite for a mast beyond its ends.
    fn support_x(&self, section: usize, mast: usize) -> f64 {
        let (first, first_mast) = self.first_supports[section];
        let own = mast.checked_sub(first_mast);
        let place = own.map(|support| {
            self.supports
                .get(first + support)
                .filter(|place| place.section == section)
        });
        match place {
            None => f64::NEG_INFINITY,
            Some(None) => f64::INFINITY,
            Some(Some(place)) => place.x,
        }
    }

    /// Span of a dropper, from 0, between neighbouring masts.
    pub(crate) fn span_of(&self, place: &DropperPlace) -> usize {
        self.first_supports[place.section].1 + place.span - 1
    }

    /// Number of tension lengths in a span (from 0).
    pub(crate) fn tension_lengths_in(&self, span: usize) -> usize {
        let at = |mast: usize| {
            self.supports_at[mast]
                .iter()
                .map(|&support| self.supports[support].section)
        };
        at(span)
            .filter(|section| at(span + 1).any(|other| other == *section))
            .count()
    }

    /// True where wires end at a mast between the first and the last one.
    pub(crate) fn has_inner_end(&self, mast: usize) -> bool {
        let mut supports = self.supports_at[mast].iter();
        supports.any(|&support| self.supports[support].is_inner_end)
    }

    /// Nodes that a mast (from 0) cuts, tension length after tension length: of the contact wires, of the messenger
    /// wire, and of the stitch wire that passes the support. Wires that end at a mast between the first and the last
    /// one belong to their last span and are not cut.
    pub(crate) fn nodes_at(&self, mast: usize) -> impl Iterator<Item = NodeOfWire> + '_ {
        let places = self.supports_at[mast].iter().map(|&support| &self.supports[support]);
        places
            .filter(|place| !place.is_inner_end)
            .flat_map(|place| self.nodes_at_support(place))
    }

    fn nodes_at_support<'a>(&'a self, place: &'a SupportPlace) -> impl Iterator<Item = NodeOfWire> + 'a {
        let stitch_wires = self.wires.iter().enumerate();
        let stitch_wires = stitch_wires
            .filter(|(_, planned)| planned.name == WireName::StitchWire && planned.section == place.section);
        let passing = stitch_wires.filter_map(|(wire, planned)| {
            let node = planned.x.binary_search_by(|x| x.total_cmp(&place.x)).ok()?;
            Some(NodeOfWire { wire, node })
        });
        place.carried().chain(passing)
    }

    /// Nodes of wires that end between the first and the last mast.
    pub(crate) fn inner_ends(&self) -> impl Iterator<Item = NodeOfWire> + '_ {
        let places = self.supports.iter().filter(|place| place.is_inner_end);
        places.flat_map(SupportPlace::carried)
    }

    /// Nodes of a wire in some spans (from 0), supports included; empty for a wire that has no element there.
    pub(crate) fn nodes_in(&self, wire: usize, spans: &Range<usize>) -> Range<usize> {
        let PlannedWire { x, section, .. } = &self.wires[wire];
        let [left, right] = [spans.start, spans.end].map(|mast| self.support_x(*section, mast));
        let nodes = x.partition_point(|&x| x < left)..x.partition_point(|&x| x <= right);
        if nodes.len() > 1 { nodes } else { 0..0 }
    }

    /// A wire with these nodes only, as a wire of a part that begins at mast `start`.
    fn part_of_wire(&self, number: usize, nodes: &Range<usize>, spans: &Range<usize>) -> PlannedWire {
        let whole = &self.wires[number];
        let start = self.mast_x(spans.start);
        let mut x: Vec<f64> = whole.x[nodes.clone()].iter().map(|x| x - start).collect();
        // Supports of one mast at one place, to the last bit: the numbering goes by x.
        for mast in spans.start..=spans.end {
            let own = self.support_x(whole.section, mast);
            if let Ok(node) = whole.x[nodes.clone()].binary_search_by(|x| x.total_cmp(&own)) {
                x[node] = self.mast_x(mast) - start;
            }
        }
        let mut fastenings = whole.fastenings[nodes.clone()].to_vec();
        if whole.ends == EndsOfWire::Anchored {
            let ends = |at: NodeOfWire| self.inner_ends_of(whole.section).any(|end| end == at);
            let last = fastenings.len() - 1;
            for own in [0, last] {
                let node = nodes.start + own;
                // The whole line has no bending layer there.
                if ends(NodeOfWire { wire: number, node }) {
                    fastenings[own] = Fastening::Free;
                }
            }
        }
        let first_mast = self.first_supports[whole.section].1;
        let span = |span: &usize| (first_mast + span).saturating_sub(spans.start).max(1);
        PlannedWire {
            x,
            span: whole.span[nodes.clone()].iter().map(span).collect(),
            fastenings,
            label: whole.label.clone(),
            ends: whole.ends,
            ..*whole
        }
    }

    fn inner_ends_of(&self, section: usize) -> impl Iterator<Item = NodeOfWire> + '_ {
        let (first, _) = self.first_supports[section];
        let next = self
            .first_supports
            .get(section + 1)
            .map_or(self.supports.len(), |next| next.0);
        let places = [&self.supports[first], &self.supports[next - 1]];
        let places = places.into_iter().filter(|place| place.is_inner_end);
        places.flat_map(SupportPlace::carried)
    }

    /// Spans `spans` (from 0), with these bending layers: every wire that passes is cut at the first and at the last
    /// mast, and masses there are left out.
    pub(crate) fn part(&self, spans: &Range<usize>, layers: BendingLayers) -> Part {
        let start = self.mast_x(spans.start);
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
            let own = self.part_of_wire(*number, nodes, spans);
            PlannedWire {
                ends: match own.ends {
                    EndsOfWire::Anchored => EndsOfWire::Anchored,
                    EndsOfWire::Clamped(clamps) => EndsOfWire::Clamped(clamps.map(|clamp| here(clamp?))),
                },
                ..own
            }
        });
        let wires = wires.collect();
        let ends = [spans.start, spans.end];
        let masts = || spans.start..=spans.end;
        let mut places: Vec<(usize, usize)> = masts()
            .flat_map(|mast| self.supports_at[mast].iter().map(move |&support| (support, mast)))
            .collect();
        places.sort_unstable();
        let places = places.into_iter().filter_map(|(support, mast)| {
            let place = &self.supports[support];
            let contact_wires: Vec<NodeOfWire> = place.contact_wires.iter().copied().filter_map(here).collect();
            let own = SupportPlace {
                x: self.mast_x(mast) - start,
                messenger_wire: place.messenger_wire.and_then(here),
                is_end: ends.contains(&mast) || place.is_end,
                contact_wires,
                ..*place
            };
            // A tension length that ends where the part begins has no element in it.
            (!own.contact_wires.is_empty()).then_some((own, mast - spans.start))
        });
        let (supports, masts_of): (Vec<SupportPlace>, Vec<usize>) = places.unzip();
        let cut: Vec<NodeOfWire> = ends.into_iter().flat_map(|mast| self.nodes_at(mast)).collect();
        let masses = self.masses.iter().filter(|(at, _)| !cut.contains(at));
        let masses = masses.filter_map(|&(at, mass)| Some((here(at)?, mass)));
        let droppers = self
            .droppers
            .iter()
            .filter(|place| spans.contains(&self.span_of(place)));
        let droppers = droppers.filter_map(|place| {
            Some(DropperPlace {
                span: self.span_of(place) + 1 - spans.start,
                upper: here(place.upper)?,
                lower: here(place.lower)?,
                ..*place
            })
        });
        let mut topology = Self {
            wires,
            masts: Vec::new(),
            supports_at: Vec::new(),
            first_supports: Vec::new(),
            supports,
            droppers: droppers.collect(),
            masses: masses.collect(),
            options: crate::LineOptions { layers, ..self.options },
        };
        topology.place_at_masts(&masts_of, (spans.len() + 1, self.first_supports.len()));
        Part { topology, origins }
    }
}
