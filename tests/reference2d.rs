//! The line against an independent two-dimensional program, tests/reference2d/line2d.py: statics, and the contact force
//! of the line linearised about its static state, point by point.
use catenary::{
    BendingLayers, ContactPair, Dimension, LineOptions, LinearLine, OverheadLine, StaticLine, contact_pair,
};
use dynamics::{Force, Layout, Simulator, StaticOptions, System};
use integration_tests::runs::{EN_250, EN_300, rms, scene_with};
use results::statistics::LowPass;
use scene::Scene;
use vehicle::PantographModel;

/// Any line, one lumped pantograph and the contact between them.
struct Whole {
    layout: Layout,
    line: Box<dyn OverheadLine>,
    pantograph: PantographModel,
    contact: ContactPair,
}

impl System for Whole {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
        self.pantograph.forces(visit);
        visit(&mut self.contact);
    }
}

/// A straight line moves in one plane, as the script's does.
const PLANAR: LineOptions = LineOptions {
    dimension: Dimension::Planar,
    layers: BendingLayers::Absent,
    contact_compliance: None,
    mass_correction: None,
};

/// Line of a run.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Linear,
    Nonlinear,
}

/// A force over the position of the strip.
struct Series {
    x: Vec<f64>,
    raw: Vec<f64>,
    filtered: Vec<f64>,
}

/// Seconds that the run goes on after the evaluated range: the filter's slowest pole decays as exp(−48 t).
const AFTER: f64 = 0.3;

/// The contact force of a planar line at every step until the evaluated range is passed.
fn contact_force(scene: &mut Scene, kind: Kind, step: f64) -> Series {
    let catenary = scene.modelled_line().unwrap().0.clone();
    let statics = StaticLine::solve(&catenary, PLANAR).unwrap();
    let start_x = scene.strip_start_x(0);
    let free_height = statics.wire_height_under(start_x, 0.0).unwrap().height;
    let scene::PantographModel::Lumped(lumped) = &mut scene.pantographs[0].model else {
        panic!("not lumped")
    };
    lumped.reference_height = Some(free_height);

    let mut layout = Layout::new();
    let mut line = statics.line_in(&mut layout);
    let line: Box<dyn OverheadLine> = match kind {
        Kind::Linear => Box::new(LinearLine::about(&mut line, &layout)),
        Kind::Nonlinear => Box::new(line),
    };
    let model = &scene.pantographs[0].model;
    let mut pantograph =
        PantographModel::new(model, vehicle::Placement::of_scene(scene, 0), "pantograph", &mut layout).unwrap();
    let mut state = layout.state_at_rest();
    let start = pantograph.equilibrium_at_height(free_height + 0.02).unwrap();
    pantograph.set_initial(&start, &mut state);
    let contact = contact_pair(scene, &*line, (0, 0), pantograph.strip()).unwrap();
    let whole = Whole {
        layout,
        line,
        pantograph,
        contact,
    };
    let options = scene.solver.newton_options();
    let mut simulator = Simulator::new(whole, state, Vec::new(), step, scene.solver.rho_inf, options);
    simulator.settle(&StaticOptions::default()).unwrap();

    let speed = scene.run.speed;
    let end = scene.evaluation_time(0).1 + AFTER;
    let steps = (end / step).round() as usize;
    let mut raw = Vec::with_capacity(steps + 1);
    let force = |whole: &Whole, motion: &dynamics::Motion<'_>| whole.contact.state(motion).unwrap().force;
    let (whole, motion) = simulator.parts();
    raw.push(force(whole, &motion));
    for n in 0..steps {
        simulator
            .advance(n as f64 * step, step, &mut |_, _| {}, &mut |whole, motion, _, _| {
                raw.push(force(whole, &motion))
            })
            .unwrap();
    }
    println!("{kind:?}: {} steps, {:?}", steps, simulator.counters());
    let filtered = LowPass::new(scene.run.low_pass_hz, step).unwrap().filter(&raw).unwrap();
    let x = (0..=steps).map(|n| start_x + speed * step * n as f64).collect();
    Series { x, raw, filtered }
}

/// A series as written by the script.
fn reference(text: &str) -> Series {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let column = |i: usize| rows.iter().map(|row| row[i]).collect();
    Series {
        x: column(0),
        filtered: column(1),
        raw: column(2),
    }
}

/// The samples of `ours` at the positions of `theirs`.
fn at_positions(ours: &Series, theirs: &Series) -> Series {
    let pitch = ours.x[1] - ours.x[0];
    let places: Vec<usize> = theirs
        .x
        .iter()
        .map(|x| ((x - ours.x[0]) / pitch).round() as usize)
        .collect();
    for (&place, x) in places.iter().zip(&theirs.x) {
        assert!(
            (ours.x[place] - x).abs() < 1e-6,
            "the positions are those of the same steps"
        );
    }
    let pick = |series: &[f64]| places.iter().map(|&place| series[place]).collect();
    Series {
        x: theirs.x.clone(),
        raw: pick(&ours.raw),
        filtered: pick(&ours.filtered),
    }
}

fn sigma(series: &[f64]) -> f64 {
    results::statistics::ForceStatistics::of(series).unwrap().std
}

/// rms difference of filtered and raw force in parts of the reference's standard deviation.
fn apart(name: &str, ours: &Series, theirs: &Series) -> (f64, f64) {
    let ours = at_positions(ours, theirs);
    let (own, other) = (sigma(&ours.filtered), sigma(&theirs.filtered));
    let filtered = rms(&ours.filtered, &theirs.filtered) / other;
    let raw = rms(&ours.raw, &theirs.raw) / sigma(&theirs.raw);
    println!(
        "{name}: σ {own:.3} N, theirs {other:.3} N; rms difference {:.2} % of σ filtered, {:.2} % raw",
        100.0 * filtered,
        100.0 * raw
    );
    (filtered, raw)
}

const MESH: &str = "catenary.mesh.elements_per_interval=16";
/// The script uses the trapezoidal rule.
const TRAPEZOID: &str = "solver.rho_inf=1.0";
/// Step of the script, s.
const STEP: f64 = 2.5e-4;

fn linear_line_agrees(text: &str, name: &str, theirs: &str) {
    let ours = contact_force(&mut scene_with(text, &[MESH, TRAPEZOID]), Kind::Linear, STEP);
    let (filtered, raw) = apart(name, &ours, &reference(theirs));
    // The script leaves out the turning of the droppers; the line here projects the strip on the moving wire.
    assert!(filtered < 0.02 && raw < 0.03);
}

#[test]
fn the_linearised_line_gives_the_force_of_an_independent_program_at_300_km_h() {
    linear_line_agrees(
        EN_300,
        "linear, 300 km/h",
        include_str!("data/reference2d/en50318-300-sagging.csv"),
    );
}

#[test]
#[ignore = "slow: 20 800 steps of 12 800 coordinates, about 45 s"]
fn the_linearised_line_gives_the_force_of_an_independent_program_at_250_km_h() {
    linear_line_agrees(
        EN_250,
        "linear, 250 km/h",
        include_str!("data/reference2d/en50318-250-sagging.csv"),
    );
}

#[test]
#[ignore = "slow: four runs of about 20 000 steps of 12 800 coordinates, about 6 min"]
fn the_nonlinear_line_stays_close_to_its_linearisation_and_to_the_independent_program() {
    for (text, theirs, name) in [
        (
            EN_300,
            include_str!("data/reference2d/en50318-300-sagging.csv"),
            "300 km/h",
        ),
        (
            EN_250,
            include_str!("data/reference2d/en50318-250-sagging.csv"),
            "250 km/h",
        ),
    ] {
        let mut scene = scene_with(text, &[MESH, TRAPEZOID]);
        let theirs = reference(theirs);
        let nonlinear = contact_force(&mut scene, Kind::Nonlinear, STEP);
        let linear = at_positions(&contact_force(&mut scene, Kind::Linear, STEP), &theirs);
        assert!(apart(&format!("nonlinear, {name}, against the script"), &nonlinear, &theirs).0 < 0.02);
        assert!(apart(&format!("nonlinear, {name}, against linear"), &nonlinear, &linear).0 < 0.02);
    }
}

/// Statics against a file of the script with the same mesh.
fn statics_agree(overrides: &[&str], theirs: &str) {
    let scene = scene_with(EN_250, &[&[MESH][..], overrides].concat());
    let (catenary, _) = scene.modelled_line().unwrap();
    let line = StaticLine::solve(catenary, PLANAR).unwrap();
    let theirs: serde_json::Value = serde_json::from_str(theirs).unwrap();
    assert_eq!(theirs["elements_per_interval"], 16);
    let mut largest = [0.0_f64; 2];
    let droppers = theirs["droppers"].as_array().unwrap();
    assert_eq!(droppers.len(), line.report().droppers.len());
    for (ours, theirs) in line.report().droppers.iter().zip(droppers) {
        assert!((ours.x - theirs["x"].as_f64().unwrap()).abs() < 1e-9);
        if (2..catenary.spans()).contains(&ours.span) {
            let force = theirs["force_N"].as_f64().unwrap();
            largest[0] = largest[0].max((ours.force / force - 1.0).abs());
        }
    }
    // Supports, quarter points and mid-spans of the evaluated spans.
    let rows = theirs["elasticity"].as_array().unwrap();
    let rows: Vec<(f64, f64)> = rows
        .iter()
        .map(|row| (row["x"].as_f64().unwrap(), row["m_per_N"].as_f64().unwrap()))
        .filter(|(x, _)| x % 15.0 == 0.0)
        .collect();
    assert_eq!(rows.len(), 9);
    let x: Vec<f64> = rows.iter().map(|row| row.0).collect();
    for (ours, (x, theirs)) in line.elasticity(&x).unwrap().iter().zip(&rows) {
        assert_eq!(ours.x, *x);
        largest[1] = largest[1].max((ours.elasticity / theirs - 1.0).abs());
    }
    println!(
        "{overrides:?}: dropper forces within {:.2e}, elasticity within {:.2e}",
        largest[0], largest[1]
    );
    // The script is linear about the static state, which shows under 100 N.
    assert!(largest[0] < 0.01 && largest[1] < 0.01);
}

#[test]
fn statics_agree_with_an_independent_program() {
    statics_agree(&[], include_str!("data/reference2d/en50318-250-statics.json"));
}

#[test]
fn statics_agree_with_an_independent_program_with_fixed_wire_ends() {
    statics_agree(
        &["catenary.wire_ends=\"fixed\""],
        include_str!("data/reference2d/en50318-300-statics-fixed.json"),
    );
}
