//! The engine of all experiments: a plan of runs, made on one pool, kept in one store, judged into one table, exported.
//!
//! | part | subject |
//! | --- | --- |
//! | [`plan`] | [`Experiment`]: the plan, the making of a job, the judge |
//! | [`run`] | a scene with some keys changed, run once: [`Run`], [`Attempt`] |
//! | [`pool`] | jobs side by side, timings one at a time, progress, end: [`execute()`], [`side_by_side()`] |
//! | [`store`] | runs that are kept, so that an experiment that was ended goes on: [`Store`] |
//! | `memory` | memory that a time loop touches |
//! | [`table`] | one row per run with the same columns everywhere, contact forces, status |
//! | [`export`] | [`Exporter`]: a table as CSV, JSON, HTML, text |
//!
//! A new experiment is a plan and a judge: a type that implements [`Experiment`], and its table that implements
//! [`Table`].

pub mod export;
mod memory;
pub mod plan;
pub mod pool;
pub mod run;
pub mod store;
pub mod table;
#[cfg(test)]
pub(crate) mod tests;

pub use export::{Exporter, Sheet, Table};
pub use plan::{Experiment, ExperimentError, Planned, Timing, Unmade};
pub use pool::{Bench, Crew, Guard, Site, Timed, execute, side_by_side};
pub(crate) use run::median;
pub use run::{Attempt, Evidence, Run, Stage, Variant};
pub use store::{Store, Times};
