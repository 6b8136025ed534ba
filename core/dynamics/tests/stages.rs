//! Stages that a step reports for profiling.
use dynamics::{
    Blocks, Force, GeneralizedAlpha, Jacobian, Layout, Motion, NewtonOptions, Stage, State, System, Weights,
};

/// A mass of 1 kg on a hardening spring.
struct Spring;

impl Force for Spring {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let q = motion.q[0];
        force[0] -= 100.0 * q + 1e4 * q * q * q;
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let q = motion.q[0];
        blocks.add(&[0], &[0], &[weights.q * (100.0 + 3e4 * q * q)]);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        blocks.add(&[0], &[0], &[1.0]);
    }
}

/// The spring, with the stages that were reported, and those in which its force was visited.
struct Told {
    layout: Layout,
    spring: Spring,
    stages: Vec<Stage>,
    visited: Vec<Stage>,
}

impl System for Told {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.visited
            .push(self.stages.last().copied().unwrap_or(Stage::Integration));
        visit(&mut self.spring);
    }

    fn enter(&mut self, stage: Stage) {
        self.stages.push(stage);
    }
}

fn told() -> Told {
    let mut layout = Layout::new();
    layout.add_coordinates(1, "mass");
    Told {
        layout,
        spring: Spring,
        stages: Vec::new(),
        visited: Vec::new(),
    }
}

fn steps(jacobian: Jacobian) -> (Told, dynamics::Counters) {
    let mut told = told();
    let options = NewtonOptions {
        jacobian,
        ..NewtonOptions::default()
    };
    let mut integrator = GeneralizedAlpha::new(0.8, options);
    let mut state = State::at_rest(1, 0, Vec::new());
    state.v[0] = 1.0;
    for step in 1..=20 {
        integrator
            .step(&mut told, &mut state, &[], f64::from(step) * 1e-2, 1e-2)
            .unwrap();
        assert_eq!(
            told.stages.last(),
            Some(&Stage::Integration),
            "at the end of step {step}"
        );
    }
    (told, integrator.counters())
}

/// A side of a coupling takes the first jump of its inputs before its first step.
#[test]
fn what_a_jump_factors_and_solves_is_counted() {
    let mut integrator = GeneralizedAlpha::new(0.8, NewtonOptions::default());
    let mut state = State::at_rest(1, 0, Vec::new());
    let mut told = told();
    integrator.jump(&mut told, &mut state, &[0.0], &[1.0], 1e-2).unwrap();
    let counters = integrator.counters();
    assert_eq!((counters.factorizations, counters.newton_iterations), (1, 0));
    assert!(counters.solves > 0);
    integrator.step(&mut told, &mut state, &[1.0], 1e-2, 1e-2).unwrap();
    assert_eq!(integrator.counters().factorizations, 1, "the same matrix");
}

#[test]
fn every_correction_and_every_factorisation_is_told() {
    for jacobian in [Jacobian::Modified, Jacobian::Full] {
        let (told, counters) = steps(jacobian);
        let count = |stage: Stage| told.stages.iter().filter(|told| **told == stage).count() as u64;
        assert!(counters.newton_iterations >= 20);
        assert_eq!(count(Stage::Solution), counters.newton_iterations, "{jacobian:?}");
        // One more for the pattern.
        assert_eq!(count(Stage::Factorization), counters.factorizations + 1, "{jacobian:?}");
        assert!(
            told.stages
                .windows(2)
                .all(|pair| (pair[0] == Stage::Integration) != (pair[1] == Stage::Integration)),
            "each stage ends in the integration"
        );
    }
}

#[test]
fn contributions_are_visited_for_the_integration_and_for_factors_only() {
    let (told, _) = steps(Jacobian::Full);
    assert!(told.visited.contains(&Stage::Integration) && told.visited.contains(&Stage::Factorization));
    assert!(!told.visited.contains(&Stage::Solution));
}
