//! All modes and algorithms on one scene: differences and costs side by side.
//!
//! | part | subject |
//! | --- | --- |
//! | `plan` | runs and their micro steps |
//! | `judge` | the plan as an experiment, timed one run at a time |
//! | `text` | the table on the terminal |
//! | `page` | `compare.html` |
//! | `test_problem` | the coupling test problem instead of a scene |

mod judge;
mod page;
mod plan;
mod test_problem;
#[cfg(test)]
mod tests;
mod text;

pub use judge::{Compare, Comparison};
pub use plan::{ComparedRun, MACRO_STEPS, StepGroup, algorithms};
pub use test_problem::{TEST_PROBLEM_STEPS, TestProblem, TestProblemTable};
