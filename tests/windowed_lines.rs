//! Accuracy of a window over lines of wires and spans that differ.
use catenary::{Checkpoint, StripStart, Subsystem};
use integration_tests::runs::{EN_300, rms, run, scene_with};
use simulation::Mode;
use std::ops::Range;

const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
const OVERLAP: &str = include_str!("../scenes/overlap.toml");
const TWIN: &str = include_str!("../scenes/dc-twin-wire.toml");

/// Spans of different lengths with their own droppers, divided differently.
const MIXED: [&str; 4] = [
    "catenary.spans=8",
    "catenary.span_length=[65,60,50,63,54,60,65,57]",
    "catenary.droppers.positions=[[5,14,23,32,41,50,60],[5,15,25,35,45,55],[5,15,25,35,45],[5,16,27,38,48,58],\
     [5,16,27,38,49],[5,15,25,35,45,55],[5,14,23,32,41,50,60],[5,16,28,40,52]]",
    "catenary.mesh={ element_length=4.0, corrections=\"none\" }",
];

/// Three seconds from the first window on, over several of its moves.
const JOURNEY: [&str; 3] = ["run.start_x=40", "run.duration=3.0", "run.evaluate={time=[0.2,2.9]}"];

const HALF_A_SECOND: [&str; 2] = ["run.duration=0.5", "run.evaluate={time=[0.1,0.4]}"];

/// rms difference of the filtered force between a run with the window and one without it, in percent of its standard
/// deviation.
fn windowed(text: &str, words: &str, more: &[&str]) -> f64 {
    let of = |words: &str| {
        let reduce = format!("model.reduce=[{words}]");
        let overrides = [&JOURNEY[..], more, &[&reduce]].concat();
        run(scene_with(text, &overrides), Mode::Monolithic, "windowed-lines")
    };
    let (whole, window) = (of(words), of(&format!("{words}, \"window\"")));
    for support in 0..whole.record.supports.len() {
        let pairs = whole.record.supports[support]
            .uplift
            .iter()
            .zip(&window.record.supports[support].uplift);
        let most = |of: fn((f64, f64)) -> f64| pairs.clone().fold(0.0, |most: f64, (a, b)| most.max(of((*a, *b))));
        let (a, b) = (most(|pair| pair.0), most(|pair| pair.1));
        assert!((a - b).abs() < 1e-3, "support {support}: {a} m, {b} m");
    }
    let difference = 100.0 * window.filtered_difference(&whole) / whole.sigma();
    let cost = |run: &integration_tests::runs::Run| run.summary.cost.real_time_factor;
    println!(
        "{words}: {difference:.4} % of σ, real-time factor {:?}, {:?}",
        cost(&whole),
        cost(&window)
    );
    difference
}

/// Linear lines: only the reduction of the spans beyond the window differs.
#[test]
fn a_window_follows_spans_that_are_divided_differently() {
    let difference = windowed(EN_300, "\"planar\", \"linearised\"", &MIXED);
    assert!(difference < 0.3, "{difference} %");
}

#[test]
fn a_window_follows_mixed_spans_with_dampers_in_the_droppers() {
    let more = [&MIXED[..], &["catenary.droppers.damping=50"]].concat();
    let difference = windowed(EN_300, "\"planar\", \"linearised\"", &more);
    assert!(difference < 0.3, "{difference} %");
}

/// Point masses on one of the wires give the wires nodes of their own.
#[test]
fn a_window_passes_point_masses() {
    let masses = "catenary.point_mass=[{ x=152, mass=3, wire=\"contact_wire\" }, { x=270, mass=5, \
                  wire=\"messenger_wire\" }]";
    let more = [&MIXED[..], &[masses]].concat();
    let difference = windowed(EN_300, "\"planar\", \"linearised\"", &more);
    assert!(difference < 0.3, "{difference} %");
}

#[test]
fn a_window_follows_a_stitched_line() {
    let more = [
        "catenary.spans=8",
        "catenary.mesh={ element_length=5.0, corrections=\"none\" }",
    ];
    let difference = windowed(STITCHED, "\"linearised\"", &more);
    assert!(difference < 0.3, "{difference} %");
}

/// Between the clamps the messenger wire has less than its nominal tension, in its bending layers too: with more there
/// than in the elements a span cut at its supports would not be stable. Layers at its supports follow without inertia,
/// whose error falls with the length of the elements.
#[test]
fn a_window_follows_a_stitched_line_on_a_corrected_mesh() {
    let more = [
        "catenary.spans=8",
        "catenary.mesh={ elements_per_interval=4, corrections=[\"contact_compliance\", \"bending_layers\"] }",
    ];
    let difference = windowed(STITCHED, "\"planar\", \"linearised\"", &more);
    assert!(difference < 1.5, "{difference} %");
}

#[test]
fn a_window_follows_twin_contact_wires() {
    let more = [
        "catenary.spans=8",
        "catenary.mesh={ element_length=5.0, corrections=\"none\" }",
    ];
    let difference = windowed(TWIN, "\"linearised\"", &more);
    assert!(difference < 0.3, "{difference} %");
}

/// In developed coordinates a curve is a lateral load, which is part of the static state.
#[test]
fn a_window_follows_a_line_through_a_curve_and_one_that_was_changed() {
    let mesh = [
        "catenary.spans=8",
        "catenary.mesh.elements_per_interval=2",
        "catenary.mesh.corrections=\"none\"",
    ];
    let curve = "catenary.curve_radius=[inf,inf,3000,3000,3000,inf,inf,inf,inf]";
    let change = "catenary.change={ temperature=10, thermal_expansion=1.7e-5, dropper=[{ span=3, dropper=4, \
                  missing=true }] }";
    for more in [curve, change] {
        let difference = windowed(EN_300, "\"linearised\"", &[&mesh[..], &[more]].concat());
        assert!(difference < 0.3, "{difference} %");
    }
}

/// The line of a scene pressed up a little by a strip that keeps its height.
fn under_a_strip(scene: &scene::Scene) -> (Subsystem, StripStart) {
    let statics = catenary::static_line(scene).unwrap();
    let mut line = Subsystem::new(scene, &statics).unwrap();
    let strip = StripStart {
        x: scene.strip_start_x(0),
        y: 0.0,
        height: statics.wire_height_under(scene.strip_start_x(0), 150.0).unwrap().height + 3e-3,
        speed: scene.run.speed,
    };
    line.start(&[strip]).unwrap();
    (line, strip)
}

/// Energy of the line, J, and force on the strip, N, at the end of each step of 1 ms.
fn course(line: &mut Subsystem, strip: &StripStart, steps: Range<usize>) -> Vec<(f64, f64)> {
    let step = |n: usize| {
        let t = n as f64 * 1e-3;
        line.set_strip_input(0, 2, strip.height);
        line.set_strip_input(0, 0, strip.x + strip.speed * t);
        line.advance_to(t, 1e-3).unwrap();
        (line.energy(), line.contact(0).force)
    };
    steps.map(step).collect()
}

/// Windows of unlike spans are different sections, with different droppers and energies at rest: the energy above the
/// static state stays that of the whole line when the window moves, and a line taken back over a move repeats itself.
#[test]
fn the_energy_passes_a_move_over_unlike_spans_which_repeats_itself_when_taken_back() {
    let subsystem = |words: &str| {
        let reduce = format!("model.reduce=[\"planar\", \"linearised\"{words}]");
        let scene = scene_with(
            EN_300,
            &[
                &MIXED[..],
                &["run.start_x=230", HALF_A_SECOND[0], HALF_A_SECOND[1], &reduce],
            ]
            .concat(),
        );
        under_a_strip(&scene)
    };
    let (mut whole, strip) = subsystem("");
    let (mut window, _) = subsystem(", \"window\"");
    // The strip comes to the next span at 0.1 s.
    let expected = course(&mut whole, &strip, 0..300);
    let mut found = course(&mut window, &strip, 0..60);
    let mut before = Checkpoint::default();
    window.save_to(&mut before);
    let first = course(&mut window, &strip, 60..300);
    window.restore_from(&before).unwrap();
    assert_eq!(course(&mut window, &strip, 60..300), first);
    found.extend(first);
    let off = |of: fn(&(f64, f64)) -> f64| {
        let pairs = expected.iter().zip(&found);
        pairs.fold(0.0, |most: f64, (a, b)| most.max((of(a) - of(b)).abs()))
    };
    let (energy, force) = (off(|step| step.0), off(|step| step.1));
    println!("{energy} J of {} J, {force} N", expected[0].0);
    assert!(energy < 0.01 * expected[0].0 && force < 1.0, "{energy} J, {force} N");
}

/// Equal spans, under stitch wires that let no span stand for another one.
#[test]
fn a_window_over_a_stitched_line_has_as_many_coordinates_whatever_the_number_of_spans() {
    let coordinates = |spans: usize| {
        let scene = scene_with(
            STITCHED,
            &[
                &format!("catenary.spans={spans}"),
                &format!("run.start_x={}", 65 * spans / 2),
                "run.duration=0.4",
                "run.evaluate={time=[0.1,0.3]}",
                "catenary.mesh={ element_length=9.0, corrections=\"none\" }",
                "model.reduce=[\"window\"]",
            ],
        );
        let statics = catenary::static_line(&scene).unwrap();
        catenary::WindowedLine::size(&scene, &statics).coordinates
    };
    assert_eq!(coordinates(72), coordinates(90));
}

const COARSE: &str = "catenary.mesh={ element_length=5.0, corrections=\"none\" }";

/// The overlap lies between 240 m and 420 m; the window reaches it before the strip and leaves it after it.
const THROUGH_THE_OVERLAP: [&str; 4] = [
    COARSE,
    "run.start_x=150",
    "run.duration=5.4",
    "run.evaluate={time=[0.2,5.3]}",
];

#[test]
fn a_window_passes_an_overlap_of_two_tension_lengths() {
    // Numbers of modes follow from wave speeds: on a mesh as coarse as this one they reach less high than elsewhere.
    for words in ["\"linearised\"", "\"planar\", \"linearised\""] {
        let difference = windowed(OVERLAP, words, &THROUGH_THE_OVERLAP);
        assert!(difference < 0.6, "{words}: {difference} %");
    }
}

#[test]
fn a_window_in_an_overlap_is_the_same_co_simulated_and_as_one_system() {
    let reduce = "model.reduce=[\"linearised\", \"window\"]";
    let journey = ["run.start_x=270", "run.duration=2", "run.evaluate={time=[0.2,1.9]}"];
    let scene = scene_with(OVERLAP, &[&journey[..], &[COARSE, reduce]].concat());
    let whole = run(scene.clone(), Mode::Monolithic, "windowed-overlap-whole");
    let coupled = run(scene, Mode::Inprocess, "windowed-overlap-coupled");
    let percent = 100.0 * rms(whole.raw(), coupled.raw()) / whole.sigma();
    println!("{percent:.4} % of the standard deviation");
    assert!(percent < 0.2, "{percent} %");
}

/// The strip starts in the middle span of the overlap under both contact wires and comes to the next span at 0.45 s;
/// there the first tension length ends two masts ahead.
#[test]
fn a_window_taken_back_in_an_overlap_repeats_itself() {
    let subsystem = |words: &str| {
        let reduce = format!("model.reduce=[\"linearised\"{words}]");
        let journey = ["run.start_x=335", HALF_A_SECOND[0], HALF_A_SECOND[1]];
        let scene = scene_with(OVERLAP, &[&journey[..], &[COARSE, &reduce]].concat());
        under_a_strip(&scene)
    };
    let forces = |line: &mut Subsystem, strip: &StripStart, steps: Range<usize>| -> Vec<f64> {
        let course = course(line, strip, steps).into_iter();
        course.map(|(_, force)| force).collect()
    };
    let (mut whole, strip) = subsystem("");
    let (mut window, _) = subsystem(", \"window\"");
    let expected = forces(&mut whole, &strip, 0..600);
    let mut found = forces(&mut window, &strip, 0..430);
    let mut before = Checkpoint::default();
    window.save_to(&mut before);
    let first = forces(&mut window, &strip, 430..600);
    window.restore_from(&before).unwrap();
    assert_eq!(forces(&mut window, &strip, 430..600), first);
    found.extend(first);
    let off = expected.iter().zip(&found);
    let off = off.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    println!("{off} N");
    assert!(off < 1.0, "{off} N");
}

/// Tension lengths of seven spans, each with an overlap over three spans at either end.
#[test]
fn a_window_has_as_many_coordinates_whatever_the_number_of_tension_lengths() {
    let (before, rest) = OVERLAP.split_once("[[catenary.tension_length]]").unwrap();
    let after = &rest[rest.find("[catenary.contact_wire]").unwrap()..];
    let after = &after[..after.find("[ranges]").unwrap()];
    let coordinates = |lengths: usize| {
        let tension_length = |number: usize| {
            let low = |at: bool| if at { "5.3, 5.3" } else { "5.8, 5.34" };
            let high = |at: bool| if at { "5.3, 5.3" } else { "5.34, 5.8" };
            format!(
                "[[catenary.tension_length]]\nstart_x = {}\nspans = 7\nspan_length = 60.0\nencumbrance = 1.2\n\
                 presag = 0.0\ncontact_wire_height = [{}, 5.3, 5.3, 5.3, 5.3, {}]\n\
                 stagger = [0.5, 0.3, 0.1, -0.1, 0.1, -0.1, -0.25, -0.4]\n",
                240 * number,
                low(number == 0),
                high(number + 1 == lengths)
            )
        };
        let all: String = (0..lengths).map(tension_length).collect();
        let start = format!("run.start_x={}", 240 * (lengths / 2) + 200);
        let scene = scene_with(
            &format!("{before}{all}{after}"),
            &[
                &start,
                "run.duration=0.4",
                "run.evaluate={time=[0.1,0.3]}",
                "catenary.mesh={ element_length=9.0, corrections=\"none\" }",
                "model.reduce=[\"linearised\", \"window\"]",
            ],
        );
        let statics = catenary::static_line(&scene).unwrap();
        catenary::WindowedLine::size(&scene, &statics)
    };
    assert_eq!(coordinates(18), coordinates(22));
}
