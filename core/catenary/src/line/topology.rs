//! Nodes of a line: positions, coordinates and attached parts.
use crate::NodeMap;
use dynamics::Layout;
use nalgebra::Vector3;
use scene::{Catenary, Element, WireEnds};

/// Coordinates of the nodes of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dimension {
    /// Six coordinates per node.
    #[default]
    Spatial,
    /// Four coordinates per node, none of them lateral: for lines in which nothing moves sideways.
    Planar,
}

/// Unknowns for the bending layers at the attachments of the wires, see [`crate::Enrichment`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BendingLayers {
    /// Cubic elements only.
    #[default]
    Absent,
    /// One vertical layer per attachment and wire, and a lateral one at the supports of a line with lateral
    /// coordinates.
    AtAttachments,
    /// [`BendingLayers::AtAttachments`] and a layer at each end: the end of a section whose wires go on has half of the
    /// layer there. `ψ` and its slope vanish at the node, so that each half is a layer of its own.
    AtAttachmentsAndEnds,
}

/// A mass matrix for one time step, see [`crate::Line::with_mass_correction`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassCorrection {
    /// Internal step of the integrator, s.
    pub step: f64,
    /// Spectral radius of the integrator at infinite frequency, –.
    pub rho_inf: f64,
}

/// Discretisation of a line beyond the mesh of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineOptions {
    /// Coordinates per node.
    pub dimension: Dimension,
    /// Extra unknowns at attachments.
    pub layers: BendingLayers,
    /// Speed of the strips for which the contact wire has its residual compliance, m/s, see
    /// [`crate::ResidualCompliance`]. Statics use the compliance of a strip at rest, except for the start of a run.
    pub contact_compliance: Option<f64>,
    /// Corrected inertia of the wires; without effect on statics.
    pub mass_correction: Option<MassCorrection>,
}

/// One of the two wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireName {
    /// The lower wire, which collector strips touch.
    ContactWire,
    /// The upper wire, which carries the contact wire.
    MessengerWire,
}

impl WireName {
    /// Both wires, in the order in which coordinates are numbered.
    pub const BOTH: [Self; 2] = [Self::ContactWire, Self::MessengerWire];

    /// Name of the wire in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ContactWire => "contact_wire",
            Self::MessengerWire => "messenger_wire",
        }
    }

    /// Parameters of the wire in a scene.
    #[must_use]
    pub fn parameters(self, catenary: &Catenary) -> &scene::Wire {
        match self {
            Self::ContactWire => &catenary.contact_wire,
            Self::MessengerWire => &catenary.messenger_wire,
        }
    }
}

/// Place of a dropper in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DropperPlace {
    /// Span, counted from 1.
    pub span: usize,
    /// Number within the span, counted from 0.
    pub position: usize,
    /// Node of both wires.
    pub node: usize,
}

/// Nodes of both wires, which stand at the same x: supports, droppers, and equal divisions between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    x: Vec<f64>,
    span: Vec<usize>,
    supports: Vec<usize>,
    droppers: Vec<DropperPlace>,
    options: LineOptions,
    /// For each wire, true with bending stiffness; a string has no layers.
    bends: [bool; 2],
    element: Element,
}

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
    /// Divides the line of a scene.
    ///
    /// # Panics
    /// When a staggered line or one with beam elements is to be planar.
    #[must_use]
    pub fn new(catenary: &Catenary, options: LineOptions) -> Self {
        let staggered = catenary.stagger.iter().any(|y| *y != catenary.stagger[0]);
        let bends = WireName::BOTH.map(|name| name.parameters(catenary).bending_stiffness > 0.0);
        assert!(
            options.dimension == Dimension::Spatial || !staggered,
            "a staggered line has lateral coordinates"
        );
        assert!(
            options.dimension == Dimension::Spatial || catenary.mesh.element == Element::Cable,
            "a beam has lateral coordinates"
        );
        let (mut x, mut span, mut droppers) = (vec![0.0], vec![1], Vec::new());
        let mut supports = vec![0];
        for number in 1..=catenary.spans() {
            let (left, right) = (catenary.support_x(number - 1), catenary.support_x(number));
            let attachments = catenary.droppers.positions.iter().map(|position| left + position);
            let mut start = left;
            // Lengths within the span: equal spans have equal ones, while differences of x are rounded.
            let lengths = catenary.intervals_of(number - 1);
            for (position, (end, length)) in attachments.chain([right]).zip(lengths).enumerate() {
                let elements = catenary.mesh.division.elements(length);
                for i in 1..=elements {
                    let xi = i as f64 / elements as f64;
                    x.push(if i == elements { end } else { start + (end - start) * xi });
                    span.push(number);
                }
                if position < catenary.droppers.positions.len() {
                    droppers.push(DropperPlace {
                        span: number,
                        position,
                        node: x.len() - 1,
                    });
                }
                start = end;
            }
            supports.push(x.len() - 1);
        }
        Self {
            x,
            span,
            supports,
            droppers,
            options,
            bends,
            element: catenary.mesh.element,
        }
    }

    /// Discretisation of the line.
    #[must_use]
    pub fn options(&self) -> &LineOptions {
        &self.options
    }

    /// Nominal x of the nodes, m.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Nodes at the supports, from the first to the last.
    #[must_use]
    pub fn supports(&self) -> &[usize] {
        &self.supports
    }

    /// The droppers, span after span.
    #[must_use]
    pub fn droppers(&self) -> &[DropperPlace] {
        &self.droppers
    }

    /// Elements of both wires together.
    #[must_use]
    pub fn elements(&self) -> usize {
        2 * (self.x.len() - 1)
    }

    /// The last node.
    #[must_use]
    pub fn last(&self) -> usize {
        self.x.len() - 1
    }

    /// Supports that are not ends, with their number from 0.
    pub(crate) fn inner_supports(&self) -> impl Iterator<Item = (usize, usize)> {
        let count = self.supports.len();
        self.supports.iter().copied().enumerate().skip(1).take(count - 2)
    }

    /// Adds the coordinates of both wires, node after node (contact wire first), so that neighbours are close in the
    /// numbering.
    pub(crate) fn register(&self, layout: &mut Layout) -> [WireCoordinates; 2] {
        let mut wires = [WireCoordinates::default(), WireCoordinates::default()];
        let mut within = 0;
        for (node, &span) in self.span.iter().enumerate() {
            within = if node > 0 && self.span[node - 1] == span {
                within + 1
            } else {
                1
            };
            for ((wire, name), bends) in wires.iter_mut().zip(WireName::BOTH).zip(self.bends) {
                let label = format!("{}, span {span}, node {within}", name.name());
                wire.nodes.push(match self.options.dimension {
                    Dimension::Spatial => NodeMap::spatial(layout.add_coordinates(6, label.clone())),
                    Dimension::Planar => NodeMap::planar(layout.add_coordinates(4, label.clone())),
                });
                if self.element == Element::Beam && name == WireName::ContactWire {
                    let name = format!("{label}, directors");
                    wire.directors.push(layout.add_coordinates(6, name));
                }
                for direction in self.layer_directions(node).into_iter().filter(|_| bends) {
                    let index = layout.add_coordinates(1, format!("{label}, bending layer"));
                    wire.layers.push(LayerCoordinate { node, index, direction });
                }
            }
        }
        wires
    }

    fn layer_directions(&self, node: usize) -> Vec<Vector3<f64>> {
        let support = self.supports.binary_search(&node).is_ok();
        let dropper = self.droppers.binary_search_by_key(&node, |place| place.node).is_ok();
        let inner = node > 0 && node < self.last();
        let has_layers = match self.options.layers {
            BendingLayers::Absent => false,
            BendingLayers::AtAttachments => inner && (support || dropper),
            BendingLayers::AtAttachmentsAndEnds => support || dropper,
        };
        if !has_layers {
            return Vec::new();
        }
        let mut directions = vec![Vector3::z()];
        if support && self.options.dimension == Dimension::Spatial {
            directions.push(Vector3::y());
        }
        directions
    }

    /// Holds the directors while the wires are treated as cables.
    pub(crate) fn hold_directors(wires: &[WireCoordinates; 2], layout: &mut Layout) {
        for &first in wires.iter().flat_map(|wire| &wire.directors) {
            (first..first + 6).for_each(|index| layout.fix(index));
        }
    }

    /// Holds the ends of both wires: y and z always, x for fixed ends; a beam is also held against spinning about its
    /// axis.
    pub(crate) fn fix_ends(&self, wires: &[WireCoordinates; 2], ends: WireEnds, layout: &mut Layout) {
        for wire in wires {
            for directors in wire.directors.first().into_iter().chain(wire.directors.last()) {
                layout.fix(directors + 2);
            }
            for map in [wire.nodes[0], wire.nodes[self.last()]] {
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

    /// Lateral position of both wires at a node, m: straight between the stagger of neighbouring supports.
    #[must_use]
    pub fn lateral(&self, catenary: &Catenary, node: usize) -> f64 {
        let number = self.span[node];
        let (left, right) = (self.x[self.supports[number - 1]], self.x[self.supports[number]]);
        let xi = (self.x[node] - left) / (right - left);
        let (a, b) = (catenary.stagger_at(number - 1), catenary.stagger_at(number));
        a + (b - a) * xi
    }

    /// Height of the contact wire that form finding prescribes at a node, m.
    ///
    /// ```text
    /// z = h − presag · 4 ξ (1 − ξ)        ξ position within the span, 0…1
    /// ```
    #[must_use]
    pub fn prescribed_height(&self, catenary: &Catenary, node: usize) -> f64 {
        let number = self.span[node];
        let (left, right) = (self.x[self.supports[number - 1]], self.x[self.supports[number]]);
        let xi = (self.x[node] - left) / (right - left);
        catenary.contact_wire_height - catenary.presag * 4.0 * xi * (1.0 - xi)
    }
}
