//! Interface of a simulation unit made from a scene: named signals, steps, checkpoints.
//!
//! No protocol appears in a component: the same signals are the variables of an FMU and the ports of an in-process
//! slave.
#![forbid(unsafe_code)]

mod common;
pub mod exchange;
mod observer;
mod parameter;
mod percentiles;
mod picture;
mod point;
mod share;
mod signal;
mod table;

pub use common::{of_pantograph, solver_parameters, start_parameters, strip_start_parameters};
pub use observer::{Observer, Progress};
pub use parameter::Parameter;
pub use percentiles::Percentiles;
pub use picture::{DropperLine, Frame};
pub use point::Point;
pub use share::Share;
pub use signal::{Causality, DeclaredSignal, Signal, SignalKind};
use table::located;
pub use table::{Access, SignalEntry, SignalGroup, positions};

use scene::{Scene, SceneError};
use serde::{Serialize, de::DeserializeOwned};
use std::error::Error;

/// Failed step; the component is in the state before the step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct StepFailure {
    /// Cause, with the numbers of the failure.
    pub reason: String,
    /// True if a smaller step may succeed.
    pub retryable: bool,
}

/// Work done by the solver of a component since construction; a restored checkpoint leaves the counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Internal time steps.
    pub micro_steps: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Factorisations of an iteration matrix.
    pub factorizations: u64,
    /// Most Newton iterations of one internal step; 0 if unknown.
    pub most_iterations: u64,
    /// Internal time steps that ended above Newton's tolerance, as their corrections are fixed.
    pub above_tolerance: u64,
}

/// A simulation unit made from a scene.
///
/// Signals are addressed by position in [`Component::signals`]. Booleans and whole numbers travel as `f64`.
pub trait Component: Sized + Send + 'static {
    /// State needed to continue bit for bit.
    type Checkpoint: Clone + Default + Send + Serialize + DeserializeOwned + 'static;
    /// Reason why construction failed.
    type Error: Error + Send + Sync + 'static;
    /// Array of [`SignalGroup`]s.
    type Groups: AsRef<[SignalGroup<Self>]>;

    /// Short name, a C identifier.
    const IDENTIFIER: &'static str;
    /// One sentence that describes the component.
    const DESCRIPTION: &'static str;

    /// Reads a scene from the text of a file; `origin` is its name in messages. A component whose rules choose what a
    /// scene leaves open does so here.
    ///
    /// # Errors
    /// Every problem found.
    fn load(text: &str, origin: &str) -> Result<Scene, SceneError> {
        Scene::from_toml(text, origin, &[])
    }

    /// Checks a scene that was changed as strictly as one from a file; `origin` is its name in messages.
    ///
    /// # Errors
    /// Every problem found.
    fn check(scene: &Scene, origin: &str) -> Result<(), SceneError> {
        scene.check(origin)
    }

    /// Inputs and outputs for a scene, sized from the scene; start values of inputs are the values of the equilibrium.
    fn signals(scene: &Scene) -> Vec<Signal> {
        table::signals(Self::groups_of(scene).as_ref(), scene)
    }

    /// Groups of signals of a component made from `scene`, in the order of the signals.
    fn groups_of(scene: &Scene) -> Self::Groups;

    /// The same groups for the component itself.
    fn groups(&self) -> Self::Groups;

    /// Physical values of the scene on which this component depends.
    fn parameters(scene: &Scene) -> Vec<Parameter>;

    /// Builds the component at rest in the start state of the scene.
    ///
    /// # Errors
    /// A scene without static equilibrium.
    fn build(scene: &Scene) -> Result<Self, Self::Error>;

    /// Sets an input; the derivatives of the input become zero.
    fn set_input(&mut self, signal: usize, value: f64) {
        let at = located(self.groups().as_ref(), signal);
        match at.entry.access {
            Access::Input { set, .. } => set(self, at.member, at.index, value),
            Access::Parameter { set, .. } => set(self, value),
            Access::Output { .. } => panic!("{} is an output", at.entry.declared.name),
        }
    }

    /// Present value of an input.
    fn input(&self, signal: usize) -> f64 {
        let at = located(self.groups().as_ref(), signal);
        match at.entry.access {
            Access::Input { get, .. } => get(self, at.member, at.index),
            Access::Parameter { get, .. } => get(self),
            Access::Output { .. } => panic!("{} is an output", at.entry.declared.name),
        }
    }

    /// Sets the derivative of order 1 to 3 of a continuous input at the start of the next step.
    fn set_input_derivative(&mut self, signal: usize, order: usize, value: f64) {
        let at = located(self.groups().as_ref(), signal);
        match at.entry.access {
            Access::Input { set_derivative, .. } => set_derivative(self, at.member, at.index, order, value),
            _ => panic!("{} is no continuous input", at.entry.declared.name),
        }
    }

    /// Value of an output, with the inputs set since the last step.
    fn output(&mut self, signal: usize) -> f64 {
        let at = located(self.groups().as_ref(), signal);
        match at.entry.access {
            Access::Output { get, .. } => get(self, at.part),
            Access::Input { get, .. } => get(self, at.member, at.index),
            Access::Parameter { get, .. } => get(self),
        }
    }

    /// First derivative of an output with respect to time, if known to the component, else 0.
    fn output_rate(&mut self, signal: usize) -> f64 {
        let at = located(self.groups().as_ref(), signal);
        match at.entry.access {
            Access::Output { rate, .. } => rate(self, at.part),
            _ => 0.0,
        }
    }

    /// Partial derivative of an output with respect to an input, states frozen.
    fn sensitivity(&mut self, output: usize, input: usize) -> f64 {
        let groups = self.groups();
        let (output, input) = (located(groups.as_ref(), output), located(groups.as_ref(), input));
        match (&output.entry.access, &input.entry.access) {
            (
                Access::Output {
                    partial: Some(partial), ..
                },
                Access::Input { .. },
            ) if output.member == input.member => partial(self, output.part, input.index),
            _ => 0.0,
        }
    }

    /// Advances from `t` to `t + h`, s.
    ///
    /// # Errors
    /// See [`StepFailure`].
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), StepFailure>;

    /// Stores the whole state into `checkpoint`, reusing memory.
    fn save(&mut self, checkpoint: &mut Self::Checkpoint);

    /// Restores a checkpoint.
    ///
    /// # Errors
    /// A checkpoint that does not fit the component.
    fn restore(&mut self, checkpoint: &Self::Checkpoint) -> Result<(), StepFailure>;

    /// Work done by the solver so far.
    fn work(&self) -> Work;
}
