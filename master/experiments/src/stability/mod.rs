//! The hard cases: what survives them, and where runs stop being stable.
//!
//! | part | subject |
//! | --- | --- |
//! | `cases` | the cases |
//! | `trial` | one run and its figures |
//! | `execute` | all runs, side by side |
//! | `maps` | boundaries by bisection |
//! | `text`, `page` | the table on the terminal, `stability.html` |
//!
//! Status, in the words of [`STATUS_RULE`](crate::table_of_runs::STATUS_RULE) with these references: a coupled run is
//! compared with the monolithic one at the same micro step, the monolithic one with itself at half the micro step. A
//! monolithic run is also `limit` where the time integration made more than 1 % of the energy that went through, and a coupled
//! run is at most `limit` where the monolithic one is.

mod cases;
mod execute;
mod maps;
mod page;
#[cfg(test)]
mod tests;
mod text;
mod trial;

pub use cases::{Case, Coupled, Knob, cases};
pub use execute::{ALGORITHMS, Line, Plan, StabilityTable, execute};
pub use maps::{Curve, Map};
pub use page::page;
pub use text::text;
pub use trial::{Figures, Made, Way, make, refined};
