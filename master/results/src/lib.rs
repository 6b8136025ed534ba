//! Results of a run: record, statistics, limits of standards, the files of an output directory, and the report.
//!
//! | file | content |
//! | --- | --- |
//! | `scene.toml` | the resolved scene, as it was run |
//! | `timeseries.csv` | the record, one row per output step, SI |
//! | `summary.json` | figures of the evaluation range, limits, model, cost |
//! | `animation.json` | coarse pictures of line and pantograph |
//! | `report.html` | one page for reading, made from the files above |

#![forbid(unsafe_code)]

mod animation;
pub mod curve;
mod detail;
mod directory;
mod error;
pub mod explain;
mod head;
mod instrument;
mod machine;
mod record;
pub mod recorder;
pub mod report;
mod series;
pub mod standards;
pub mod statistics;
mod summary;
#[cfg(test)]
pub(crate) mod tests;
mod undecided;
mod wearing;

pub use animation::Animation;
pub use detail::{ContactHeight, Detail, OtherFilter};
pub use directory::{OutputDirectory, RunBundle, SUMMARY};
pub use directory::{io, write_json};
pub use error::ResultsError;
pub use instrument::{Bending, Gain, Instrument, Measured};
pub use machine::Machine;
pub use record::{DropperRow, LineGeometry, NamedSeries, Record, StripRecord, SupportRecord, WindRecord};
pub use series::{read_timeseries, write_timeseries};
pub use summary::{
    Accuracy, ContactForceSummary, Cost, Coupling, ErrorShare, Evaluation, Model, PantographSummary, Part, RunInfo,
    StripSummary, Summary, SupportUplift, Uncertainty, Uplift,
};
pub use wearing::Wearing;
