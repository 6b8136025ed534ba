//! Speed against error: mesh, step, coupling and reductions that a scene needs for an error, and their cost.
//!
//! | part | subject |
//! | --- | --- |
//! | `run_spec` | parts of a run that sweeps change, and the values that a scene allows |
//! | `options` | options of the user, names of the sweeps |
//! | `plan` | sweeps and ladder |
//! | `reference` | refined until two levels agree |
//! | `vehicle` | variants of the vehicle below the pantograph |
//! | `judge` | the plan as an experiment: errors in parallel, times one at a time |
//! | `assemble`, `outcome` | rows judged, in one table |
//! | `pareto` | Pareto front and recommendations |
//! | `text`, `page`, `plots` | for reading |
//! | `rank` | rank of a single run in a study |

mod assemble;
mod judge;
mod options;
mod outcome;
mod page;
mod pareto;
mod plan;
mod plots;
mod rank;
mod reference;
mod run_spec;
#[cfg(test)]
mod tests;
mod text;
mod vehicle;

pub use judge::{FOLDER, Script, StudyFound, StudyJob, script};
pub use options::{Options, Sweep};
pub use outcome::{Entry, Levels, Order, Reference, Study};
pub use pareto::{Recommendation, TARGETS};
pub use plan::StudyRun;
pub use rank::{keep_ranks, rank};
pub use reference::{Discretisation, Refinement};
pub use run_spec::{Class, Exchange, Family, Mesh, RunSpec, Subject};
pub use vehicle::{VehicleVariant, VehicleVariantName};

/// Table of a study.
pub const CSV: &str = "study.csv";
/// Page of a study.
pub const PAGE: &str = "study.html";
