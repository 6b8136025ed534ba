//! The overhead line as a list of contributions, in full, linearised, or as a window that follows the strips.
//!
//! ```text
//! file          subject
//! overhead      the trait that contact and coupling see: any line
//! topology      nodes of a line, their positions and their coordinates
//! nonlinear     the line in full: wires, droppers, supports, arms, ends
//! linear        constant matrices with unilateral droppers
//! linear_force  a force linear in coordinates, velocities and accelerations
//! window        the line in full around the strips, condensed elsewhere
//! ```
mod linear;
mod linear_force;
mod nonlinear;
mod overhead;
mod topology;
pub(crate) mod window;

pub use linear::{LinearDropper, LinearDroppers, LinearLine};
pub use linear_force::LinearForce;
pub use nonlinear::{DropperSample, Line};
pub(crate) use nonlinear::{Equilibrium, layers, wire};
pub use overhead::{OverheadLine, adopt_state, follow_strips};
pub(crate) use topology::WireCoordinates;
pub use topology::{BendingLayers, Dimension, DropperPlace, LineOptions, MassCorrection, Topology, WireName};
pub use window::{WindowSize, WindowedLine};
