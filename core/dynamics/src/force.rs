//! The law of a contribution that adds a generalised force.
use crate::{Blocks, LowRank, Motion, OnePass, StepHistory};

/// Weights of the two parts of a tangent: `S = q K + v D` with `K = −∂Q/∂q` and `D = −∂Q/∂v`.
///
/// Statics use `q = 1, v = 0`; generalized-α uses `q = 1, v = γ/(β h)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Weight of the stiffness, –.
    pub q: f64,
    /// Weight of the damping, 1/s.
    pub v: f64,
}

/// Power that crosses the boundary of a system at one contribution, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Brought in by prescribed motion.
    pub driven: f64,
    /// Turned into heat.
    pub dissipated: f64,
}

/// A contribution that adds a generalised force, its tangent, and its (constant) inertia.
///
/// Sign: `Q` acts *on* the coordinates, so a spring adds `−k q` and its tangent block is `+k`.
///
/// The law is force, tangent, mass, energy and power. A contribution that can do more for the solver offers it by one
/// of the accessors [`Force::one_pass`], [`Force::low_rank`] and [`Force::step_history`]; the answer `Some` or `None`
/// of an accessor never changes.
pub trait Force: Send {
    /// Adds `Q(t, q, v, u)` to `force` (one entry per generalised velocity; N, N·m).
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]);

    /// False if `Q` does not depend on the inputs `u`: a jump of the inputs then asks nothing of this contribution.
    fn depends_on_inputs(&self) -> bool {
        true
    }

    /// Adds the dense blocks of `S` that belong into the factored matrix.
    ///
    /// The blocks must come in the same order and with the same indices in every call: the pattern is analysed once.
    /// A term that switches (a dropper) adds its present tangent here and corrects it in [`LowRank::push_updates`].
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let _ = (motion, weights, blocks);
    }

    /// Adds the constant mass matrix of this contribution as dense blocks (kg, kg·m, kg·m²).
    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        let _ = blocks;
    }

    /// Potential energy, J; zero for forces without one.
    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let _ = motion;
        0.0
    }

    /// Power exchanged with the outside at `motion`. `None` stands for a potential and losses that end with the
    /// velocities: the losses are then `Q(q, v) − Q(q, 0)`.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let _ = motion;
        None
    }

    /// Access to the evaluation of force and inertia in one pass, if this contribution offers it.
    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        None
    }

    /// Access to low-rank updates of the tangent, if this contribution has some.
    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        None
    }

    /// Access to the history that this contribution carries from step to step, if it has one.
    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        None
    }
}
