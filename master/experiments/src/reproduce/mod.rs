//! A published piece of work, computed again: its figures beside ours.
//!
//! | part | subject |
//! | --- | --- |
//! | `published` | what was published |
//! | `open`, `quantities` | what the publication leaves open, and the range each such quantity plausibly has |
//! | `wind` | how the published wind can be read, and its forces on the pan-head by hand |
//! | `plan` | the runs |
//! | `execute` | making them, side by side |
//! | `relation`, `verdict` | changes between cases, published and computed, and what the one says of the other |
//! | `spread` | what an open quantity does to the standard deviation |
//! | `columns` | `reproduction.csv` |
//! | `text`, `page`, `figures` | the tables on the terminal, `reproduction.html` |
//!
//! Nothing is tuned to a published value: runs take the scenes as they are and change one thing at a time.
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois at
//!   Chicago, 2016.

mod columns;
mod execute;
mod figures;
mod open;
mod page;
mod plan;
mod published;
mod quantities;
mod relation;
mod spread;
#[cfg(test)]
mod tests;
mod text;
mod verdict;
mod wind;

pub use execute::{Extent, HeadWind, Line, Reproduction, Site, execute};
pub use page::page;
pub use plan::{Group, Mesh, Planned, plan};
pub use published::{CASES, Case, Figure};
pub use relation::Relation;
pub use spread::{End, Spread};
pub use text::text;
pub use verdict::{SAME_SIZE, VERDICT_RULE, VISIBLE, Verdict, judge};
