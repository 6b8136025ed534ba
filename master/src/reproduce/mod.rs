//! A published piece of work, computed again: its figures beside ours.
//!
//! | part | subject |
//! | --- | --- |
//! | `published` | what was published |
//! | `open` | what the publication leaves open, and the range each such quantity plausibly has |
//! | `wind` | how the published wind can be read, and its forces on the pan-head by hand |
//! | `plan` | the runs |
//! | `execute` | making them, side by side |
//! | `relation` | changes between cases, published and computed |
//! | `text`, `page` | the tables on the terminal, `reproduction.html` |
//!
//! Nothing is tuned to a published value: runs take the scenes as they are and change one thing at a time.
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois at
//!   Chicago, 2016.

mod execute;
mod open;
mod page;
mod plan;
mod published;
mod relation;
#[cfg(test)]
mod tests;
mod text;
mod wind;

pub use execute::{Extent, HeadWind, Line, Reproduction, Site, execute};
pub use page::page;
pub use plan::{Group, Mesh, Planned, plan};
pub use published::{CASES, Case, Figure};
pub use text::text;
