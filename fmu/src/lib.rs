//! Any [`component::Component`] as an FMI 2.0 co-simulation slave.
//!
//! The packages `fmu-catenary` and `fmu-pantograph` only name their component and export it; the model description of a
//! scene comes from the same tables through [`description`].
#![forbid(unsafe_code)]

mod slave;
mod table;

pub use slave::{SCENE_RESOURCE, SceneSlave, checkpoint};
pub use table::{WORK, description};
