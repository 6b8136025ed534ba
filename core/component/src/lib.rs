//! What a simulation unit made from a scene offers to whoever runs it: named signals, steps, checkpoints.
//!
//! A component knows no protocol. The same signals are the variables of an FMU, and what a master connects in one process.
#![forbid(unsafe_code)]

mod common;
pub mod exchange;
mod observer;
mod parameter;
mod picture;
mod point;
mod share;
mod signal;

pub use common::{of_pantograph, solver_parameters, start_parameters};
pub use observer::{Observer, Progress};
pub use parameter::Parameter;
pub use picture::{DropperLine, Frame};
pub use point::Point;
pub use share::Share;
pub use signal::{Kind, Role, Signal};

use scene::Scene;
use serde::{Serialize, de::DeserializeOwned};
use std::error::Error;

/// A step was not completed; the component is as before it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct StepFailure {
    /// What went wrong, with its numbers.
    pub reason: String,
    /// Whether a smaller step may succeed.
    pub retryable: bool,
}

/// Work done by the solver of a component since it was built; going back to a checkpoint takes none of it back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Internal time steps.
    pub micro_steps: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Factorisations of an iteration matrix.
    pub factorizations: u64,
    /// Most Newton iterations of one internal step; 0 where that is not known.
    pub most_iterations: u64,
}

/// A simulation unit made from a scene.
///
/// Signals are addressed by their position in [`Component::signals`]. Booleans and whole numbers travel as `f64`.
pub trait Component: Sized + Send + 'static {
    /// Everything the component must keep to continue bit for bit.
    type Checkpoint: Clone + Default + Send + Serialize + DeserializeOwned + 'static;
    /// Why it could not be built.
    type Error: Error + Send + Sync + 'static;

    /// Short name, a C identifier.
    const IDENTIFIER: &'static str;
    /// One sentence on what it is.
    const DESCRIPTION: &'static str;

    /// Inputs and outputs for a scene, sized from it; start values of inputs are those of its equilibrium.
    fn signals(scene: &Scene) -> Vec<Signal>;

    /// The physical values of the scene that this component depends on.
    fn parameters(scene: &Scene) -> Vec<Parameter>;

    /// Builds the component at rest in the start state of the scene.
    ///
    /// # Errors
    /// A scene without static equilibrium.
    fn build(scene: &Scene) -> Result<Self, Self::Error>;

    /// Sets an input; its derivatives become zero.
    fn set_input(&mut self, signal: usize, value: f64);

    /// The present value of an input.
    fn input(&self, signal: usize) -> f64;

    /// Sets the derivative of order 1 to 3 of a continuous input at the start of the next step.
    fn set_input_derivative(&mut self, signal: usize, order: usize, value: f64);

    /// The value of an output, with the inputs set since the last step.
    fn output(&mut self, signal: usize) -> f64;

    /// First derivative of an output with respect to time, where the component knows it, else 0.
    fn output_rate(&mut self, signal: usize) -> f64;

    /// Partial derivative of an output with respect to an input, states frozen.
    fn sensitivity(&mut self, output: usize, input: usize) -> f64;

    /// Advances from `t` to `t + h`, s.
    ///
    /// # Errors
    /// See [`StepFailure`].
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), StepFailure>;

    /// Stores everything into `checkpoint`, reusing its memory.
    fn save(&mut self, checkpoint: &mut Self::Checkpoint);

    /// Goes back to a checkpoint.
    ///
    /// # Errors
    /// A checkpoint that does not fit.
    fn restore(&mut self, checkpoint: &Self::Checkpoint) -> Result<(), StepFailure>;

    /// What the solver has done so far.
    fn work(&self) -> Work;
}
