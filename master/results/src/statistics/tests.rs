//! Reference numbers were made with scipy 1.17.1:
//!
//! ```python
//! import numpy as np, scipy.signal as s
//! def signal(n, step):
//!     t = np.arange(n) * step
//!     return 110 + 25*np.sin(2*np.pi*3*t) + 40*np.cos(2*np.pi*70*t) + 300*t*t
//! FILTERED_1_MS = s.sosfiltfilt(s.butter(4, 20, fs=1000, output="sos"), signal(48, 1e-3))
//! FILTERED_5_MS = s.sosfiltfilt(s.butter(4, 20, fs=200, output="sos"), signal(16, 5e-3))
//! DENSITY_n = s.periodogram(signal(n, 2e-3), fs=500, window="hann", detrend="constant",
//!                           scaling="density")[1]
//! ```

use std::f64::consts::PI;

use super::*;

fn signal(n: usize, step: f64) -> Vec<f64> {
    (0..n)
        .map(|i| {
            let t = i as f64 * step;
            110.0 + 25.0 * (2.0 * PI * 3.0 * t).sin() + 40.0 * (2.0 * PI * 70.0 * t).cos() + 300.0 * t * t
        })
        .collect()
}

/// Compares relative to the size of the whole reference.
fn assert_close(found: &[f64], expected: &[f64], relative: f64) {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= relative * scale, "sample {i}: {f}, expected {e}");
    }
}

#[test]
fn the_filter_agrees_with_sosfiltfilt_of_scipy() {
    // Two implementations of one formula: only rounding differs, amplified by poles near 1.
    let filtered = LowPass::new(20.0, 1e-3).unwrap().filter(&signal(48, 1e-3)).unwrap();
    assert_close(&filtered, &FILTERED_1_MS, 1e-11);
    // The shortest record that the padding allows.
    let filtered = LowPass::new(20.0, 5e-3).unwrap().filter(&signal(16, 5e-3)).unwrap();
    assert_close(&filtered, &FILTERED_5_MS, 1e-11);
}

#[test]
fn a_straight_line_passes_the_filter_unchanged() {
    // Odd padding continues a line, and the filter has gain 1 and no delay.
    let line: Vec<f64> = (0..1200).map(|i| 50.0 + 0.3 * f64::from(i)).collect();
    let filtered = LowPass::new(20.0, 1e-3).unwrap().filter(&line).unwrap();
    // The first pass starts in the steady state of a constant; its transient ends inside.
    assert_close(&filtered[500..700], &line[500..700], 1e-6);
    let constant = vec![120.0; 40];
    assert_close(
        &LowPass::new(20.0, 1e-3).unwrap().filter(&constant).unwrap(),
        &constant,
        1e-12,
    );
}

#[test]
fn the_cut_off_frequency_loses_half_of_its_amplitude_without_a_phase_shift() {
    let step = 1e-3;
    let sine: Vec<f64> = (0..4000)
        .map(|i| (2.0 * PI * 20.0 * step * f64::from(i)).sin())
        .collect();
    let filtered = LowPass::new(20.0, step).unwrap().filter(&sine).unwrap();
    // |H|² at the cut-off is 1/2; the ends, where the transients are, are left out.
    for i in 1500..2500 {
        assert!((filtered[i] - 0.5 * sine[i]).abs() < 1e-6, "sample {i}");
    }
}

#[test]
fn an_impossible_cut_off_frequency_and_a_short_record_are_refused_with_their_numbers() {
    for cutoff in [0.0, -1.0, 500.0, f64::NAN] {
        let error = LowPass::new(cutoff, 1e-3).unwrap_err().to_string();
        assert!(error.contains("500 Hz"), "{error}");
    }
    let error = LowPass::new(20.0, 1e-3).unwrap().filter(&[0.0; 15]).unwrap_err();
    assert_eq!(
        error,
        FilterError::TooShort {
            samples: 15,
            needed: 16
        }
    );
}

#[test]
fn mean_deviation_and_extremes_are_those_of_the_population() {
    let s = ForceStatistics::of(&[80.0, 120.0, 100.0, 140.0]).unwrap();
    assert_eq!((s.mean, s.max, s.min), (110.0, 140.0, 80.0));
    let std = 500.0_f64.sqrt(); // (30² + 10² + 10² + 30²)/4 = 500
    assert!((s.std - std).abs() < 1e-12); // rounding
    assert!((s.statistical_max - (110.0 + 3.0 * std)).abs() < 1e-12);
    assert!((s.statistical_min - (110.0 - 3.0 * std)).abs() < 1e-12);
    assert_eq!(ForceStatistics::of(&[]), None);
    assert_eq!(ForceStatistics::of(&[1.0, f64::NAN]), None);
}

#[test]
fn loss_of_contact_counts_the_samples_without_force() {
    assert_eq!(loss_of_contact_percent(&[0.0, 1.0, 2.0, 0.0]), Some(50.0));
    assert_eq!(loss_of_contact_percent(&[1e-12, 1.0]), Some(0.0));
    assert_eq!(loss_of_contact_percent(&[]), None);
}

#[test]
fn peak_to_peak_is_the_distance_of_the_extremes() {
    assert_eq!(peak_to_peak(&[5.0, 4.75, 5.25]), Some(0.5));
    assert_eq!(peak_to_peak(&[5.0, f64::INFINITY]), None);
}

#[test]
fn both_ends_of_the_evaluation_range_belong_to_it() {
    let time: Vec<f64> = (0..=1000).map(|n| f64::from(n) * 1e-3).collect();
    assert_eq!(sample_range(&time, 0.007, 0.009), 7..10);
    assert_eq!(sample_range(&time, 0.1 + 0.2, 0.7), 300..701); // 0.1 + 0.2 is above 0.3
    assert_eq!(sample_range(&time, 0.9, 5.0), 900..1001);
    assert!(sample_range(&time, 2.0, 5.0).is_empty());
    assert!(sample_range(&time, 0.5, 0.2).is_empty());
    assert!(sample_range(&[], 0.0, 1.0).is_empty());
}

#[test]
fn the_spectrum_agrees_with_the_periodogram_of_scipy() {
    for (n, expected) in [(16, &DENSITY_16[..]), (15, &DENSITY_15[..])] {
        let spectrum = power_spectral_density(&signal(n, 2e-3), 2e-3).unwrap();
        assert_close(&spectrum.density, expected, 1e-12); // rounding
        assert_eq!(spectrum.frequency[0], 0.0);
        assert!((spectrum.frequency[1] - 500.0 / n as f64).abs() < 1e-12);
    }
    assert_eq!(power_spectral_density(&[1.0; 7], 1e-3), None);
}

#[test]
fn the_spectrum_of_a_sine_holds_its_power() {
    // 12 Hz, amplitude 5, whole number of periods: ∫ S df = 5²/2.
    let sine: Vec<f64> = (0..2000)
        .map(|i| 5.0 * (2.0 * PI * 0.012 * f64::from(i)).sin())
        .collect();
    let spectrum = power_spectral_density(&sine, 1e-3).unwrap();
    let power: f64 = spectrum.density.iter().sum::<f64>() * spectrum.frequency[1];
    assert!((power - 12.5).abs() < 1e-9); // rounding
    let peak = spectrum.density.iter().copied().fold(0.0, f64::max);
    let at = spectrum.density.iter().position(|d| *d == peak).unwrap();
    assert!((spectrum.frequency[at] - 12.0).abs() < 1e-9);
}

#[test]
fn a_histogram_counts_every_sample_once() {
    let h = histogram(&[-1.0, 0.0, 4.999, 5.0, 12.0], 5.0).unwrap();
    assert_eq!(h.start, -5.0);
    assert_eq!(h.percent, [20.0, 40.0, 20.0, 20.0]);
    assert_eq!(histogram(&[1.0], 0.0), None);
    assert_eq!(histogram(&[3.0, 3.0], 5.0).unwrap().percent, [100.0]);
}

const FILTERED_1_MS: [f64; 48] = [
    149.0372374622522,
    146.85314205481038,
    144.6147464149343,
    142.3456698172776,
    140.0694864999455,
    137.8092852501302,
    135.58725790028888,
    133.42432822620606,
    131.33983057872655,
    129.35124476354346,
    127.47399043725378,
    125.72128095430573,
    124.1040335665315,
    122.63083050478659,
    121.30792402339253,
    120.13927807651046,
    119.12663986347192,
    118.26963580751365,
    117.56588827749611,
    117.01115112477731,
    116.59946350324726,
    116.32332217282938,
    116.17387240094166,
    116.14111668779886,
    116.21413903063926,
    116.38134061888329,
    116.63068109552857,
    116.94991820362355,
    117.32683805698495,
    117.74946859296372,
    118.20626997665595,
    118.68629765825213,
    119.1793361309995,
    119.67600381204731,
    120.16783148309506,
    120.64731806199714,
    121.10796793948879,
    121.54431368170383,
    121.95192671404088,
    122.32741695260945,
    122.66842061119206,
    122.973573976137,
    123.24247014267405,
    123.4755957564031,
    123.67424575425434,
    123.84041583024786,
    123.97667459525833,
    124.08601979250658,
];
const FILTERED_5_MS: [f64; 16] = [
    149.98946000297948,
    135.89940891924084,
    124.31497339310023,
    116.92755714663656,
    114.16816822017353,
    115.30386077746694,
    118.90743827968059,
    123.42916992738304,
    127.64343974330944,
    130.86197600321162,
    132.92257872948932,
    134.03195669810862,
    134.56175419439427,
    134.87816187507013,
    135.2442968050928,
    135.79759537297468,
];
const DENSITY_16: [f64; 9] = [
    0.34496613449753905,
    0.7397475685077328,
    15.417731305550848,
    7.939701039847733,
    0.0567941049539876,
    0.002163860756464593,
    0.0002790724710540741,
    6.612463258779613e-05,
    1.7572249709797077e-05,
];
const DENSITY_15: [f64; 8] = [
    0.07549882140956486,
    2.271205415315865,
    15.601320775547636,
    5.32867000246671,
    0.0058403935297319815,
    0.00029521187801577524,
    4.9179761827184736e-05,
    1.926044160465548e-05,
];

#[test]
fn a_loss_of_contact_counts_as_an_arc_from_its_shortest_duration_on() {
    let lost = |force: &[f64], range: std::ops::Range<usize>| long_loss_of_contact_percent(force, range, 1e-3, 5e-3);
    // Losses of 4, 5 and 6 samples of 1 ms among 30.
    let mut force = vec![100.0; 30];
    for loss in [2..6, 10..15, 20..26] {
        force[loss].fill(0.0);
    }
    assert_eq!(lost(&force, 0..30), Some(100.0 * 11.0 / 30.0));
    // A loss across the end of the range keeps its duration and counts with what lies inside: 3 and 2 of 10 samples.
    assert_eq!(lost(&force, 12..22), Some(100.0 * 5.0 / 10.0));
    assert_eq!(lost(&force, 13..20), Some(100.0 * 2.0 / 7.0));
    // Every loss is long enough where the step is.
    assert_eq!(
        long_loss_of_contact_percent(&force, 0..30, 5e-3, 5e-3),
        Some(100.0 * 15.0 / 30.0)
    );
    assert_eq!(lost(&force, 7..7), None);
    force[29] = f64::NAN;
    assert_eq!(lost(&force, 0..10), None);
}
