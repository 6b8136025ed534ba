//! Acceptance limits of standards, held against the figures of one run.
//!
//! Sources: `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc
//! thesis, University of Illinois at Chicago, 2016. `[EN 50367]` CENELEC, EN 50367: Railway
//! applications – Current collection systems – Technical criteria for the interaction between
//! pantograph and overhead line.

mod en50367;

pub use en50367::{Figures, en50367, uplift_limit};

use serde::{Deserialize, Serialize};

/// One quantity held against its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Name of the standard.
    pub standard: String,
    /// What is limited: `mean`, `std`, `max`, `uplift`, `vertical_amplitude`, `arcing`.
    pub quantity: String,
    /// Pantograph, numbered from 1; absent where the quantity belongs to the line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pantograph: Option<usize>,
    /// Value of the run in `unit`; `null` where it is not known.
    pub value: Option<f64>,
    /// Largest permitted value, in `unit`; `null` where it depends on an unknown value.
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`.
    pub unit: String,
    /// Whether the limit is kept; `null` where this was not decided.
    pub pass: Option<bool>,
    /// Where the limit comes from, or why nothing was decided.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub remark: String,
}
