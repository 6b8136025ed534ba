//! Stitched, overlapping and twin-wire lines against an independent program, tests/reference2d/wires2d.py: statics,
//! elasticity, and the filtered contact force point by point.
use catenary::{BendingLayers, Dimension, LineOptions, StaticLine, WireName};
use integration_tests::runs::{rms, run, scene_with};
use results::statistics::ForceStatistics;
use serde_json::Value;
use simulation::Mode;

/// A scene and results of the other program.
struct Case {
    name: &'static str,
    scene: &'static str,
    statics: &'static str,
    force: &'static str,
    dimension: Dimension,
}

const STITCHED: Case = Case {
    name: "stitched",
    scene: include_str!("data/reference2d/stitched.toml"),
    statics: include_str!("data/reference2d/stitched-statics.json"),
    force: include_str!("data/reference2d/stitched-force.csv"),
    dimension: Dimension::Planar,
};
const OVERLAP: Case = Case {
    name: "overlap",
    scene: include_str!("data/reference2d/overlap.toml"),
    statics: include_str!("data/reference2d/overlap-statics.json"),
    force: include_str!("data/reference2d/overlap-force.csv"),
    dimension: Dimension::Planar,
};
/// Two wires side by side: three dimensions here, one plane in the other program.
const TWIN: Case = Case {
    name: "twin",
    scene: include_str!("data/reference2d/twin.toml"),
    statics: include_str!("data/reference2d/twin-statics.json"),
    force: include_str!("data/reference2d/twin-force.csv"),
    dimension: Dimension::Spatial,
};

const MESH: &str = "catenary.mesh={elements_per_interval=32}";
/// Elements as short as the bending length of the contact wire.
const FINE: &str = "catenary.mesh={elements_per_interval=64}";

fn column(rows: &Value, key: &str) -> Vec<f64> {
    let rows = rows.as_array().unwrap().iter();
    rows.map(|row| row[key].as_f64().unwrap()).collect()
}

/// Largest difference of two lists.
fn farthest(ours: &[f64], theirs: &[f64], difference: fn(f64, f64) -> f64) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let pairs = ours.iter().zip(theirs);
    pairs.map(|(&a, &b)| difference(a, b).abs()).fold(0.0, f64::max)
}

fn relative(ours: f64, theirs: f64) -> f64 {
    ours / theirs - 1.0
}

fn statics_agree(case: &Case, mesh: &str) -> (StaticLine, Value) {
    let scene = scene_with(case.scene, &[mesh]);
    let options = LineOptions {
        dimension: case.dimension,
        layers: BendingLayers::AtAttachments,
        contact_compliance: Some(0.0),
        mass_correction: None,
    };
    let (catenary, _) = scene.modelled_line().unwrap();
    let line = StaticLine::solve(catenary, options).unwrap();
    let theirs: Value = serde_json::from_str(case.statics).unwrap();
    let droppers = &line.report().droppers;
    let ours = |of: fn(&catenary::DropperReport) -> f64| droppers.iter().map(of).collect::<Vec<f64>>();
    let theirs_of = |key| column(&theirs["droppers"], key);
    let places = farthest(&ours(|dropper| dropper.x), &theirs_of("x"), |a, b| a - b);
    assert!(places < 1e-6, "{places} m");
    let forces = farthest(&ours(|dropper| dropper.force), &theirs_of("force_N"), relative);
    let stiffness = catenary.droppers.stiffness;
    let lengths: Vec<f64> = droppers
        .iter()
        .map(|dropper| dropper.length + dropper.force / stiffness)
        .collect();
    let lengths = farthest(&lengths, &theirs_of("stressed_length_m"), |a, b| a - b);
    let x = column(&theirs["elasticity"], "x");
    let elasticity: Vec<f64> = line
        .elasticity(&x)
        .unwrap()
        .iter()
        .map(|point| point.elasticity)
        .collect();
    let elasticity = farthest(&elasticity, &column(&theirs["elasticity"], "m_per_N"), relative);
    println!(
        "{}: dropper forces within {forces:.1e}, lengths within {:.2} mm, elasticities within {elasticity:.1e}",
        case.name,
        1e3 * lengths
    );
    assert!(forces < 0.005 && elasticity < 0.01 && lengths < 1e-3);
    (line, theirs)
}

#[test]
fn a_stitched_line_hangs_and_yields_as_in_an_independent_program() {
    let (line, theirs) = statics_agree(&STITCHED, MESH);
    // The heights of the clamps follow from the jump of the messenger wire's tension there.
    let mut ours = Vec::new();
    let wires = line.line().topology().wires().iter().zip(line.line().wires());
    for (planned, wire) in wires.filter(|(planned, _)| planned.name == WireName::StitchWire) {
        let nodes = wire.geometry().nodes();
        ours.extend([0, planned.last()].map(|end| nodes[end].position.z));
    }
    let heights = farthest(&ours, &column(&theirs["clamps"], "z_m"), |a, b| a - b);
    println!("heights of the clamps within {:.2} mm", 1e3 * heights);
    assert!(heights < 1e-3);
}

#[test]
fn an_overlap_hangs_and_yields_as_in_an_independent_program() {
    statics_agree(&OVERLAP, MESH);
}

#[test]
fn twin_wires_hang_and_yield_as_in_an_independent_program() {
    // Kinks of the messenger wire, a string, are there on both meshes.
    let [coarse, fine] = [MESH, FINE].map(|mesh| {
        let (line, _) = statics_agree(&TWIN, mesh);
        line.elasticity(&[180.0]).unwrap()[0].elasticity
    });
    assert!(
        (coarse / fine - 1.0).abs() < 5e-4,
        "at a support: {coarse} and {fine} m/N"
    );
}

/// Difference of the filtered force of a run as one system from that of the other program, of its `σ`: rms and largest.
fn force_apart(case: &Case, linearised: bool) -> [f64; 2] {
    let mut reductions = Vec::new();
    reductions.extend((case.dimension == Dimension::Planar).then_some("\"planar\""));
    reductions.extend(linearised.then_some("\"linearised\""));
    let reductions = match reductions.is_empty() {
        true => "model.reduce=\"none\"".to_owned(),
        false => format!("model.reduce=[{}]", reductions.join(",")),
    };
    // The other program takes the same step with the same trapezoidal rule, short enough for both.
    let overrides = [
        MESH,
        &reductions,
        "solver.rho_inf=1",
        "solver.micro_step=2.5e-4",
        "coupling.macro_step=1e-3",
    ];
    let scene = scene_with(case.scene, &overrides);
    let (start, speed) = (scene.strip_start_x(0), scene.run.speed);
    let run = run(scene, Mode::Monolithic, &format!("reference-{}", case.name));
    let step = run.record.time[1];
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for row in case.force.lines().skip(1) {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let place = (cells[0] - start) / (speed * step);
        assert!(
            (place - place.round()).abs() < 1e-3,
            "the places are those of the same steps"
        );
        ours.push(run.filtered[place.round() as usize]);
        theirs.push(cells[1]);
    }
    let sigma = |series: &[f64]| ForceStatistics::of(series).unwrap().std;
    let (own, other) = (sigma(&ours), sigma(&theirs));
    let apart = rms(&ours, &theirs) / other;
    let most = farthest(&ours, &theirs, |a, b| a - b) / other;
    println!(
        "{}, linearised {linearised}: σ {own:.3} N, theirs {other:.3} N; apart {:.2} % of σ, at most {:.2} %",
        case.name,
        100.0 * apart,
        100.0 * most
    );
    [apart, most]
}

#[test]
fn the_force_on_a_stitched_line_is_that_of_an_independent_program() {
    let [_, most] = force_apart(&STITCHED, true);
    assert!(most < 0.02);
}

#[test]
fn the_force_through_an_overlap_is_that_of_an_independent_program() {
    let [_, most] = force_apart(&OVERLAP, true);
    assert!(most < 0.02);
}

#[test]
fn the_force_on_twin_wires_is_that_of_an_independent_program() {
    let [_, most] = force_apart(&TWIN, true);
    assert!(most < 0.02);
}

#[test]
#[ignore = "slow: three nonlinear runs, about two minutes"]
fn nonlinear_lines_stay_close_to_an_independent_program_that_is_linear() {
    // Products of displacements are left out there; wires under constant tension wander along the track.
    for case in [STITCHED, OVERLAP, TWIN] {
        let [apart, most] = force_apart(&case, false);
        assert!(apart < 0.06 && most < 0.2);
    }
}
