//! Static states of lines that differ in their loads only.
use catenary::{LineOptions, StaticLine};
use scene::Catenary;

/// Four spans of the line of EN 50318, with all forces `factor` times as large: it has the same form.
fn line(elements: usize, factor: f64) -> Catenary {
    let text = include_str!("../../../scenes/en50318-250.toml");
    let mesh = format!("catenary.mesh.elements_per_interval={elements}");
    let keys = [
        "catenary.spans=4",
        "run.start_x=20",
        "run.duration=1",
        "run.evaluate={ time = [0.0, 1.0] }",
        mesh.as_str(),
    ];
    let scene = catenary::load(text, "en50318-250.toml", &keys.map(str::to_owned)).unwrap();
    let mut line = scene.modelled_line().unwrap().0.clone();
    line.gravity *= factor;
    let messenger = line.messenger_wire.as_mut().unwrap();
    for wire in [&mut line.contact_wire, messenger] {
        wire.tension *= factor;
        wire.axial_stiffness *= factor;
        wire.bending_stiffness *= factor;
        wire.breaking_force = None;
    }
    line.droppers.stiffness *= factor;
    line.supports.messenger_vertical_stiffness *= factor;
    line.supports.messenger_lateral_stiffness *= factor;
    line.supports.messenger_longitudinal_stiffness *= factor;
    line.registration_arms.vertical_stiffness *= factor;
    line.registration_arms.lateral_stiffness *= factor;
    line
}

#[test]
fn the_residual_is_held_against_the_loads_so_that_the_same_form_is_found_for_any() {
    // As much rounding as on thousands of spans under the loads of the scene: of the strain, of many elements.
    for (elements, factor) in [(1, 1e4), (64, 1e3)] {
        let [own, heavy] = [1.0, factor].map(|factor| {
            let found = StaticLine::solve(&line(elements, factor), LineOptions::default());
            found.unwrap_or_else(|error| panic!("{elements} elements, {factor}: {error}"))
        });
        let length = |line: &StaticLine| -> Vec<f64> {
            let droppers = line.report().droppers.iter();
            droppers.map(|dropper| dropper.length).collect()
        };
        for (a, b) in length(&own).into_iter().zip(length(&heavy)) {
            // Form finding ends at 1e-10 m, and 1e-9 of the tension is 1e-10 m of a dropper.
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

#[test]
fn elasticity_is_the_rise_under_a_force_that_acts_alone() {
    const FORCE: f64 = 100.0;
    let line = StaticLine::solve(&line(4, 1.0), LineOptions::default()).unwrap();
    let x: Vec<f64> = (1..48).map(|part| 5.0 * f64::from(part)).collect();
    let height = |x: f64, force: f64| line.wire_height_under(x, force).unwrap().height;
    for (report, &x) in line.elasticity(&x).unwrap().iter().zip(&x) {
        let alone = (height(x, FORCE) - height(x, 0.0)) / FORCE;
        // Both solutions end at residuals far below 1e-6 of the force.
        assert!(
            (report.elasticity / alone - 1.0).abs() < 1e-6,
            "{x} m: {} {alone}",
            report.elasticity
        );
    }
}
