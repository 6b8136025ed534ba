//! Contact between the contact wire and collector strips.
mod geometry;
mod law;
mod pair;
mod strip;

pub use geometry::ContactGeometry;
pub use law::PenaltyContact;
pub use pair::{ContactPair, ContactState, ContactTangent, Sensitivity};
pub use strip::{PrescribedStrip, STRIP_INPUTS};
