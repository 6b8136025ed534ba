//! Line and pantographs as one: their coupled equilibrium, and the run as one system in time.
//!
//! | file | subject |
//! | --- | --- |
//! | `equilibrium` | state at t = 0: heights and forces at which both sides are at rest |
//! | `one_system` | line, pantographs and contacts under one integrator, in a run or step by step |
//! | `galloping` | the line alone in a steady wind that feeds its motion |
//! | `run` | schedule, outcome, and the time loop of one system |
//! | `disturbance` | disturbances put on a run to test its stability |
//! | `step_times` | wall times of macro steps, and their pace in real time |
//! | `time_shares` | shares of the wall time of a run |
//! | `picture` | pictures of line and pantographs |
#![forbid(unsafe_code)]

pub mod disturbance;
pub mod equilibrium;
pub mod galloping;
pub mod one_system;
pub mod picture;
pub mod run;
pub mod step_times;
pub mod time_shares;

pub use catenary::{load, load_with};

/// Share of the work that crossed the contact beyond which the energy that the coupling added is worth a note (–).
pub const ENERGY_SHARE: f64 = 0.01;
