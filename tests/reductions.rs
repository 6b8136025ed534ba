//! What `model.reduce` leaves out changes the result by no more than it says.
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
