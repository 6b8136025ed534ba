//! Wires of a line, their nodes, and the parts that join them.
mod part;

use super::options::{BendingLayers, Dimension, LineOptions};
use nalgebra::Vector3;
pub(crate) use part::Part;
use scene::{Catenary, Element, MassOn, Section};
use serde::{Deserialize, Serialize};

/// Kind of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WireName {
    /// Wire that collector strips touch.
    ContactWire,
    /// Wire at the supports that carries the contact wire.
    MessengerWire,
    /// Wire below the messenger wire about a support, clamped to it at both ends.
    StitchWire,
}

impl WireName {
    /// Name of the wire in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ContactWire => "contact_wire",
            Self::MessengerWire => "messenger_wire",
            Self::StitchWire => "stitch_wire",
        }
    }

    /// Kind of the wire in a scene.
    #[must_use]
    pub fn kind(self) -> scene::WireKind {
        match self {
            Self::ContactWire => scene::WireKind::Contact,
            Self::MessengerWire => scene::WireKind::Messenger,
            Self::StitchWire => scene::WireKind::Stitch,
        }
    }
}

/// A node of one of the wires of a line, both counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeOfWire {
    /// The wire, in the order of [`Topology::wires`].
    pub wire: usize,
    /// The node along the wire.
    pub node: usize,
}

/// Fastening of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fastening {
    /// None: a node between elements.
    Free,
    /// A dropper or a clamp pulls vertically.
    Hanger,
    /// A support or a registration arm.
    Support,
}

/// Ends of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EndsOfWire {
    /// At the anchors of the line.
    Anchored,
    /// Clamped to these nodes of another wire, whose positions are those of the ends; none where the wire is cut.
    Clamped([Option<NodeOfWire>; 2]),
}

/// A wire of a line and its division.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedWire {
    /// Kind of the wire.
    pub name: WireName,
    /// Name in messages.
    pub label: String,
    /// Tension length, from 0.
    pub section: usize,
    /// Lateral distance from the stagger, m.
    pub(crate) offset: f64,
    /// Section, tension and strength.
    pub parameters: scene::Wire,
    /// Nominal x of the nodes, m.
    pub x: Vec<f64>,
    /// Span of each node, from 1; a support belongs to the span before it.
    pub(crate) span: Vec<usize>,
    pub(crate) fastenings: Vec<Fastening>,
    pub(crate) ends: EndsOfWire,
    /// True for beam elements.
    pub(crate) beam: bool,
    /// True for elements that need bending layers.
    layered: bool,
}

/// Place of a dropper in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DropperPlace {
    /// Tension length, from 0.
    pub section: usize,
    /// Span, counted from 1.
    pub span: usize,
    /// Number within the span, counted from 0.
    pub position: usize,
    /// Node above: of the messenger wire, or of a stitch wire.
    pub upper: NodeOfWire,
    /// Node of the contact wire.
    pub lower: NodeOfWire,
}

/// A support of one tension length.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportPlace {
    /// Tension length, from 0.
    pub section: usize,
    /// x, m.
    pub x: f64,
    /// Nodes of the contact wires.
    pub contact_wires: Vec<NodeOfWire>,
    /// Node of the messenger wire; none of a single wire.
    pub messenger_wire: Option<NodeOfWire>,
    /// True where the wires end.
    pub is_end: bool,
    /// True where the wires end between the first and the last mast of the line.
    pub(crate) is_inner_end: bool,
}

impl SupportPlace {
    /// Nodes of the contact wires, then that of the messenger wire.
    fn carried(&self) -> impl Iterator<Item = NodeOfWire> + '_ {
        self.contact_wires.iter().copied().chain(self.messenger_wire)
    }
}

/// The wires of a line with their nodes, at supports, droppers, clamps and equal divisions between them, and the parts
/// that join them.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    wires: Vec<PlannedWire>,
    supports: Vec<SupportPlace>,
    /// Nodes of the contact wires at each mast, from the first to the last.
    masts: Vec<Vec<NodeOfWire>>,
    /// Supports at each mast, as `masts`.
    supports_at: Vec<Vec<usize>>,
    /// First support and its mast of each tension length.
    first_supports: Vec<(usize, usize)>,
    droppers: Vec<DropperPlace>,
    /// Nodes with masses of clamps, insulators and splices, kg.
    masses: Vec<(NodeOfWire, f64)>,
    options: LineOptions,
}

/// Fastening of a wire, and the way to it from the one before.
struct Station {
    /// x, m.
    x: f64,
    /// Distance from the station before, m.
    length: f64,
    /// Span, from 1.
    span: usize,
    fastening: Fastening,
}

impl PlannedWire {
    /// A wire through `stations`, with equal elements between them.
    fn new(
        (name, label, parameters): (WireName, String, scene::Wire),
        section: usize,
        division: scene::Division,
        stations: &[Station],
        ends: EndsOfWire,
    ) -> Self {
        let first = &stations[0];
        let mut wire = Self {
            name,
            label,
            section,
            offset: 0.0,
            parameters,
            x: vec![first.x],
            span: vec![first.span],
            fastenings: vec![first.fastening],
            ends,
            beam: false,
            layered: false,
        };
        for (start, end) in stations.iter().zip(&stations[1..]) {
            let elements = division.elements(end.length);
            for i in 1..elements {
                let xi = i as f64 / elements as f64;
                wire.x.push(start.x + (end.x - start.x) * xi);
                wire.span.push(end.span);
                wire.fastenings.push(Fastening::Free);
            }
            wire.x.push(end.x);
            wire.span.push(end.span);
            wire.fastenings.push(end.fastening);
        }
        let elements = wire.x.windows(2).map(|ends| ends[1] - ends[0]);
        let shortest = elements.fold(f64::INFINITY, f64::min);
        wire.layered = parameters.needs_layers(name.kind(), shortest);
        wire
    }

    /// The last node.
    #[must_use]
    pub fn last(&self) -> usize {
        self.x.len() - 1
    }

    /// Lateral place at a support of its tension length, m, from 0; of a stitch wire that of the messenger wire.
    pub(crate) fn lateral_at(&self, section: Section<'_>, support: usize) -> f64 {
        match self.name {
            WireName::ContactWire => section.stagger_at(support) + self.offset,
            WireName::MessengerWire | WireName::StitchWire => section.messenger_stagger_at(support),
        }
    }

    /// Nodes with a fastening, ascending.
    pub(crate) fn fastened(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.x.len()).filter(|&node| self.fastenings[node] != Fastening::Free)
    }

    /// Directions of the bending layers at a node.
    pub(crate) fn layer_directions(&self, node: usize, options: &LineOptions) -> Vec<Vector3<f64>> {
        let inner = node > 0 && node < self.last();
        let has_layers = self.layered
            && match options.layers {
                BendingLayers::Absent => false,
                BendingLayers::AtAttachments => inner,
                BendingLayers::AtAttachmentsAndEnds => inner || self.ends == EndsOfWire::Anchored,
            };
        match self.fastenings[node] {
            Fastening::Support if has_layers && options.dimension == Dimension::Spatial => {
                vec![Vector3::z(), Vector3::y()]
            }
            Fastening::Support | Fastening::Hanger if has_layers => vec![Vector3::z()],
            _ => Vec::new(),
        }
    }
}

/// Stations of a wire that runs over all supports of a tension length, with hangers at these positions in each span.
fn along(section: Section<'_>, hangers: impl Fn(usize) -> Vec<f64>) -> Vec<Station> {
    let mut stations = vec![Station {
        x: section.support_x(0),
        length: 0.0,
        span: 1,
        fastening: Fastening::Support,
    }];
    for span in 0..section.spans() {
        let (left, right) = (section.support_x(span), section.support_x(span + 1));
        // Lengths within the span: equal spans have equal ones, while differences of x are rounded.
        let mut start = 0.0;
        let mut station = |position: f64, x: f64, fastening: Fastening| {
            stations.push(Station {
                x,
                length: position - start,
                span: span + 1,
                fastening,
            });
            start = position;
        };
        for position in hangers(span) {
            station(position, left + position, Fastening::Hanger);
        }
        station(section.span_lengths[span], right, Fastening::Support);
    }
    stations
}

/// Stations of the stitch wire about a support (from 0): from clamp to clamp, with the droppers it carries.
fn about_a_support(section: Section<'_>, support: usize) -> Vec<Station> {
    let x = section.support_x(support);
    let mut stations: Vec<Station> = Vec::new();
    for (offset, fastened) in section.stitch_stations(support) {
        stations.push(Station {
            x: x + offset,
            length: stations.last().map_or(0.0, |before| x + offset - before.x),
            span: support + usize::from(offset > 0.0),
            fastening: if fastened { Fastening::Hanger } else { Fastening::Free },
        });
    }
    stations
}

impl Topology {
    /// Divides the line of a scene.
    ///
    /// # Panics
    /// When a line with beam elements is to be planar.
    #[must_use]
    pub fn new(catenary: &Catenary, options: LineOptions) -> Self {
        assert!(
            options.dimension == Dimension::Spatial || catenary.mesh.element == Element::Cable,
            "a beam has lateral coordinates"
        );
        let mut topology = Self {
            wires: Vec::new(),
            supports: Vec::new(),
            masts: Vec::new(),
            supports_at: Vec::new(),
            first_supports: Vec::new(),
            droppers: Vec::new(),
            masses: Vec::new(),
            options,
        };
        for (number, section) in catenary.sections().enumerate() {
            topology.add_section(section, number);
        }
        let masts = catenary.supports_x();
        let nearest = |support: &SupportPlace| {
            let right = masts.partition_point(|&x| x < support.x).min(masts.len() - 1);
            let nearer = right > 0 && support.x - masts[right - 1] < masts[right] - support.x;
            right - usize::from(nearer)
        };
        let masts_of: Vec<usize> = topology.supports.iter().map(nearest).collect();
        topology.place_at_masts(&masts_of, (masts.len(), catenary.tension_lengths.len()));
        let last = masts.len() - 1;
        for number in topology.supports_at[1..last].iter().flatten() {
            let support = &mut topology.supports[*number];
            support.is_inner_end = support.is_end;
        }
        topology
    }

    /// Notes which supports, given with their masts, stand at which of so many masts, and where so many tension lengths
    /// begin.
    fn place_at_masts(&mut self, masts_of: &[usize], (masts, sections): (usize, usize)) {
        self.masts = vec![Vec::new(); masts];
        self.supports_at = vec![Vec::new(); masts];
        self.first_supports = vec![(self.supports.len(), 0); sections];
        for (number, (support, &mast)) in self.supports.iter().zip(masts_of).enumerate() {
            self.masts[mast].extend(&support.contact_wires);
            self.supports_at[mast].push(number);
            let first = &mut self.first_supports[support.section];
            if number < first.0 {
                *first = (number, mast);
            }
        }
    }

    fn add_section(&mut self, section: Section<'_>, number: usize) {
        let line = section.line;
        let of_several = |label: String| match line.tension_lengths.len() {
            1 => label,
            _ => format!("{label} of tension length {}", number + 1),
        };
        let offsets = line.contact_wire_offsets();
        let mut contact_wires = Vec::new();
        for (twin, &offset) in offsets.iter().enumerate() {
            let name = WireName::ContactWire;
            let label = match offsets.len() {
                1 => name.name().to_owned(),
                _ => format!("{} {}", name.name(), twin + 1),
            };
            let stations = along(section, |span| section.contact_attachments(span));
            contact_wires.push(self.wires.len());
            self.wires.push(PlannedWire {
                beam: line.mesh.element == Element::Beam,
                offset,
                ..PlannedWire::new(
                    (name, of_several(label), line.contact_wire),
                    number,
                    line.mesh.division,
                    &stations,
                    EndsOfWire::Anchored,
                )
            });
        }
        let messenger_wire = line.messenger_wire.map(|parameters| {
            let name = WireName::MessengerWire;
            let stations = along(section, |span| section.messenger_attachments(span));
            self.wires.push(PlannedWire::new(
                (name, of_several(name.name().to_owned()), parameters),
                number,
                line.mesh.division,
                &stations,
                EndsOfWire::Anchored,
            ));
            self.wires.len() - 1
        });
        let mut stitch_wires = vec![None; section.spans() + 1];
        if let Some(messenger) = messenger_wire {
            for (support, stitch_wire) in stitch_wires.iter_mut().enumerate() {
                *stitch_wire = self.add_stitch_wire(section, (number, messenger), support, &of_several);
            }
        }
        for support in 0..=section.spans() {
            let x = section.support_x(support);
            self.supports.push(SupportPlace {
                section: number,
                x,
                contact_wires: contact_wires.iter().map(|&wire| self.node_at(wire, x)).collect(),
                messenger_wire: messenger_wire.map(|wire| self.node_at(wire, x)),
                is_end: support == 0 || support == section.spans(),
                is_inner_end: false,
            });
        }
        for (on, wires) in [
            (MassOn::ContactWire, contact_wires.as_slice()),
            (MassOn::MessengerWire, messenger_wire.as_slice()),
        ] {
            for span in 0..section.spans() {
                for (position, mass) in section.masses_on(on, span) {
                    let x = section.support_x(span) + position;
                    let nodes = wires.iter().map(|&wire| (self.node_at(wire, x), mass));
                    let nodes: Vec<_> = nodes.collect();
                    self.masses.extend(nodes);
                }
            }
        }
        let Some(messenger) = messenger_wire else { return };
        for span in 0..section.spans() {
            let left = section.support_x(span);
            for (position, &at) in section.droppers_of(span).iter().enumerate() {
                let x = left + at;
                let above = section
                    .stitch_wire_over(span, at)
                    .and_then(|support| stitch_wires[support]);
                for &lower in &contact_wires {
                    let (upper, lower) = (self.node_at(above.unwrap_or(messenger), x), self.node_at(lower, x));
                    let clamps = [
                        (upper, line.droppers.upper_clamp_mass),
                        (lower, line.droppers.lower_clamp_mass),
                    ];
                    self.masses.extend(clamps.iter().filter(|(_, mass)| *mass > 0.0));
                    self.droppers.push(DropperPlace {
                        section: number,
                        span: span + 1,
                        position,
                        upper,
                        lower,
                    });
                }
            }
        }
    }

    /// Adds the stitch wire about a support, if there is one; its number among the wires.
    fn add_stitch_wire(
        &mut self,
        section: Section<'_>,
        (number, messenger): (usize, usize),
        support: usize,
        of_several: &dyn Fn(String) -> String,
    ) -> Option<usize> {
        let stitch = section.stitch_wire_at(support)?;
        let mut stations = about_a_support(section, support);
        let last = stations.len() - 1;
        let clamps = [0, last].map(|end| self.node_at(messenger, stations[end].x));
        for (end, clamp) in [0, last].into_iter().zip(clamps) {
            stations[end].x = self.wires[messenger].x[clamp.node];
        }
        if stitch.clamp_mass > 0.0 {
            self.masses.extend(clamps.map(|clamp| (clamp, stitch.clamp_mass)));
        }
        let label = format!("{} at support {}", WireName::StitchWire.name(), support + 1);
        self.wires.push(PlannedWire::new(
            (WireName::StitchWire, of_several(label), stitch.wire),
            number,
            section.line.mesh.division,
            &stations,
            EndsOfWire::Clamped(clamps.map(Some)),
        ));
        Some(self.wires.len() - 1)
    }

    /// Static tension of each element of a wire in units of the nominal one, –, to first order; empty where all have
    /// the nominal one. A stitch wire takes its own tension off the messenger wire between its clamps.
    pub(crate) fn tension_shares(&self, wire: usize) -> Vec<f64> {
        let tension = self.wires[wire].parameters.tension;
        let mut shares = Vec::new();
        for stitch_wire in &self.wires {
            let EndsOfWire::Clamped(clamps) = stitch_wire.ends else {
                continue;
            };
            if !clamps.iter().flatten().any(|clamp| clamp.wire == wire) {
                continue;
            }
            // Beyond a cut the wire goes on.
            let elements = self.wires[wire].last();
            let [from, to] =
                [(clamps[0], 0), (clamps[1], elements)].map(|(clamp, cut)| clamp.map_or(cut, |at| at.node));
            shares.resize(elements, 1.0);
            for share in &mut shares[from..to] {
                *share -= stitch_wire.parameters.tension / tension;
            }
        }
        shares
    }

    /// Node of a wire next to `x`, m.
    fn node_at(&self, wire: usize, x: f64) -> NodeOfWire {
        let nodes = &self.wires[wire].x;
        let right = nodes.partition_point(|&node| node < x).min(nodes.len() - 1);
        let node = if right > 0 && x - nodes[right - 1] < nodes[right] - x {
            right - 1
        } else {
            right
        };
        NodeOfWire { wire, node }
    }

    /// True for two wires that have their nodes at the same x.
    pub(crate) fn has_common_nodes(&self) -> bool {
        self.wires.len() == 2 && self.wires.iter().all(|wire| wire.x == self.x())
    }

    /// Discretisation of the line.
    #[must_use]
    pub fn options(&self) -> &LineOptions {
        &self.options
    }

    /// The wires of each tension length in turn: contact wires, messenger wire, stitch wires from the first support on.
    #[must_use]
    pub fn wires(&self) -> &[PlannedWire] {
        &self.wires
    }

    /// Numbers of the contact wires among all wires.
    pub fn contact_wires(&self) -> impl Iterator<Item = usize> + '_ {
        let all = self.wires.iter().enumerate();
        all.filter(|(_, wire)| wire.name == WireName::ContactWire)
            .map(|(number, _)| number)
    }

    /// Nominal x of the nodes of the first contact wire, m.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.wires[0].x
    }

    /// Nodes of the first contact wire at its supports, from the first to the last.
    #[must_use]
    pub fn supports(&self) -> Vec<usize> {
        let first = self.supports.iter().filter(|support| support.section == 0);
        first.map(|support| support.contact_wires[0].node).collect()
    }

    /// Supports of each tension length in turn, from the first to the last.
    #[must_use]
    pub fn support_places(&self) -> &[SupportPlace] {
        &self.supports
    }

    /// Nodes of the contact wires at each mast, from the first to the last.
    #[must_use]
    pub fn masts(&self) -> &[Vec<NodeOfWire>] {
        &self.masts
    }

    /// The droppers, span after span.
    #[must_use]
    pub fn droppers(&self) -> &[DropperPlace] {
        &self.droppers
    }

    /// Nodes with masses of clamps, insulators and splices, kg.
    #[must_use]
    pub fn masses(&self) -> &[(NodeOfWire, f64)] {
        &self.masses
    }

    /// Line without those droppers that `keep` is false for; the nodes stay.
    pub(crate) fn with_droppers(&self, keep: impl Fn(&DropperPlace) -> bool) -> Self {
        let mut changed = self.clone();
        changed.droppers.retain(keep);
        changed
    }

    /// Line with other wires at the same nodes.
    pub(crate) fn with_parameters(&self, change: impl Fn(&PlannedWire) -> scene::Wire) -> Self {
        let mut changed = self.clone();
        for wire in &mut changed.wires {
            wire.parameters = change(wire);
        }
        changed
    }

    /// Curvature of the track at a node, 1/m, positive with the middle to the left.
    pub(crate) fn curvature(&self, catenary: &Catenary, at: NodeOfWire) -> f64 {
        let section = catenary.section(self.wires[at.wire].section);
        section.between_supports(self.x_of(at), |support| section.curvature_at(support))
    }

    /// Nominal x of a node, m.
    #[must_use]
    pub fn x_of(&self, at: NodeOfWire) -> f64 {
        self.wires[at.wire].x[at.node]
    }

    /// Elements of all wires together.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.wires.iter().map(PlannedWire::last).sum()
    }

    fn inner_supports(&self) -> impl Iterator<Item = &SupportPlace> {
        self.supports.iter().filter(|support| !support.is_end)
    }

    /// Nodes of the messenger wires at supports that are not their ends.
    pub(crate) fn held_by_supports(&self) -> impl Iterator<Item = NodeOfWire> + '_ {
        self.inner_supports().filter_map(|support| support.messenger_wire)
    }

    /// Nodes of the contact wires at supports that are not their ends.
    pub(crate) fn held_by_arms(&self) -> impl Iterator<Item = NodeOfWire> + '_ {
        self.inner_supports()
            .flat_map(|support| support.contact_wires.iter().copied())
    }

    /// Span (from 0) of a node, its position within the span, 0…1.
    pub(crate) fn within_span(&self, catenary: &Catenary, NodeOfWire { wire, node }: NodeOfWire) -> (usize, f64) {
        let planned = &self.wires[wire];
        let (section, span) = (catenary.section(planned.section), planned.span[node] - 1);
        let (left, right) = (section.support_x(span), section.support_x(span + 1));
        (span, (planned.x[node] - left) / (right - left))
    }

    /// Lateral position of a node at rest, m.
    ///
    /// Wires of a planar line stay there; those of a line in space are let go from there.
    #[must_use]
    pub fn lateral(&self, catenary: &Catenary, node: NodeOfWire) -> f64 {
        let planned = &self.wires[node.wire];
        let section = catenary.section(planned.section);
        let at = self.within_span(catenary, node);
        section.lateral_within(at, |support| planned.lateral_at(section, support))
    }

    /// Height that form finding prescribes at a node of a contact wire, m.
    ///
    /// ```text
    /// z = h − presag · 4 ξ (1 − ξ)        ξ position within the span, 0…1; h straight between the supports
    /// ```
    #[must_use]
    pub fn prescribed_height(&self, catenary: &Catenary, node: NodeOfWire) -> f64 {
        let section = catenary.section(self.wires[node.wire].section);
        let (span, xi) = self.within_span(catenary, node);
        let (a, b) = (section.height_at(span), section.height_at(span + 1));
        a + (b - a) * xi - section.presag_of(span) * 4.0 * xi * (1.0 - xi)
    }
}
