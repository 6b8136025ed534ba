//! Interface of a model to the runtime, free of C.

use crate::model_description::Variable;
use std::fmt::Display;
use std::path::Path;

/// Errors of a model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The step did not converge and the model is as before it: a smaller step may succeed (`fmi2Discard`).
    #[error("{0}")]
    Retryable(String),
    /// The model cannot go on before it is reset or restored (`fmi2Error`).
    #[error("{0}")]
    Unusable(String),
}

impl ModelError {
    /// Error for a step that may be tried again with a smaller one; `cause` goes to the log.
    pub fn retryable(cause: impl Display) -> Self {
        Self::Retryable(cause.to_string())
    }

    /// Error for a model that cannot go on; `cause` goes to the log.
    pub fn unusable(cause: impl Display) -> Self {
        Self::Unusable(cause.to_string())
    }
}

/// Result of a request to a model.
pub type ModelResult<T> = Result<T, ModelError>;

/// Plan of the importer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time, s.
    pub start_time: f64,
    /// Stop time, s; `None` if the importer gives none. Sizes must not depend on it.
    pub stop_time: Option<f64>,
    /// Relative tolerance, –; a wish.
    pub tolerance: Option<f64>,
}

/// A co-simulation model. Variables are addressed by their position in [`Model::variables`].
///
/// The runtime has checked, before it calls: the position exists and has the type of the method; a variable that is set
/// may be set in the present phase; reals are finite; steps are positive, begin where the last one ended and do not
/// pass the stop time; only outputs are asked for derivatives with respect to inputs only.
///
/// The order of calls differs between importers: parameters may be set several times before
/// [`exit_initialization`](Model::exit_initialization), and outputs read in between. Setting should therefore only
/// mark, and the next reader bring dependent values up to date; a repeated read costs nothing. After an input was set
/// between two steps the outputs are those at the present time with the new input.
pub trait Model: Sized + Send + 'static {
    /// Complete state: states, inputs with derivatives, parameters, solver history.
    type State: Clone + Send + 'static;

    /// A model with the parameters of its resources. Cheap; nothing else of the host is touched.
    ///
    /// # Errors
    ///
    /// Wrong resources; the error names the file.
    fn instantiate(resources: Option<&Path>) -> ModelResult<Self>;

    /// The GUID in the model description this model was packaged with; by default the content of the resource
    /// `guid.txt`, which [`crate::archive::Package`] writes.
    ///
    /// # Errors
    ///
    /// An unreadable file; the error names the path.
    fn guid(resources: Option<&Path>) -> ModelResult<String> {
        super::resources::resource_guid(resources)
    }

    /// The table of variables of this model; fixed from now on.
    fn variables(&self) -> Vec<Variable>;

    /// Returns to the state after `instantiate`, from any state, without reading files.
    ///
    /// # Errors
    ///
    /// A model that cannot be reset.
    fn reset(&mut self) -> ModelResult<()>;

    /// Receives the plan of the importer.
    ///
    /// # Errors
    ///
    /// A plan the model cannot follow.
    fn setup_experiment(&mut self, _experiment: Experiment) -> ModelResult<()> {
        Ok(())
    }

    /// Begin of the initialisation.
    ///
    /// # Errors
    ///
    /// Wrong parameters, unless the next reader reports them.
    fn enter_initialization(&mut self) -> ModelResult<()> {
        Ok(())
    }

    /// End of the initialisation: the model is built and at rest at the start time.
    ///
    /// # Errors
    ///
    /// Wrong parameters, no static equilibrium.
    fn exit_initialization(&mut self) -> ModelResult<()>;

    /// Value of a real variable, in its unit.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn real(&mut self, position: usize) -> ModelResult<f64>;

    /// Value of a whole-number variable.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn integer(&mut self, position: usize) -> ModelResult<i32> {
        Err(no_value(position, "whole-number"))
    }

    /// Value of a yes-or-no variable.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn boolean(&mut self, position: usize) -> ModelResult<bool> {
        Err(no_value(position, "yes-or-no"))
    }

    /// Value of a text variable.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn string(&mut self, position: usize) -> ModelResult<String> {
        Err(no_value(position, "text"))
    }

    /// Sets a real variable, in its unit; an input loses its derivatives.
    ///
    /// # Errors
    ///
    /// A value without physical meaning; the error gives unit and valid range.
    fn set_real(&mut self, position: usize, value: f64) -> ModelResult<()>;

    /// Sets a whole-number variable.
    ///
    /// # Errors
    ///
    /// A value without meaning.
    fn set_integer(&mut self, position: usize, _value: i32) -> ModelResult<()> {
        Err(no_value(position, "whole-number"))
    }

    /// Sets a yes-or-no variable.
    ///
    /// # Errors
    ///
    /// A value without meaning.
    fn set_boolean(&mut self, position: usize, _value: bool) -> ModelResult<()> {
        Err(no_value(position, "yes-or-no"))
    }

    /// Sets a text variable.
    ///
    /// # Errors
    ///
    /// A value without meaning.
    fn set_string(&mut self, position: usize, _value: &str) -> ModelResult<()> {
        Err(no_value(position, "text"))
    }

    /// Derivative of order ≥ 1 of a real input with respect to time at the start of the coming step, in its unit per
    /// second to that order. Orders above what is used may be ignored.
    ///
    /// # Errors
    ///
    /// A derivative that the model cannot take.
    fn set_input_derivative(&mut self, position: usize, order: u32, value: f64) -> ModelResult<()>;

    /// Derivative of order ≥ 1 of a real output with respect to time, now; 0 above the order that is known.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn output_derivative(&mut self, position: usize, order: u32) -> ModelResult<f64>;

    /// Partial derivative of an output with respect to an input with the states held, now. Changes no value.
    ///
    /// # Errors
    ///
    /// The model cannot be brought up to date.
    fn directional_derivative(&mut self, output: usize, input: usize) -> ModelResult<f64>;

    /// Goes from `time` to `time + step`, s, with these very numbers.
    ///
    /// # Errors
    ///
    /// [`ModelError::Retryable`] if a smaller step may succeed; the model is then as before the step.
    fn do_step(&mut self, time: f64, step: f64) -> ModelResult<()>;

    /// End of the simulation; values stay readable.
    fn terminate(&mut self) {}

    /// Copy of the complete state, in any phase.
    fn save(&mut self) -> Self::State;

    /// Like [`save`](Model::save) into an old copy, so that its memory is used again.
    fn save_into(&mut self, state: &mut Self::State) {
        *state = self.save();
    }

    /// Goes on as from `state`; the same steps give the same bits.
    ///
    /// # Errors
    ///
    /// A state that does not fit this model.
    fn restore(&mut self, state: &Self::State) -> ModelResult<()>;

    /// A state as bytes, for this very version of the model.
    ///
    /// # Errors
    ///
    /// A state that cannot be serialised.
    fn serialize(state: &Self::State) -> ModelResult<Vec<u8>>;

    /// State from bytes; the runtime has checked their origin and integrity.
    ///
    /// # Errors
    ///
    /// Bytes that are no state of this model.
    fn deserialize(bytes: &[u8]) -> ModelResult<Self::State>;
}

fn no_value(position: usize, kind: &str) -> ModelError {
    ModelError::unusable(format!(
        "variable {} is declared as a {kind} variable but the model has none",
        position + 1
    ))
}
