//! Pantographs: masses in a chain, or a mechanism of rigid bodies.
//!
//! | file | subject |
//! | --- | --- |
//! | `interface` | the trait of all pantographs, and the choice of a model for a scene's entry |
//! | `lumped` | masses one above the other |
//! | `linkage` | rigid bodies and joints; statics |
//! | `reduced` | a linkage in the two coordinates that joints leave free |
//! | `base_mount` | fixing of the base: travelling frame, given motion, vehicle |
//! | `air` | points exposed to the wind |
//! | `equilibrium` | a pantograph at rest |
mod air;
mod base_mount;
mod equilibrium;
mod interface;
mod linkage;
mod lumped;
mod reduced;
#[cfg(test)]
mod tests;

pub use air::Air;
pub(crate) use base_mount::{BaseDisplacement, BaseMount};
pub use equilibrium::Equilibrium;
pub(crate) use equilibrium::{Offsets, Target};
pub(crate) use interface::{Pantograph, build, reference_x};
pub use linkage::Linkage;
use lumped::HeadMarker;
pub(crate) use lumped::Lumped;
#[cfg(test)]
use lumped::{ChainDrive, ChainElement, ChainInertia, Foot};
use reduced::{ReducedLinkage, ReducedPoint, ReducedStrip};
