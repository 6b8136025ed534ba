//! Accuracy of the algorithms on the test problem.

use super::*;

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).unwrap()
}

/// Runs the case at each macro step in ms, with the largest rms error in N and the most passes per step.
fn reaches(name: &str, bounds: &[(f64, f64, f64)]) {
    let case = case(name);
    for &(milliseconds, error, passes) in bounds {
        let found = run(&case, 1e-3 * milliseconds);
        println!(
            "{name}, {milliseconds} ms: rms {:.6} N, {:.3} passes, residual {:+.1e} J",
            found.rms_error, found.passes_per_step, found.energy_residual
        );
        assert!(found.stable, "{name}, {milliseconds} ms: {:?}", found.failure);
        assert!(
            found.rms_error <= error && found.passes_per_step <= passes,
            "{name}, {milliseconds} ms: {found:?}"
        );
    }
}

/// Mean, standard deviation and range as published with the problem.
#[test]
fn the_truth_has_the_published_statistics() {
    let truth = truth(&Parameters::CLOSED);
    let count = truth.forces().len() as f64;
    let mean = truth.forces().iter().sum::<f64>() / count;
    let variance = truth.forces().iter().map(|force| (force - mean).powi(2)).sum::<f64>() / count;
    let (smallest, largest) = truth.forces().iter().fold((f64::MAX, 0.0_f64), |(min, max), force| {
        (min.min(*force), max.max(*force))
    });
    assert!((mean - 109.7).abs() < 0.05, "mean {mean} N");
    assert!(
        (variance.sqrt() - 18.6).abs() < 0.05,
        "standard deviation {} N",
        variance.sqrt()
    );
    assert!(
        (smallest - 87.0).abs() < 0.5 && (largest - 142.0).abs() < 0.5,
        "{smallest} to {largest} N"
    );
    let losing = super::truth(&Parameters::LOSING);
    let lost = losing.forces().iter().filter(|force| **force <= 0.0).count() as f64 / count;
    assert!((lost - 0.16).abs() < 0.005, "contact lost {lost}");
}

#[test]
fn one_pass_without_rollback_stays_near_the_truth() {
    reaches(
        "auto, no rollback",
        &[(1.0, 0.00001, 1.0), (2.0, 0.00005, 1.0), (5.0, 0.004, 1.0)],
    );
}

#[test]
fn with_rollback_steps_are_repeated_only_where_it_pays() {
    reaches("auto", &[(1.0, 0.00001, 1.1), (2.0, 0.00005, 1.1), (5.0, 0.004, 1.1)]);
}

#[test]
fn a_pantograph_that_holds_its_inputs_reaches_the_neutral_exchange() {
    reaches(
        "auto, pantograph without input derivatives and rollback",
        &[(1.0, 0.0125, 1.0), (2.0, 0.05, 1.0)],
    );
}

#[test]
fn lost_contact_is_followed() {
    reaches(
        "auto, contact lost",
        &[(1.0, 0.003, 1.1), (2.0, 0.06, 1.1), (5.0, 0.5, 2.0)],
    );
    reaches(
        "auto, one pass, contact lost",
        &[(1.0, 0.005, 1.0), (2.0, 0.06, 1.0), (5.0, 2.5, 1.0)],
    );
}

/// ω h = 1.5: contact ten times as stiff, a head of 1 kg, 2 ms.
#[test]
fn a_stiff_contact_under_a_light_head_is_stable() {
    assert!(Parameters::STIFF.contact_frequency() * 2e-3 > 1.4);
    reaches("auto, head 1 kg, contact 500 kN/m", &[(2.0, 0.1, 2.0)]);
}

/// The prototypes measured with the problem: h321 is Gauss-Seidel, the pantograph first, with parabolic forces; "held"
/// the common exchange.
#[test]
fn the_common_exchanges_have_the_published_errors() {
    reaches(
        "gauss_seidel, pantograph first, extrapolation 2, interpolated",
        &[(1.0, 0.0005, 1.0), (2.0, 0.0035, 1.0), (5.0, 0.04, 1.0)],
    );
    let held = run(&case("gauss_seidel, held"), 1e-3);
    assert!((held.rms_error - 2.1).abs() < 0.1, "{held:?}");
    let jacobi = run(&case("jacobi, held"), 1e-3);
    assert!(
        !jacobi.stable && jacobi.smallest_force <= 0.0,
        "contact is lost: {jacobi:?}"
    );
}

#[test]
fn the_coupling_with_held_values_adds_energy_and_the_best_adds_none() {
    let held = run(&case("gauss_seidel, held"), 2e-3);
    assert!(held.energy_residual > 10.0);
    let note = held.energy_note.expect("said");
    assert!(
        note.contains("the coupling added 16.") && note.contains("% of the"),
        "{note}"
    );
    for name in [
        "auto",
        "auto, no rollback",
        "auto, pantograph without input derivatives and rollback",
    ] {
        let auto = run(&case(name), 2e-3);
        assert_eq!(auto.energy_note, None, "{name}");
    }
    assert!(run(&case("auto"), 1e-3).energy_residual.abs() < 1e-7);
}

/// Frequency seen in the run is that of the head on the contact: √(k/m) h, with and without sounding.
#[test]
fn auto_sees_the_contact_of_the_test_problem() {
    for (name, expected) in [
        ("auto", 0.417),
        ("auto, no rollback", 0.417),
        ("auto, contact lost", 0.417),
    ] {
        let report = run(&case(name), 5e-3).report.unwrap();
        let range = report.split("omega h ").nth(1).unwrap();
        let mut ends = range.split(" to ").map(|text| text.parse::<f64>().unwrap());
        let (low, high) = (ends.next().unwrap(), ends.next().unwrap());
        assert!(low > 0.95 * expected && high < 1.05 * expected, "{name}: {report}");
    }
}
