//! Tangential forces of rolling contact.
mod dual;
mod fastsim;
mod law;
mod polach;
mod saturated;
#[cfg(test)]
mod tests;

pub use fastsim::Fastsim;
pub use law::{CreepLaw, CreepModel, CreepSlopes, Patch};
