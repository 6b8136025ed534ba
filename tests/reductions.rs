//! Accuracy of `model.reduce`: each word changes the result by no more than stated.
use catenary::{Checkpoint, StripStart, Subsystem};
use integration_tests::fmus::THESIS;
use integration_tests::runs::{EN_300, Run, run, scene_with};
use simulation::Mode;

const THESIS_LUMPED: &str = include_str!("../scenes/thesis-lumped.toml");

/// Three spans of the reference model, with droppers going slack and the contact force varying widely.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=1.5",
    "run.evaluate={time=[0.3,1.4]}",
    "run.start_x=30",
];

fn reduced(words: &str, more: &[&str]) -> Run {
    let reduce = format!("model.reduce={words}");
    let overrides = [&SHORT[..], &[&reduce], more].concat();
    run(scene_with(EN_300, &overrides), Mode::Monolithic, "reductions")
}

/// The lateral coordinates of a straight line stay zero, so nothing but rounding may differ; rounding grows through the
/// impacts of droppers and the tolerance of Newton's method (1e-3 N).
#[test]
fn a_planar_line_is_the_spatial_line_where_nothing_pushes_sideways() {
    for more in [&[][..], &["catenary.stagger=[0.15]"]] {
        let (full, planar) = (reduced("none", more), reduced("auto", more));
        assert_eq!(planar.summary.model.reductions, ["planar"]);
        assert!(planar.summary.model.coordinates < full.summary.model.coordinates * 7 / 10);
        let difference = planar.raw_difference(&full);
        assert!(difference < 1e-6 * full.sigma(), "{difference} N");
        let uplift = |run: &Run| run.record.supports[1].uplift.clone();
        for (a, b) in uplift(&planar).iter().zip(uplift(&full)) {
            assert!((a - b).abs() < 1e-9, "{a} m, {b} m");
        }
    }
}

/// Arms give way to changes of the tension by the square of the angle at which wires turn.
#[test]
fn a_staggered_line_is_planar_only_where_asked_for_with_an_error_of_second_order() {
    let of = |words: &str, stagger: f64| reduced(words, &[&format!("catenary.stagger=[{stagger},-{stagger}]")]);
    let straight = reduced("planar", &["catenary.stagger=[0.0]"]);
    let error = |stagger: f64| {
        let (full, planar) = (of("auto", stagger), of("planar", stagger));
        assert!(full.summary.model.reductions.is_empty());
        // Droppers are upright, as both wires have the same stagger.
        assert!(planar.raw_difference(&straight) < 1e-6 * full.sigma());
        let places = |run: &Run| run.record.pantographs[0].contact_y.clone();
        for (kept, moved) in places(&planar).iter().zip(places(&full)) {
            assert!((kept - moved).abs() < 0.01 * stagger, "{kept} m, {moved} m");
        }
        planar.raw_difference(&full) / full.sigma()
    };
    let (small, large) = (error(0.2), error(0.4));
    println!("{small:.2e} of σ at 0.2 m, {large:.2e} at 0.4 m");
    assert!(small < 0.02 && (3.0..5.0).contains(&(large / small)), "{small} {large}");
}

/// Half as much give of stiffer arms is half as much error beyond that of the side view, which has no arms.
#[test]
fn the_error_of_a_planar_line_grows_with_the_give_of_its_arms() {
    const TRAM: &str = include_str!("../scenes/tram-single-wire.toml");
    let of = |more: &[&str]| run(scene_with(TRAM, more), Mode::Monolithic, "planar");
    let planar = of(&["model.reduce=[\"planar\"]"]);
    let percent = |stiffness: f64| {
        let arms = format!("catenary.registration_arms.lateral_stiffness={stiffness}");
        let full = of(&["model.reduce=\"none\"", &arms]);
        100.0 * planar.filtered_difference(&full) / full.sigma()
    };
    let [soft, stiff, rest] = [5e4, 1e5, 1e8].map(percent);
    println!("{soft:.2} %, {stiff:.2} %, {rest:.2} % of σ");
    let ratio = (soft - rest) / (stiff - rest);
    assert!((1.7..2.5).contains(&ratio), "{soft} % {stiff} % {rest} %");
    assert!(soft < 1.0 && rest < 0.5 * soft, "{soft} % {rest} %");
}

/// Planar lines, so that only the law of motion differs. Fixed ends make the tension follow the lift.
#[test]
fn a_linearised_line_is_within_two_percent_of_its_line_and_a_flat_one_is_not() {
    for (ends, flat_is_beyond) in [("constant_tension", 0.2), ("fixed", 3.0)] {
        let ends = format!("catenary.wire_ends={ends}");
        let more = [ends.as_str(), "catenary.mesh.elements_per_interval=4"];
        let exact = reduced("planar", &more);
        let percent = |run: &Run| 100.0 * run.filtered_difference(&exact) / exact.sigma();
        let (linearised, flat) = (reduced("[\"planar\", \"linearised\"]", &more), reduced("flat", &more));
        assert_eq!(linearised.summary.model.reductions, ["planar", "linearised"]);
        assert_eq!(flat.summary.model.reductions, ["flat"]);
        let reason = |run: &Run| run.summary.model.parts[0].reason.clone();
        assert!(reason(&linearised).contains("linearised about the static state"));
        assert!(reason(&exact).contains("nonlinear") && reason(&flat).contains("flat"));
        let distances = (percent(&linearised), percent(&flat));
        println!(
            "{ends}: linearised {:.2} %, flat {:.2} % of σ",
            distances.0, distances.1
        );
        assert!(distances.0 < 2.0 && distances.0 > 0.01, "{distances:?} %");
        assert!(
            distances.1 > flat_is_beyond && distances.1 > distances.0,
            "{distances:?} %"
        );
        // Every line starts in its own equilibrium: the first steps differ from those of the whole line by less than a
        // newton of more than 100.
        for run in [&linearised, &flat] {
            let [own, of_line] = [run, &exact].map(|run| &run.record.pantographs[0].force[..10]);
            for (own, of_line) in own.iter().zip(of_line) {
                assert!((own - of_line).abs() < 0.5, "{own} N, {of_line} N");
            }
        }
    }
}

#[test]
fn the_modes_run_the_same_linearised_line() {
    let reduce = "model.reduce=[\"planar\", \"linearised\"]";
    let overrides = [&SHORT[..], &[reduce]].concat();
    let of = |mode: Mode| run(scene_with(EN_300, &overrides), mode, "reductions-linearised");
    let (whole, parts, fmus) = (of(Mode::Monolithic), of(Mode::Inprocess), of(Mode::Cosimulation));
    assert_eq!(parts.raw(), fmus.raw(), "FMUs run the components");
    let nonlinear = reduced("planar", &[]);
    let coupling = whole.filtered_difference(&parts);
    // As far from the monolithic run as the nonlinear line is, and nearer to it than to that line.
    assert!(coupling < 0.01 * whole.sigma(), "{coupling} N");
    assert!(coupling < 0.5 * whole.filtered_difference(&nonlinear), "{coupling} N");
    assert_eq!(whole.record.supports.len(), nonlinear.record.supports.len());
    let largest = |run: &Run| -> f64 {
        let uplift = run.record.supports.iter().flat_map(|support| &support.uplift);
        uplift.fold(0.0, |max, u| max.max(*u))
    };
    assert!(largest(&nonlinear) > 5e-3, "{} m", largest(&nonlinear));
    for run in [&whole, &parts] {
        assert!((largest(run) - largest(&nonlinear)).abs() < 0.02 * largest(&nonlinear));
    }
}

/// A strip at the start of its scene that presses with 110 N.
fn pressing(scene: &scene::Scene, statics: &catenary::StaticLine) -> StripStart {
    let x = scene.strip_start_x(0);
    StripStart {
        x,
        y: 0.0,
        height: statics.wire_height_under(x, 110.0).unwrap().height,
        speed: scene.run.speed,
    }
}

#[test]
fn a_linearised_line_taken_back_repeats_bit_for_bit() {
    let scene = scene_with(
        EN_300,
        &[&SHORT[..], &["model.reduce=[\"planar\", \"linearised\"]"]].concat(),
    );
    let statics = catenary::static_line(&scene).unwrap();
    let start = pressing(&scene, &statics);
    let StripStart { x, height, speed, .. } = start;
    let mut line = Subsystem::new(&scene, &statics).unwrap();
    line.start(&[start]).unwrap();
    let mut slack = 0;
    let mut course = |line: &mut Subsystem, from: usize| -> Vec<f64> {
        (from..from + 150)
            .map(|n| {
                let t = n as f64 * 1e-3;
                line.set_strip_input(0, 2, height + 0.03 * (30.0 * t).sin().powi(2));
                line.set_strip_input(0, 0, x + speed * t);
                line.advance_to(t, 1e-3).unwrap();
                slack = slack.max(line.slack_droppers());
                line.contact(0).force
            })
            .collect()
    };
    course(&mut line, 0);
    let mut checkpoint = Checkpoint::default();
    line.save_to(&mut checkpoint);
    let first = course(&mut line, 150);
    line.restore_from(&checkpoint).unwrap();
    assert_eq!(course(&mut line, 150), first);
    let mut other = Subsystem::new(&scene, &statics).unwrap();
    other.restore_from(&checkpoint).unwrap();
    assert_eq!(course(&mut other, 150), first, "in another instance");
    assert!(slack > 0, "no dropper went slack");
}

/// A run with the window against the same one without it, both with `words` as further reductions: rms difference of
/// the filtered force in percent of its standard deviation, and the largest difference of the raw force in the
/// evaluated time, N.
fn windowed(words: &str, more: &[&str]) -> (f64, f64) {
    windowed_scene(EN_300, words, more)
}

fn windowed_scene(text: &str, words: &str, more: &[&str]) -> (f64, f64) {
    let of = |words: &str| {
        let reduce = format!("model.reduce=[{words}]");
        let overrides = [&["catenary.mesh.elements_per_interval=2", &reduce], more].concat();
        run(scene_with(text, &overrides), Mode::Monolithic, "reductions-window")
    };
    let (whole, window) = (of(words), of(&format!("{words}, \"window\"")));
    assert!(window.summary.model.parts[0].reason.contains("in full"));
    let uplift = |run: &Run, support: usize| -> f64 {
        let uplift = &run.record.supports[support].uplift;
        uplift.iter().fold(0.0, |max: f64, u| max.max(*u))
    };
    for support in 0..whole.record.supports.len() {
        let (a, b) = (uplift(&whole, support), uplift(&window, support));
        // A support that the window has left rings on in a linear span.
        assert!((a - b).abs() < 1e-3, "support {support}: {a} m, {b} m");
    }
    let strips = whole.record.pantographs.iter().zip(&window.record.pantographs);
    let largest = strips
        .flat_map(|(a, b)| a.force.iter().zip(&b.force))
        .fold(0.0, |max: f64, (a, b)| max.max((a - b).abs()));
    let difference = 100.0 * window.filtered_difference(&whole) / whole.sigma();
    println!("{words}: {difference:.4} % of σ, {largest:.4} N");
    (difference, largest)
}

/// From the first span to the last one: both true ends, and a border of spans every 0.72 s, where nothing jumps.
#[test]
fn a_window_travels_from_end_to_end_without_a_trace_on_a_linearised_line() {
    let more = [
        "catenary.spans=7",
        "catenary.mesh.corrections=\"none\"",
        "run.start_x=30",
        "run.duration=4.2",
        "run.evaluate={time=[0.2,4.0]}",
    ];
    let (difference, largest) = windowed("\"planar\", \"linearised\"", &more);
    assert!(difference < 0.1 && largest < 0.5, "{difference} %, {largest} N");
}

/// Reduced spans have their halves of the bending layers at their supports, the window's own line has none at its ends:
/// the remaining difference of a line with layers, smaller on a finer mesh.
#[test]
fn a_window_has_bending_layers_beyond_it() {
    for (elements, most) in [(2, 1.5), (4, 0.4)] {
        let mesh = format!("catenary.mesh.elements_per_interval={elements}");
        let more = [
            &*mesh,
            "catenary.spans=7",
            "run.start_x=30",
            "run.duration=4.2",
            "run.evaluate={time=[0.2,4.0]}",
        ];
        let (difference, _) = windowed("\"planar\", \"linearised\"", &more);
        assert!(difference < most, "{elements} elements: {difference} %");
    }
}

/// Remaining difference besides the modes: spans beyond the window are linear.
#[test]
fn a_window_of_the_nonlinear_line_differs_by_less_than_it_says() {
    let more = [
        "catenary.spans=8",
        "run.start_x=140",
        "run.duration=1.6",
        "run.evaluate={time=[0.2,1.5]}",
    ];
    let (difference, largest) = windowed("\"planar\"", &more);
    assert!(difference < 0.3 && largest < 1.0, "{difference} %, {largest} N");
}

/// Droppers whose dampers hold the wires together, `ω c = 60 k` at 20 Hz: without the elongations on the interface of a
/// reduced span modes would blow up as the window moves.
#[test]
fn a_window_takes_droppers_with_strong_dampers() {
    let more = [
        "catenary.spans=10",
        "catenary.droppers.damping=1e5",
        "catenary.mesh.elements_per_interval=4",
        "run.duration=6.0",
        "run.evaluate={time=[1.0,5.8]}",
    ];
    let (difference, _) = windowed_scene(THESIS_LUMPED, "\"planar\", \"linearised\"", &more);
    assert!(difference < 0.45, "{difference} %");
}

/// Waves of tension run along the whole line between fixed ends: longitudinal modes in the spans far from the window
/// are needed.
#[test]
fn a_window_is_followed_by_waves_along_the_wires() {
    let more = [
        "catenary.mesh.elements_per_interval=6",
        "run.start_x=560",
        "run.duration=4.0",
        "run.evaluate={time=[0.5,3.9]}",
    ];
    let (difference, _) = windowed_scene(THESIS_LUMPED, "\"planar\", \"linearised\"", &more);
    assert!(difference < 0.25, "{difference} %");
}

/// Spans beyond the near ones, first ahead of the window, then behind: modes up to less than the filter's frequency
/// would not do.
#[test]
fn a_window_runs_through_a_tension_length_of_32_spans() {
    let more = [
        "catenary.spans=32",
        "catenary.mesh.elements_per_interval=6",
        "run.duration=16.0",
        "run.evaluate={time=[9.0,15.8]}",
    ];
    let (difference, largest) = windowed("\"planar\", \"linearised\"", &more);
    assert!(difference < 0.35 && largest < 1.5, "{difference} %, {largest} N");
}

/// Steps close to the longest ones for which the corrected inertia of the whole line is positive.
#[test]
fn a_window_takes_the_steps_of_its_line() {
    let more = [
        "catenary.mesh.elements_per_interval=4",
        "solver.micro_step=0.0025",
        "coupling.macro_step=0.0025",
        "run.output_step=0.0025",
        "run.duration=3.0",
        "run.evaluate={time=[0.5,2.9]}",
    ];
    let (difference, _) = windowed("\"planar\"", &more);
    assert!(difference < 0.5, "{difference} %");
}

#[test]
fn a_window_follows_a_staggered_line() {
    let more = [
        "catenary.spans=9",
        "catenary.stagger=[0.2,-0.2]",
        "run.start_x=200",
        "run.duration=1.0",
        "run.evaluate={time=[0.1,0.9]}",
    ];
    let (difference, largest) = windowed("\"linearised\"", &more);
    assert!(difference < 0.3 && largest < 1.0, "{difference} %, {largest} N");
}

#[test]
fn a_window_holds_several_pantographs() {
    let second = r#"
[[pantograph]]
model = "lumped"
offset_x = -85.0
static_force = 120.0
strip = { width = 1.2 }
masses = [7.2, 15.0]
stiffnesses = [4200.0, 50.0]
dampings = [10.0, 90.0]
"#;
    let more = [
        "catenary.spans=9",
        "catenary.mesh.corrections=\"none\"",
        "run.start_x=230",
        "run.duration=1.0",
        "run.evaluate={time=[0.1,0.9]}",
    ];
    let (difference, largest) = windowed_scene(&format!("{EN_300}{second}"), "\"planar\", \"linearised\"", &more);
    assert!(difference < 0.3 && largest < 1.0, "{difference} %, {largest} N");
}

/// Waves do not come back from beyond the modelled spans of a longer line.
#[test]
fn nothing_comes_back_from_the_end_of_what_is_modelled_on_a_long_line() {
    let more = [
        "catenary.spans=90",
        "catenary.mesh.corrections=\"none\"",
        "catenary.mesh.elements_per_interval=1",
        "run.start_x=2650",
        "run.duration=1.5",
        "run.evaluate={time=[0.3,1.4]}",
    ];
    let (difference, largest) = windowed("\"planar\", \"linearised\"", &more);
    assert!(difference < 0.3 && largest < 3.0, "{difference} %, {largest} N");
}

/// A window that travels, gone back over one of its moves: on a short line the spans beyond it become other ones, in
/// the middle of a long one they stay.
#[test]
fn a_window_taken_back_over_a_border_of_spans_repeats_bit_for_bit() {
    for (spans, start) in [("10", "run.start_x=290"), ("80", "run.start_x=2390")] {
        let scene = scene_with(
            EN_300,
            &[
                &format!("catenary.spans={spans}"),
                start,
                "run.duration=0.4",
                "run.evaluate={time=[0.1,0.3]}",
                "catenary.mesh.elements_per_interval=1",
                "model.reduce=[\"planar\", \"window\"]",
            ],
        );
        let statics = catenary::static_line(&scene).unwrap();
        let strip = pressing(&scene, &statics);
        let StripStart { x, height, speed, .. } = strip;
        let new = || {
            let mut line = Subsystem::new(&scene, &statics).unwrap();
            line.start(&[strip]).unwrap();
            line
        };
        let course = |line: &mut Subsystem, steps: std::ops::Range<usize>| -> Vec<f64> {
            steps
                .map(|n| {
                    let t = n as f64 * 1e-3;
                    line.set_strip_input(0, 2, height + 0.01 * (30.0 * t).sin().powi(2));
                    line.set_strip_input(0, 0, x + speed * t);
                    line.advance_to(t, 1e-3).unwrap();
                    line.contact(0).force
                })
                .collect()
        };
        let mut line = new();
        // The borders are at 0.12 s and 0.84 s.
        course(&mut line, 0..60);
        let (mut before, mut after) = (Checkpoint::default(), Checkpoint::default());
        line.save_to(&mut before);
        let mut first = course(&mut line, 60..200);
        line.save_to(&mut after);
        let second = course(&mut line, 200..300);
        line.restore_from(&before).unwrap();
        assert_eq!(course(&mut line, 60..200), first, "{spans} spans, back over the border");
        line.restore_from(&after).unwrap();
        assert_eq!(course(&mut line, 200..300), second, "{spans} spans, beyond the border");
        let mut other = new();
        other.restore_from(&after).unwrap();
        assert_eq!(
            course(&mut other, 200..300),
            second,
            "{spans} spans, in another instance"
        );
        first.extend(second);
        assert!(first.iter().any(|force| *force > 0.0));
    }
}

/// Windows of a line of unequal spans are different sections with different energies at rest: the move of the window
/// must show neither in the energy of the line above its static state nor in the force.
#[test]
fn a_window_over_unequal_spans_moves_without_a_jump_of_energy() {
    let course = |reduce: &str| -> Vec<(f64, f64)> {
        let scene = scene_with(
            EN_300,
            &[
                "catenary.span_length=[60,60,60,60,60,60,66,60,60,60]",
                "run.start_x=290",
                "run.duration=0.4",
                "run.evaluate={time=[0.1,0.3]}",
                "catenary.mesh.elements_per_interval=2",
                &format!("model.reduce=[{reduce}]"),
            ],
        );
        let statics = catenary::static_line(&scene).unwrap();
        let strip = pressing(&scene, &statics);
        let mut line = Subsystem::new(&scene, &statics).unwrap();
        line.start(&[strip]).unwrap();
        (0..300)
            .map(|n| {
                let t = f64::from(n) * 1e-3;
                line.set_strip_input(0, 2, strip.height);
                line.set_strip_input(0, 0, strip.x + strip.speed * t);
                line.advance_to(t, 1e-3).unwrap();
                (line.energy(), line.contact(0).force)
            })
            .collect()
    };
    let reduce = "\"planar\", \"linearised\"";
    let (whole, window) = (course(reduce), course(&format!("{reduce}, \"window\"")));
    let off = |of: fn(&(f64, f64)) -> f64| {
        let pairs = whole.iter().zip(&window);
        pairs.fold(0.0, |most: f64, (a, b)| most.max((of(a) - of(b)).abs()))
    };
    let (energy, force) = (off(|step| step.0), off(|step| step.1));
    println!("{energy} J of {} J, {force} N", whole[0].0);
    // The window moves at 0.12 s.
    assert!(energy < 0.01 * whole[0].0 && force < 1.0, "{energy} J, {force} N");
}

#[test]
fn a_windowed_line_is_as_large_whatever_the_number_of_spans() {
    let size = |spans: usize| {
        let scene = scene_with(
            EN_300,
            &[
                &format!("catenary.spans={spans}"),
                &format!("run.start_x={}", 30 * spans),
                "run.duration=0.4",
                "run.evaluate={time=[0.1,0.3]}",
                "catenary.mesh.elements_per_interval=1",
                "model.reduce=[\"planar\", \"window\"]",
            ],
        );
        let statics = catenary::static_line(&scene).unwrap();
        assert_eq!((statics.spans(), statics.report().supports.len()), (spans, spans + 1));
        let line = Subsystem::new(&scene, &statics).unwrap();
        let said = catenary::WindowedLine::size(&scene, &statics);
        assert_eq!(said.coordinates, line.coordinates());
        // The equilibrium kept is that of as many spans, too.
        (line.coordinates(), statics.coordinates(), said.full)
    };
    let expected = size(80);
    assert_eq!(expected.2, 4);
    for spans in [400, 2000] {
        assert_eq!(size(spans), expected, "{spans} spans");
    }
}

/// The middle of a long line stands for its like, and its ends are those of any line.
#[test]
fn a_long_line_known_from_a_short_one_is_the_long_line() {
    for (stagger, spans) in [("[0.0]", 40), ("[0.2,-0.2]", 41), ("[0.2,0.0,-0.2]", 43)] {
        let overrides = [
            format!("catenary.spans={spans}"),
            format!("catenary.stagger={stagger}"),
            "catenary.mesh.elements_per_interval=1".to_owned(),
        ];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let scene = |reduce| scene_with(EN_300, &[&overrides[..], &[reduce]].concat());
        let [whole, short] = ["model.reduce=\"none\"", "model.reduce=[\"window\"]"]
            .map(|reduce| catenary::static_line(&scene(reduce)).unwrap());
        assert!(short.coordinates() < whole.coordinates());
        let (a, b) = (whole.report(), short.report());
        assert_eq!(
            (a.droppers.len(), a.supports.len()),
            (b.droppers.len(), b.supports.len())
        );
        for (a, b) in a.droppers.iter().zip(&b.droppers) {
            assert!(a.span == b.span && (a.x - b.x).abs() < 1e-9);
            assert!(
                (a.length - b.length).abs() < 1e-7 && (a.force - b.force).abs() < 1e-3,
                "{a:?} {b:?}"
            );
        }
        for (a, b) in a.supports.iter().zip(&b.supports) {
            assert!((a.x - b.x).abs() < 1e-9 && (a.contact_wire_z - b.contact_wire_z).abs() < 1e-7);
            assert!(
                (a.messenger_reaction - b.messenger_reaction).abs() < 1e-2,
                "{a:?} {b:?}"
            );
        }
        for x in [30.0, 1215.0, 60.0 * f64::from(spans) - 20.0] {
            let [a, b] = [&whole, &short].map(|line| line.wire_height_under(x, 100.0).unwrap().height);
            assert!((a - b).abs() < 1e-3, "{x} m: {a} m, {b} m");
        }
    }
}

/// A mechanism that its joints hold in one plane has one motion, whatever pushes its strip: the rest is the step's
/// error, which the same scheme makes of second order in 36 constrained coordinates and in two free ones.
#[test]
fn a_linkage_is_its_one_motion_where_the_joints_hold_the_strip() {
    for stagger in ["[0.0]", "[0.2,-0.2]"] {
        let run = |words: &str| {
            let overrides = [
                "catenary.spans=5".to_owned(),
                "run.duration=2.5".to_owned(),
                "run.evaluate={time=[0.3,2.4]}".to_owned(),
                format!("catenary.stagger={stagger}"),
                format!("model.reduce={words}"),
            ];
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            run(scene_with(THESIS, &overrides), Mode::Monolithic, "reductions")
        };
        let (full, reduced) = (run("none"), run("[\"linkage\"]"));
        let (all, few) = (&full.summary.model, &reduced.summary.model);
        assert_eq!(
            (all.coordinates - few.coordinates, all.constraints, few.constraints),
            (34, 32, 0)
        );
        let difference = reduced.raw_difference(&full);
        println!("{stagger}: {difference} N of sigma {} N", full.sigma());
        assert!(difference < 1e-3 * full.sigma(), "{difference} N");
    }
}

/// As above, with a drive: its force does work on the one motion alone.
#[test]
fn a_controlled_linkage_is_its_one_motion() {
    let run = |words: &str| {
        let reduce = format!("model.reduce={words}");
        let overrides = [
            "catenary.spans=5",
            "run.duration=2.5",
            "run.evaluate={time=[0.3,2.4]}",
            &reduce,
            "pantograph[1].control={ law=\"skyhook\", sample_time=0.005, damping=1000, \
             actuator={ lag=0.01, limit=80 }, sensors={ delay=0.001 } }",
        ];
        run(scene_with(THESIS, &overrides), Mode::Monolithic, "reductions")
    };
    let (full, reduced) = (run("none"), run("[\"linkage\"]"));
    let difference = reduced.raw_difference(&full);
    println!("{difference} N of sigma {} N", full.sigma());
    assert!(difference < 1e-3 * full.sigma(), "{difference} N");
    let largest = |run: &Run| {
        let forces = run.record.pantographs[0].control.as_ref().unwrap().iter();
        forces.fold(0.0_f64, |most, force| most.max(force.abs()))
    };
    assert!(largest(&full) > 10.0 && (largest(&full) - largest(&reduced)).abs() < 0.1);
}

#[test]
fn auto_reduces_a_linkage_and_says_why() {
    let scene = scene_with(THESIS, &[]);
    let words: Vec<&str> = scene
        .model
        .reductions
        .iter()
        .map(|reduction| reduction.name())
        .collect();
    assert_eq!(words, ["planar", "linkage"]);
    let staggered = scene_with(THESIS, &["catenary.stagger=[0.2,-0.2]"]);
    let words: Vec<&str> = staggered
        .model
        .reductions
        .iter()
        .map(|reduction| reduction.name())
        .collect();
    assert_eq!(words, ["linkage"]);
}
