//! A system: its coordinates, and how the solver reaches its contributions.
use crate::{Constraint, Force, State};
use nalgebra::UnitQuaternion;
use std::ops::Range;

/// The coordinates of a system, built up part by part: a line and a pantograph may share one layout.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    coordinates: usize,
    constraints: usize,
    fixed: Vec<usize>,
    rotations: Vec<usize>,
    orientations: Vec<UnitQuaternion<f64>>,
    names: Vec<(usize, String)>,
}

impl Layout {
    /// An empty layout.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds `count` translational coordinates under one name ("contact_wire, node 12"); returns the first index.
    pub fn add_coordinates(&mut self, count: usize, name: impl Into<String>) -> usize {
        let first = self.coordinates;
        self.names.push((first, name.into()));
        self.coordinates += count;
        first
    }

    /// Adds a rigid body's three rotational coordinates (body-frame angular velocity) with its start orientation; returns the
    /// first index and the index into [`crate::Motion::rotation`].
    pub fn add_rotation(&mut self, orientation: UnitQuaternion<f64>, name: impl Into<String>) -> (usize, usize) {
        let first = self.add_coordinates(3, name);
        self.rotations.push(first);
        self.orientations.push(orientation);
        (first, self.rotations.len() - 1)
    }

    /// Adds `count` constraint equations; returns the first index of their multipliers.
    pub fn add_constraints(&mut self, count: usize) -> usize {
        let first = self.constraints;
        self.constraints += count;
        first
    }

    /// Holds a coordinate at its value in the start state.
    pub fn fix(&mut self, index: usize) {
        self.fixed.push(index);
    }

    /// Holds exactly these of the coordinates within `range`, whatever was held there before.
    pub fn fix_within(&mut self, range: Range<usize>, fixed: &[usize]) {
        self.fixed.retain(|index| !range.contains(index));
        self.fixed.extend_from_slice(fixed);
    }

    /// Number of generalised velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.constraints
    }

    /// Coordinates held fixed.
    #[must_use]
    pub fn fixed(&self) -> &[usize] {
        &self.fixed
    }

    /// First velocity index of each rotation.
    #[must_use]
    pub fn rotations(&self) -> &[usize] {
        &self.rotations
    }

    /// Name of the part that coordinate `index` belongs to, with its number within that part.
    #[must_use]
    pub fn name(&self, index: usize) -> String {
        match self.names.iter().rev().find(|(first, _)| *first <= index) {
            Some((first, name)) => format!("{name}, coordinate {}", index - first + 1),
            None => format!("coordinate {index}"),
        }
    }

    /// The state at rest with all coordinates zero and the start orientations.
    #[must_use]
    pub fn state_at_rest(&self) -> State {
        State::at_rest(self.coordinates, self.constraints, self.orientations.clone())
    }
}

/// How a system goes on after a completed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// As it was.
    Kept,
    /// The state was moved among the coordinates; the matrices are the same ones.
    Moved,
    /// The contributions or the fixed coordinates are others now; the number of coordinates is the same.
    Replaced,
}

/// What a solver is about, between and during its visits to the contributions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Residuals, predictions, corrections that are applied: everything that is not named below.
    Integration,
    /// The pattern of the iteration matrix, its assembly and its factors.
    Factorization,
    /// A correction from the factors and the low-rank terms; no contribution is visited.
    Solution,
}

/// A mechanical system as solvers see it: contributions in a fixed order over one layout.
pub trait System {
    /// The coordinates.
    fn layout(&self) -> &Layout;

    /// Visits every force, always in the same order.
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force));

    /// Visits every constraint, always in the same order; their equations follow one another in this order.
    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        let _ = visit;
    }

    /// Called where a time step turns to another [`Stage`]: for those who keep an account of what it is spent on. A step begins
    /// and ends in [`Stage::Integration`].
    fn enter(&mut self, stage: Stage) {
        let _ = stage;
    }

    /// Called after each completed step within [`crate::Simulator::advance`]: a system that models only the neighbourhood of
    /// something that moves follows it here, and takes the state along.
    fn follow(&mut self, state: &mut State, u: &[f64]) -> Continuity {
        let _ = (state, u);
        Continuity::Kept
    }

    /// Goes to where the system was in `state`, which is restored next: the way back of [`System::follow`].
    fn adopt(&mut self, state: &State) -> Continuity {
        let _ = state;
        Continuity::Kept
    }
}
