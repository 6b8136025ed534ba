//! An instance behind an `fmi2Component`, and the entry of every call.

use super::guard::guarded;
use super::logger::{Category, Logger};
use super::model::{Experiment, Model, ModelError};
use super::phase::{Call, Phase};
use crate::abi::{Status, fmi2Component, fmi2Status};
use crate::model_description::{BaseType, Variable};
use std::ffi::CString;

/// Failures of a call.
#[derive(Debug)]
pub(super) enum Failure {
    /// The arguments are wrong; nothing was changed.
    Refused(String),
    /// The model reports an error.
    Model(ModelError),
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

/// Refuses with a message.
pub(super) fn refuse<T>(message: impl Into<String>) -> Result<T, Failure> {
    Err(Failure::Refused(message.into()))
}

/// Phase and time of the instance; part of a saved state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Progress {
    pub phase: Phase,
    pub experiment: Experiment,
    /// End of the last completed step, s.
    pub time: f64,
    /// Status of the last step.
    pub step_status: Status,
}

impl Progress {
    pub(super) fn new() -> Self {
        Self {
            phase: Phase::Instantiated,
            experiment: Experiment::default(),
            time: 0.0,
            step_status: Status::Ok,
        }
    }
}

/// Unusual calls that are accepted; each is reported once.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
pub(super) enum Oddity {
    InputBeforeInitialization = 1,
    AnyValueInInitialization = 2,
    NoExperiment = 4,
}

/// A model with everything the C interface needs around it.
pub(super) struct Instance<M: Model> {
    pub model: M,
    pub variables: Vec<Variable>,
    pub guid: String,
    pub logger: Logger,
    pub progress: Progress,
    /// True if the importer has given its plan since the last reset.
    pub experiment_set: bool,
    /// Texts handed out by the last call that returned any.
    pub strings: Vec<CString>,
    mentioned: u8,
}

impl<M: Model> Instance<M> {
    pub(super) fn new(model: M, guid: String, logger: Logger) -> Self {
        let variables = model.variables();
        Self {
            model,
            variables,
            guid,
            logger,
            progress: Progress::new(),
            experiment_set: false,
            strings: Vec::new(),
            mentioned: 0,
        }
    }

    /// Position and variable behind a value reference.
    pub(super) fn variable(&self, reference: u32, base_type: BaseType) -> Result<(usize, &Variable), Failure> {
        let variable = usize::try_from(reference)
            .ok()
            .and_then(|at| Some((at, self.variables.get(at)?)));
        match variable {
            Some((position, variable)) if variable.base_type() == base_type => Ok((position, variable)),
            Some((_, variable)) => refuse(format!(
                "value reference {reference} is {} of type {:?}, not {base_type:?}",
                variable.name,
                variable.base_type()
            )),
            None => refuse(format!(
                "there is no value reference {reference}; the highest is {}",
                self.variables.len().saturating_sub(1)
            )),
        }
    }

    /// Reports an accepted oddity at its first occurrence.
    pub(super) fn mention(&mut self, oddity: Oddity) {
        if self.mentioned & oddity as u8 != 0 {
            return;
        }
        self.mentioned |= oddity as u8;
        let text = match oddity {
            Oddity::InputBeforeInitialization => "an input was set before fmi2EnterInitializationMode; accepted",
            Oddity::AnyValueInInitialization => {
                "a variable that is no output was read in initialisation mode; accepted"
            }
            Oddity::NoExperiment => "fmi2SetupExperiment was not called; the start time is 0 s",
        };
        self.logger.log(Category::Event, text);
    }
}

/// Runs `body` on the instance behind `component`; every C entry point but instantiate and free goes through here.
///
/// # Safety
///
/// `component` is null or was returned by `fmi2Instantiate` of the same model and not freed, and no other call on
/// it is under way.
pub(super) unsafe fn enter<M: Model>(
    component: fmi2Component,
    call: Call,
    name: &str,
    body: impl FnOnce(&mut Instance<M>) -> Result<Status, Failure>,
) -> fmi2Status {
    // SAFETY: forwarded to the caller.
    let Some(instance) = (unsafe { component.cast::<Instance<M>>().as_mut() }) else {
        return Status::Error as fmi2Status;
    };
    let phase = instance.progress.phase;
    let status = if !phase.allows(call) {
        instance
            .logger
            .log(Category::Error, &format!("{name} is illegal {}", phase.name()));
        fail(instance, call, false)
    } else {
        match guarded(|| body(instance)) {
            Ok(Ok(status)) => status,
            Ok(Err(Failure::Refused(message))) => {
                instance.logger.log(Category::Error, &format!("{name}: {message}"));
                fail(instance, call, false)
            }
            Ok(Err(Failure::Model(ModelError::Retryable(message)))) if call == Call::DoStep => {
                instance.logger.log(Category::Discard, &format!("{name}: {message}"));
                instance.progress.phase = Phase::StepFailed;
                instance.progress.step_status = Status::Discard;
                Status::Discard
            }
            Ok(Err(Failure::Model(error))) => {
                instance.logger.log(Category::Error, &format!("{name}: {error}"));
                fail(instance, call, true)
            }
            Err(message) => {
                instance.progress.phase = Phase::Poisoned;
                instance
                    .logger
                    .log(Category::Error, &format!("{name} panicked: {message}"));
                Status::Error
            }
        }
    };
    status as fmi2Status
}

/// Makes the instance unusable, unless the refused call changed nothing.
fn fail<M: Model>(instance: &mut Instance<M>, call: Call, model_failed: bool) -> Status {
    if (model_failed || !call.is_query()) && instance.progress.phase != Phase::Poisoned {
        instance.progress.phase = Phase::Error;
    }
    Status::Error
}

/// Most elements that a call may have: far more than variables, and a count that is not one in other calls is caught
/// before memory is taken for it.
const MOST: usize = 1 << 24;

/// Refuses a null pointer and a count that no call has.
fn plausible<T>(pointer: *const T, count: usize, what: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return refuse(format!("the pointer to {count} {what} is null"));
    }
    if count > MOST {
        return refuse(format!("{count} {what}: must be {MOST} at most"));
    }
    Ok(())
}

/// The elements behind a pointer of the importer; no slice is made of a null pointer.
///
/// # Safety
///
/// `pointer` is null or points to `count` elements that nobody changes during `'a`.
pub(super) unsafe fn elements<'a, T>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    plausible(pointer, count, what)?;
    // SAFETY: not null, and forwarded to the caller.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Mutable [`elements`].
///
/// # Safety
///
/// `pointer` is null or points to `count` elements that nobody else uses during `'a`.
pub(super) unsafe fn elements_mut<'a, T>(pointer: *mut T, count: usize, what: &str) -> Result<&'a mut [T], Failure> {
    if count == 0 {
        return Ok(&mut []);
    }
    plausible(pointer, count, what)?;
    // SAFETY: not null, and forwarded to the caller.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}
