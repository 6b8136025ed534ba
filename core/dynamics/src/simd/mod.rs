//! Several elements, nodes or droppers side by side in the vector registers of the processor.
//!
//! ```text
//! file       subject
//! number     numbers and vectors that laws compute with: those of one element, or of several side by side
//! lanes      one number of several elements in a vector register
//! transpose  rows among the coordinates to columns in the registers, and back
//! ```
mod lanes;
mod number;
mod transpose;

pub use lanes::{Components, GROUP, Lanes};
pub use number::{Number, Space};
pub use transpose::{Transpose, change, run};
