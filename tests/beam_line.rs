//! A contact wire of fully parameterised beam elements against one of cable elements.
use integration_tests::lines::{EN, scene_line, solve};
use integration_tests::runs::{EN_250, run, scene_with};
use simulation::Mode;

/// The round wire of the standard's line: `r² = 4 EI/EA`, Poisson's ratio 0.34, `k = 6 (1 + ν)/(7 + 6 ν)`, `J = 2 I`.
const BEAM: [&str; 2] = [
    "catenary.mesh.element=\"beam\"",
    "catenary.contact_wire.beam={ shear_stiffness = 5.64e6, torsional_stiffness = 145.5, rotary_inertia = 1.55e-5 }",
];

/// The mesh that both kinds of elements can have.
const PLAIN: [&str; 3] = [
    "catenary.mesh.corrections=\"none\"",
    "catenary.mesh.elements_per_interval=4",
    "model.reduce=\"none\"",
];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    PLAIN.iter().chain(more).copied().collect()
}

#[test]
fn a_contact_wire_of_beams_hangs_where_one_of_cables_hangs() {
    for statics in ["form_finding", "nodal_displacement"] {
        let statics = format!("catenary.statics=\"{statics}\"");
        let more = [
            statics.as_str(),
            "catenary.spans=3",
            "catenary.stagger=[0.2, -0.2]",
            "run.evaluate={ spans = [2, 2] }",
            "run.duration=1.5",
        ];
        let cable = solve(&scene_line(EN, &with(&more)));
        let beam = solve(&scene_line(EN, &with(&[&more[..], &BEAM].concat())));
        // The reference is rounded to 1e-13 m; elements have 1e7 N/m.
        assert!(beam.report().residual < 2e-5, "{} N", beam.report().residual);
        let height = |line: &catenary::StaticLine, x: f64| line.wire_height_under(x, 0.0).unwrap().height;
        for x in [30.0, 60.0, 77.0, 91.0] {
            // The two kinds of elements bend alike: the difference is shear, 2 EI/(kGA l²) = 3e-5 of the bend, of the
            // millimetres that a wire sags between droppers.
            let difference = height(&beam, x) - height(&cable, x);
            assert!(difference.abs() < 1e-6, "{statics}, {x} m: {difference:e} m");
        }
    }
}

#[test]
fn the_contact_force_on_beams_is_that_on_cables() {
    let more = [
        "catenary.spans=6",
        "run.evaluate={ spans = [3, 4] }",
        "run.duration=4.0",
    ];
    let [cable, beam] = [&[][..], &BEAM].map(|element| {
        let scene = scene_with(EN_250, &with(&[&more[..], element].concat()));
        run(scene, Mode::Monolithic, "beam line")
    });
    let (sigma, difference) = (cable.sigma(), beam.filtered_difference(&cable));
    println!(
        "σ {sigma} N of cables, {} N of beams, difference {difference} N",
        beam.sigma()
    );
    assert!(
        (beam.sigma() / sigma - 1.0).abs() < 0.01,
        "{} N, {sigma} N",
        beam.sigma()
    );
    assert!(difference < 0.01 * sigma, "{difference} N");
}

#[test]
fn the_line_of_beams_steps_as_a_subsystem_too() {
    let more = [
        "catenary.spans=3",
        "run.evaluate={ spans = [2, 2] }",
        "run.duration=1.5",
    ];
    let [whole, coupled] = [Mode::Monolithic, Mode::Inprocess].map(|mode| {
        let scene = scene_with(EN_250, &with(&[&more[..], &BEAM].concat()));
        run(scene, mode, "beam line")
    });
    // The bound of the project for coupling at 1 ms.
    let difference = coupled.filtered_difference(&whole);
    assert!(
        difference < 0.02 * whole.sigma(),
        "{difference} N of {} N",
        whole.sigma()
    );
}
