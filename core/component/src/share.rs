//! Shares of the wall time of a run.

use serde::{Deserialize, Serialize};

/// A part's share of the wall time of the time loop; those of a run sum to 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Of coupled sides `catenary` and `pantograph[i]`, each with all that it holds. Of one system `wires`, `droppers`, `supports`,
    /// `registration_arms`, `wind_wires`, `vehicle`, `wheel_rail`, `pantograph`, `wind_pantograph`, `contact`, `factorization`,
    /// `linear_solution` and `time_integration`, as far as they take time. The last one is `master`: what is left.
    pub part: String,
    /// –.
    pub share: f64,
}
