//! Errors of runs that `run.accuracy_percent` chooses, against the whole nonlinear line on a fine mesh in short steps.
//!
//! `docs/validation/accuracy.csv` has sixteen lines, and 0.3 % too.
use integration_tests::runs::{EN_300, THREE_SPANS, run, scene_with};
use simulation::Mode;

const FIXED_ENDS: &str = include_str!("../scenes/thesis-lumped.toml");
const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
const TRAM: &str = include_str!("../scenes/tram-single-wire.toml");

/// Error of a run beside its wish that is allowed, –: rules are good to a factor of two, and several share a wish.
const ALLOWED: f64 = 1.5;

/// The line as it is, on elements and steps that err by a tenth of a percent.
const CONVERGED: [&str; 5] = [
    "catenary.mesh={ element_length=0.35, corrections=\"auto\" }",
    "solver.micro_step=2.5e-4",
    "coupling.macro_step=2.5e-4",
    "solver.newton_tolerance=3e-3",
    "model.reduce=auto",
];

#[test]
fn runs_err_by_no_more_than_they_were_asked_to() {
    for text in [EN_300, FIXED_ENDS, STITCHED] {
        let of = |more: &[&str]| {
            run(
                scene_with(text, &[&THREE_SPANS, more].concat()),
                Mode::Monolithic,
                "accuracy",
            )
        };
        let reference = of(&CONVERGED);
        for percent in [3.0, 1.0] {
            let asked = of(&[&format!("run.accuracy_percent={percent}")]);
            let error = 100.0 * asked.filtered_difference(&reference) / reference.sigma();
            let accuracy = &asked.summary.accuracy;
            println!("{}: {error:.2} % of {percent} %, {accuracy:?}", asked.summary.title);
            assert!(accuracy.expected_percent.unwrap() <= percent, "{accuracy:?}");
            assert!(error <= ALLOWED * percent, "{error} % of {percent} %");
        }
    }
}

/// A slow train, whose force varies little and for which steps that ended after one correction erred by seven times as
/// much, and a fast one.
#[test]
fn what_newtons_method_leaves_moves_the_force_by_no_more_than_stated() {
    let slow = ["run.speed_kmh=65", "run.duration=12.3"];
    for (text, more) in [(TRAM, &slow[..]), (EN_300, &THREE_SPANS)] {
        let of = |tolerance: f64| {
            let key = format!("solver.newton_tolerance={tolerance}");
            let keys = [more, &["catenary.mesh.error_percent=1", &key]].concat();
            run(scene_with(text, &keys), Mode::Monolithic, "tolerance")
        };
        let (exact, loose) = (of(1e-3), of(0.2));
        let percent = 100.0 * loose.filtered_difference(&exact) / exact.sigma();
        let shares = &loose.summary.accuracy.shares;
        let stated = shares
            .iter()
            .find(|share| share.cause == "newton_tolerance")
            .unwrap()
            .percent;
        println!("{}: {percent:.3} % of {stated} %", exact.summary.title);
        assert!(percent <= stated && stated <= 0.1, "{percent} % of {stated} %");
        assert!(loose.summary.cost.newton_iterations < exact.summary.cost.newton_iterations);
    }
}
