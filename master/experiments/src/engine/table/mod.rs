//! Tables that compare runs: one row per run, the same columns in every table.
//!
//! | part | subject |
//! | --- | --- |
//! | [`RunRow`] | the columns |
//! | [`Columns`] | columns that only one table has |
//! | [`ForceCurve`] | the contact force of a run against position, and its difference from another run's |
//! | [`Status`] | stable, limit, diverged or refused, by stated bounds |
//! | [`Keys`] | overrides of a run with another algorithm |

mod columns;
mod curve;
mod format;
mod keys;
mod row;
mod status;
#[cfg(test)]
mod tests;

pub use columns::{Column, Columns};
pub use curve::{Errors, ForceCurve, NO_ERRORS, pointwise_rms};
pub(crate) use format::{joined, milliseconds, or_dash, short, significant};
pub use keys::{AUTO, Keys, macro_step};
pub(crate) use row::Cell;
pub use row::{RunRow, observed_orders};
pub use status::{ENERGY, LOSS, RAW_ERROR, RUNAWAY, STATUS_RULE, Status};
