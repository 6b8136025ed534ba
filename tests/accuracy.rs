//! Errors of runs that `run.accuracy_percent` chooses, against the whole nonlinear line on a fine mesh in short steps.
//!
//! `docs/validation/accuracy.csv` has more lines, finer wishes, and references that were refined once more.
use integration_tests::runs::{EN_300, run, scene_with};
use simulation::Mode;

const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
const FIXED_ENDS: &str = include_str!("../scenes/thesis-lumped.toml");

/// Error of a run beside its wish that is allowed, –: what is expected of rules that are good to a factor of two, where
/// several of them share the wish.
const ALLOWED: f64 = 1.5;

/// The line as it is, on elements and steps that err by a twentieth of a percent.
const CONVERGED: [&str; 5] = [
    "catenary.mesh={ element_length=0.3, corrections=\"auto\" }",
    "solver.micro_step=2.5e-4",
    "coupling.macro_step=2.5e-4",
    "solver.newton_tolerance=1e-3",
    "model.reduce=auto",
];

/// Some spans of a line, and a journey over them.
const SHORT: [&str; 4] = [
    "catenary.spans=5",
    "run.start_x=40",
    "run.duration=2.5",
    "run.evaluate={time=[0.3,2.3]}",
];

#[test]
fn runs_err_by_no_more_than_they_were_asked_to() {
    for text in [EN_300, FIXED_ENDS, STITCHED] {
        let of = |more: &[&str]| run(scene_with(text, &[&SHORT, more].concat()), Mode::Monolithic, "accuracy");
        let reference = of(&CONVERGED);
        for percent in [3.0, 1.0] {
            let asked = of(&[&format!("run.accuracy_percent={percent}")]);
            let error = 100.0 * asked.filtered_difference(&reference) / reference.sigma();
            let accuracy = &asked.summary.accuracy;
            println!("{}: {error:.2} % of {percent} %, {:?}", asked.summary.scene, accuracy.shares);
            assert!(error <= ALLOWED * percent, "{error} % of {percent} %");
        }
    }
}
