//! FMI 2.0 for co-simulation, both sides of the C interface.
//!
//! - [`slave`]: export. A [`slave::Model`] has variables, steps and states and is free of C; [`export_fmu!`] turns the
//!   model into a shared library.
//! - [`model_description`]: `modelDescription.xml`, read and written.
//! - [`archive`]: the `.fmu` archive, written reproducibly and extracted with bounds.
//! - [`import`]: any FMU, loaded through its C interface.
//! - [`instance`]: an instance of an FMU, in this process or in another; [`isolation`]: FMUs in processes of their own.
//! - [`program`]: the file of the program, which libraries and children are looked for beside.
//! - [`scratch`]: private folders of unpacked archives; [`supervision`]: a process that watches FMUs in this one.
//! - [`abi`]: the C types.
//!
//! No other crate of the workspace has hand-written `unsafe`; every block says why it is sound.
//!
//! # Sources
//! - `[FMI 2.0, n]`: section n of Functional Mock-up Interface for Model Exchange and Co-Simulation, version 2.0.5,
//!   Modelica Association, 2024, <https://fmi-standard.org>.
//!
//! ```no_run
//! use fmi2::import::{Fmu, StepOutcome};
//!
//! # fn main() -> Result<(), fmi2::Error> {
//! let fmu = Fmu::open("Pantograph.fmu")?;
//! let mut pantograph = fmu.instantiate("pantograph 1", false, false)?;
//! pantograph.setup_experiment(0.0, Some(1.0), None)?;
//! pantograph.enter_initialization_mode()?;
//! pantograph.exit_initialization_mode()?;
//! let outcome = pantograph.do_step(0.0, 0.001)?;
//! assert_eq!(outcome, StepOutcome::Ok);
//! # Ok(())
//! # }
//! ```

pub mod abi;
pub mod archive;
mod error;
pub mod import;
pub mod instance;
pub mod isolation;
mod location;
pub mod model_description;
pub mod program;
pub mod scratch;
pub mod slave;
pub mod supervision;
mod text;

pub use error::{Error, Log};
pub use text::visible;
