//! Static solutions that keep their factors while corrections contract.
use dynamics::{Blocks, Force, Layout, Motion, State, StaticOptions, StaticSolver, System, Weights};

const MASSES: usize = 40;
/// N/m, N/m³.
const SPRING: f64 = 2e3;
const HARDENING: f64 = 4e5;

/// Masses on hardening springs in line: the first spring is held, input 0 (N) pulls the last mass.
struct Line {
    layout: Layout,
    springs: Springs,
}

struct Springs {
    tangents: usize,
}

fn stretch(i: usize, q: &[f64]) -> f64 {
    q[i] - if i > 0 { q[i - 1] } else { 0.0 }
}

impl Force for Springs {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for i in 0..MASSES {
            let s = stretch(i, motion.q);
            let pull = SPRING * s + HARDENING * s.powi(3);
            force[i] -= pull;
            if i > 0 {
                force[i - 1] += pull;
            }
        }
        force[MASSES - 1] += motion.u[0];
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.tangents += 1;
        for i in 0..MASSES {
            let k = weights.q * (SPRING + 3.0 * HARDENING * stretch(i, motion.q).powi(2));
            if i > 0 {
                blocks.add(&[i - 1, i], &[i - 1, i], &[k, -k, -k, k]);
            } else {
                blocks.add(&[i], &[i], &[k]);
            }
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        (0..MASSES).for_each(|i| blocks.add(&[i], &[i], &[1.0]));
    }
}

impl System for Line {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.springs);
    }
}

fn line() -> Line {
    let mut layout = Layout::new();
    layout.add_coordinates(MASSES, "mass");
    let springs = Springs { tangents: 0 };
    Line { layout, springs }
}

/// Iterations and assembled tangents of a solution under a pull of `force` N, which is compared with the closed form:
/// every spring bears the whole pull.
fn pulled(
    line: &mut Line,
    solver: &mut StaticSolver,
    state: &mut State,
    (force, options): (f64, StaticOptions),
) -> (usize, usize) {
    let before = line.springs.tangents;
    let report = solver.solve(line, state, &[force], &options).unwrap();
    for i in 0..MASSES {
        let s = stretch(i, &state.q);
        let borne = SPRING * s + HARDENING * s.powi(3);
        assert!(
            (borne - force).abs() < 2e-6 * MASSES as f64,
            "spring {i}: {borne} N of {force} N"
        );
    }
    (report.iterations, line.springs.tangents - before)
}

/// Iterations and tangents of a first solution under 100 N.
fn first(options: StaticOptions) -> (usize, usize) {
    let mut line = line();
    let mut state = line.layout.state_at_rest();
    let mut solver = StaticSolver::new(&mut line, &state.motion(&[0.0]));
    pulled(&mut line, &mut solver, &mut state, (100.0, options))
}

#[test]
fn factors_are_kept_while_corrections_contract() {
    let [every, some] = [StaticOptions::default(), StaticOptions::modified()].map(first);
    assert!(
        some.0 > every.0 && some.1 < every.1,
        "iterations, tangents: {some:?}, {every:?}"
    );
}

#[test]
fn exact_tangents_find_what_kept_factors_do_not() {
    let iterations = first(StaticOptions::default()).0;
    let mut options = StaticOptions::modified();
    options.newton.max_iterations = iterations;
    assert_eq!(first(options).0, iterations);
}

#[test]
fn solutions_close_together_share_factors_as_long_as_they_serve() {
    let mut line = line();
    let mut state = line.layout.state_at_rest();
    let mut solver = StaticSolver::new(&mut line, &state.motion(&[0.0]));
    let mut tangents = |force: f64, options| pulled(&mut line, &mut solver, &mut state, (force, options)).1;
    let kept = StaticOptions::modified();
    assert_eq!(tangents(0.0, kept), 0, "at rest from the start");
    assert!(tangents(100.0, kept) > 0);
    for force in [100.5, 101.0, 101.5] {
        assert_eq!(tangents(force, kept), 0, "{force} N");
    }
    assert!(tangents(2000.0, kept) > 0, "factors of a softer line cannot serve");
    assert!(tangents(0.0, kept) > 0, "nor those of a stiffer one");
    assert!(tangents(1e-3, StaticOptions::default()) > 0, "without keeping factors");
}
