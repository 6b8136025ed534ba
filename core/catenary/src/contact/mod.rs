//! Contact between the contact wire and collector strips.
mod compliance;
mod geometry;
mod law;
mod pair;
mod state;
mod strip;

pub use compliance::{Compliance, CompliantWire, ResidualCompliance};
pub use geometry::ContactGeometry;
pub use law::PenaltyContact;
pub use pair::{ContactPair, ContactTangent};
pub use state::{ContactState, Sensitivity};
pub use strip::{PrescribedStrip, STRIP_INPUTS};
