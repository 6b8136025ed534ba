//! Wires of a line, their nodes, and the parts that join them.
use super::options::{BendingLayers, Dimension, LineOptions};
use nalgebra::Vector3;
use scene::{Catenary, Element};

/// Kind of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Clamped to these nodes of another wire, whose positions are those of the ends.
    Clamped([NodeOfWire; 2]),
}

/// A wire of a line and its division.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedWire {
    /// Kind of the wire.
    pub name: WireName,
    /// Name in messages.
    pub label: String,
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
}

/// Place of a dropper in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DropperPlace {
    /// Span, counted from 1.
    pub span: usize,
    /// Number within the span, counted from 0.
    pub position: usize,
    /// Node above: of the messenger wire, or of a stitch wire.
    pub upper: NodeOfWire,
    /// Node of the contact wire.
    pub lower: NodeOfWire,
}

/// The wires of a line with their nodes, at supports, droppers, clamps and equal divisions between them, and the parts
/// that join them.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    wires: Vec<PlannedWire>,
    /// For each support, its node of the contact wire and of the messenger wire.
    supports: Vec<[NodeOfWire; 2]>,
    droppers: Vec<DropperPlace>,
    options: LineOptions,
}

const CONTACT: usize = 0;
const MESSENGER: usize = 1;

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
        division: scene::Division,
        stations: &[Station],
        ends: EndsOfWire,
    ) -> Self {
        let first = &stations[0];
        let mut wire = Self {
            name,
            label,
            parameters,
            x: vec![first.x],
            span: vec![first.span],
            fastenings: vec![first.fastening],
            ends,
            beam: false,
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
        wire
    }

    /// The last node.
    #[must_use]
    pub fn last(&self) -> usize {
        self.x.len() - 1
    }

    /// Nodes with a fastening, ascending.
    pub(crate) fn fastened(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.x.len()).filter(|&node| self.fastenings[node] != Fastening::Free)
    }

    /// Directions of the bending layers at a node.
    pub(crate) fn layer_directions(&self, node: usize, options: &LineOptions) -> Vec<Vector3<f64>> {
        let inner = node > 0 && node < self.last();
        let has_layers = match options.layers {
            BendingLayers::Absent => false,
            BendingLayers::AtAttachments => inner,
            BendingLayers::AtAttachmentsAndEnds => inner || self.ends == EndsOfWire::Anchored,
        };
        // A string has no layers.
        let bends = self.parameters.bending_stiffness > 0.0;
        match self.fastenings[node] {
            Fastening::Support if has_layers && bends && options.dimension == Dimension::Spatial => {
                vec![Vector3::z(), Vector3::y()]
            }
            Fastening::Support | Fastening::Hanger if has_layers && bends => vec![Vector3::z()],
            _ => Vec::new(),
        }
    }
}

/// Stations of a wire that runs over all supports, with hangers at these positions in each span.
fn along_the_line(catenary: &Catenary, hangers: impl Fn(usize) -> Vec<f64>) -> Vec<Station> {
    let mut stations = vec![Station {
        x: catenary.support_x(0),
        length: 0.0,
        span: 1,
        fastening: Fastening::Support,
    }];
    for span in 0..catenary.spans() {
        let (left, right) = (catenary.support_x(span), catenary.support_x(span + 1));
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
        station(catenary.span_lengths()[span], right, Fastening::Support);
    }
    stations
}

/// Stations of the stitch wire about a support (from 0): from clamp to clamp, with the droppers it carries.
fn about_a_support(catenary: &Catenary, support: usize) -> Vec<Station> {
    let x = catenary.support_x(support);
    let mut stations: Vec<Station> = Vec::new();
    for (offset, fastening) in catenary.stitch_stations(support) {
        stations.push(Station {
            x: x + offset,
            length: stations.last().map_or(0.0, |before| x + offset - before.x),
            span: support + usize::from(offset > 0.0),
            fastening: if fastening { Fastening::Hanger } else { Fastening::Free },
        });
    }
    stations
}

impl Topology {
    /// Divides the line of a scene.
    ///
    /// # Panics
    /// When a staggered line or one with beam elements is to be planar.
    #[must_use]
    pub fn new(catenary: &Catenary, options: LineOptions) -> Self {
        assert!(
            options.dimension == Dimension::Spatial || !catenary.is_staggered(),
            "a staggered line has lateral coordinates"
        );
        assert!(
            options.dimension == Dimension::Spatial || catenary.mesh.element == Element::Cable,
            "a beam has lateral coordinates"
        );
        let division = catenary.mesh.division;
        let wire = |name: WireName, parameters: scene::Wire, hangers: &dyn Fn(usize) -> Vec<f64>| {
            let stations = along_the_line(catenary, hangers);
            let label = name.name().to_owned();
            PlannedWire::new((name, label, parameters), division, &stations, EndsOfWire::Anchored)
        };
        let contact_wire = PlannedWire {
            beam: catenary.mesh.element == Element::Beam,
            ..wire(WireName::ContactWire, catenary.contact_wire, &|span| {
                catenary.droppers.of_span(span).to_vec()
            })
        };
        let messenger_wire = wire(WireName::MessengerWire, catenary.messenger_wire, &|span| {
            catenary.messenger_attachments(span)
        });
        let mut topology = Self {
            wires: vec![contact_wire, messenger_wire],
            supports: Vec::new(),
            droppers: Vec::new(),
            options,
        };
        for support in 0..=catenary.spans() {
            topology.add_stitch_wire(catenary, support);
        }
        topology.supports = (0..=catenary.spans())
            .map(|support| {
                let x = catenary.support_x(support);
                [CONTACT, MESSENGER].map(|wire| topology.node_at(wire, x))
            })
            .collect();
        for span in 0..catenary.spans() {
            let left = catenary.support_x(span);
            for (position, &at) in catenary.droppers.of_span(span).iter().enumerate() {
                let x = left + at;
                let above = catenary.stitch_wire_over(span, at);
                let above = above.and_then(|support| topology.stitch_wire_about(catenary.support_x(support)));
                topology.droppers.push(DropperPlace {
                    span: span + 1,
                    position,
                    upper: topology.node_at(above.unwrap_or(MESSENGER), x),
                    lower: topology.node_at(CONTACT, x),
                });
            }
        }
        topology
    }

    fn add_stitch_wire(&mut self, catenary: &Catenary, support: usize) {
        let Some(stitch) = catenary.stitch_wire_at(support) else {
            return;
        };
        let mut stations = about_a_support(catenary, support);
        let last = stations.len() - 1;
        let clamps = [0, last].map(|end| self.node_at(MESSENGER, stations[end].x));
        for (end, clamp) in [0, last].into_iter().zip(clamps) {
            stations[end].x = self.wires[clamp.wire].x[clamp.node];
        }
        let label = format!("{} at support {}", WireName::StitchWire.name(), support + 1);
        self.wires.push(PlannedWire::new(
            (WireName::StitchWire, label, stitch.wire),
            catenary.mesh.division,
            &stations,
            EndsOfWire::Clamped(clamps),
        ));
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

    /// The stitch wire over `x`, m.
    fn stitch_wire_about(&self, x: f64) -> Option<usize> {
        let over = |wire: &PlannedWire| wire.name == WireName::StitchWire && wire.x[0] < x && x < wire.x[wire.last()];
        self.wires.iter().position(over)
    }

    /// True where all wires have their nodes at the same x, as a line cut at its supports must.
    pub(crate) fn has_common_nodes(&self) -> bool {
        self.wires.iter().all(|wire| wire.x == self.wires[CONTACT].x)
    }

    /// Discretisation of the line.
    #[must_use]
    pub fn options(&self) -> &LineOptions {
        &self.options
    }

    /// The wires: contact wire, messenger wire, then the stitch wires from the first support on.
    #[must_use]
    pub fn wires(&self) -> &[PlannedWire] {
        &self.wires
    }

    /// Nominal x of the nodes of the contact wire, m.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.wires[CONTACT].x
    }

    /// Nodes of the contact wire at the supports, from the first to the last.
    #[must_use]
    pub fn supports(&self) -> Vec<usize> {
        self.supports.iter().map(|nodes| nodes[CONTACT].node).collect()
    }

    /// Node of the contact wire and node of the messenger wire at each support, from the first to the last.
    pub(crate) fn support_nodes(&self) -> &[[NodeOfWire; 2]] {
        &self.supports
    }

    /// The droppers, span after span.
    #[must_use]
    pub fn droppers(&self) -> &[DropperPlace] {
        &self.droppers
    }

    /// Elements of all wires together.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.wires.iter().map(PlannedWire::last).sum()
    }

    /// Supports that are not ends: their nodes of contact wire and messenger wire.
    pub(crate) fn inner_supports(&self) -> &[[NodeOfWire; 2]] {
        &self.supports[1..self.supports.len() - 1]
    }

    /// Position of a node within its span, 0…1, and the span, from 0.
    fn within_span(&self, NodeOfWire { wire, node }: NodeOfWire) -> (usize, f64) {
        let span = self.wires[wire].span[node] - 1;
        let [left, right] = [span, span + 1].map(|support| self.x()[self.supports[support][CONTACT].node]);
        (span, (self.wires[wire].x[node] - left) / (right - left))
    }

    /// Lateral position of a node, m: straight between the stagger of neighbouring supports; of a stitch wire that of
    /// the messenger wire.
    #[must_use]
    pub fn lateral(&self, catenary: &Catenary, node: NodeOfWire) -> f64 {
        let (span, xi) = self.within_span(node);
        let line = catenary.first();
        let stagger = |support: usize| match self.wires[node.wire].name {
            WireName::ContactWire => line.stagger_at(support),
            WireName::MessengerWire | WireName::StitchWire => line.messenger_stagger_at(support),
        };
        let (a, b) = (stagger(span), stagger(span + 1));
        a + (b - a) * xi
    }

    /// Height of the contact wire that form finding prescribes at a node, m.
    ///
    /// ```text
    /// z = h − presag · 4 ξ (1 − ξ)        ξ position within the span, 0…1; h straight between the supports
    /// ```
    #[must_use]
    pub fn prescribed_height(&self, catenary: &Catenary, node: usize) -> f64 {
        let (span, xi) = self.within_span(NodeOfWire { wire: CONTACT, node });
        let line = catenary.first();
        let (a, b) = (line.height_at(span), line.height_at(span + 1));
        a + (b - a) * xi - line.presag_of(span) * 4.0 * xi * (1.0 - xi)
    }
}
