//! Percentiles of the wall times of macro steps.

use serde::{Deserialize, Serialize};

/// Percentiles of wall times, s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Median.
    pub p50_s: f64,
    /// 99 %.
    pub p99_s: f64,
    /// 99.9 %.
    pub p99_9_s: f64,
    /// 99.99 %.
    pub p99_99_s: f64,
    /// Longest.
    pub longest_s: f64,
}
