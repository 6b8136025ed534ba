//! Import: any FMI 2.0 co-simulation FMU, through its C interface.
//!
//! [`Fmu::open`] unpacks and reads an FMU, [`Fmu::instantiate`] loads the binary and gives an [`Instance`]. All steps
//! are undone in reverse order when the last instance is dropped: states, terminate, free, unload, remove the folder.
//! After `fmi2Fatal` the FMU is not called any more and stays loaded [FMI 2.0, 2.1.3].
//!
//! An FMU is native code with the rights of the user and can do anything to this process. The directory, the locale and
//! the floating-point mode are restored after instantiation and initialisation; [`guard`] reports crashes, endless
//! loops and `exit()`. Full protection takes a process of its own, see [`process`].

mod binary;
mod fmu;
pub mod guard;
mod host;
mod instance;
mod log;
#[cfg(unix)]
pub mod process;
mod state;
mod stepping;
mod values;

pub use fmu::{Fmu, Options};
pub use instance::Instance;
pub use log::{Listener, LogMessage};
pub use state::StateHandle;
pub use stepping::StepOutcome;
