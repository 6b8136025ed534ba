//! Rigid bodies, joints, springs and loads in the frame of the base.
//!
//! | file | subject |
//! | --- | --- |
//! | `body` | rigid bodies, their coordinates and markers |
//! | `anchor` | ends of joints and springs |
//! | `measure` | scalar functions of two anchors, with derivatives |
//! | `joint` | ideal joints |
//! | `axial_spring`, `bushing`, `characteristic` | springs and dampers |
//! | `dead_force`, `applied_force` | constant forces, force of a drive and contact force as inputs |
//! | `joint_moment` | moment of a drive as an input |
mod anchor;
mod applied_force;
mod axial_spring;
mod body;
mod bushing;
mod characteristic;
mod dead_force;
mod joint;
mod joint_moment;
mod measure;
#[cfg(test)]
mod tests;

pub(crate) use anchor::GivenMarker;
pub use anchor::{Anchor, BaseMarker};
pub use applied_force::AppliedForce;
pub(crate) use axial_spring::AxialSpring;
pub use body::{BodyMarker, Pose, RigidBody};
pub(crate) use body::{BodyNow, Grip, Wrench};
pub use bushing::Bushing;
pub(crate) use bushing::{Bushings, Rates};
pub(crate) use characteristic::Characteristic;
pub(crate) use dead_force::{DeadForce, DriveForce};
pub use joint::Joint;
pub(crate) use joint_moment::JointMoment;
pub(crate) use measure::{Measure, Pair, add_square};
