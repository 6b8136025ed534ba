//! Fastenings of the wires: messenger supports, registration arms, tensioned ends.
//!
//! ```text
//! file              subject
//! attachment        a node of a wire and its displacements, as everything fastened to it sees them
//! anchor            springs between a node and the ground, with the static reaction as preload
//! messenger         supports of the messenger wire at the masts
//! registration_arm  arms that pull the contact wire to its stagger
//! point_mass        clamps, insulators and splices on the wires
//! dead_load         loads that do not depend on the motion
//! line_end          ends of the wires under constant tension
//! ```
mod anchor;
mod attachment;
mod dead_load;
mod line_end;
mod messenger;
mod point_mass;
mod registration_arm;

pub use anchor::Anchor;
pub use attachment::Attachment;
pub(crate) use attachment::add_block;
pub(crate) use dead_load::DeadLoad;
pub(crate) use line_end::HOLDING_STIFFNESS;
pub use line_end::{LineEnd, LineEnds};
pub use messenger::Supports;
pub use point_mass::PointMasses;
pub use registration_arm::RegistrationArms;
