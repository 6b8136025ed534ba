//! Exceptions: messages are those of the program.

use pyo3::create_exception;
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use simulation::SetupError;
use system::one_system::stepped::SteppedError;

create_exception!(
    pantoline,
    SceneError,
    PyValueError,
    "A scene, or a value in it, that is refused."
);
create_exception!(
    pantoline,
    SweepError,
    PyValueError,
    "A wish for a sweep that is refused."
);
create_exception!(
    pantoline,
    RunError,
    PyRuntimeError,
    "A computation that has not reached its end."
);

/// A scene that is refused.
pub fn of_scene(error: &scene::SceneError) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// A run that cannot begin; `file` is named where the message names no file yet.
pub fn of_setup(error: &SetupError, file: &str) -> PyErr {
    let text = cosim::chain(error);
    let text = match error {
        SetupError::Scene(_) | SetupError::FmuFile(_) | SetupError::Package(_) => text,
        _ => format!("{file}: {text}"),
    };
    if error.is_input() {
        SceneError::new_err(text)
    } else {
        RunError::new_err(text)
    }
}

/// A sweep that cannot begin or go on.
pub fn of_sweep(error: &::sweep::SweepError) -> PyErr {
    match error {
        ::sweep::SweepError::Scene(error) => of_scene(error),
        error if error.is_input() => SweepError::new_err(cosim::chain(error)),
        error => RunError::new_err(cosim::chain(error)),
    }
}

/// A step that cannot be made.
pub fn of_step(error: &SteppedError) -> PyErr {
    match error {
        SteppedError::OtherSystem => PyValueError::new_err(error.to_string()),
        error => RunError::new_err(cosim::chain(error)),
    }
}

/// A name that is none of the known ones.
pub fn of_name<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> PyErr {
    PyKeyError::new_err(format!("{name}: unknown name{}", meant(name, known)))
}

/// The nearest of the known names as a question; nothing where none is near.
pub fn meant<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let nearest = scene::nearest(name, known);
    nearest.map_or_else(String::new, |nearest| format!(", did you mean \"{nearest}\"?"))
}

/// Files that cannot be written.
pub fn of_results(error: &results::ResultsError) -> PyErr {
    RunError::new_err(cosim::chain(error))
}
