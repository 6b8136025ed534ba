//! Import: any FMI 2.0 co-simulation FMU, through its C interface.
//!
//! [`Fmu::open`] unpacks and reads it, [`Fmu::instantiate`] loads the binary and gives an [`Instance`]. Everything is
//! undone in reverse order when the last of them is dropped: states, terminate, free, unload, remove the folder.
//! After `fmi2Fatal` nothing of the FMU is called any more and it stays loaded [FMI 2.0, 2.1.3].
//!
//! An FMU is native code with the rights of the user: it can do to this process whatever it likes. The directory, the
//! locale and the floating-point mode are put back after it was instantiated and initialised; [`guard`] says what is done about crashes,
//! endless loops and `exit()`. What is left is a process of its own, which [`process`] helps to make.

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

pub use fmu::{Fmu, Keep, Options};
pub use instance::Instance;
pub use log::{Listener, LogMessage};
pub use state::StateHandle;
pub use stepping::StepOutcome;
