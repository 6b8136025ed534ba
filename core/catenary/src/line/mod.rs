//! The overhead line as a list of contributions, in full, linearised, or as a window that follows the strips.
//!
//! ```text
//! file          subject
//! overhead      the trait that contact and coupling see: any line
//! options       discretisation beyond the mesh of the scene
//! topology      wires of a line, their nodes, and the parts that join them
//! coordinates   coordinates of the wires
//! curve_pull    pull of curved track on the wires
//! nonlinear     the line in full: wires, droppers, supports, arms, ends
//! beam          directors of a contact wire of beams
//! in_wind       the wind of a scene on a line
//! parts_in_wind droppers and registration arms in the wind
//! linear        constant matrices with unilateral droppers
//! modal         the linearised line in its own modes
//! uplift        uplift of the contact wires at the masts
//! window        the line in full around the strips, condensed elsewhere
//! ```
mod beam;
mod coordinates;
mod curve_pull;
mod in_wind;
mod linear;
pub(crate) mod modal;
mod nonlinear;
mod options;
mod overhead;
mod parts_in_wind;
mod topology;
mod uplift;
pub(crate) mod window;

pub(crate) use coordinates::WireCoordinates;
pub(crate) use curve_pull::curve_pull;
pub(crate) use in_wind::AirOnLine;
pub use in_wind::WindOnLine;
pub use linear::{LinearDropper, LinearDroppers, LinearLine};
pub use modal::ModalLine;
pub use nonlinear::{DropperSample, Line};
pub(crate) use nonlinear::{Equilibrium, layers, wire};
pub use options::{BendingLayers, Dimension, LineOptions, MassCorrection};
pub use overhead::{OverheadLine, adopt_state, follow_strips};
pub use topology::{DropperPlace, NodeOfWire, PlannedWire, Topology, WireName};
pub(crate) use topology::{EndsOfWire, Part};
pub(crate) use uplift::Uplift;
pub use window::{WindowSize, WindowedLine};
