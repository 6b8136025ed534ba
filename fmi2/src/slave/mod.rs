//! Export: the runtime that makes an FMU of a [`Model`].
//!
//! A shell crate of type `cdylib` implements [`Model`] and calls [`export_fmu!`](crate::export_fmu). The runtime keeps
//! the order of calls [FMI 2.0, 4.2.4], checks every argument before the model sees it, catches panics, saves and
//! restores states and talks to the importer's logger. The runtime has no state outside the instances but the silent
//! panic hook of its own copy of the standard library, and stays in memory after the first instance.
//!
//! A refused call leaves values unchanged. After a refused change the instance is unusable until restored, reset or
//! freed [FMI 2.0, 2.1.3]; a refused read has no consequence.

#[doc(hidden)]
pub mod entry;
mod export;
mod guard;
mod instance;
mod library;
mod logger;
mod model;
mod phase;
mod resources;
mod saved;

pub use logger::log_categories;
pub use model::{Experiment, Model, ModelError, ModelResult};
pub use phase::Phase;
pub use resources::GUID_FILE;
pub use saved::model_part;
