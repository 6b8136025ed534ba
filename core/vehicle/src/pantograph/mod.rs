//! Pantographs: masses in a chain, or a mechanism of rigid bodies.
mod air;
mod base_mount;
mod builder;
mod chain;
mod curve;
mod equilibrium;
mod linkage;
mod lumped;
mod one_motion;
mod plane;
mod reduced;
mod statics;
mod table;
#[cfg(test)]
mod tests;

pub use air::{Air, AirMarker, ReducedPoint};
pub(crate) use base_mount::BaseMount;
pub use chain::{ChainElement, ChainInertia, ChainMasses, FRICTION_VELOCITY, HeadMarker};
pub use equilibrium::Equilibrium;
pub(crate) use equilibrium::Offsets;
pub use linkage::Linkage;
pub use lumped::Lumped;
pub use one_motion::ReducedStrip;
pub use reduced::ReducedLinkage;
pub(crate) use statics::Target;
