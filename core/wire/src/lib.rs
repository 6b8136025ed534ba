//! A wire of an overhead line: a chain of cable elements in the coordinates of a system, with damping, inertia, bending
//! layers and the force of the air.
//!
//! ```text
//! file        subject
//! curve       a wire as contact sees it
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
//! drag        force of the wind on a wire
//! ```
#![forbid(unsafe_code)]

mod batch;
mod curve;
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

pub use curve::{Compliance, CurveColumn, CurveColumns, CurvePoint, LoadCorrection, WireCurve};
pub use directors::{DirectorInertia, Directors, WireDirectors};
pub use drag::WireDrag;
pub use enrichment::Enrichment;
pub use force::{Rayleigh, Wire, WireSection};
pub use geometry::{WireGeometry, element_between};
pub use node::{NodeMap, WireNode};
pub use point::WirePoint;
