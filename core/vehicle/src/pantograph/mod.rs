//! Pantographs: masses in a chain, or a mechanism of rigid bodies.
mod builder;
mod chain;
mod equilibrium;
mod linkage;
mod lumped;
mod statics;
#[cfg(test)]
mod tests;

pub use chain::{ChainElement, ChainMasses, FRICTION_VELOCITY, HeadMarker};
pub use equilibrium::Equilibrium;
pub use linkage::Linkage;
pub use lumped::Lumped;
