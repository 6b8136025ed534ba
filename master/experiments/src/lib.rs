//! Experiments on many runs.
//!
//! | module | subject |
//! | --- | --- |
//! | `engine` | plan, pool, store, table, exporters of all experiments |
//! | `compare` | all modes and algorithms on one scene |
//! | `study` | speed against error: references, sweeps, Pareto front |
//! | `stability` | hard cases, and boundaries beyond which runs are not stable |
//! | `reproduce` | published work computed again, published beside computed |
#![forbid(unsafe_code)]

pub mod compare;
pub mod engine;
pub mod reproduce;
pub mod stability;
pub mod study;

pub use study::rank;
