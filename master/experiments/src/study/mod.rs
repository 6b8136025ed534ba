//! Speed against error: which mesh, step, coupling and reductions a scene needs for an error, and what they cost.
//!
//! | part | subject |
//! | --- | --- |
//! | `recipe` | what a run is made of, and what a scene allows |
//! | `plan` | sweeps and ladder |
//! | `reference` | refined until two levels agree |
//! | `vehicle` | what the pantograph stands on |
//! | `store` | runs that are kept |
//! | `execute` | making them in parallel, timing them one at a time |
//! | `assemble`, `outcome` | rows judged, in one table |
//! | `order` | orders of convergence |
//! | `front` | Pareto front and recommendations |
//! | `machine` | where times were taken, memory of a time loop |
//! | `text`, `page`, `plots`, `labels` | for reading |
//! | `standing` | where a single run stands in a study |

mod assemble;
mod execute;
mod front;
mod labels;
mod machine;
mod order;
mod outcome;
mod page;
mod plan;
mod plots;
mod recipe;
mod reference;
mod standing;
mod store;
#[cfg(test)]
mod tests;
mod text;
mod vehicle;

pub use execute::{Script, StudyError, script, study};
pub use front::{Recommendation, TARGETS};
pub use machine::Machine;
pub use order::{Order, order};
pub use outcome::{Entry, Levels, Reference, Study};
pub use page::page;
pub use plan::{Options, Planned, Sweep};
pub use recipe::{Class, Exchange, Family, Ground, Mesh, Recipe, identity, settings};
pub use reference::{Discretisation, Refinement};
pub use standing::standing;
pub use store::Store;
pub use text::text;
pub use vehicle::{Standing, StandingName};

/// Table of a study.
pub const CSV: &str = "study.csv";
/// Page of a study.
pub const PAGE: &str = "study.html";
