//! All modes and algorithms on one scene: differences and costs side by side.
//!
//! | part | subject |
//! | --- | --- |
//! | `plan` | which runs, at which micro step |
//! | `execute` | making them, one at a time |
//! | `text` | the table on the terminal |
//! | `page` | `compare.html` |
//! | `trial` | the coupling test problem instead of a scene |

mod execute;
mod page;
mod plan;
#[cfg(test)]
mod tests;
mod text;
mod trial;

pub use execute::{Comparison, Script, compare, script};
pub use page::page;
pub use plan::{Group, MACRO_STEPS, Planned, algorithms, groups, plan};
pub use text::text;
pub use trial::{TRIAL_STEPS, Trial, trial, trial_page, trial_text};
