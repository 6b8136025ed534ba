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

pub use execute::{Comparison, SETTLE, Script, compare, script};
pub use page::page;
pub use plan::{AUTO, Group, Keys, MACRO_STEPS, Planned, algorithms, groups, macro_step, plan};
pub use text::text;
pub(crate) use text::{milliseconds, significant, wrapped};
pub use trial::{TRIAL_STEPS, Trial, trial, trial_page, trial_text};
