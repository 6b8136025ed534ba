//! Experiments on many runs.
//!
//! | module | subject |
//! | --- | --- |
//! | `table_of_runs` | one row per run: columns, errors, status |
//! | `compare` | all modes and algorithms on one scene |
//! | `study` | speed against error: references, sweeps, Pareto front |
//! | `stability` | hard cases, and where runs stop being stable |
//! | `reproduce` | published work computed again, published beside computed |
#![forbid(unsafe_code)]

pub mod compare;
pub mod reproduce;
pub mod stability;
pub mod study;
pub mod table_of_runs;
