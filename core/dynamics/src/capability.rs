//! Capabilities of a contribution beyond its law: evaluation in one pass or within ranges, low-rank updates, history.
use crate::{Blocks, Force, Motion, Updates, Weights};
use std::ops::Range;

/// Force and inertia in one pass over the elements of a contribution.
///
/// The solver calls [`OnePass::add_dynamic_force`] in place of [`Force::add_force`] within a time step, and does not
/// multiply the mass matrix of this contribution.
pub trait OnePass: Force {
    /// Adds `Q(t, q, v, u) − M v̇` to `force`, with `M` that of [`Force::add_mass`].
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]);

    /// Adds `S + m M`, with `m` (1/s²) the `mass_weight`: [`Force::add_tangent`] and [`Force::add_mass`] together.
    ///
    /// The blocks must come in the same order and with the same indices in every call, as those of
    /// [`Force::add_tangent`].
    fn add_dynamic_tangent(
        &mut self,
        motion: &Motion<'_>,
        weights: Weights,
        mass_weight: f64,
        blocks: &mut Blocks<'_>,
    ) {
        self.add_tangent(motion, weights, blocks);
        blocks.weigh(mass_weight, |blocks| self.add_mass(blocks));
    }

    /// Access to the evaluation within ranges, if this contribution offers it; the answer never changes.
    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        None
    }
}

/// Evaluation within a range of coordinates, for less than the cost of a whole evaluation.
///
/// Only for a contribution whose force on a coordinate depends on no inputs, and on no other coordinates than those
/// that the blocks of [`Force::add_tangent`] couple with it. Corrections after the first one of a step are often
/// confined to the neighbourhood of the contact: the solver then evaluates the changed rows alone.
pub trait ByRange: OnePass {
    /// Adds to the entries `range` of `force` the same as [`OnePass::add_dynamic_force`]; entries elsewhere are not
    /// used.
    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]);

    /// Returns `true` if `Q − M v̇` is linear (a constant part included) in coordinates, velocities and accelerations,
    /// depends on nothing else, and has exactly the tangent of [`Force::add_tangent`] and [`Force::add_mass`]; the
    /// answer never changes.
    ///
    /// The solver knows the residual after a correction without evaluation on rows with linear contributions alone.
    fn is_linear(&self) -> bool {
        false
    }
}

/// Low-rank updates of the tangent: moving contact, a dropper that has switched.
pub trait LowRank {
    /// Adds the difference of the present tangent and the blocks of the last [`Force::add_tangent`], as low-rank terms.
    /// Called in each Newton iteration.
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates);
}

/// History that a contribution carries from step to step beyond `q, v`: start values of searches, states that switch.
pub trait StepHistory {
    /// Called once per step of `h` s with the predicted motion, before the first force of the step: contact search and
    /// the like. A static solution begins as a step of 0 s.
    fn begin_step(&mut self, motion: &Motion<'_>, h: f64) {
        let _ = (motion, h);
    }

    /// Called once at the end of each completed step, after a static solution, and at the start of a motion: decisions
    /// from one step to the next.
    fn end_step(&mut self, motion: &Motion<'_>) {
        let _ = motion;
    }

    /// Called after a correction that may end its step without an evaluation, or whose contraction the solver records:
    /// the last evaluation was near `motion`. Returns `true` if the force comes from the same branch of its law in both
    /// places, as a smooth force always does; else the solver evaluates. Contributions after the first `false` are not
    /// asked.
    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        let _ = motion;
        true
    }

    /// Appends the history, so that a restored state continues bit for bit. Values in the factored matrix are no part
    /// of it: with another matrix they are assembled again.
    fn save(&self, out: &mut Vec<f64>) {
        let _ = out;
    }

    /// Appends what a step that fails may have changed, before the step; all of the history unless less is enough.
    fn save_for_step(&self, out: &mut Vec<f64>) {
        self.save(out);
    }

    /// Takes back the values of [`StepHistory::save_for_step`] after a step that failed.
    fn restore_after_step(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        self.restore(values);
    }

    /// Takes back the values of [`StepHistory::save`], in the same order.
    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let _ = values;
    }
}

/// Adds `S + m M` of a contribution, in one pass if it offers that.
pub(crate) fn add_dynamic_tangent(
    force: &mut dyn Force,
    motion: &Motion<'_>,
    weights: Weights,
    mass_weight: f64,
    blocks: &mut Blocks<'_>,
) {
    match force.one_pass() {
        Some(one_pass) => one_pass.add_dynamic_tangent(motion, weights, mass_weight, blocks),
        None => {
            force.add_tangent(motion, weights, blocks);
            blocks.weigh(mass_weight, |blocks| force.add_mass(blocks));
        }
    }
}

/// The evaluation within ranges of a contribution, if it offers one.
pub(crate) fn by_range(force: &mut dyn Force) -> Option<&mut dyn ByRange> {
    force.one_pass()?.by_range()
}

/// Calls `visit` for each history of a system, in the order of its forces.
pub(crate) fn visit_histories(system: &mut dyn crate::System, visit: &mut dyn FnMut(&mut dyn StepHistory)) {
    system.forces(&mut |force| {
        if let Some(history) = force.step_history() {
            visit(history);
        }
    });
}
