//! Motion in modes, each a damped oscillator by itself.
//!
//! | file | subject |
//! | --- | --- |
//! | `step` | exact solution of a mode over a step |
//! | `kernels` | sums over all modes in the vector registers of the processor |
pub mod kernels;
mod step;

pub use step::StepFactors;
