//! Environments for learning, one case or many at once.

use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use simulation::environment::{self, Demand, Environments, Situation};
use simulation::{SetupError, StaticLines, prepare_on};
use system::one_system::stepped::SteppedSystem;

use crate::error::{of_name, of_setup, of_step};
use crate::interruption::interruptible;
use crate::scene::SceneSource;
use crate::simulation::Stepper;

/// Lines at rest that are kept for cases that have them in common.
const LINES: usize = 8;

/// Observation, reward, end of the run, reason of a failed step, time, s, contact force, N.
type Turn = (Vec<f32>, f64, bool, Option<String>, f64, f64);

fn turn(situation: Situation) -> Turn {
    let Situation {
        observation,
        reward,
        truncated,
        failure,
        time,
        force,
    } = situation;
    (observation.to_vec(), reward, truncated, failure, time, force)
}

/// Refusal of an action that is no number.
fn finite(action: f64, name: &str) -> PyResult<f64> {
    if action.is_finite() {
        return Ok(action);
    }
    let what = format!("{name} = {action}: must be a finite number, from -1 to 1");
    Err(PyValueError::new_err(what))
}

/// Contact force as the aim of whoever commands the drive of a simulation.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct ForceAim {
    stepper: Py<Stepper>,
    aim: environment::ForceAim,
}

#[pymethods]
impl ForceAim {
    /// Aim for a pantograph (from 1) of a simulation at its start.
    #[new]
    fn new(py: Python<'_>, stepper: Py<Stepper>, pantograph: usize, effort: f64) -> PyResult<Self> {
        let own = stepper.get();
        let made = own.with(py, |system| {
            environment::ForceAim::new(&own.scene, system, pantograph, effort)
        });
        let aim = made.map_err(|error| of_setup(&error, &own.origin))?;
        Ok(Self { stepper, aim })
    }

    /// Goes back to the start, and samples on without a command.
    fn begin(&self, py: Python<'_>, lead: u64) -> PyResult<Turn> {
        let begun = self.stepper.get().with(py, |system| self.aim.begin(system, lead));
        begun.map(turn).map_err(|error| of_step(&error))
    }

    /// Holds a command for a sample.
    fn step(&self, py: Python<'_>, action: f64) -> PyResult<Turn> {
        let action = finite(action, "action")?;
        Ok(turn(
            self.stepper.get().with(py, |system| self.aim.step(system, action)),
        ))
    }
}

/// Many environments that are stepped at once.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct EnvironmentBatch {
    environments: Mutex<Environments>,
}

/// Observations (32 bits), rewards, ends, times, s, and contact forces, N, of all environments as bytes, and the
/// reasons of failed steps by environment.
type Turns<'py> = (
    Bound<'py, PyByteArray>,
    Bound<'py, PyByteArray>,
    Vec<bool>,
    Bound<'py, PyByteArray>,
    Bound<'py, PyByteArray>,
    Vec<(usize, String)>,
);

fn bytes<'py>(py: Python<'py>, values: impl Iterator<Item = f64>) -> Bound<'py, PyByteArray> {
    PyByteArray::new(py, &values.flat_map(f64::to_ne_bytes).collect::<Vec<u8>>())
}

impl EnvironmentBatch {
    fn environments(&self) -> MutexGuard<'_, Environments> {
        self.environments.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl EnvironmentBatch {
    /// Cases of a scene, each with keys of its own, `key=value`; on up to `threads` threads.
    #[new]
    fn new(
        py: Python<'_>,
        scene: &SceneSource,
        cases: Vec<Vec<String>>,
        pantograph: usize,
        effort: f64,
        threads: usize,
    ) -> PyResult<Self> {
        let base = scene.base();
        let lines = StaticLines::keeping(LINES.max(threads));
        let made = interruptible(py, |stop| {
            Environments::new(cases.len(), threads, |case| {
                if stop.load(Ordering::Relaxed) {
                    return Err(SetupError::NotAvailable("interrupted".to_owned()));
                }
                let resolved = base.scene(&cases[case])?;
                let prepared = prepare_on(&lines, resolved, &scene.name, &scene.folder, false)?;
                let resolved = prepared.scene.clone();
                let system = prepared.stepped()?;
                let aim = environment::ForceAim::new(&resolved, &system, pantograph, effort)?;
                Ok((system, aim))
            })
        })?;
        let made = made.map_err(|(case, error)| {
            let keys = cases[case].join(", ");
            of_setup(&error, &format!("{}, environment {case} ({keys})", scene.origin))
        })?;
        Ok(Self {
            environments: Mutex::new(made),
        })
    }

    /// One turn of each environment: a start so many samples on, or a step with its action; with neither it rests.
    fn turn<'py>(&self, py: Python<'py>, leads: Vec<Option<u64>>, actions: Option<Vec<f64>>) -> PyResult<Turns<'py>> {
        let demand = |(place, lead): (usize, &Option<u64>)| match (lead, &actions) {
            (Some(lead), _) => Ok(Demand::Begin(*lead)),
            (None, Some(actions)) => {
                let action = actions.get(place).copied().unwrap_or(f64::NAN);
                finite(action, &format!("actions[{place}]")).map(Demand::Step)
            }
            (None, None) => Ok(Demand::Rest),
        };
        let demands = leads.iter().enumerate().map(demand).collect::<PyResult<Vec<_>>>()?;
        let met = py.detach(|| self.environments().turn(&demands));
        let mut all = met.map_err(|(_, error)| of_step(&error))?;
        py.check_signals()?;
        let failures = all.iter_mut().enumerate();
        let failures = failures.filter_map(|(place, one)| Some((place, one.failure.take()?)));
        let failures = failures.collect();
        let observed = all.iter().flat_map(|one| one.observation);
        let observed: Vec<u8> = observed.flat_map(f32::to_ne_bytes).collect();
        Ok((
            PyByteArray::new(py, &observed),
            bytes(py, all.iter().map(|one| one.reward)),
            all.iter().map(|one| one.truncated).collect(),
            bytes(py, all.iter().map(|one| one.time)),
            bytes(py, all.iter().map(|one| one.force)),
            failures,
        ))
    }

    /// Values of a signal in all environments.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<Vec<f64>> {
        let value = |system: &SteppedSystem| {
            let signals = system.signals();
            let place = signals.iter().position(|signal| signal.name == name);
            let place = place.ok_or_else(|| of_name(name, signals.iter().map(|signal| &*signal.name)))?;
            Ok(system.value(place))
        };
        py.detach(|| self.environments().systems().map(value).collect())
    }
}
