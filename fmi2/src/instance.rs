//! An instance of an FMU, wherever it runs.

use crate::import::{Fmu, Instance, LogMessage, StateHandle, StepOutcome};

use crate::isolation::{self, Isolation, IsolationError};

/// Why an instance did not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum InstanceError {
    /// It runs in this process.
    #[error(transparent)]
    Fmi(#[from] crate::Error),
    /// It runs in another one.
    #[error(transparent)]
    Isolation(#[from] IsolationError),
}

/// A saved state of one instance, valid until it is freed; a plain number, so that it can be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SavedState(pub(crate) u32);

/// An instance of an FMU: the functions of FMI 2.0 [FMI 2.0, 2 and 4], wherever they are carried out.
///
/// Calls that only set something may be put off until something is asked for, together with its errors: each error
/// names the function that it comes from.
///
/// # Errors
/// All functions: [`InstanceError`] where the FMU refuses, lacks the function, or has gone down.
pub trait FmuInstance: Send {
    /// Name of the instance.
    fn name(&self) -> &str;

    /// Tells the plan: times in s, relative tolerance.
    fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<(), InstanceError>;

    /// Begins the initialisation.
    fn enter_initialization_mode(&mut self) -> Result<(), InstanceError>;

    /// Ends the initialisation.
    fn exit_initialization_mode(&mut self) -> Result<(), InstanceError>;

    /// Ends the simulation; values can still be read.
    fn terminate(&mut self) -> Result<(), InstanceError>;

    /// Back to the state after instantiation.
    fn reset(&mut self) -> Result<(), InstanceError>;

    /// Sets real variables, in their units.
    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), InstanceError>;

    /// Sets whole-number and enumeration variables.
    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), InstanceError>;

    /// Sets yes-or-no variables.
    fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<(), InstanceError>;

    /// Sets text variables.
    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<(), InstanceError>;

    /// Reads real variables, in their units.
    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), InstanceError>;

    /// Reads whole-number and enumeration variables.
    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), InstanceError>;

    /// Reads yes-or-no variables.
    fn get_boolean(&mut self, references: &[u32], values: &mut [bool]) -> Result<(), InstanceError>;

    /// Reads text variables.
    fn get_string(&mut self, references: &[u32]) -> Result<Vec<String>, InstanceError>;

    /// Sets time derivatives of inputs, of orders ≥ 1, at the start of the coming step.
    fn set_real_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), InstanceError>;

    /// Reads time derivatives of outputs, of orders ≥ 1.
    fn get_real_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), InstanceError>;

    /// Jacobian of `unknowns` with respect to `knowns` at the present point, states held, times `seed`.
    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        derivatives: &mut [f64],
    ) -> Result<(), InstanceError>;

    /// Goes from `time` to `time + step`, s.
    fn do_step(&mut self, time: f64, step: f64) -> Result<StepOutcome, InstanceError>;

    /// Time up to which the last step was computed, s; `None` where the FMU cannot say.
    fn last_successful_time(&mut self) -> Result<Option<f64>, InstanceError>;

    /// `true` where the FMU wants to end the simulation; `false` where it cannot say.
    fn wants_to_terminate(&mut self) -> Result<bool, InstanceError>;

    /// Saves the present state.
    fn save_state(&mut self) -> Result<SavedState, InstanceError>;

    /// Saves the present state in place of an older one.
    fn save_state_again(&mut self, state: SavedState) -> Result<(), InstanceError>;

    /// Goes back to a saved state; also after an error.
    fn restore_state(&mut self, state: SavedState) -> Result<(), InstanceError>;

    /// Frees a saved state.
    fn free_state(&mut self, state: SavedState) -> Result<(), InstanceError>;

    /// A saved state as bytes.
    fn serialize_state(&mut self, state: SavedState) -> Result<Vec<u8>, InstanceError>;

    /// A saved state from bytes; the present state does not change.
    fn deserialize_state(&mut self, bytes: &[u8]) -> Result<SavedState, InstanceError>;

    /// Chooses what is logged; no categories are all.
    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), InstanceError>;

    /// Messages since the last time, at most the last thousand.
    fn take_log(&mut self) -> Vec<LogMessage>;

    /// Says which real variables will be read after each step, so that they can be fetched with it.
    fn will_read(&mut self, _references: &[u32]) {}
}

/// Makes an instance, in this process or in one of its own. The binary of an isolated one is not loaded here.
///
/// # Errors
/// No binary for this platform, a binary that cannot be loaded, an instance that cannot be made, and what a process of
/// its own can die of.
pub fn instantiate(
    fmu: &Fmu,
    name: &str,
    logging: bool,
    isolation: Option<&Isolation>,
) -> Result<Box<dyn FmuInstance>, InstanceError> {
    Ok(match isolation {
        Some(isolation) => isolation::start(fmu, name, logging, isolation)?,
        None => Box::new(Local::new(fmu.instantiate(name, false, logging)?)),
    })
}

/// An instance in this process.
pub(crate) struct Local {
    instance: Instance,
    /// By the numbers of [`SavedState`].
    states: Vec<Option<StateHandle>>,
}

impl Local {
    pub(crate) fn new(instance: Instance) -> Self {
        Self {
            instance,
            states: Vec::new(),
        }
    }

    /// `true` for a state that was saved of this instance and not freed.
    pub(crate) fn has(&self, state: SavedState) -> bool {
        self.states.get(state.0 as usize).is_some_and(Option::is_some)
    }

    fn keep(&mut self, handle: StateHandle) -> SavedState {
        let free = self.states.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| {
            self.states.push(None);
            self.states.len() - 1
        });
        self.states[place] = Some(handle);
        SavedState(u32::try_from(place).expect("fewer states than memory"))
    }
}

/// The handle behind a saved state.
///
/// # Panics
/// If it was freed or is of another instance.
fn handle(states: &[Option<StateHandle>], state: SavedState) -> &StateHandle {
    let found = states.get(state.0 as usize).and_then(Option::as_ref);
    found.expect("the saved state is of this instance and was not freed")
}

impl FmuInstance for Local {
    fn name(&self) -> &str {
        self.instance.name()
    }

    fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<(), InstanceError> {
        Ok(self.instance.setup_experiment(start, stop, tolerance)?)
    }

    fn enter_initialization_mode(&mut self) -> Result<(), InstanceError> {
        Ok(self.instance.enter_initialization_mode()?)
    }

    fn exit_initialization_mode(&mut self) -> Result<(), InstanceError> {
        Ok(self.instance.exit_initialization_mode()?)
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        Ok(self.instance.terminate()?)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        Ok(self.instance.reset()?)
    }

    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), InstanceError> {
        Ok(self.instance.set_real(references, values)?)
    }

    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), InstanceError> {
        Ok(self.instance.set_integer(references, values)?)
    }

    fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<(), InstanceError> {
        Ok(self.instance.set_boolean(references, values)?)
    }

    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<(), InstanceError> {
        Ok(self.instance.set_string(references, values)?)
    }

    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), InstanceError> {
        Ok(self.instance.get_real(references, values)?)
    }

    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), InstanceError> {
        Ok(self.instance.get_integer(references, values)?)
    }

    fn get_boolean(&mut self, references: &[u32], values: &mut [bool]) -> Result<(), InstanceError> {
        Ok(self.instance.get_boolean(references, values)?)
    }

    fn get_string(&mut self, references: &[u32]) -> Result<Vec<String>, InstanceError> {
        Ok(self.instance.get_string(references)?)
    }

    fn set_real_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), InstanceError> {
        Ok(self.instance.set_real_input_derivatives(references, orders, values)?)
    }

    fn get_real_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), InstanceError> {
        Ok(self.instance.get_real_output_derivatives(references, orders, values)?)
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        derivatives: &mut [f64],
    ) -> Result<(), InstanceError> {
        Ok(self
            .instance
            .directional_derivative(unknowns, knowns, seed, derivatives)?)
    }

    fn do_step(&mut self, time: f64, step: f64) -> Result<StepOutcome, InstanceError> {
        Ok(self.instance.do_step(time, step)?)
    }

    fn last_successful_time(&mut self) -> Result<Option<f64>, InstanceError> {
        Ok(self.instance.last_successful_time()?)
    }

    fn wants_to_terminate(&mut self) -> Result<bool, InstanceError> {
        Ok(self.instance.wants_to_terminate()?)
    }

    fn save_state(&mut self) -> Result<SavedState, InstanceError> {
        let handle = self.instance.save_state()?;
        Ok(self.keep(handle))
    }

    fn save_state_again(&mut self, state: SavedState) -> Result<(), InstanceError> {
        Ok(self.instance.save_state_again(handle(&self.states, state))?)
    }

    fn restore_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        Ok(self.instance.restore_state(handle(&self.states, state))?)
    }

    fn free_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        let handle = self.states.get_mut(state.0 as usize).and_then(Option::take);
        handle.map_or(Ok(()), |handle| Ok(self.instance.free_state(handle)?))
    }

    fn serialize_state(&mut self, state: SavedState) -> Result<Vec<u8>, InstanceError> {
        Ok(self.instance.serialize_state(handle(&self.states, state))?)
    }

    fn deserialize_state(&mut self, bytes: &[u8]) -> Result<SavedState, InstanceError> {
        let handle = self.instance.deserialize_state(bytes)?;
        Ok(self.keep(handle))
    }

    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), InstanceError> {
        Ok(self.instance.set_debug_logging(on, categories)?)
    }

    fn take_log(&mut self) -> Vec<LogMessage> {
        self.instance.take_log()
    }
}
