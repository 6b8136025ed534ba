//! The time loop: no allocation in steady state, quadratic convergence, other lines behind the same interface.
use catenary::{
    AxialLaw, BendingLaw, BendingLayers, ContactPair, ContactTangent, Dimension, Line, LineOptions, LinearLine,
    OverheadLine, PenaltyContact, PrescribedStrip, StaticLine, StripStart, Subsystem, WireSection,
};
use component::Component;
use dynamics::{GeneralizedAlpha, Jacobian, Layout, NewtonOptions, System};
use integration_tests::lines::EN;
use integration_tests::runs::{run, scene_with};
use integration_tests::single_wire::{Material, SingleWire};
use scene::Scene;
use simulation::Mode;

const LUMPED: &str = include_str!("../scenes/thesis-lumped.toml");
const H: f64 = 1e-3;

/// Three spans of the EN 50318 line on a coarse mesh under one strip that starts in the second span.
fn scene(text: &str, more: &[&str]) -> Scene {
    let mut overrides: Vec<String> = [
        "catenary.mesh.elements_per_interval=1",
        "run.start_x=70",
        "run.duration=1.0",
        "run.evaluate={time=[0.1,0.9]}",
    ]
    .map(String::from)
    .to_vec();
    overrides.extend(more.iter().map(ToString::to_string));
    system::load(text, "scene.toml", &overrides).unwrap()
}

fn starts(scene: &Scene, height: f64) -> [StripStart; 1] {
    [StripStart {
        x: scene.strip_start_x(0),
        y: 0.0,
        height,
        speed: scene.run.speed,
    }]
}

/// Allocations of `steps` communication steps after `warm_up` steps.
fn allocations<C: Component>(
    component: &mut C,
    warm_up: usize,
    steps: usize,
    drive: &mut dyn FnMut(&mut C, usize),
) -> u64 {
    let mut run = |from: usize, to: usize| {
        for n in from..to {
            drive(component, n);
            component.do_step(n as f64 * H, H).unwrap();
        }
    };
    run(0, warm_up);
    allocation_counter::measure(|| run(warm_up, warm_up + steps)).count_total
}

#[test]
fn a_line_steps_without_allocating() {
    let scene = scene(EN, &["catenary.droppers.damping=100"]);
    let statics = catenary::static_line(&scene).unwrap();
    let height = statics.wire_height_under(scene.run.start_x, 110.0).unwrap().height + 110.0 / 5e4;
    let mut line = Subsystem::new(&scene, &statics).unwrap();
    line.start(&starts(&scene, height)).unwrap();
    // Rising and falling by 20 mm on the spot, so that the same droppers go slack and come back: the first time each of
    // them gets the column that is kept for it.
    let mut slack = 0;
    let count = allocations(&mut line, 700, 600, &mut |line, n| {
        let t = n as f64 * H;
        line.set_strip_input(0, 2, height + 0.01 * (1.0 - (20.0 * t).cos()));
        line.set_strip_input(0, 3, 0.0);
        line.set_strip_input(0, 5, 0.2 * (20.0 * t).sin());
        slack = slack.max(line.slack_droppers());
    });
    assert!(slack > 0, "no dropper went slack");
    assert_eq!(count, 0, "allocations in 600 steps");
}

#[test]
fn a_linkage_steps_without_allocating() {
    let mut scene = scene(integration_tests::lines::THESIS, &[]);
    scene.pantographs[0].start = Some(scene::Start {
        height: 4.95,
        force: 107.0,
    });
    let mut pantograph = vehicle::Subsystem::new(&scene, 0).unwrap();
    let count = allocations(&mut pantograph, 50, 300, &mut |pantograph, n| {
        pantograph.set_contact_input(2, -107.0 - 30.0 * (0.02 * n as f64).sin());
    });
    println!("{count} allocations in 300 steps of the linkage");
    assert_eq!(count, 0, "allocations in 300 steps");
}

#[test]
fn a_line_settles_under_a_strip_of_any_stiffness() {
    for stiffness in [5e4, 1e6, 1e8] {
        let scene = scene(EN, &[&format!("contact.stiffness={stiffness}")]);
        let statics = catenary::static_line(&scene).unwrap();
        let force = 110.0;
        let height = statics.wire_height_under(scene.run.start_x, force).unwrap().height + force / stiffness;
        let mut line = Subsystem::new(&scene, &statics).unwrap();
        line.start(&starts(&scene, height)).unwrap();
        // The dead force acts upwards, the contact along its normal: they differ by the slope of the wire squared.
        let found = line.contact(0).force;
        assert!((found - force).abs() < 0.01 * force, "{stiffness} N/m: {found} N");
    }
}

#[test]
fn newton_converges_quadratically_on_a_hard_contact_step() {
    let section = WireSection {
        axial_stiffness: 1.7e7,
        bending_stiffness: 195.0,
        mass_per_length: 1.35,
        tension: 2e4,
    };
    let material = Material {
        section,
        laws: (AxialLaw::Full, BendingLaw::Constant),
        gravity: 0.0,
    };
    let mut wire = SingleWire::spatial(&material, 20.0, 8).pinned(0).pinned(8);
    let law = PenaltyContact {
        stiffness: 1e7,
        damping: 500.0,
    };
    let curve = wire.geometry().clone();
    wire.contact = Some(ContactPair::new(
        law,
        curve,
        Box::new(PrescribedStrip { first: 0 }),
        2.0,
        ContactTangent::Exact,
    ));
    // A strip rising at 2 m/s while travelling at 60 m/s meets the wire within the step.
    let u = [9.3, 0.0, 2e-3, 60.0, 0.0, 2.0, 0.02, 0.0];
    let options = NewtonOptions {
        tolerance: 1e-6,
        jacobian: Jacobian::Full,
        ..NewtonOptions::default()
    };
    let mut integrator = GeneralizedAlpha::new(0.9, options);
    let mut state = wire.layout().state_at_rest();
    integrator.step(&mut wire, &mut state, &u, H, H).unwrap();
    let residuals = integrator.residuals();
    let printed: Vec<String> = residuals.iter().map(|residual| format!("{residual:.2e}")).collect();
    println!("residuals, N: {}", printed.join(", "));
    assert!(residuals[0] > 1e3, "the step is hard");
    // Once the contact has closed each residual goes with the square of the one before: r₊/r² does not grow.
    let tail: Vec<f64> = residuals.iter().copied().filter(|r| *r > 1e-6).collect();
    let steep = tail.windows(2).filter(|pair| pair[1] < 1e-3 * pair[0]).count();
    assert!(steep >= 2 && residuals.len() <= 9, "{residuals:?}");
}

/// Runs a line under a strip that rises by a cosine and returns the history of the contact force.
fn forces(scene: &Scene, layout: Layout, line: Box<dyn OverheadLine>, steps: usize) -> Vec<f64> {
    let mut line = Subsystem::with_line(scene, layout, line).unwrap();
    line.start(&starts(
        scene,
        scene.modelled_line().unwrap().0.first().height_at(0) + 0.045,
    ))
    .unwrap();
    (0..steps)
        .map(|n| {
            let t = n as f64 * H;
            line.set_strip_input(0, 5, 0.05 * (20.0 * t).sin());
            line.do_step(t, H).unwrap();
            line.contact(0).force
        })
        .collect()
}

fn solved(scene: &Scene, options: LineOptions) -> (Layout, Line) {
    let statics = StaticLine::solve(scene.modelled_line().unwrap().0, options).unwrap();
    let mut layout = Layout::new();
    let line = statics.line_in(&mut layout);
    (layout, line)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn planar_enriched_and_linear_lines_go_through_the_same_subsystem() {
    let scene = scene(EN, &["catenary.mesh.elements_per_interval=2"]);
    let steps = 200;
    let (layout, line) = solved(&scene, LineOptions::default());
    let spatial = forces(&scene, layout, Box::new(line), steps);
    let swing =
        spatial.iter().fold(0.0_f64, |max, f| max.max(*f)) - spatial.iter().fold(f64::MAX, |min, f| min.min(*f));
    assert!(swing > 20.0, "the strip moves the line: {swing} N");

    let planar = LineOptions {
        dimension: Dimension::Planar,
        ..LineOptions::default()
    };
    let (layout, line) = solved(&scene, planar);
    let coordinates = layout.coordinates();
    let flat = forces(&scene, layout, Box::new(line), steps);
    // No sideways motion: the same solution to the Newton tolerance of 1e-4 N, which contact and mass amplify little.
    assert!(
        distance(&flat, &spatial) < 1e-2,
        "planar: {} N",
        distance(&flat, &spatial)
    );

    let enriched = LineOptions {
        layers: BendingLayers::AtAttachments,
        ..planar
    };
    let (layout, line) = solved(&scene, enriched);
    assert!(layout.coordinates() > coordinates);
    let layered = forces(&scene, layout, Box::new(line), steps);
    let change = distance(&layered, &spatial);
    assert!(
        change > 1e-3 && change < 0.5 * swing,
        "bending layers change the force by {change} N"
    );

    let (layout, mut line) = solved(&scene, LineOptions::default());
    let linear = LinearLine::about(&mut line, &layout);
    let linear = forces(&scene, layout, Box::new(linear), steps);
    let change = distance(&linear, &spatial);
    assert!(
        change > 1e-6 && change < 0.1 * swing,
        "the linear line is {change} N away"
    );
}

/// A correction leaves out what is far below the tolerance; through a closing dropper's term of 2e7 N/m that became
/// more than the tolerance, and stayed in every further correction of the step at 0.9625 s.
#[test]
fn steps_that_close_stiffly_damped_droppers_reach_their_tolerance() {
    let overrides = [
        "model.reduce=[\"window\"]",
        "pantograph[1].static_force=106",
        "coupling.macro_step=0.00125",
        "solver.micro_step=0.00125",
        "solver.newton_tolerance=0.05",
        "run.duration=1.2",
        "run.evaluate={time=[0.2,1.0]}",
    ];
    let run = run(scene_with(LUMPED, &overrides), Mode::Monolithic, "stiff droppers");
    let cost = run.summary.cost;
    assert!(cost.newton_iterations < 3 * cost.micro_steps, "{cost:?}");
}

#[test]
fn a_step_too_short_to_see_changes_nothing_of_what_follows() {
    // Rates over it are rounding: of the contact force, which the correction of the mass needs, and of the
    // accelerations.
    let scene = scene(EN, &["catenary.mesh.corrections=[\"mass_correction\"]"]);
    let statics = catenary::static_line(&scene).unwrap();
    let course = |short: Option<f64>| -> Vec<f64> {
        let mut line = Subsystem::new(&scene, &statics).unwrap();
        let [start] = starts(&scene, scene.modelled_line().unwrap().0.first().height_at(0) + 0.045);
        line.start(&[start]).unwrap();
        let mut t = 0.0;
        let step = |n: i32| {
            if let Some(h) = short.filter(|_| n == 20) {
                line.advance_to(t, h).unwrap();
                t += h;
            }
            line.advance_to(t, H).unwrap();
            t += H;
            line.contact(0).force
        };
        (0..60).map(step).collect()
    };
    let whole = course(None);
    assert!(whole.iter().all(|force| *force > 10.0), "{whole:?}");
    for short in [1e-7, 1e-9, 1e-10, 1e-12, 1e-14] {
        let apart = distance(&whole, &course(Some(short)));
        println!("after a step of {short} s: {apart:e} N");
        assert!(apart < 0.01, "{short} s: {apart} N");
    }
}
