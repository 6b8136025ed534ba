//! A published piece of work, computed again: its figures beside ours.
//!
//! | part | subject |
//! | --- | --- |
//! | `published` | what was published |
//! | `open` | quantities that the publication leaves open, and their plausible ranges |
//! | `wind` | readings of the published wind, and its forces on the pan-head by hand |
//! | `plan` | the runs |
//! | `judge` | the plan as an experiment, made side by side |
//! | `relation`, `verdict` | changes between cases, published and computed, and their verdicts |
//! | `spread` | standard deviation over the range of an open quantity |
//! | `columns` | `reproduction.csv` |
//! | `text`, `page`, `figures` | the tables on the terminal, `reproduction.html` |
//!
//! Nothing is tuned to a published value: runs take the scenes as they are and change one thing at a time.
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois
//!   at Chicago, 2016.

mod columns;
mod figures;
mod judge;
mod open;
mod page;
mod plan;
mod published;
mod relation;
mod spread;
#[cfg(test)]
mod tests;
mod text;
mod verdict;
mod wind;

pub use judge::{Extent, HeadWind, Line, Reproduce, Reproduction};
pub use plan::{Mesh, ReproductionRun, RunGroup};
pub use published::{CASES, Case, Figure};
pub use relation::Relation;
pub use spread::{End, Spread};
pub use verdict::Verdict;
