//! Contact between the contact wire and collector strips.
mod at_start;
mod compliance;
mod geometry;
mod law;
mod on_wire;
mod pair;
mod sides;
mod sliding_joint;
mod state;
mod strip;

pub use at_start::AtStart;
pub use compliance::{Compliance, CompliantWire, ResidualCompliance};
pub use geometry::ContactGeometry;
pub use law::PenaltyContact;
pub use on_wire::{OnWire, StripContact};
pub use pair::{ContactPair, ContactTangent};
pub use sliding_joint::SlidingJoint;
pub use state::{ContactState, Sensitivity};
pub use strip::{PrescribedStrip, STRIP_INPUTS};
