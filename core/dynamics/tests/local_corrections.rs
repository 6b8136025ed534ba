//! Steps that correct and evaluate only the rows with a remainder, against whole evaluations converged further.
use dynamics::{
    Blocks, ByRange, Checkpoint, Force, GeneralizedAlpha, Layout, LowRank, Motion, NewtonOptions, OnePass, Simulator,
    State, StepHistory, System, Updates, Weights,
};
use std::ops::Range;

const NODES: usize = 300;
const H: f64 = 1e-3;
/// N/m, N/m³, N/m.
const SPRING: f64 = 2e4;
const HARDENING: f64 = 5e8;
const FOUNDATION: f64 = 100.0;
const CONTACT: f64 = 5e4;

/// A chain of masses of 1 kg with hardening springs on a soft foundation.
struct Chain {
    evaluates_ranges: bool,
    whole: usize,
    /// Nodes evaluated within ranges.
    within: usize,
}

impl Chain {
    fn add(&self, nodes: Range<usize>, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        for i in nodes {
            let inertia = v_dot.map_or(0.0, |v_dot| v_dot[i]);
            let left = if i > 0 { motion.q[i] - motion.q[i - 1] } else { 0.0 };
            let right = if i + 1 < NODES {
                motion.q[i + 1] - motion.q[i]
            } else {
                0.0
            };
            let pull = |stretch: f64| SPRING * stretch + HARDENING * stretch.powi(3);
            force[i] += pull(right) - pull(left) - FOUNDATION * motion.q[i] - motion.v[i] - inertia;
        }
    }
}

impl Force for Chain {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..NODES, motion, None, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for i in 0..NODES {
            blocks.add(&[i], &[i], &[weights.q * FOUNDATION + weights.v]);
        }
        for i in 0..NODES - 1 {
            let stretch = motion.q[i + 1] - motion.q[i];
            let k = weights.q * (SPRING + 3.0 * HARDENING * stretch * stretch);
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
        self.whole += 1;
        self.add(0..NODES, motion, Some(v_dot), force);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        if self.evaluates_ranges { Some(self) } else { None }
    }
}

impl ByRange for Chain {
    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        let range = range.start.min(NODES)..range.end.min(NODES);
        self.within += range.len();
        self.add(range.clone(), motion, Some(v_dot), force);
        // Entries beside the range are not used by the solver.
        let ends = [range.start.checked_sub(1), Some(range.end).filter(|&end| end < NODES)];
        for beside in ends.into_iter().flatten() {
            force[beside] = f64::NAN;
        }
    }
}

/// A body of 10 kg, the last coordinate, that travels along the chain at one node per 10 ms, pushed against it by 100 N
/// that falls below zero for a while: contact is lost and comes back.
struct Contact {
    node: f64,
    version: u64,
    closed: bool,
    /// Steps in which the contact was open at the end.
    open_steps: usize,
}

impl Contact {
    fn weights(&self) -> (usize, [f64; 2]) {
        let node = (self.node as usize).min(NODES - 2);
        let part = self.node - node as f64;
        (node, [1.0 - part, part])
    }

    fn penetration(&self, motion: &Motion<'_>) -> f64 {
        let (node, [left, right]) = self.weights();
        motion.q[NODES] - left * motion.q[node] - right * motion.q[node + 1]
    }
}

impl Force for Contact {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let depth = self.penetration(motion);
        self.closed = depth > 0.0;
        force[NODES] += 100.0 - 160.0 * (20.0 * motion.t).sin().max(0.0);
        if self.closed {
            let (node, [left, right]) = self.weights();
            force[NODES] -= CONTACT * depth;
            force[node] += CONTACT * depth * left;
            force[node + 1] += CONTACT * depth * right;
        }
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

    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        self.closed == (self.penetration(motion) > 0.0)
    }

    fn end_step(&mut self, motion: &Motion<'_>) {
        self.open_steps += usize::from(self.penetration(motion) <= 0.0);
    }
}

struct Model {
    layout: Layout,
    chain: Chain,
    contact: Contact,
}

impl Model {
    fn new(evaluates_ranges: bool) -> Self {
        let mut layout = Layout::new();
        layout.add_coordinates(NODES, "chain");
        layout.add_coordinates(1, "body");
        Self {
            layout,
            chain: Chain {
                evaluates_ranges,
                whole: 0,
                within: 0,
            },
            contact: Contact {
                node: 100.0,
                version: 0,
                closed: false,
                open_steps: 0,
            },
        }
    }
}

impl System for Model {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.chain);
        visit(&mut self.contact);
    }
}

const STEPS: usize = 600;

fn options(tolerance: f64) -> NewtonOptions {
    NewtonOptions {
        tolerance,
        ..NewtonOptions::default()
    }
}

/// Largest residual of a state, N, evaluated anew.
fn left(judge: &mut Model, state: &State) -> f64 {
    let motion = state.motion(&[]);
    let mut force = vec![0.0; NODES + 1];
    judge.contact.begin_step(&motion, H);
    judge.contact.add_force(&motion, &mut force);
    judge.chain.add_dynamic_force(&motion, &state.v_dot, &mut force);
    force[NODES] -= 10.0 * state.v_dot[NODES];
    force.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Positions and velocities of the body after each step, and the model, state and work at the end.
fn run(evaluates_ranges: bool, tolerance: f64) -> (Vec<[f64; 2]>, Model, State, GeneralizedAlpha) {
    let mut model = Model::new(evaluates_ranges);
    let mut state = model.layout.state_at_rest();
    let mut integrator = GeneralizedAlpha::new(0.9, options(tolerance));
    let (mut path, mut judge, mut above) = (Vec::new(), Model::new(false), 0);
    for step in 1..=STEPS {
        let estimated = integrator.counters().estimated;
        integrator
            .step(&mut model, &mut state, &[], step as f64 * H, H)
            .unwrap();
        path.push([state.q[NODES], state.v[NODES]]);
        let residuals = integrator.residuals();
        assert!(residuals[residuals.len() - 1] <= tolerance, "{residuals:?}");
        let left = left(&mut judge, &state);
        let most = if integrator.counters().estimated > estimated {
            5.0
        } else {
            1.001
        };
        assert!(left <= most * tolerance, "step {step}: {left:e} N, {residuals:?}");
        above += usize::from(left > 1.001 * tolerance);
    }
    assert!(above <= STEPS / 100, "{above} of {STEPS} steps end above the tolerance");
    (path, model, state, integrator)
}

#[test]
fn local_corrections_reach_what_whole_evaluations_reach() {
    let tolerance = 1e-4;
    let (exact, whole, end, reference) = run(false, 1e-10);
    let (path, local, state, integrator) = run(true, tolerance);
    assert!(
        whole.contact.open_steps > 50,
        "contact is lost for {} steps",
        whole.contact.open_steps
    );
    assert!(whole.chain.within == 0);
    // A residual of the tolerance left in every step, always to the same side, is a force on 10 kg for 0.6 s.
    let (time, mass) = (STEPS as f64 * H, 10.0);
    for (step, (path, exact)) in path.iter().zip(&exact).enumerate() {
        let [position, velocity] = [path[0] - exact[0], path[1] - exact[1]].map(f64::abs);
        assert!(
            position < 0.5 * tolerance / mass * time * time,
            "step {step}: {position:e} m"
        );
        assert!(velocity < tolerance / mass * time, "step {step}: {velocity:e} m/s");
    }
    let largest = state
        .q
        .iter()
        .zip(&end.q)
        .fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
    assert!(largest < 1e-6, "{largest:e} m between the chains");
    // The first correction of a step reaches far; those after it do not.
    let [work, more] = [integrator.counters(), reference.counters()];
    assert!(work.newton_iterations < more.newton_iterations);
    assert!(work.estimated > STEPS as u64 / 10, "{work:?}");
    assert_eq!(local.chain.whole, STEPS);
    let whole_evaluations = work.newton_iterations as usize * NODES;
    println!("{} nodes of {whole_evaluations}, {work:?}", local.chain.within);
    assert!(work.newton_iterations > 3 * STEPS as u64 / 2, "{work:?}");
    assert!(
        2 * local.chain.within < whole_evaluations,
        "{} nodes of {whole_evaluations}",
        local.chain.within
    );
}

#[test]
fn a_restored_run_repeats_bit_for_bit_with_local_corrections() {
    let model = Model::new(true);
    let state = model.layout.state_at_rest();
    let mut simulator = Simulator::new(model, state, Vec::new(), H, 0.9, options(1e-4));
    let mut checkpoint = Checkpoint::default();
    let advance = |simulator: &mut Simulator<Model>, from: usize, to: usize| {
        for step in from..to {
            simulator
                .advance(step as f64 * H, H, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
        }
        simulator.state().clone()
    };
    advance(&mut simulator, 0, 150);
    simulator.save(&mut checkpoint);
    let first = advance(&mut simulator, 150, 400);
    simulator.restore(&checkpoint).unwrap();
    assert_eq!(advance(&mut simulator, 150, 400), first);
    // And in another simulator, which has no factors yet.
    let fresh = Model::new(true);
    let start = fresh.layout.state_at_rest();
    let mut other = Simulator::new(fresh, start, Vec::new(), H, 0.9, options(1e-4));
    other.restore(&checkpoint).unwrap();
    assert_eq!(advance(&mut other, 150, 400), first);
}
