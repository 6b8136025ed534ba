//! Motion in modes, each a damped oscillator by itself.
//!
//! | file | subject |
//! | --- | --- |
//! | `aligned` | numbers of all modes in memory |
//! | `packed` | these as bytes |
//! | `step` | solution of a mode over a step |
//! | `bend` | force that a member which only pulls lacks within a step |
//! | `kernels` | sums over all modes in the vector registers of the processor |
mod aligned;
mod bend;
pub mod kernels;
mod packed;
mod step;

pub use aligned::Aligned;
pub use bend::bend;
pub use step::{Factors, LARGEST_TURN, StepFactors};
