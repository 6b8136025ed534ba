//! Tables that compare runs: one row per run, the same columns in every table.
//!
//! | part | subject |
//! | --- | --- |
//! | [`RunRow`] | the columns |
//! | [`Columns`] | columns that only one table has |
//! | [`Status`] | stable, limit, diverged or refused, by stated bounds |
//! | [`Keys`] | overrides of a run with another algorithm |

mod columns;
mod keys;
mod row;
mod status;
#[cfg(test)]
mod tests;

pub use columns::{Column, Columns};
pub use keys::{AUTO, Keys};
pub(crate) use row::joined;
pub use row::{Cell, RunRow, observed_orders};
pub use status::{ENERGY, LOSS, RAW_ERROR, RUNAWAY, STATUS_RULE, Status};
