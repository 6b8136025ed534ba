//! A line and its linearisation in motion.
use catenary::{ContactPair, ContactTangent, Line, LinearLine, PenaltyContact, PrescribedStrip, StaticLine, WireName};
use dynamics::{Force, GeneralizedAlpha, Layout, NewtonOptions, State, System};
use integration_tests::lines::{short_line, solve};

/// A line as a system of its own.
struct Alone<L> {
    layout: Layout,
    line: L,
}

impl System for Alone<Line> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
    }
}

impl System for Alone<LinearLine> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
    }
}

fn alone(line: &StaticLine) -> Alone<Line> {
    let mut layout = Layout::new();
    let line = line.line_in(&mut layout);
    Alone { layout, line }
}

#[test]
fn uplift_counts_from_its_reference() {
    let line = solve(&short_line(2));
    let mut system = alone(&line);
    let lifted = line.wire_height_under(55.0, 150.0).unwrap().state.q;
    let rise = system.line.uplift(1, &lifted);
    assert!(rise > 0.0);
    system.line.set_uplift_reference(&lifted);
    assert_eq!(system.line.uplift(1, &lifted), 0.0);
    assert_eq!(system.line.uplift(1, &vec![0.0; lifted.len()]), -rise);
}

/// Runs a line freely from a state for `steps` steps of 1 ms; calls `watch` after each.
fn run<L>(system: &mut Alone<L>, state: &mut State, steps: usize, mut watch: impl FnMut(&Alone<L>, &State))
where
    Alone<L>: System,
{
    let mut integrator = GeneralizedAlpha::new(0.9, NewtonOptions::default());
    for step in 1..=steps {
        integrator.step(system, state, &[], step as f64 * 1e-3, 1e-3).unwrap();
        watch(system, state);
    }
}

/// Gives the contact wire an upward velocity that vanishes at the supports, m/s.
fn gust(system: &Alone<Line>, peak: f64) -> State {
    let mut state = system.layout.state_at_rest();
    for node in system.line.wire(WireName::ContactWire).geometry().nodes() {
        let phase = std::f64::consts::PI * node.position.x / 60.0;
        state.v[node.map.position(2).unwrap()] = peak * phase.sin().powi(2);
        state.v[node.map.slope(2).unwrap()] = peak * std::f64::consts::PI / 60.0 * (2.0 * phase).sin();
    }
    state
}

#[test]
fn a_line_at_rest_stays_at_rest() {
    let mut system = alone(&solve(&short_line(2)));
    let mut state = system.layout.state_at_rest();
    run(&mut system, &mut state, 100, |_, _| {});
    assert!(
        state.q.iter().all(|q| q.abs() < 1e-8),
        "{:e}",
        state.q.iter().fold(0.0_f64, |a, b| a.max(b.abs()))
    );
}

#[test]
fn a_gust_that_slackens_every_dropper_is_survived_and_loses_energy() {
    let mut system = alone(&solve(&short_line(2)));
    let mut state = gust(&system, 4.0);
    let speed = state.v.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let start = system.line.energy(&system.layout.state_at_rest().motion(&[]));
    let (mut slackest, mut highest) = (0, f64::NEG_INFINITY);
    run(&mut system, &mut state, 1000, |system, state| {
        let motion = state.motion(&[]);
        slackest = slackest.max(system.line.slack_count(&motion));
        highest = highest.max(system.line.energy(&motion) - start);
    });
    assert_eq!(slackest, 18);
    assert!(state.q.iter().all(|q| q.is_finite() && q.abs() < 1.0));
    // Potential energy never exceeds the kinetic energy of the gust: two spans, ∫ sin⁴ = 3/8.
    let kinetic = 0.5 * 1.35 * 120.0 * 0.375 * speed * speed;
    assert!(highest > 0.05 * kinetic && highest < kinetic, "{highest} {kinetic}");
}

#[test]
fn the_linear_line_answers_small_forces_as_the_line_does() {
    let mut system = alone(&solve(&short_line(3)));
    let linear = LinearLine::about(&mut system.line, &system.layout);
    let mut linear = Alone {
        layout: system.layout.clone(),
        line: linear,
    };
    let difference = |size: f64, linear: &mut Alone<LinearLine>| {
        let mut exact = alone(&solve(&short_line(3)));
        let (mut a, mut b) = (gust(&exact, size), gust(&exact, size));
        run(&mut exact, &mut a, 100, |_, _| {});
        run(linear, &mut b, 100, |_, _| {});
        let largest = a.q.iter().fold(0.0_f64, |max, q| max.max(q.abs()));
        let error = a.q.iter().zip(&b.q).fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
        error / largest
    };
    // The error of a linearisation is proportional to the motion: millimetres, then centimetres.
    let (small, large) = (difference(0.01, &mut linear), difference(0.5, &mut linear));
    assert!(small < 1e-3, "{small}");
    assert!(large < 0.1 && large > small, "{large}");
}

/// A line with a strip that inputs move.
struct Touched<L> {
    alone: Alone<L>,
    contact: ContactPair,
}

impl<L> System for Touched<L>
where
    Alone<L>: System,
{
    fn layout(&self) -> &Layout {
        self.alone.layout()
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.alone.forces(visit);
        visit(&mut self.contact);
    }
}

/// Contact force, N, in every millisecond of half a second under a strip that runs through the second span at 60 m/s.
fn contact_force<L>(alone: Alone<L>, curve: std::sync::Arc<dyn catenary::WireCurve>) -> Vec<f64>
where
    Alone<L>: System,
{
    let law = PenaltyContact {
        stiffness: 5e4,
        damping: 0.0,
    };
    let strip = Box::new(PrescribedStrip { first: 0 });
    let contact = ContactPair::new(law, curve, strip, 1.6, ContactTangent::RankOne);
    let mut system = Touched { alone, contact };
    let mut state = system.layout().state_at_rest();
    let mut integrator = GeneralizedAlpha::new(0.9, NewtonOptions::default());
    let mut forces = Vec::new();
    for step in 1..=500 {
        let t = f64::from(step) * 1e-3;
        // The strip rises by 20 mm in the first tenth of a second.
        let u = [
            65.0 + 60.0 * t,
            0.0,
            5.28 + 0.2 * t.min(0.2),
            60.0,
            0.0,
            if t < 0.2 { 0.2 } else { 0.0 },
            0.0,
            0.0,
        ];
        integrator.step(&mut system, &mut state, &u, t, 1e-3).unwrap();
        forces.push(
            system
                .contact
                .state(&state.motion(&u))
                .map_or(0.0, |contact| contact.force),
        );
    }
    forces
}

#[test]
fn the_same_contact_runs_along_the_line_and_its_linearisation() {
    let mut exact = alone(&solve(&short_line(3)));
    let curve = exact.line.contact_curve(0);
    let linear = Alone {
        layout: exact.layout.clone(),
        line: LinearLine::about(&mut exact.line, &exact.layout),
    };
    let b = contact_force(linear, curve.clone());
    let a = contact_force(exact, curve);
    let norm = |values: &mut dyn Iterator<Item = f64>| (values.map(|x| x * x).sum::<f64>() / 500.0).sqrt();
    let (size, error) = (
        norm(&mut a.iter().copied()),
        norm(&mut a.iter().zip(&b).map(|(a, b)| a - b)),
    );
    assert!(size > 20.0, "{size}");
    assert!(error < 0.02 * size && error > 0.0, "{error} {size}");
}

#[test]
fn the_linear_line_has_the_static_residual_and_tangent_of_the_line() {
    let mut system = alone(&solve(&short_line(3)));
    let linear = LinearLine::about(&mut system.line, &system.layout);
    let mut linear = Alone {
        layout: system.layout.clone(),
        line: linear,
    };
    let mut state = gust(&system, 1.0);
    let v = state.v.clone();
    for scale in [0.0, 1e-6] {
        for (q, v) in state.q.iter_mut().zip(&v) {
            *q = scale * v;
        }
        let (mut a, mut b) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        system.forces(&mut |part| part.add_force(&state.motion(&[]), &mut a));
        linear.forces(&mut |part| part.add_force(&state.motion(&[]), &mut b));
        let largest = a.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
        for (i, (a, b)) in a.iter().zip(&b).enumerate() {
            assert!((a - b).abs() < 1e-5 * largest, "{}: {a} {b}", system.layout.name(i));
        }
    }
    assert_eq!(linear.line.droppers().slack_count(&state.motion(&[])), 0);
}

/// The difference of the forces of a line and its linearisation at `scale` times the displacements under a lifted
/// contact wire, N.
fn neglected(scale: f64) -> Vec<f64> {
    let statics = solve(&short_line(3));
    let mut exact = alone(&statics);
    let mut linear = LinearLine::about(&mut exact.line, &exact.layout);
    let mut state = exact.layout.state_at_rest();
    let lifted = statics.wire_height_under(80.0, 100.0).unwrap().state.q;
    for (q, lifted) in state.q.iter_mut().zip(&lifted) {
        *q = scale * lifted;
    }
    let motion = state.motion(&[]);
    assert_eq!(
        (exact.line.slack_count(&motion), linear.droppers().slack_count(&motion)),
        (0, 0)
    );
    let (mut a, mut b) = (vec![0.0; lifted.len()], vec![0.0; lifted.len()]);
    exact.line.forces(&mut |part| part.add_force(&motion, &mut a));
    linear.forces(&mut |part| part.add_force(&motion, &mut b));
    a.iter().zip(&b).map(|(a, b)| a - b).collect()
}

#[test]
fn what_the_linear_line_neglects_is_of_second_order() {
    let norm = |force: Vec<f64>| force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let (whole, half, quarter) = (norm(neglected(0.4)), norm(neglected(0.2)), norm(neglected(0.1)));
    assert!(whole > 1.0, "{whole} N");
    for ratio in [whole / half, half / quarter] {
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
    }
}

#[test]
fn droppers_of_the_linear_line_go_slack_where_those_of_the_line_do() {
    let statics = solve(&short_line(3));
    let mut exact = alone(&statics);
    let linear = LinearLine::about(&mut exact.line, &exact.layout);
    let mut most = 0;
    for lift in [5e-4, 2e-3, 1e-2] {
        let mut state = gust(&exact, lift);
        std::mem::swap(&mut state.q, &mut state.v);
        let motion = state.motion(&[]);
        let samples = exact.line.dropper_samples(&motion).zip(linear.dropper_samples(&motion));
        for (exact, linear) in samples {
            assert_eq!(exact.force == 0.0, linear.force == 0.0, "{exact:?} {linear:?}");
            assert_eq!((exact.top, exact.bottom), (linear.top, linear.bottom));
            assert!((exact.force - linear.force).abs() < 1e-3, "{exact:?} {linear:?}");
        }
        assert_eq!(exact.line.slack_count(&motion), linear.droppers().slack_count(&motion));
        most = most.max(linear.droppers().slack_count(&motion));
    }
    assert!(most > 2, "{most} slack droppers");
}
