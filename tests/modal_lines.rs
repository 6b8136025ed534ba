//! Lines in their own modes against the same lines linearised, and their saved states.
//!
//! Bounds of differences lie above the measured values of `docs/validation/reductions.csv` by less than a half.
use catenary::{Checkpoint, StripStart, Subsystem, static_line};
use integration_tests::runs::{EN_300, run, scene_with};
use scene::Scene;
use simulation::Mode;
use system::equilibrium::wire_height;

const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
const OVERLAP: &str = include_str!("../scenes/overlap.toml");
const TWIN: &str = include_str!("../scenes/dc-twin-wire.toml");

/// Five spans, and two seconds over three of them.
const SHORT: [&str; 5] = [
    "catenary.spans=5",
    "run.start_x=40",
    "run.duration=2.0",
    "run.evaluate={time=[0.3,1.8]}",
    "run.output_step=0.001",
];
const MESH: &str =
    "catenary.mesh={ elements_per_interval=4, corrections=[\"contact_compliance\", \"bending_layers\"] }";

/// Droppers of Kulkarni 2016, Table 4.
const CREEPING: [&str; 2] = ["catenary.droppers.stiffness=2e5", "catenary.droppers.damping=1e4"];

fn scene(text: &str, words: &str, step: f64, more: &[&str]) -> Scene {
    let step = format!("{step}");
    let overrides = [
        format!("model.reduce=[{words}]"),
        format!("coupling.macro_step={step}"),
        format!("solver.micro_step={step}"),
    ];
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    scene_with(text, &[&SHORT[..], &overrides, more].concat())
}

/// rms difference of the filtered force between the line in its modes at 1 ms and the linearised one at a quarter of
/// that, in percent of its standard deviation.
fn difference(text: &str, words: [&str; 2], more: &[&str]) -> f64 {
    let linear = run(scene(text, words[0], 2.5e-4, more), Mode::Monolithic, "modal-lines");
    let modal = run(scene(text, words[1], 1e-3, more), Mode::Monolithic, "modal-lines");
    let difference = 100.0 * modal.filtered_difference(&linear) / linear.sigma();
    let cost = [&linear, &modal].map(|run| run.summary.cost.real_time_factor);
    println!("{}: {difference:.3} % of σ, real-time factors {cost:?}", words[1]);
    difference
}

#[test]
fn a_planar_line_in_its_modes_is_the_linearised_one() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    // Stiff droppers have modes that turn too far in a step.
    for (stiffness, most) in [("1e5", 0.75), ("1e6", 1.5)] {
        let stiffness = format!("catenary.droppers.stiffness={stiffness}");
        let difference = difference(EN_300, words, &[MESH, &stiffness]);
        assert!(difference < most, "{difference} %");
    }
}

/// Wires have no dampers along them. Forces take those of the modes back on the whole line, for which soft droppers and
/// some seconds are needed to tell.
#[test]
fn wires_that_modes_stretch_are_not_damped_by_it() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    let longer = [
        MESH,
        "catenary.droppers.stiffness=2e4",
        "pantograph[1].static_force=50.0",
        "run.speed_kmh=250",
        "catenary.spans=8",
        "run.start_x=20",
        "run.duration=4.8",
        "run.evaluate={time=[1.1,4.8]}",
    ];
    let difference = difference(EN_300, words, &longer);
    assert!(difference < 0.25, "{difference} %");
}

/// Modes that are left out answer to a strip that moves by `1/(1 − (v/c)²)` of what they would at rest: on a fine mesh
/// that is a good part of the difference.
#[test]
fn modes_that_are_left_out_answer_to_strips_that_move() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    let mesh = MESH.replace("elements_per_interval=4", "elements_per_interval=8");
    let difference = difference(EN_300, words, &[&mesh]);
    assert!(difference < 0.5, "{difference} %");
}

/// A wire does not yield where its end is held: a strip that is exactly there feels what one beside it does.
#[test]
fn a_strip_under_the_end_of_a_second_wire_is_like_one_beside_it() {
    // The second wire begins at 240 m, where the strip is after 720 steps.
    let from = |start: &str| {
        let overrides = [
            "model.reduce=[\"planar\", \"modal\"]",
            "run.duration=1.2",
            "run.evaluate={time=[0.3,1.1]}",
            "run.output_step=0.001",
            "coupling.macro_step=0.001",
            "solver.micro_step=0.001",
            MESH,
            start,
        ];
        run(scene_with(OVERLAP, &overrides), Mode::Monolithic, "modal-end")
    };
    let [exact, beside] = ["run.start_x=200.0", "run.start_x=200.01"].map(from);
    let difference = exact.filtered_difference(&beside) / beside.sigma();
    assert!(difference < 0.02, "{difference}");
}

/// Slack droppers and the move of the strip are followed within steps, so that longer steps hardly tell: also where a
/// strip lifts the wire so far that wires behind it swing and make droppers slack. With droppers like rods, modes that
/// turn too far in a step tell more.
#[test]
fn longer_steps_change_the_force_little() {
    let cases = [
        (MESH, [0.3, 0.8]),
        ("pantograph[1].static_force=160.0", [0.3, 1.0]),
        ("catenary.droppers.stiffness=1e7", [0.75, 2.5]),
    ];
    for (line, most) in cases {
        let of = |step: f64| {
            let overrides = [MESH, line];
            run(
                scene(EN_300, "\"modal\"", step, &overrides),
                Mode::Monolithic,
                "modal-steps",
            )
        };
        let fine = of(2.5e-4);
        for (step, most) in [1e-3, 2e-3].into_iter().zip(most) {
            let difference = 100.0 * of(step).filtered_difference(&fine) / fine.sigma();
            println!("{line}, steps of {step} s: {difference:.3} % of σ");
            assert!(difference < most, "{line}, {step} s: {difference} %");
        }
    }
}

#[test]
fn dampers_in_the_droppers_are_those_of_the_line() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    let difference = difference(EN_300, words, &[MESH, "catenary.droppers.damping=20"]);
    assert!(difference < 0.75, "{difference} %");
}

#[test]
fn a_stitched_line_in_space_and_one_of_twin_wires_in_their_modes_are_the_linearised_ones() {
    let mesh = "catenary.mesh={ element_length=2.0, corrections=[\"contact_compliance\", \"bending_layers\"] }";
    for text in [STITCHED, TWIN] {
        let difference = difference(text, ["\"linearised\"", "\"modal\""], &[mesh]);
        assert!(difference < 0.75, "{difference} %");
    }
}

/// Dampers between those that steps can stand for and those that hold wires together.
#[test]
fn droppers_with_dampers_of_any_strength_are_those_of_the_line() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    // Coarser meshes have slack droppers that come taut elsewhere.
    let mesh = MESH.replace("=4", "=8");
    for (stiffness, damping, most) in [
        ("1e5", "200", 1.1),
        ("1e5", "1e3", 2.0),
        ("3e4", "1e3", 2.3),
        ("2e5", "3e3", 1.5),
    ] {
        let droppers = [("stiffness", stiffness), ("damping", damping)];
        let droppers = droppers.map(|(key, value)| format!("catenary.droppers.{key}={value}"));
        let difference = difference(EN_300, words, &[&mesh, &droppers[0], &droppers[1]]);
        assert!(difference < most, "{stiffness} N/m, {damping} N s/m: {difference} %");
    }
}

/// Modes of rods on coarse meshes turn by a third in a step: pushes by the tension at its begin would swing.
#[test]
fn droppers_creep_on_coarse_meshes_too() {
    let words = ["\"planar\", \"linearised\"", "\"modal\""];
    let mesh = "catenary.mesh={ elements_per_interval=2, corrections=\"none\" }";
    let difference = difference(EN_300, words, &[&[mesh], &CREEPING[..]].concat());
    assert!(difference < 3.0, "{difference} %");
}

/// Rods that do not creep are further from the linearised line by half and more.
#[test]
fn droppers_whose_dampers_hold_wires_together_creep_in_modes() {
    let of = |words: &str, step: f64, droppers: &[&str]| {
        let scene = scene(EN_300, words, step, &[&[MESH], droppers].concat());
        run(scene, Mode::Monolithic, "modal-creep")
    };
    let linear = of("\"planar\", \"linearised\"", 2.5e-4, &CREEPING);
    let [creeping, rods] = [&CREEPING[..], &["catenary.droppers.stiffness=1e7"]].map(|droppers| {
        let modal = of("\"modal\"", 1e-3, droppers);
        100.0 * modal.filtered_difference(&linear) / linear.sigma()
    });
    println!("droppers that creep: {creeping:.3} % of σ, rods: {rods:.3} % of σ");
    assert!(creeping < 1.4 && rods > 1.5 * creeping, "{creeping} %, {rods} %");
}

/// Contact force and height of the wire at rest on a strip that stands at `x` m, with the height that lifts the
/// linearised line by 150 N.
fn at_rest(words: &str, x: f64, droppers: &[&str]) -> (f64, f64) {
    let start = format!("run.start_x={x}");
    let brief = [MESH, "run.duration=0.5", "run.evaluate={time=[0.1,0.4]}", &start];
    let of = |words: &str| scene(EN_300, words, 1e-3, &[&brief[..], droppers].concat());
    let linear = of("\"planar\", \"linearised\"");
    let height = wire_height(&linear, &static_line(&linear).unwrap(), 0, 150.0).unwrap();
    let scene = of(words);
    let statics = static_line(&scene).unwrap();
    let mut line = Subsystem::new(&scene, &statics).unwrap();
    let strip = StripStart {
        x,
        y: 0.0,
        height,
        speed: 0.0,
    };
    line.start(&[strip]).unwrap();
    let contact = line.contact(0);
    (contact.force, contact.position.z)
}

/// Statics know no modes: with what the modes left out add, both deflections are the same, wherever the strip is.
#[test]
fn at_rest_the_modes_and_their_rest_are_the_whole_line() {
    let places = [150.0, 151.3, 155.0, 177.7].map(|x| (x, &[][..]));
    for (x, droppers) in places.into_iter().chain([(155.0, &CREEPING[..]), (177.7, &CREEPING)]) {
        let (force, z) = at_rest("\"planar\", \"linearised\"", x, droppers);
        let (modal_force, modal_z) = at_rest("\"modal\"", x, droppers);
        assert!(
            (modal_force / force - 1.0).abs() < 2e-4,
            "{x}: {modal_force} N and {force} N"
        );
        assert!((modal_z - z).abs() < 2e-6, "{x}: {modal_z} m and {z} m");
    }
}

#[test]
fn a_saved_line_continues_bit_for_bit() {
    for droppers in [&[][..], &CREEPING] {
        continues_bit_for_bit(droppers);
    }
}

fn continues_bit_for_bit(droppers: &[&str]) {
    let more = [&[MESH, "run.start_x=70"], droppers].concat();
    let scene = scene(EN_300, "\"modal\"", 1e-3, &more);
    let statics = static_line(&scene).unwrap();
    let mut line = Subsystem::new(&scene, &statics).unwrap();
    let strip = StripStart {
        x: 70.0,
        y: 0.0,
        height: wire_height(&scene, &statics, 0, 150.0).unwrap(),
        speed: scene.run.speed,
    };
    line.start(&[strip]).unwrap();
    let advance = |line: &mut Subsystem, from: usize, steps: usize| {
        for step in from..from + steps {
            line.advance_to(step as f64 * 1e-3, 1e-3).unwrap();
        }
        let contact = line.contact(0);
        [contact.force, contact.position.x, contact.position.z, contact.wire_vz].map(f64::to_bits)
    };
    advance(&mut line, 0, 40);
    let mut saved = Checkpoint::default();
    line.save_to(&mut saved);
    let first = advance(&mut line, 40, 60);
    line.restore_from(&saved).unwrap();
    assert_eq!(first, advance(&mut line, 40, 60));
    let mut other = Subsystem::new(&scene, &statics).unwrap();
    other.start(&[strip]).unwrap();
    other.restore_from(&saved).unwrap();
    assert_eq!(first, advance(&mut other, 40, 60), "in another instance");
}

/// Forces beyond the filter do not enter: co-simulation at 1 ms against one system.
#[test]
fn coupled_slaves_agree_with_one_system() {
    let scene = || scene(EN_300, "\"modal\"", 1e-3, &[MESH]);
    let whole = run(scene(), Mode::Monolithic, "modal-lines");
    let coupled = run(scene(), Mode::Inprocess, "modal-lines");
    let difference = 100.0 * coupled.filtered_difference(&whole) / whole.sigma();
    assert!(difference < 0.2, "{difference} %");
}
