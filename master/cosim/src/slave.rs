//! Subsystem as a coupling algorithm sees it.

use std::error::Error;
use std::time::Duration;

use component::{Frame, Work};

/// Abilities of a slave besides stepping forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abilities {
    /// True where the slave can go back to a saved state.
    pub rollback: bool,
    /// Highest order of input derivatives that it follows inside a step; 0 where inputs are held.
    pub input_derivatives: usize,
    /// True where the slave takes steps of any length.
    pub variable_step: bool,
}

/// A subsystem at a communication point; values go through flat slices whose order [`component::exchange`] fixes.
///
/// Calls per step, in this order:
///
/// 1. [`save`](Self::save), where the step may have to be taken back,
/// 2. [`set_inputs`](Self::set_inputs),
/// 3. [`set_input_derivatives`](Self::set_input_derivatives), for each order that is followed,
/// 4. [`do_step`](Self::do_step), which starts where the last one ended,
/// 5. [`outputs`](Self::outputs).
///
/// After an error that [`SlaveError::is_retryable`], the slave is where it was before the step. No call allocates
/// memory after the first step.
pub trait Slave: Send {
    /// Name for messages.
    fn name(&self) -> &str;

    /// Abilities of the slave.
    fn abilities(&self) -> Abilities;

    /// Sets all inputs at the start of the next step, and clears their derivatives.
    ///
    /// # Errors
    /// [`SlaveError`] where the slave refuses them.
    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError>;

    /// Sets the derivatives of `order` (1 to [`Abilities::input_derivatives`]) of all inputs at the start of the next
    /// step.
    ///
    /// # Errors
    /// [`SlaveError`] where the slave refuses them.
    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError>;

    /// Advances from `t` to `t + h`, in s.
    ///
    /// # Errors
    /// [`SlaveError::Step`] where it cannot.
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError>;

    /// Reads all outputs at the end of the last step.
    ///
    /// # Errors
    /// [`SlaveError::NotFinite`] and what the slave itself reports.
    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError>;

    /// Keeps the present state, in place of the one kept before.
    ///
    /// # Errors
    /// [`SlaveError`] where the slave cannot.
    fn save(&mut self) -> Result<(), SlaveError>;

    /// Goes back to the state kept last.
    ///
    /// # Errors
    /// [`SlaveError`] where the slave cannot.
    fn restore(&mut self) -> Result<(), SlaveError>;

    /// Work done so far; zeros where the slave does not count.
    fn work(&mut self) -> Work {
        Work::default()
    }

    /// Wall time that the caller has spent in the slave so far, where the time is taken; see [`crate::timed::Timed`].
    fn spent(&self) -> Option<Duration> {
        None
    }

    /// Adds what it looks like at present to a picture; nothing where it cannot.
    fn draw(&mut self, _frame: &mut Frame) {}

    /// Completes pictures, all those of the run in order, where [`Slave::draw`] has put the drawing off until after it.
    fn finish_drawing(&mut self, _frames: &mut [Frame]) {}
}

/// Refuses values that must not be handed on.
///
/// # Errors
/// [`SlaveError::NotFinite`] with the name of the first one.
pub fn finite(slave: &str, names: &[String], values: &[f64], t: f64) -> Result<(), SlaveError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(SlaveError::NotFinite {
            slave: slave.to_owned(),
            variable: names[index].clone(),
            value: values[index],
            t,
        }),
    }
}

/// Reason why a slave did not do a call.
#[derive(Debug, thiserror::Error)]
pub enum SlaveError {
    /// Step not completed.
    #[error("{slave}: the step from t = {t} s over {h} s failed")]
    Step {
        /// Name of the slave.
        slave: String,
        /// Start of the step, s.
        t: f64,
        /// Length of the step, s.
        h: f64,
        /// True where a shorter step may succeed; the slave is then in the state before the step.
        retryable: bool,
        /// Message of the slave.
        #[source]
        source: Box<dyn Error + Send + Sync>,
    },
    /// A value that must not be handed on.
    #[error(
        "{slave}: {variable} = {value} at t = {t} s is not a finite number: nothing is handed on; try a smaller \
         coupling.macro_step or other parameters"
    )]
    NotFinite {
        /// Name of the slave.
        slave: String,
        /// Name of the output.
        variable: String,
        /// As read.
        value: f64,
        /// Time, s.
        t: f64,
    },
    /// A call other than a step failed.
    #[error("{slave}: cannot {action}")]
    Call {
        /// Name of the slave.
        slave: String,
        /// Attempted action, as a verb: `set inputs`, `restore its state`.
        action: &'static str,
        /// Message of the slave.
        #[source]
        source: Box<dyn Error + Send + Sync>,
    },
}

impl SlaveError {
    /// True where the step may be tried again with a smaller length.
    #[must_use]
    pub fn is_retryable(&self) -> bool {
        matches!(self, Self::Step { retryable: true, .. })
    }
}
