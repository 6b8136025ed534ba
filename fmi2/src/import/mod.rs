//! Import: any FMI 2.0 co-simulation FMU, through its C interface.
//!
//! [`Fmu::open`] unpacks and reads it, [`Fmu::instantiate`] loads the binary and gives an [`Instance`]. Everything is
//! undone in reverse order when the last of them is dropped: states, terminate, free, unload, remove the folder.
//! After `fmi2Fatal` nothing of the FMU is called any more and it stays loaded [FMI 2.0, 2.1.3].
//!
//! An FMU is native code with the rights of the user: it can do to this process whatever it likes.

mod binary;
mod fmu;
mod host;
mod instance;
mod log;
mod state;
mod stepping;
mod values;

pub use fmu::{Fmu, Keep, Options};
pub use instance::Instance;
pub use log::LogMessage;
pub use state::StateHandle;
pub use stepping::StepOutcome;
