//! What `model.reduce` leaves out changes the result by no more than it says.
use catenary::{Checkpoint, StripStart, Subsystem};
use integration_tests::fmus::THESIS;
use integration_tests::runs::{EN_300, Run, run, scene_with};
use master::simulation::Mode;

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

#[test]
fn a_staggered_line_is_never_planar() {
    let run = reduced("auto", &["catenary.stagger=[0.2,-0.2]"]);
    assert!(run.summary.model.reductions.is_empty());
}

/// Both planar, so that only the law of motion differs. Fixed ends make the tension follow the lift.
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
        // Each starts in its own equilibrium: the first steps differ from those of the line by less than a newton of more than 100.
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

#[test]
fn a_linearised_line_taken_back_repeats_bit_for_bit() {
    let scene = scene_with(
        EN_300,
        &[&SHORT[..], &["model.reduce=[\"planar\", \"linearised\"]"]].concat(),
    );
    let statics = catenary::static_line(&scene).unwrap();
    let (x, speed) = (scene.strip_start_x(0), scene.run.speed);
    let height = statics.wire_height_under(x, 110.0).unwrap().height;
    let mut line = Subsystem::new(&scene, &statics).unwrap();
    line.start(&[StripStart {
        x,
        y: 0.0,
        height,
        speed,
    }])
    .unwrap();
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

/// A mechanism that its joints hold in one plane has one motion, whatever pushes its strip: the rest is the step's error, which the
/// same scheme makes of second order in 36 constrained coordinates and in two free ones.
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
