//! Steps in which the remainder of linear contributions is known without evaluation, against evaluations.
use dynamics::{
    Blocks, ByRange, Force, GeneralizedAlpha, Layout, LowRank, Motion, NewtonOptions, OnePass, State, StepHistory,
    System, Updates, Weights,
};
use std::ops::Range;

const NODES: usize = 300;
const H: f64 = 1e-3;
/// N/m.
const SPRING: f64 = 2e4;
const FOUNDATION: f64 = 100.0;
const ROPE: f64 = 1e5;
const CONTACT: f64 = 5e4;
/// N·s/m.
const DAMPER: f64 = 3.0;
/// Every how many nodes a rope hangs.
const APART: usize = 20;

/// A chain of masses of 1 kg with linear springs and dampers between them and to the ground.
struct Chain {
    is_linear: bool,
    /// Evaluations of the whole and within ranges.
    evaluations: [usize; 2],
    /// Least start and largest end of these ranges.
    within: [usize; 2],
}

impl Chain {
    fn add(&self, nodes: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        let pull = |i: usize| {
            if i == 0 || i == NODES {
                return 0.0;
            }
            SPRING * (motion.q[i] - motion.q[i - 1]) + DAMPER * (motion.v[i] - motion.v[i - 1])
        };
        for i in nodes {
            force[i] += pull(i + 1) - pull(i) - FOUNDATION * motion.q[i] - v_dot[i];
        }
    }
}

impl Force for Chain {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..NODES, motion, &[0.0; NODES], force);
    }

    fn add_tangent(&mut self, _: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for i in 0..NODES {
            blocks.add(&[i], &[i], &[weights.q * FOUNDATION]);
        }
        for i in 0..NODES - 1 {
            let k = weights.q * SPRING + weights.v * DAMPER;
            blocks.add(&[i, i + 1], &[i, i + 1], &[k, -k, -k, k]);
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        (0..NODES).for_each(|i| blocks.add(&[i], &[i], &[1.0]));
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for Chain {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.evaluations[0] += 1;
        self.add(0..NODES, motion, v_dot, force);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        Some(self)
    }
}

impl ByRange for Chain {
    fn is_linear(&self) -> bool {
        self.is_linear
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.evaluations[1] += 1;
        let [start, end] = self.within;
        self.within = [start.min(range.start), end.max(range.end)];
        self.add(range.start.min(NODES)..range.end.min(NODES), motion, v_dot, force);
    }
}

/// Springs to the ground with a cubic law, where there are any.
struct Bed(Vec<usize>);

impl Bed {
    /// N/m³: a few N at the millimetres that the chain moves by.
    const STIFFNESS: f64 = 1e9;
}

impl Force for Bed {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for &i in &self.0 {
            force[i] -= Self::STIFFNESS * motion.q[i].powi(3);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for &i in &self.0 {
            blocks.add(&[i], &[i], &[3.0 * weights.q * Self::STIFFNESS * motion.q[i].powi(2)]);
        }
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for Bed {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, _v_dot: &[f64], force: &mut [f64]) {
        self.add_force(motion, force);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        Some(self)
    }
}

impl ByRange for Bed {
    fn add_dynamic_force_within(&mut self, _: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_dynamic_force(motion, v_dot, force);
    }
}

/// Ropes to the ground that only pull, taut at rest under the weight of a few masses of their own.
struct Ropes {
    assembled: [f64; NODES],
    /// Steps that ended with a slack rope.
    slack_steps: usize,
}

impl Ropes {
    /// Elongation at rest, m: 10 N.
    const AT_REST: f64 = 1e-4;

    fn nodes() -> impl Iterator<Item = usize> {
        (0..NODES).step_by(APART)
    }

    fn pulls(motion: &Motion<'_>, i: usize) -> bool {
        Self::AT_REST + motion.q[i] > 0.0
    }
}

impl Force for Ropes {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for i in Self::nodes() {
            force[i] += ROPE * Self::AT_REST;
            if Self::pulls(motion, i) {
                force[i] -= ROPE * (Self::AT_REST + motion.q[i]);
            }
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for i in Self::nodes() {
            self.assembled[i] = if Self::pulls(motion, i) { weights.q * ROPE } else { 0.0 };
            blocks.add(&[i], &[i], &[self.assembled[i]]);
        }
    }

    /// The solver multiplies this mass.
    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        Self::nodes().for_each(|i| blocks.add(&[i], &[i], &[0.5]));
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for Ropes {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        for i in Self::nodes() {
            let slope = if Self::pulls(motion, i) { weights.q * ROPE } else { 0.0 };
            if slope != self.assembled[i] {
                updates.rank_one(i as u32, 0, slope - self.assembled[i], std::iter::once((i, 1.0)));
            }
        }
    }
}

impl StepHistory for Ropes {
    fn end_step(&mut self, motion: &Motion<'_>) {
        self.slack_steps += usize::from(Self::nodes().any(|i| !Self::pulls(motion, i)));
    }
}

/// A body of 10 kg, the last coordinate, that travels along the chain at one node per 10 ms, pushed against it by 100 N
/// that falls below zero for a while. Its force grows with the depth and its square, so that one correction is not
/// enough.
struct Contact {
    node: f64,
    version: u64,
    closed: bool,
}

impl Contact {
    fn weights(&self) -> (usize, [f64; 2]) {
        let node = (self.node as usize).min(NODES - 2);
        let part = self.node - node as f64;
        (node, [1.0 - part, part])
    }

    fn force(&self, motion: &Motion<'_>) -> f64 {
        let (node, [left, right]) = self.weights();
        let depth = motion.q[NODES] - left * motion.q[node] - right * motion.q[node + 1];
        CONTACT * depth.max(0.0) * (1.0 + 100.0 * depth)
    }
}

impl Force for Contact {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let pressed = self.force(motion);
        self.closed = pressed > 0.0;
        let (node, [left, right]) = self.weights();
        force[NODES] += 100.0 - 160.0 * (20.0 * motion.t).sin().max(0.0) - pressed;
        force[node] += pressed * left;
        force[node + 1] += pressed * right;
    }

    fn add_tangent(&mut self, _: &Motion<'_>, _: Weights, blocks: &mut Blocks<'_>) {
        blocks.add(&[NODES], &[NODES], &[0.0]);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        blocks.add(&[NODES], &[NODES], &[10.0]);
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for Contact {
    fn push_updates(&mut self, _: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        if self.closed {
            let (node, [left, right]) = self.weights();
            let entries = [(NODES, 1.0), (node, -left), (node + 1, -right)];
            updates.rank_one(0, self.version, weights.q * CONTACT, entries.into_iter());
        }
    }
}

impl StepHistory for Contact {
    fn begin_step(&mut self, motion: &Motion<'_>, _: f64) {
        self.node = 100.0 + 100.0 * motion.t;
        self.version += 1;
    }
}

struct Model {
    layout: Layout,
    chain: Chain,
    bed: Bed,
    ropes: Ropes,
    contact: Contact,
}

impl System for Model {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.chain);
        visit(&mut self.bed);
        visit(&mut self.ropes);
        visit(&mut self.contact);
    }
}

struct Run {
    states: Vec<State>,
    /// Largest `Q − M v̇` that any step ended with, N.
    left: f64,
    model: Model,
    iterations: u64,
    estimated: u64,
}

fn run(is_linear: bool, bed: impl Iterator<Item = usize>, tolerance: f64) -> Run {
    let mut layout = Layout::new();
    layout.add_coordinates(NODES + 1, "chain and body");
    let mut model = Model {
        layout,
        chain: Chain {
            is_linear,
            evaluations: [0; 2],
            within: [NODES, 0],
        },
        bed: Bed(bed.collect()),
        ropes: Ropes {
            assembled: [0.0; NODES],
            slack_steps: 0,
        },
        contact: Contact {
            node: 100.0,
            version: 0,
            closed: false,
        },
    };
    let mut state = model.layout.state_at_rest();
    let options = NewtonOptions {
        tolerance,
        ..NewtonOptions::default()
    };
    let mut integrator = GeneralizedAlpha::new(0.9, options);
    let (mut states, mut left) = (Vec::new(), 0.0_f64);
    for step in 1..=600 {
        let stepped = integrator.step(&mut model, &mut state, &[], step as f64 * H, H);
        stepped.expect("every step converges");
        let motion = state.motion(&[]);
        let mut force = [0.0; NODES + 1];
        model.chain.add(0..NODES, &motion, &state.v_dot, &mut force);
        model.bed.add_force(&motion, &mut force);
        model.ropes.add_force(&motion, &mut force);
        model.contact.add_force(&motion, &mut force);
        Ropes::nodes().for_each(|i| force[i] -= 0.5 * state.v_dot[i]);
        force[NODES] -= 10.0 * state.v_dot[NODES];
        left = force.iter().fold(left, |left, force| left.max(force.abs()));
        states.push(state.clone());
    }
    Run {
        states,
        left,
        model,
        iterations: integrator.counters().newton_iterations,
        estimated: integrator.counters().estimated,
    }
}

/// Both end their steps within a tolerance of 1e-4 N; 600 steps of that on 1 kg under 2e4 N/m make at most about 1e-7
/// m.
fn compare(known: &Run, evaluated: &Run) {
    for (a, b) in known.states.iter().zip(&evaluated.states) {
        for (a, b) in a.q.iter().zip(&b.q) {
            assert!((a - b).abs() < 1e-7, "{a} m against {b} m");
        }
    }
}

#[test]
fn what_a_correction_leaves_of_linear_contributions_is_what_an_evaluation_finds() {
    let tolerance = 1e-4;
    let (known, evaluated) = (run(true, 0..0, tolerance), run(false, 0..0, tolerance));
    assert!(known.model.ropes.slack_steps > 50, "ropes go slack");
    assert!(known.iterations > 700, "some steps take more than one correction");
    assert_eq!(
        known.model.chain.evaluations,
        [600, 0],
        "one evaluation per step is enough"
    );
    assert!(evaluated.model.chain.evaluations[1] > 600);
    // Blocks with less than three tenths of the tolerance are not corrected: what they leave is not seen, but stays
    // below it.
    assert!(known.left <= tolerance, "{} N are left", known.left);
    compare(&known, &evaluated);
}

#[test]
fn beside_nonlinear_contributions_linear_ones_are_evaluated_on_common_rows_only() {
    let tolerance = 1e-4;
    let bed = 90..150;
    let (known, evaluated) = (run(true, bed.clone(), tolerance), run(false, bed.clone(), tolerance));
    let chain = &known.model.chain;
    assert!(known.iterations > 900, "the bed takes more corrections");
    assert!(chain.evaluations[0] == 600 && chain.evaluations[1] > 600);
    let [start, end] = chain.within;
    assert!(bed.start <= start && end <= bed.end);
    let [start, end] = evaluated.model.chain.within;
    assert!(start < bed.start && bed.end < end, "{start}, {end}");
    assert!(known.left <= tolerance, "{} N are left", known.left);
    compare(&known, &evaluated);
}

/// As on a linearised line in the wind, whose bending layers alone have no drag: a range for each run of such rows
/// would ask every contribution for its share of each.
#[test]
fn rows_of_linear_contributions_between_those_of_others_are_evaluated_with_them() {
    let bed = || (90..150).filter(|i| i % 4 != 0);
    let (known, evaluated) = (run(true, bed(), 1e-4), run(false, bed(), 1e-4));
    let [known_within, evaluated_within] = [&known, &evaluated].map(|run| run.model.chain.evaluations[1]);
    assert!(
        known_within > 600 && known_within <= evaluated_within,
        "{known_within}, {evaluated_within}"
    );
    assert!(known.left <= 1e-4, "{} N are left", known.left);
    compare(&known, &evaluated);
}

#[test]
fn a_tolerance_near_rounding_is_proved_by_evaluation() {
    // The largest first residual is some 100 N, of which a solution is trusted to leave 1e-7.
    let tolerance = 1e-9;
    let run = run(true, 0..0, tolerance);
    assert!(
        run.model.chain.evaluations[1] > 300,
        "{:?}",
        run.model.chain.evaluations
    );
    assert!(run.left <= tolerance, "{} N are left", run.left);
}

#[test]
fn a_first_correction_ends_a_step_unevaluated_only_where_it_leaves_less_than_the_tolerance() {
    // The contact's law bends, by turns more and less, and it opens and closes: what a correction leaves comes and
    // goes.
    for tolerance in [1.0, 0.1, 1e-2, 1e-3, 1e-4] {
        let run = run(true, 0..0, tolerance);
        assert!(run.estimated > 200, "{tolerance} N: {} steps of 600", run.estimated);
        assert!(run.left <= tolerance, "{tolerance} N: {} N are left", run.left);
    }
}
