//! The trait of everything that adds a generalised force.
use crate::{Blocks, Motion, Updates};

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
pub trait Force: Send {
    /// Adds `Q(t, q, v, u)` to `force` (one entry per generalised velocity; N, N·m).
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]);

    /// Adds the dense blocks of `S` that belong into the factored matrix.
    ///
    /// The blocks must come in the same order and with the same indices in every call: the pattern is analysed once.
    /// A term that switches (a dropper) adds its present tangent here and corrects it in [`Force::push_updates`].
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let _ = (motion, weights, blocks);
    }

    /// Adds what the tangent now has beyond the blocks of the last [`Force::add_tangent`], as low-rank terms: moving contact,
    /// a dropper that has switched since. Called in each Newton iteration.
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        let _ = (motion, weights, updates);
    }

    /// Adds the constant mass matrix of this contribution as dense blocks (kg, kg·m, kg·m²).
    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        let _ = blocks;
    }

    /// Adds `S + m M`, with `m` (1/s²) the `mass_weight`: [`Force::add_tangent`] and [`Force::add_mass`] together, for which a
    /// contribution to which both are the same blocks needs one pass.
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

    /// Whether [`Force::add_dynamic_force`] subtracts `M v̇` of this contribution itself; the answer never changes. Where it does
    /// not, the solver multiplies the assembled matrix of [`Force::add_mass`].
    fn multiplies_mass(&self) -> bool {
        false
    }

    /// Adds `Q(t, q, v, u) − M v̇` to `force`, with `M` that of [`Force::add_mass`]: called in place of [`Force::add_force`] within
    /// a time step where [`Force::multiplies_mass`], so that both are done in one pass over the elements.
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        let _ = v_dot;
        self.add_force(motion, force);
    }

    /// Whether [`Force::add_dynamic_force_within`] is cheaper than a whole evaluation; the answer never changes. Only for a
    /// contribution that [`Force::multiplies_mass`] and whose force on a coordinate depends on no inputs, and on no other coordinates
    /// than those that the blocks of [`Force::add_tangent`] couple with it.
    fn evaluates_ranges(&self) -> bool {
        false
    }

    /// Adds to the entries `range` of `force` what [`Force::add_dynamic_force`] adds there; what it adds elsewhere is not used.
    ///
    /// Corrections after the first one of a step are often confined to the neighbourhood of the contact: the solver then evaluates
    /// again only what has changed.
    fn add_dynamic_force_within(
        &mut self,
        range: std::ops::Range<usize>,
        motion: &Motion<'_>,
        v_dot: &[f64],
        force: &mut [f64],
    ) {
        let _ = range;
        self.add_dynamic_force(motion, v_dot, force);
    }

    /// Whether `Q − M v̇` is linear (a constant part included) in coordinates, velocities and accelerations, depends on nothing else,
    /// and has exactly the tangent of [`Force::add_tangent`] and [`Force::add_mass`]; the answer never changes. Only for a contribution
    /// that [`Force::evaluates_ranges`].
    ///
    /// On rows where all that evaluate ranges are linear the solver knows what a correction leaves of their forces without evaluating
    /// them.
    fn is_linear(&self) -> bool {
        false
    }

    /// What it is called in an account of the parts of a model ("droppers"), where its type says that; `None` where only its owner
    /// knows, as with a body.
    fn part(&self) -> Option<&'static str> {
        None
    }

    /// Potential energy, J; zero for forces without one.
    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let _ = motion;
        0.0
    }

    /// What this contribution exchanges with the outside at `motion`, where it knows that itself; `None` stands for a potential
    /// and losses that end with the velocities: the losses are then `Q(q, v) − Q(q, 0)`.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let _ = motion;
        None
    }

    /// Called once per step of `h` s with the predicted motion, before the first force of the step: contact search and the like. A
    /// static solution begins as a step of 0 s.
    fn begin_step(&mut self, motion: &Motion<'_>, h: f64) {
        let _ = (motion, h);
    }

    /// Called once at the end of each completed step, after a static solution, and where a motion starts: what a contribution decides
    /// from one step to the next.
    fn end_step(&mut self, motion: &Motion<'_>) {
        let _ = motion;
    }

    /// Called after a correction that may end its step without an evaluation, or of which the solver learns what corrections leave: the
    /// force was found last near `motion` and may not be found there. Returns whether it comes from the same piece of its law in both
    /// places, as what is smooth always does; where it does not the solver evaluates. Who comes after one whose force does not is not
    /// asked.
    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        let _ = motion;
        true
    }

    /// Appends the history this contribution carries beyond `q, v` (start values of searches, what the next step begins with), so that
    /// a restored state continues bit for bit. What it has put into the factored matrix is none of it: with another matrix that one is
    /// assembled again.
    fn save(&self, out: &mut Vec<f64>) {
        let _ = out;
    }

    /// Takes back what [`Force::save`] appended, in the same order.
    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let _ = values;
    }
}
