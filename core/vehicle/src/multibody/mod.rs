//! Rigid bodies, joints, springs and loads in the frame of the base.
mod anchor;
mod applied_force;
mod axial_spring;
mod body;
mod bushing;
mod characteristic;
mod dead_force;
mod joint;
mod measure;
#[cfg(test)]
mod tests;

pub use anchor::{Anchor, BaseMarker, GivenMarker};
pub use applied_force::AppliedForce;
pub use axial_spring::AxialSpring;
pub use body::{BodyMarker, Pose, RigidBody};
pub use bushing::{Bushing, BushingLoad, Rates};
pub use characteristic::{Characteristic, CharacteristicError};
pub use dead_force::DeadForce;
pub use joint::Joint;
pub(crate) use measure::{Measure, Pair, add_square};
