//! The Python package: scenes, runs, steps and sweeps for Python.
//!
//! | file | subject |
//! | --- | --- |
//! | `scene` | a scene with the keys set in it |
//! | `result` | a run that has ended |
//! | `simulation` | one system step by step, and its kept states |
//! | `environment` | environments for learning, one case or many at once |
//! | `sweep` | many cases of one scene, whole or in batches |
//! | `interruption` | work without the lock of the interpreter, ended by Ctrl-C |
//! | `error` | exceptions |
//! | `value` | values of a scene as Python has them |
//!
//! The classes here are the small ones under those of the package `pantoline`, which has names, units, tables and
//! plots. No physics and no formula is in this crate.

#![forbid(unsafe_code)]

mod environment;
mod error;
mod interruption;
mod result;
mod scene;
mod simulation;
mod sweep;
mod value;

use std::path::PathBuf;

use ::sweep::values::{Distribution, Values};
use pyo3::prelude::*;

/// Names the program that the package carries; libraries of FMUs are beside it.
#[pyfunction]
fn set_program(file: PathBuf) {
    fmi2::program::stand_in(file);
}

/// Refuses a name that is none of the known ones, with the nearest of them.
#[pyfunction]
fn check_name(name: &str, known: Vec<String>) -> PyResult<()> {
    let names = || known.iter().map(String::as_str);
    if names().any(|known| known == name) {
        return Ok(());
    }
    Err(error::of_name(name, names()))
}

/// Names of the figures of a sensitivity analysis.
#[pyfunction]
fn figure_names() -> Vec<&'static str> {
    ::sweep::sensitivity::FIGURES.iter().map(|(name, ..)| *name).collect()
}

/// A distribution of numbers as it is typed behind `--range KEY=`.
fn distribution(text: &str) -> PyResult<Distribution> {
    let found = match Values::typed(text) {
        Ok(Values::Distributed(found)) if found.shares().is_some() => Ok(found),
        Ok(_) => Err("must be a distribution of numbers, such as normal(110, 5)".to_owned()),
        Err(what) => Err(what),
    };
    found.map_err(|what| error::SweepError::new_err(format!("{text}: {what}")))
}

/// Shares of all values between which the numbers of a distribution are varied.
#[pyfunction]
fn shares(text: &str) -> PyResult<[f64; 2]> {
    Ok(distribution(text)?.shares().unwrap_or([0.0, 1.0]))
}

/// Values of a distribution below which these shares of all values lie.
#[pyfunction]
fn quantiles(text: &str, shares: Vec<f64>) -> PyResult<Vec<f64>> {
    let distribution = distribution(text)?;
    Ok(shares
        .iter()
        .filter_map(|share| distribution.quantile(*share).number())
        .collect())
}

/// The extension module.
#[pymodule]
mod _pantoline {
    #[pymodule_export]
    use super::environment::{EnvironmentBatch, ForceAim};
    #[pymodule_export]
    use super::error::{RunError, SceneError, SweepError};
    #[pymodule_export]
    use super::result::RunResult;
    #[pymodule_export]
    use super::scene::SceneSource;
    #[pymodule_export]
    use super::simulation::{Checkpoint, Stepper};
    #[pymodule_export]
    use super::sweep::CaseSweep;
    #[pymodule_export]
    use super::{check_name, figure_names, quantiles, set_program, shares};

    /// Version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
