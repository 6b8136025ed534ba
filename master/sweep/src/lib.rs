//! Sweeps: many cases of one scene, on all cores, into one table.
//!
//! | file | subject |
//! | --- | --- |
//! | `file` | a sweep as a TOML file, and as options of the command line: [`Wishes`] |
//! | `values` | values of a key: list, range, distribution |
//! | `expression` | derived values and constraints |
//! | `design` | combinations and samples |
//! | `plan` | [`Plan`]: from wishes to cases |
//! | `base` | the scene that all cases are made of |
//! | `case` | one case: scene, run, record |
//! | `record` | figures and costs of a case |
//! | `journal` | finished cases on disk: a sweep that was ended goes on |
//! | `run` | [`Sweep`]: all cases on a pool, tables at the end |
//! | `table`, `parquet` | the table as CSV and as Parquet |
//! | `page` | `sweep.html` |
//! | `sensitivity` | how much results depend on numbers that are not known for certain |
//!
//! Workers, status and identity are those of [`experiments::engine`]. Its
//! [`Experiment`](experiments::engine::Experiment) and store are not used: these hold the whole plan and all runs in
//! memory, judge the table after each run and keep two files for each, where a sweep has up to millions of cases.
#![forbid(unsafe_code)]

pub mod base;
pub mod case;
pub mod design;
mod error;
mod expression;
pub mod file;
pub mod journal;
pub mod page;
pub mod parquet;
pub mod plan;
pub mod record;
pub mod run;
pub mod sensitivity;
pub mod table;
#[cfg(test)]
mod tests;
pub mod values;

pub use base::Base;
pub use case::Made;
pub use error::SweepError;
pub use file::Wishes;
pub use plan::Plan;
pub use run::{Options, Summary, Sweep};
