//! Tables that compare runs: one row per run, the same columns in every table.
//!
//! | part | subject |
//! | --- | --- |
//! | [`Row`] | the columns |
//! | [`Curve`] | the contact force of a run against position, and its difference from another run's |
//! | [`Status`] | stable, limit, diverged or refused, by stated bounds |
//! | [`Variant`], [`attempt()`], [`perform()`] | a scene with some keys changed, run once, or run and timed |
//! | [`Keys`] | what a scene's own keys mean for such a variant |
//! | [`write()`] | the file |

mod curve;
mod format;
mod keys;
mod perform;
mod row;
mod status;
#[cfg(test)]
mod tests;

pub use curve::{Curve, Errors, NO_ERRORS, pointwise_rms};
pub(crate) use format::{milliseconds, short, significant, wrapped};
pub use keys::{AUTO, Keys, macro_step};
pub use perform::{Attempt, Performed, SETTLE, Stage, Variant, attempt, median, perform, settled};
pub(crate) use row::Cell;
pub use row::{Column, Row, observed_orders, write};
pub use status::{ENERGY, LOSS, RAW_ERROR, RUNAWAY, STATUS_RULE, Status};
