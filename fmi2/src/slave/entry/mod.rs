//! The functions of the C interface, generic over the model; [`export_fmu!`](crate::export_fmu) gives them their names.
//!
//! One safety condition holds for all: callers follow FMI 2.0, that is, call with a component of `fmi2Instantiate` of
//! the same model that has not been freed (or null), with pointers to as many elements as the count argument says (or
//! null), and never twice at the same time for one component.
#![allow(clippy::missing_safety_doc)] // one condition for all, above

mod lifecycle;
mod states;
mod stepping;
mod values;

pub use lifecycle::*;
pub use states::*;
pub use stepping::*;
pub use values::*;
