//! Slaves, coupling algorithms and the time loop of a co-simulation.
//!
//! | module | subject |
//! | --- | --- |
//! | `slave` | subsystem as an algorithm sees it |
//! | `algorithm` | who steps when, and from which values |
//! | `run` | time loop, with a controlled macro step where asked for |
//! | `inprocess` | slaves made of the core components |
//! | `fmu_slave`, `parameter` | slaves made of FMUs, values of their parameters |
//! | `head` | pantograph with several strips as one slave per strip |
//! | `package` | FMUs made from a scene |
//! | `timed` | slave whose time is taken |
//! | `parallel` | slaves on threads of their own |
//! | `disturbance` | slaves under a disturbance |
//! | `test_problem` | two small slaves with a known solution, to rate coupling algorithms |
#![forbid(unsafe_code)]

pub mod algorithm;
mod chain;
pub mod disturbance;
pub mod fmu_slave;
pub mod head;
pub mod inprocess;
pub mod package;
pub mod parallel;
mod parameter;
pub mod run;
pub mod slave;
pub mod test_problem;
pub mod timed;

pub use chain::chain;
