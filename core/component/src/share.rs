//! Shares of the wall time of a run.

use serde::{Deserialize, Serialize};

/// A part's share of the wall time of the time loop; the shares of a run sum to 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Name of the part: `catenary` and `pantograph[i]` for coupled sides; for one system `wires`, `droppers`,
    /// `supports`, `registration_arms`, `wind_wires`, `vehicle`, `wheel_rail`, `pantograph`, `wind_pantograph`,
    /// `contact`, `factorization`, `linear_solution` and `time_integration`, if they take time; last `master`, the
    /// remainder.
    pub part: String,
    /// Share of the wall time, –.
    pub share: f64,
}
