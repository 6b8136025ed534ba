//! Figures by band, stretch and loss against closed forms.

use std::f64::consts::PI;

use super::*;

const STEP: f64 = 1e-3;

fn sine(hz: f64, amplitude: f64, seconds: f64) -> Vec<f64> {
    let count = (seconds / STEP) as usize;
    (0..count)
        .map(|n| amplitude * (2.0 * PI * hz * n as f64 * STEP).sin())
        .collect()
}

/// Gain of the filter without delay of cut-off `cutoff` at `hz`, both warped by the bilinear transform.
fn gain(hz: f64, cutoff: f64) -> f64 {
    let warped = |f: f64| (PI * f * STEP).tan();
    1.0 / (1.0 + (warped(hz) / warped(cutoff)).powi(8))
}

#[test]
fn a_sine_has_in_each_band_what_the_filters_leave_of_it() {
    // Whole periods in the middle, where no end of the record is felt.
    let range = 4000..8000;
    for hz in [1.0, 4.0, 5.0, 7.0, 19.0, 30.0] {
        let found = bands(
            &sine(hz, 30.0, 12.0),
            &[[0.0, 5.0], [5.0, 20.0], [0.0, 20.0]],
            &range,
            STEP,
        );
        let (low, all) = (gain(hz, 5.0), gain(hz, 20.0));
        for (band, left) in found.iter().zip([low, (1.0 - low) * all, all]) {
            let expected = 30.0 * left / 2.0_f64.sqrt();
            // Rounding, amplified by the poles of 5 Hz near one.
            assert!(
                (band.std.unwrap() - expected).abs() < 1e-6,
                "{hz} Hz: {band:?}, {expected}"
            );
        }
    }
}

#[test]
fn the_variances_of_neighbouring_bands_add_up_to_that_of_both_to_their_overlap() {
    let range = 4000..8000;
    let signal: Vec<f64> = sine(2.0, 20.0, 12.0)
        .iter()
        .zip(sine(10.0, 30.0, 12.0))
        .map(|(a, b)| a + b)
        .collect();
    let std = |band: [f64; 2]| bands(&signal, &[band], &range, STEP)[0].std.unwrap();
    let parts = std([0.0, 5.0]).powi(2) + std([5.0, 20.0]).powi(2);
    // A² (H₂₀² − H₅² − (1 − H₅)² H₂₀²)/2 of each sine.
    let left = |hz: f64| {
        let (low, all) = (gain(hz, 5.0), gain(hz, 20.0));
        all.powi(2) - low.powi(2) - ((1.0 - low) * all).powi(2)
    };
    let overlap = 0.5 * (20.0_f64.powi(2) * left(2.0) + 30.0_f64.powi(2) * left(10.0));
    let all = std([0.0, 20.0]).powi(2);
    // Rounding, amplified by the poles of 5 Hz near one.
    assert!((all - parts - overlap).abs() < 1e-5, "{all} {parts} {overlap}");
    assert!(overlap < 0.02 * all);
}

#[test]
fn bands_that_the_samples_do_not_resolve_have_no_figure() {
    let found = bands(&sine(1.0, 1.0, 4.0), &[[0.0, 500.0], [0.0, 5.0]], &(0..10), STEP);
    assert_eq!(found[0].std, None);
    assert!(found[1].std.is_some());
    assert_eq!(bands(&[1.0, f64::NAN], &[[0.0, 5.0]], &(0..1), STEP)[0].std, None);
}

#[test]
fn losses_of_contact_are_listed_one_by_one_with_place_and_span() {
    // Without force: 3 samples from 2 ms on, 12 from 20 ms on, the last 1 from 99 ms on.
    let without = |n: usize| (2..5).contains(&n) || (20..32).contains(&n) || n == 99;
    let time: Vec<f64> = (0..100).map(|n| n as f64 * STEP).collect();
    let force: Vec<f64> = (0..100).map(|n| if without(n) { 0.0 } else { 100.0 }).collect();
    let x: Vec<f64> = time.iter().map(|t| 59.0 + 80.0 * t).collect();
    let span = |x: f64| Some(if x < 60.0 { 1 } else { 2 });
    let found = losses([&time, &force, &x], &(0..100), STEP, span);
    let expected = [(2, 3, 1), (20, 12, 2), (99, 1, 2)].map(|(first, samples, span)| Loss {
        start: time[first],
        duration: samples as f64 * STEP,
        x: x[first],
        span: Some(span),
    });
    assert_eq!(found, expected);
    // A loss that reaches into the range keeps its duration and counts with its part inside.
    let inside = losses([&time, &force, &x], &(30..50), STEP, span);
    assert_eq!(inside, expected[1..2]);
    let classes = loss_classes(&force, &(30..50), STEP);
    let of = |from: f64| classes.iter().find(|class| class.from_s == from).unwrap();
    assert_eq!((of(0.01).count, of(0.0).count), (1, 0));
    assert!((of(0.01).percent - 10.0).abs() < 1e-12);
    let all = loss_classes(&force, &(0..100), STEP);
    let counts: Vec<usize> = all.iter().map(|class| class.count).collect();
    assert_eq!(counts, [2, 0, 1, 0, 0]);
    // The classes from 5 ms on are the arcing of the TSI.
    let arcing: f64 = all[1..].iter().map(|class| class.percent).sum();
    let known = long_loss_of_contact_percent(&force, 0..100, STEP, 5e-3).unwrap();
    assert!((arcing - known).abs() < 1e-12);
}

#[test]
fn quantiles_lie_between_the_samples_in_order() {
    let found = quantiles(&[40.0, 10.0, 30.0, 20.0, 50.0], &[0.0, 25.0, 50.0, 90.0, 100.0]);
    let values: Vec<f64> = found.iter().map(|quantile| quantile.value).collect();
    assert_eq!(values, [10.0, 20.0, 30.0, 46.0, 50.0]);
    assert!(quantiles(&[], &[50.0]).is_empty() && quantiles(&[f64::NAN], &[50.0]).is_empty());
}

#[test]
fn each_span_has_the_figures_of_its_own_samples() {
    let x: Vec<f64> = (0..=20).map(f64::from).collect();
    let force: Vec<f64> = x.iter().map(|x| if *x < 10.0 { 100.0 } else { 200.0 + x }).collect();
    let raw: Vec<f64> = x.iter().map(|x| if *x == 3.0 { 0.0 } else { 1.0 }).collect();
    let ends = [(-10.0, 0.0), (0.0, 10.0), (10.0, 20.0), (20.0, 30.0)];
    let found = stretches(&ends[..3], &x, [&force, &raw], &(1..21));
    let numbers: Vec<usize> = found.iter().map(|stretch| stretch.number).collect();
    assert_eq!(numbers, [2, 3]);
    assert_eq!((found[0].from_m, found[0].to_m), (1.0, 9.0));
    assert_eq!(found[0].filtered.unwrap().std, 0.0);
    assert!((found[0].loss_of_contact_percent.unwrap() - 100.0 / 9.0).abs() < 1e-12);
    // The end of the last stretch belongs to it.
    assert_eq!((found[1].to_m, found[1].filtered.unwrap().max), (20.0, 220.0));
}

#[test]
fn the_causal_filter_agrees_with_sosfilt_of_scipy_and_delays() {
    // sos = s.butter(6, 20, fs=200, output="sos"); s.sosfilt(sos, x, zi=s.sosfilt_zi(sos)*x[0]), of the signal of
    // tests.rs
    const EXPECTED: [f64; 16] = [
        149.99999999999983,
        149.97917571312163,
        149.78428979459832,
        148.93773242422785,
        146.64397035228558,
        142.230522620891,
        135.72486915015855,
        128.06466865356973,
        120.81965537462632,
        115.59909044993843,
        113.43931517322278,
        114.48414878074469,
        118.0322056020679,
        122.85582917524758,
        127.66401101061881,
        131.49349305702688,
    ];
    let signal: Vec<f64> = (0..16)
        .map(|n| {
            let t = f64::from(n) * 5e-3;
            110.0 + 25.0 * (2.0 * PI * 3.0 * t).sin() + 40.0 * (2.0 * PI * 70.0 * t).cos() + 300.0 * t * t
        })
        .collect();
    let found = Filter::Causal.design(20.0, 5e-3).unwrap().filter(&signal).unwrap();
    for (found, expected) in found.iter().zip(EXPECTED) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // At the cut-off frequency one pass leaves 1/√2.
    let sine = Filter::Causal
        .design(20.0, STEP)
        .unwrap()
        .filter(&sine(20.0, 1.0, 6.0))
        .unwrap();
    let rms = (sine[3000..5000].iter().map(|v| v * v).sum::<f64>() / 2000.0).sqrt();
    assert!((rms - 0.5).abs() < 1e-6, "{rms}");
}

#[test]
fn the_steepest_place_of_a_wire_is_found() {
    let x = [0.0, 1.0, 1.0, 2.0, 4.0];
    let found = largest_slope(&[5.0, 5.002, 9.0, 9.001, 8.995], &x).unwrap();
    assert!((found - 0.003).abs() < 1e-12); // rounding
    assert_eq!(largest_slope(&[5.0], &[0.0]), None);
}
