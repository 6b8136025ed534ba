//! Low-rank updates `U C Uᵀ` of a factored matrix.
//!
//! | file | subject |
//! | --- | --- |
//! | `updates` | the terms, as contributions push them in each iteration |
//! | `woodbury` | solutions with the factors of the matrix without them |

mod updates;
mod woodbury;

pub(crate) use updates::PLACEHOLDER;
pub use updates::Updates;
pub(crate) use woodbury::Woodbury;
