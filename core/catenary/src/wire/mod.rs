//! A wire: a chain of cable elements in the coordinates of a system.
mod batch;
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

pub use directors::{DirectorInertia, Directors, WireDirectors};
pub use drag::WireDrag;
pub use enrichment::Enrichment;
pub use force::{Rayleigh, Wire, WireSection};
pub use geometry::WireGeometry;
pub use node::{NodeMap, WireNode};
pub use point::WirePoint;
