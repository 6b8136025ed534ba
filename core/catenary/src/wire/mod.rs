//! A wire: a chain of cable elements in the coordinates of a system.
//!
//! ```text
//! file        subject
//! geometry    nodes, elements and the curve between them
//! node        coordinates of a node
//! point       position, gradients and velocity at a point
//! force       strain, weight, damping and inertia of the whole wire
//! batch       the same of cable elements, several side by side
//! rows        numbers of the nodes as rows
//! places      positions of the entries of element matrices in the assembled one
//! enrichment  unknown of a bending layer at an attachment
//! layer       forces of the bending layers
//! directors   two directors per node: beam elements
//! beam        the directors of a scene's contact wire
//! drag        force of the wind on a wire
//! wind        the wind of a scene on both wires
//! ```
mod batch;
mod beam;
mod directors;
mod drag;
mod enrichment;
mod force;
mod geometry;
mod layer;
mod node;
mod places;
mod point;
mod rows;
#[cfg(test)]
mod tests;
mod wind;

pub(crate) use beam::contact_wire_directors;
pub use directors::{DirectorInertia, Directors, WireDirectors};
pub use drag::WireDrag;
pub use enrichment::Enrichment;
pub use force::{Rayleigh, Wire, WireSection};
pub use geometry::WireGeometry;
pub use node::{NodeMap, WireNode};
pub use point::WirePoint;
pub use wind::WiresInWind;
