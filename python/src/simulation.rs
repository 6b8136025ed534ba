//! One system step by step, and its kept states.

use std::sync::{Mutex, MutexGuard, PoisonError};

use ::scene::Scene;
use ::simulation::identity::digest;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use system::one_system::stepped::{SteppedError, SteppedState, SteppedSystem};

use crate::error::{of_name, of_setup, of_step};
use crate::interruption::interruptible;
use crate::scene::SceneSource;

/// Steps between two requests to the interpreter for signals.
const STEPS: u64 = 64;

/// A kept state of a simulation; never changed.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct Checkpoint {
    state: SteppedState,
}

#[pymethods]
impl Checkpoint {
    /// A state from its bytes.
    #[new]
    fn new(bytes: &[u8]) -> PyResult<Self> {
        let read: Option<SteppedState> = match postcard::take_from_bytes::<(String, &[u8])>(bytes) {
            Ok(((hash, state), [])) if hash == digest(&[state]) => postcard::from_bytes(state).ok(),
            _ => None,
        };
        let refused = || PyValueError::new_err("not the bytes of a kept state: must be those of to_bytes(), unchanged");
        read.map(|state| Self { state }).ok_or_else(refused)
    }

    /// Bytes that another process of the same version reads back to the same state, with their hash before them.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let written = postcard::to_allocvec(&self.state);
        let bytes = written.and_then(|state| postcard::to_allocvec(&(digest(&[&state]), &*state)));
        let bytes = bytes.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyBytes>,)> {
        Ok((self.to_bytes(py)?,))
    }
}

/// Line and pantographs as one system that is advanced from outside.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct Stepper {
    system: Mutex<SteppedSystem>,
    /// Scene with its choices resolved.
    pub(crate) scene: Scene,
    /// The file in messages.
    pub(crate) origin: String,
}

impl Stepper {
    fn system(&self) -> MutexGuard<'_, SteppedSystem> {
        self.system.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Works on the system without the lock of the interpreter.
    pub(crate) fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut SteppedSystem) -> T + Send) -> T {
        py.detach(|| work(&mut self.system()))
    }

    /// Place of a signal among all.
    fn place(&self, py: Python<'_>, name: &str) -> PyResult<usize> {
        self.with(py, |system| {
            let signals = system.signals();
            let place = signals.iter().position(|signal| signal.name == name);
            place.ok_or_else(|| of_name(name, signals.iter().map(|signal| &*signal.name)))
        })
    }
}

#[pymethods]
impl Stepper {
    /// The scene at its start.
    #[new]
    fn new(py: Python<'_>, scene: &SceneSource) -> PyResult<Self> {
        let resolved = scene
            .base()
            .scene(&[])
            .map_err(|error| crate::error::of_scene(&error))?;
        let made = interruptible(py, |_| {
            let prepared = scene.prepared(resolved)?;
            let resolved = prepared.scene.clone();
            Ok((prepared.stepped()?, resolved))
        })?;
        let (system, resolved) = made.map_err(|error| of_setup(&error, &scene.origin))?;
        Ok(Self {
            system: Mutex::new(system),
            scene: resolved,
            origin: scene.origin.clone(),
        })
    }

    /// Time, s.
    fn time(&self, py: Python<'_>) -> f64 {
        self.with(py, |system| system.time())
    }

    /// Length of a step, s.
    fn step_length(&self, py: Python<'_>) -> f64 {
        self.with(py, |system| system.macro_step())
    }

    /// Steps left until the end of the run.
    fn steps_left(&self, py: Python<'_>) -> u64 {
        self.with(py, |system| system.steps_left())
    }

    /// Makes steps.
    fn step(&self, py: Python<'_>, count: u64) -> PyResult<()> {
        let mut left = count;
        while left > 0 {
            let steps = left.min(STEPS);
            let advance = |system: &mut SteppedSystem| (0..steps).try_for_each(|_| system.advance());
            self.with(py, advance).map_err(|error| of_step(&error))?;
            left -= steps;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Goes back to the start.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, SteppedSystem::reset).map_err(|error| of_step(&error))
    }

    /// Keeps the present state.
    fn save(&self, py: Python<'_>) -> Checkpoint {
        let state = self.with(py, |system| {
            let mut state = SteppedState::default();
            system.save(&mut state);
            state
        });
        Checkpoint { state }
    }

    /// Goes to a kept state.
    fn restore(&self, py: Python<'_>, checkpoint: &Checkpoint) -> PyResult<()> {
        let restored: Result<(), SteppedError> = self.with(py, |system| system.restore(&checkpoint.state));
        restored.map_err(|error| of_step(&error))
    }

    /// Name, unit, description of each signal, and `true` where it can be set.
    fn signals(&self, py: Python<'_>) -> Vec<(String, &'static str, String, bool)> {
        self.with(py, |system| {
            let signals = system.signals().iter();
            let entry = signals.map(|one| (one.name.clone(), one.unit, one.description.clone(), one.settable));
            entry.collect()
        })
    }

    /// Value of a signal.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        let place = self.place(py, name)?;
        Ok(self.with(py, |system| system.value(place)))
    }

    /// Sets a signal.
    fn set(&self, py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let place = self.place(py, name)?;
        let (settable, unit) = self.with(py, |system| {
            let signal = &system.signals()[place];
            (signal.settable, signal.unit)
        });
        if !settable {
            return Err(PyValueError::new_err(format!("{name}: cannot be set, only read")));
        }
        let Ok(number) = value.extract::<f64>() else {
            let shown = value.repr()?;
            return Err(PyTypeError::new_err(format!(
                "{name} = {shown}: must be a number, in {unit}"
            )));
        };
        if !number.is_finite() {
            return Err(PyValueError::new_err(format!(
                "{name} = {number}: must be a finite number"
            )));
        }
        self.with(py, |system| system.set(place, number));
        Ok(())
    }
}
