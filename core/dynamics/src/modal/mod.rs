//! Motion in modes, each a damped oscillator by itself.
//!
//! | file | subject |
//! | --- | --- |
//! | `aligned` | numbers of all modes in memory |
//! | `step` | solution of a mode over a step |
//! | `kernels` | sums over all modes in the vector registers of the processor |
mod aligned;
pub mod kernels;
mod step;

pub use aligned::Aligned;
pub use step::{Factors, StepFactors};
