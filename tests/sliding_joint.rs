//! Strips joined to the line of the thesis without numerical damping: 10 s at 1 ms on the thesis' mesh and on finer
//! ones.
use integration_tests::runs::{Run, run, scene_with};
use simulation::Mode;

const JOINT: &str = include_str!("../scenes/thesis-sliding-joint.toml");
const PENALTY: &str = include_str!("../scenes/thesis-own-mesh.toml");

fn monolithic(text: &str, overrides: &[&str]) -> Run {
    run(scene_with(text, overrides), Mode::Monolithic, "sliding_joint")
}

/// Oscillation of a force from sample to sample in each fifth of the run: the median of its amounts, N. The median
/// leaves out single jolts of droppers that go taut.
fn to_and_fro(force: &[f64]) -> Vec<f64> {
    let fifths = force.chunks_exact(force.len() / 5);
    fifths
        .map(|part| {
            let amount = |w: &[f64]| 0.25 * (w[0] - 2.0 * w[1] + w[2]).abs();
            let mut amounts: Vec<f64> = part.windows(3).map(amount).collect();
            amounts.sort_by(f64::total_cmp);
            amounts[amounts.len() / 2]
        })
        .collect()
}

/// A run with `rho_inf` = 1 whose multiplier stays bounded; returns the standard deviation of its 20 Hz force, N.
fn endures(mesh: &[&str]) -> f64 {
    let keys: Vec<&str> = ["solver.rho_inf=1"].iter().chain(mesh).copied().collect();
    let run = monolithic(JOINT, &keys);
    let strip = &run.record.pantographs[0];
    let force = &strip.force;
    let noise = to_and_fro(force);
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    let (largest, drift) = (largest(force), largest(&strip.gap));
    println!(
        "{mesh:?}: σ {:.2} N, up to {largest:.0} N, to and fro {noise:.3?} N; {drift:.1e} m off the wire",
        run.sigma()
    );
    assert_eq!(force.len(), 10_001);
    // An oscillation that grows does so by orders of magnitude within 10 s; droppers that go taut bring some 400 N.
    assert!(largest < 1000.0, "{largest} N");
    let [first, .., last] = noise[..] else {
        unreachable!("five fifths")
    };
    assert!(last < 1.5 * first.max(0.1) && last < 10.0, "{noise:?}");
    // A tenth of a millimetre beside uplifts of 80 mm.
    assert!(drift < 1e-4, "{drift} m");
    run.sigma()
}

#[test]
fn on_the_mesh_of_the_thesis_it_lasts_10_s_and_is_the_limit_of_the_stiff_penalty() {
    let joint = endures(&[]);
    let stiff = monolithic(PENALTY, &["solver.rho_inf=1", "contact.stiffness=5e6"]).sigma();
    // Penalties of usual stiffness are farther away, and approach the joint with the stiffness.
    assert!((joint / stiff - 1.0).abs() < 0.01, "{joint} N, {stiff} N");
}

#[test]
fn with_72_elements_per_span_it_lasts_10_s() {
    endures(&["catenary.mesh.elements_per_interval=8"]);
}

#[test]
fn on_the_corrected_mesh_it_lasts_10_s() {
    endures(&[
        "catenary.mesh.elements_per_interval=8",
        "catenary.mesh.corrections=\"auto\"",
    ]);
}

/// Seven seconds fewer than above. The window cuts the line anew under way.
#[test]
fn it_goes_with_a_line_that_is_linear_in_part_or_all_through() {
    let of = |reductions: &str| {
        let reduce = format!("model.reduce=[\"planar\"{reductions}]");
        let time = ["run.duration=3.0", "run.evaluate={time=[1.0,3.0]}"];
        monolithic(
            JOINT,
            &[time[0], time[1], &reduce, "catenary.mesh.elements_per_interval=4"],
        )
    };
    let whole = of("");
    // Differences of the window and the linear line under the penalty law, 4 elements between droppers.
    for (reductions, most) in [(", \"window\"", 0.05), (", \"linearised\"", 0.1)] {
        let run = of(reductions);
        assert!(run.summary.complete);
        let difference = whole.filtered_difference(&run) / whole.sigma();
        println!("{reductions}: {difference}");
        assert!(difference > 0.0 && difference < most, "{reductions}: {difference}");
    }
}
