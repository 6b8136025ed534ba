//! Contact between the contact wire and collector strips.
//!
//! ```text
//! file            subject
//! corrected_wire  a wire with the corrections of its mesh and of the time step
//! compliance      deflection under a strip that the mesh lacks
//! moving_load     force that a corrected inertia asks for under a moving strip
//! geometry        contact point of a wire and a strip
//! law             penalty law
//! state           gap, force and their derivatives at one instant
//! sides           columns of wire and strip at their contact
//! pair            penalty contact as a contribution of forces
//! sliding_joint   bilateral contact as a constraint
//! on_wire         a strip under either law
//! surface         running surface of a wire
//! total           a strip on all contact wires together
//! strip           a strip whose motion is prescribed
//! ```
#![forbid(unsafe_code)]

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
mod surface;
mod total;

pub use compliance::ResidualCompliance;
pub use corrected_wire::CorrectedWire;
pub use geometry::ContactGeometry;
pub use law::PenaltyContact;
pub use on_wire::{OnWire, StripContact};
pub use pair::{ContactPair, ContactTangent};
pub use sliding_joint::SlidingJoint;
pub use state::{ContactState, Sensitivity};
pub use strip::{PrescribedStrip, STRIP_INPUTS, STRIP_VALUES};
pub use surface::RunningSurface;
pub use total::ContactTotal;
