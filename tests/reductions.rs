//! What `model.reduce` leaves out changes the result by no more than it says.
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
