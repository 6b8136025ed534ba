//! Contact forces against position, and their differences.

use crate::curve::{Errors, ForceCurve, pointwise_rms};

/// Samples of `force` at positions `step` m apart from `start` to `end` m.
fn sampled(start: f64, end: f64, step: f64, force: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let count = ((end - start) / step).round() as usize;
    let x: Vec<f64> = (0..=count).map(|n| start + n as f64 * step).collect();
    let force = x.iter().map(|x| force(*x)).collect();
    (x, force)
}

#[test]
fn the_pointwise_error_of_two_sines_is_the_known_one() {
    // rms of sin(x) − sin(x − φ) over whole periods is √2 sin(φ/2).
    let period = std::f64::consts::TAU;
    let shift = 0.3;
    let (x, expected) = sampled(0.0, 3.0 * period - period / 500.0, period / 500.0, |x| x.sin());
    let found: Vec<f64> = x.iter().map(|x| (x - shift).sin()).collect();
    let rms = pointwise_rms((&x, &expected), (&x, &found)).unwrap();
    assert!((rms - 2.0_f64.sqrt() * (0.5 * shift).sin()).abs() < 1e-12, "{rms}");
}

#[test]
fn equal_forces_at_other_samples_are_equal() {
    // Linear interpolation of a parabola is off by width²/8 · curvature at most; of a straight line not at all.
    let (x, expected) = sampled(10.0, 20.0, 0.07, |x| 3.0 * x - 7.0);
    let (x_other, found) = sampled(9.9, 20.1, 0.05, |x| 3.0 * x - 7.0);
    assert!(pointwise_rms((&x, &expected), (&x_other, &found)).unwrap() < 1e-12);
    let (x, expected) = sampled(10.0, 20.0, 0.07, |x| x * x);
    let (x_other, found) = sampled(9.9, 20.1, 0.05, |x| x * x);
    let rms = pointwise_rms((&x, &expected), (&x_other, &found)).unwrap();
    assert!(rms > 1e-5 && rms < 0.05 * 0.05 / 8.0 * 2.0, "{rms}");
}

#[test]
fn a_run_that_ends_early_cannot_be_compared() {
    let (x, expected) = sampled(0.0, 10.0, 0.1, |x| x);
    assert_eq!(pointwise_rms((&x, &expected), (&x[..50], &expected[..50])), None);
    assert_eq!(pointwise_rms((&x, &expected), (&[], &[])), None);
}

/// A curve of 1000 samples, 0.1 m apart; the outer fifths are not evaluated.
fn curve(filtered: impl Fn(f64) -> f64, raw: impl Fn(f64) -> f64) -> ForceCurve {
    let (x, filtered) = sampled(0.0, 99.9, 0.1, filtered);
    ForceCurve {
        raw: x.iter().map(|x| raw(*x)).collect(),
        x,
        filtered,
        range: 200..800,
    }
}

#[test]
fn errors_are_in_percent_of_sigma_and_the_worst_pantograph_counts() {
    // Six whole periods of 10 m are evaluated: σ = 20/√2.
    let wave = |x: f64| 100.0 + 20.0 * (x * std::f64::consts::TAU / 10.0).sin();
    let reference = [curve(wave, wave), curve(wave, wave)];
    let run = [
        curve(|x| wave(x) + 1.0, |x| wave(x) + 2.0),
        curve(|x| 1.1 * wave(x) - 10.0, wave),
    ];
    let sigma = 20.0 / 2.0_f64.sqrt();
    let errors = Errors::between(&reference, &run);
    // The second differs by a tenth of its wave, 10 % of σ, the first by 1 N, 7 %.
    assert!((errors.filtered.unwrap() - 10.0).abs() < 1e-9);
    assert!((errors.raw.unwrap() - 100.0 * 2.0 / sigma).abs() < 1e-9);
    assert!((errors.std.unwrap() - 10.0).abs() < 1e-9);
    assert_eq!(Errors::between(&reference, &run[..1]), Errors::default());
    // What happens outside the evaluation range has no part in it.
    let outside = |x: f64| if (20.0..80.0).contains(&x) { wave(x) } else { 1e9 };
    let errors = Errors::between(&reference[..1], &[curve(outside, outside)]);
    assert_eq!((errors.filtered, errors.raw), (Some(0.0), Some(0.0)));
}

#[test]
fn a_force_that_does_not_vary_has_no_errors_in_percent() {
    let wave = |x: f64| 100.0 + 20.0 * x.sin();
    let (none, some) = (curve(|_| 0.0, |_| 0.0), curve(wave, wave));
    assert!(none.is_still() && !some.is_still());
    let between = |reference: &ForceCurve, run: &ForceCurve| {
        Errors::between(std::slice::from_ref(reference), std::slice::from_ref(run))
    };
    assert_eq!(between(&none, &none), Errors::default());
    assert_eq!(between(&none, &some), Errors::default());
    // What is no number is no error of nothing, whichever strip it is on.
    let lost = curve(wave, |_| f64::NAN);
    for run in [[lost.clone(), some.clone()], [some.clone(), lost]] {
        let errors = Errors::between(&[some.clone(), some.clone()], &run);
        assert_eq!((errors.filtered, errors.raw), (Some(0.0), None));
    }
}
