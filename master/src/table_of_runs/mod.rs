//! Tables that compare runs: one row per run, the same columns in every table.
//!
//! | part | subject |
//! | --- | --- |
//! | [`Row`] | the columns |
//! | [`Curve`] | the contact force of a run against position, and its difference from another run's |
//! | [`Status`] | stable, limit, diverged or refused, by stated bounds |
//! | [`Variant`], [`perform()`] | a scene with some keys changed, run and timed |
//! | [`write()`] | the file |

mod curve;
mod perform;
mod row;
mod status;
#[cfg(test)]
mod tests;

pub use curve::{Curve, Errors, pointwise_rms};
pub use perform::{Performed, Stage, Variant, perform};
pub use row::{Column, Row, observed_orders, write};
pub use status::{ENERGY, LOSS, RAW_ERROR, RUNAWAY, STATUS_RULE, Status};
