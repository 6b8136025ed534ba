//! What a run leaves behind: the record, its summary, and the files of an output directory.
//!
//! | file | content |
//! | --- | --- |
//! | `scene.toml` | the resolved scene, as it was run |
//! | `timeseries.csv` | the record, one row per output step, SI |
//! | `summary.json` | figures of the evaluation range, limits, model, cost |
//! | `animation.json` | coarse pictures of line and pantograph |
//! | `report.html` | one page for reading, made from the files above |

mod animation;
mod directory;
mod error;
mod record;
mod series;
mod summary;
#[cfg(test)]
pub(crate) mod tests;

pub use animation::{Animation, DropperLine, Frame};
pub(crate) use directory::io;
pub use directory::{OutputDirectory, RunBundle, SUMMARY};
pub use error::ResultsError;
pub use record::{LineGeometry, Record, StripRecord, SupportRecord, WindRecord};
pub use series::{read_timeseries, write_timeseries};
pub use summary::{
    ContactForceSummary, Cost, Coupling, Evaluation, Model, PantographSummary, Part, RunInfo, Share, StripSummary,
    Summary, Uplift,
};
