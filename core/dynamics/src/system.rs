//! A system: its coordinates and its contributions, as solvers visit them.
use crate::{Constraint, Force, Layout, State};

/// Visitor of contributions: part of the model that each belongs to ("droppers"), for profiling, and the contribution.
pub type PartVisitor<'a> = dyn FnMut(&'static str, &mut dyn Force) + 'a;

/// Change of a system after a completed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// No change.
    Kept,
    /// The state was moved among the coordinates; the matrices are the same ones.
    Moved,
    /// The contributions or the fixed coordinates are others now; the number of coordinates is the same.
    Replaced,
}

/// Work of a solver, between and during its visits to the contributions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Residuals, predictions, applied corrections: all work that is not named below.
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

    /// Called when a step enters another [`Stage`]; for profiling. A step begins and ends in [`Stage::Integration`].
    fn enter(&mut self, stage: Stage) {
        let _ = stage;
    }

    /// Called after each completed step within [`crate::Simulator::advance`]: a system that models only the
    /// neighbourhood of a moving object follows the object here, and takes the state along.
    fn follow(&mut self, state: &mut State, u: &[f64]) -> Continuity {
        let _ = (state, u);
        Continuity::Kept
    }

    /// Returns to the neighbourhood of `state`, which is restored next: the way back of [`System::follow`].
    fn adopt(&mut self, state: &State) -> Continuity {
        let _ = state;
        Continuity::Kept
    }
}
