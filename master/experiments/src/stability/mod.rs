//! The hard cases: their status in every way of running them, and boundaries beyond which runs are not stable.
//!
//! | part | subject |
//! | --- | --- |
//! | `cases` | the cases, data in `cases.toml` |
//! | `judge` | the cases as an experiment, made side by side |
//! | `bench` | one case in one way, and its boundary |
//! | `figures` | figures and status of one run |
//! | `maps` | boundaries by bisection |
//! | `text`, `page` | the table on the terminal, `stability.html` |
//!
//! Status, in the words of [`STATUS_RULE`](crate::engine::table::STATUS_RULE) with these references: a coupled run is
//! compared with the monolithic one at the same micro step, the monolithic one with itself at half the micro step. A
//! monolithic run is also `limit` where the time integration made more than 1 % of the energy that went through, and a
//! coupled run is at most `limit` where the monolithic one is.

mod bench;
mod cases;
mod figures;
mod judge;
mod maps;
mod page;
#[cfg(test)]
mod tests;
mod text;

pub use bench::Way;
pub use cases::{Case, HardParameter, cases};
pub use figures::Figures;
pub use judge::{ALGORITHMS, Line, Stability, StabilityFound, StabilityTable};
pub use maps::{CurveKind, Map, MapCurve};
