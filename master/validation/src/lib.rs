//! Validation: reference models against their ranges, in every mode, as a record that can be kept.
//!
//! | file | subject |
//! | --- | --- |
//! | `model` | [`ReferenceModel`]: a file of cases with their ranges |
//! | `measured` | [`MeasuredFiles`]: measured series beside the computed ones |
//! | `record` | [`Record`]: runs of the cases, and what they show |
//! | `page` | `validation.html` |
#![forbid(unsafe_code)]

mod measured;
mod model;
mod page;
mod record;

pub use measured::{Compared, Measured, MeasuredFiles, Quantity};
pub use model::{Case, Figure, ReferenceModel, ValidationError};
pub use record::{Differences, Found, ModeFigures, Record, Run, Surroundings, record};

/// Name of the file for programs.
pub const JSON: &str = "validation.json";
/// Name of the page.
pub const PAGE: &str = "validation.html";
