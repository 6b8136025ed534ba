//! Many passages of a train over a line that wears: simulated, worn by as many passages as change the line little,
//! simulated again.
//!
//! | file | subject |
//! | --- | --- |
//! | `worn_line` | [`WornLine`]: wear of a run as a profile of the line, and the profile as its running surface |
//! | `jump` | passages that change a profile little |
//! | `run` | [`run()`]: blocks of passages, kept after each |
//! | `record` | [`Record`]: blocks and figures as they are kept |
//! | `table`, `page` | the record on the terminal, as `wear.csv` and as `wear.html` |
#![forbid(unsafe_code)]

mod error;
mod jump;
mod page;
mod record;
mod run;
mod table;
mod worn_line;

pub use error::PassagesError;
pub use jump::{Worn, passages_within};
pub use record::{Block, ForceEffect, Record};
pub use run::{Forces, Surroundings, Wishes, run};
pub use worn_line::WornLine;

/// Record for programs, from which a command that was ended goes on.
pub const JSON: &str = "wear.json";
/// Worn profile after each block.
pub const CSV: &str = "wear.csv";
/// Page.
pub const PAGE: &str = "wear.html";
