//! Contact between the contact wire and collector strips.
mod compliance;
mod corrected_wire;
mod geometry;
mod law;
mod moving_load;
mod on_wire;
mod pair;
mod sides;
mod sliding_joint;
mod state;
mod strip;

pub use compliance::{Compliance, ResidualCompliance};
pub use corrected_wire::CorrectedWire;
pub use geometry::ContactGeometry;
pub use law::PenaltyContact;
pub use moving_load::LoadCorrection;
pub use on_wire::{OnWire, StripContact};
pub use pair::{ContactPair, ContactTangent};
pub use sliding_joint::SlidingJoint;
pub use state::{ContactState, Sensitivity};
pub use strip::{PrescribedStrip, STRIP_INPUTS, STRIP_VALUES};
