//! The six-body pantograph in time: order, drift and energy of constrained motion.
use dynamics::{
    Blocks, Columns, Constraint, Force, Formulation, GeneralizedAlpha, Layout, Marker, Motion, NewtonOptions, State,
    System, Weights,
};
use nalgebra::Vector3;
use vehicle::{PantographModel, Placement};

/// A vertical spring between strip and a point that stays `height` high, as long as it is.
struct StripSpring {
    marker: Box<dyn Marker>,
    stiffness: f64,
    height: f64,
}

impl StripSpring {
    fn stretch(&self, motion: &Motion<'_>) -> f64 {
        self.height - self.marker.frame(motion).position.z
    }
}

impl Force for StripSpring {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        let lift = self.stiffness * self.stretch(motion);
        columns.add_force(&Vector3::new(0.0, 0.0, lift), &Vector3::zeros(), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        let indices: Vec<usize> = columns.as_slice().iter().map(|column| column.index).collect();
        let z: Vec<f64> = columns.as_slice().iter().map(|column| column.translation.z).collect();
        let k = weights.q * self.stiffness;
        let block: Vec<f64> = z.iter().flat_map(|a| z.iter().map(move |b| k * a * b)).collect();
        blocks.add(&indices, &indices, &block);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        0.5 * self.stiffness * self.stretch(motion) * self.stretch(motion)
    }
}

struct Pantograph {
    layout: Layout,
    model: PantographModel,
    spring: StripSpring,
}

impl System for Pantograph {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.model.forces(visit);
        visit(&mut self.spring);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.model.constraints(visit);
    }
}

/// Stiffness of the spring on the strip, N/m: that of EN 50318's contact.
const CONTACT: f64 = 5e4;

/// The thesis pantograph at rest against a spring whose other end has jumped by `jump` m; `damping` in the suspension.
fn released(jump: f64, damping: f64) -> (Pantograph, State) {
    let text = include_str!("../scenes/thesis-pantograph.toml");
    let mut scene = system::load(text, "thesis.toml", &[]).unwrap();
    if let scene::PantographModel::Linkage(entry) = &mut scene.pantographs[0].model {
        entry.collector_suspension.damping = damping;
    }
    let placement = Placement {
        start_x: 10.0,
        speed: scene.run.speed,
        gravity: 9.81,
        one_motion: false,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let mut layout = Layout::new();
    let mut model = PantographModel::new(&scene.pantographs[0].model, placement, "pantograph 1", &mut layout).unwrap();
    let mut state = layout.state_at_rest();
    let equilibrium = model.equilibrium_at_height(4.945).unwrap();
    model.set_initial(&equilibrium, &mut state);
    let spring = StripSpring {
        marker: model.strip(),
        stiffness: CONTACT,
        height: 4.945 - equilibrium.force / CONTACT + jump,
    };
    (Pantograph { layout, model, spring }, state)
}

/// A gap of g m counts as g/(β h²) in the accelerations: small steps need joints closed to rounding.
fn options() -> NewtonOptions {
    NewtonOptions {
        constraint_tolerance: 1e-14,
        ..NewtonOptions::default()
    }
}

/// State after `duration` s in steps of `h`, and the largest joint gap on the way.
fn run(jump: f64, damping: f64, duration: f64, h: f64) -> (State, f64, f64) {
    run_with(options(), jump, damping, duration, h)
}

fn run_with(options: NewtonOptions, jump: f64, damping: f64, duration: f64, h: f64) -> (State, f64, f64) {
    let (mut system, mut state) = released(jump, damping);
    let mut integrator = GeneralizedAlpha::new(0.9, options);
    integrator.start_accelerations(&mut system, &mut state, &[]).unwrap();
    let (mut worst, mut rate) = (0.0_f64, 0.0_f64);
    for step in 1..=(duration / h).round() as usize {
        integrator
            .step(&mut system, &mut state, &[], step as f64 * h, h)
            .unwrap();
        worst = worst.max(gap(&mut system, &state));
        rate = rate.max(gap_rate(&mut system, &state));
    }
    let work = integrator.counters();
    println!("h = {h} s: {work:?}");
    (state, worst, rate)
}

/// Largest residual of the joints, m or –.
fn gap(system: &mut Pantograph, state: &State) -> f64 {
    let mut worst = 0.0_f64;
    system.constraints(&mut |joint| {
        let mut g = [0.0; 5];
        joint.residual(&state.motion(&[]), &mut g);
        worst = g.iter().fold(worst, |worst, g| worst.max(g.abs()));
    });
    worst
}

/// Largest rate of the joints' residuals, m/s or 1/s.
fn gap_rate(system: &mut Pantograph, state: &State) -> f64 {
    let mut worst = 0.0_f64;
    system.constraints(&mut |joint| {
        let mut sink = |_: usize, columns: &[usize], values: &[f64]| {
            let rate: f64 = columns
                .iter()
                .zip(values)
                .map(|(&column, value)| value * state.v[column])
                .sum();
            worst = worst.max(rate.abs());
        };
        joint.jacobian(&state.motion(&[]), &mut dynamics::JacobianRows::new(&mut sink));
    });
    worst
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

fn turned(a: &State, b: &State) -> f64 {
    a.rotation.iter().zip(&b.rotation).fold(0.0, |worst: f64, (a, b)| {
        worst.max(dynamics::rotation::log(&(a.inverse() * b)).amax())
    })
}

#[test]
fn generalized_alpha_is_second_order_on_the_linkage() {
    let run = |h: f64| run(-0.02, 50.0, 0.2, h).0;
    let reference = run(0.2 / 3200.0);
    let errors = |h: f64| {
        let state = run(h);
        [
            distance(&state.q, &reference.q).max(turned(&state, &reference)),
            distance(&state.v, &reference.v),
            distance(&state.lambda, &reference.lambda),
        ]
    };
    let steps = [100.0, 200.0, 400.0].map(|count| errors(0.2 / count));
    for (kind, name) in ["positions", "velocities", "multipliers"].iter().enumerate() {
        let order = (steps[1][kind] / steps[2][kind]).log2();
        println!(
            "{name}: errors {:.3e} {:.3e} {:.3e}, order {order:.3}",
            steps[0][kind], steps[1][kind], steps[2][kind]
        );
        assert!((order - 2.0).abs() < 0.1, "{name}: {order}");
    }
}

#[test]
fn the_augmented_equations_move_the_linkage_as_index_3_does() {
    let augmented = NewtonOptions {
        formulation: Formulation::Index1Baumgarte,
        ..options()
    };
    let rest = released(-0.02, 50.0).1;
    let reference = run(-0.02, 50.0, 0.2, 0.2 / 3200.0).0;
    let moved = distance(&reference.q, &rest.q);
    let errors = [400.0, 800.0].map(|count| {
        let (state, gap, rate) = run_with(augmented, -0.02, 50.0, 0.2, 0.2 / count);
        [
            distance(&state.q, &reference.q).max(turned(&state, &reference)),
            distance(&state.v, &reference.v),
            distance(&state.lambda, &reference.lambda),
            gap,
            rate,
        ]
    });
    let names = [
        "positions",
        "velocities",
        "multipliers",
        "gaps of the joints",
        "their rates",
    ];
    for (kind, name) in names.iter().enumerate() {
        let order = (errors[0][kind] / errors[1][kind]).log2();
        println!(
            "{name}: {:.3e} {:.3e}, order {order:.3}",
            errors[0][kind], errors[1][kind]
        );
        assert!((order - 2.0).abs() < 0.3, "{name}: {order}");
    }
    println!("moved by {moved:.3e}");
    // A thousandth of the motion at a quarter of a millisecond; the head swings with 80 rad/s: (ω h)² = 4e-4.
    assert!(errors[1][0] < 1e-3 * moved, "{:e} of {moved:e}", errors[1][0]);
}

#[test]
fn joints_stay_closed_to_rounding_while_the_mechanism_moves() {
    let (state, gap, rate) = run(-0.05, 50.0, 2.0, 1e-3);
    assert!(gap <= 1e-14, "{gap}"); // Newton's tolerance
    // Index 3 does not enforce the rates; they follow with the order of the scheme.
    assert!(rate < 1e-3, "{rate}");
    let sideways = state
        .q
        .iter()
        .skip(1)
        .step_by(6)
        .fold(0.0_f64, |worst, y| worst.max(y.abs()));
    assert!(sideways < 1e-9, "left its plane by {sideways} m");
}

#[test]
fn the_undamped_linkage_keeps_its_energy() {
    let (mut system, mut state) = released(-0.02, 0.0);
    let mut integrator = GeneralizedAlpha::new(1.0, NewtonOptions::default());
    integrator.start_accelerations(&mut system, &mut state, &[]).unwrap();
    let energy = |system: &mut Pantograph, state: &State| {
        let motion = state.motion(&[]);
        let mut sum = 0.0;
        system.forces(&mut |force| sum += force.energy(&motion));
        let bodies = system.model.linkage().unwrap().bodies();
        let kinetic: f64 = bodies.iter().map(|body| body.kinetic_energy(&motion)).sum();
        (sum + kinetic, kinetic)
    };
    let (start, _) = energy(&mut system, &state);
    let h = 2e-4;
    let mut largest_kinetic = 0.0_f64;
    for step in 1..=5000 {
        integrator
            .step(&mut system, &mut state, &[], f64::from(step) * h, h)
            .unwrap();
        largest_kinetic = largest_kinetic.max(energy(&mut system, &state).1);
    }
    let (end, _) = energy(&mut system, &state);
    assert!(largest_kinetic > 1.0, "{largest_kinetic}");
    // Second order: (ωh)² of the energy in motion, ω of the head on the contact about 80 rad/s.
    assert!(
        (end - start).abs() < 1e-3 * largest_kinetic,
        "{start} {end} {largest_kinetic}"
    );
}
