//! The engine of all experiments: a plan of runs, made on one pool, kept in one store, judged into one table, exported.
//!
//! | part | subject |
//! | --- | --- |
//! | [`plan`] | [`Experiment`]: the plan, the making of a job, the judge |
//! | [`run`] | a scene with some keys changed, run once: [`Run`], [`Attempt`] |
//! | [`pool`] | jobs side by side, timings one at a time, progress, end: [`execute()`], [`side_by_side()`] |
//! | [`store`] | runs that are kept, so that an experiment that was ended goes on: [`Store`] |
//! | [`table`] | one row per run with the same columns everywhere, status |
//! | [`export`] | [`Exporter`]: a table as CSV, JSON, HTML, text |
//! | `data` | data files that are part of the program |
//! | `words` | choices that tables name by one word |
//!
//! A new experiment is a plan and a judge: a type that implements [`Experiment`], and its table that implements
//! [`Table`].

mod data;
pub mod export;
pub mod plan;
pub mod pool;
pub mod run;
pub mod store;
pub mod table;
#[cfg(test)]
pub(crate) mod tests;
mod words;

pub(crate) use data::entries;
pub use export::{Exporter, Sheet, Table};
pub use plan::{Experiment, ExperimentError, Planned, Timing, Unmade};
pub use pool::{Bench, Crew, Guard, Site, Timed, execute, side_by_side};
pub(crate) use run::median;
pub use run::{Attempt, Run, Stage, Variant};
pub use store::{Store, Times};
pub(crate) use words::words;
