//! Measured force against closed forms.

use std::f64::consts::{PI, TAU};

use crate::{Bending, Instrument, StripRecord, WindRecord};

const STEP: f64 = 1e-3;

fn rigid() -> Instrument {
    Instrument {
        strip_mass: 4.0,
        stride: 1,
        ..Instrument::default()
    }
}

fn bends() -> Instrument {
    Instrument {
        bending: Some(Bending {
            frequency_hz: 60.0,
            mass_kg: 4.0,
            damping_ratio: 0.02,
        }),
        ..rigid()
    }
}

/// A head under `100 + 30 sin(2π f t)` N that moves with `0.02 sin(2π f t + 1)` m for 20 s.
fn head(frequency: f64, amplitude: f64) -> StripRecord {
    let phase = |index: usize| TAU * frequency * index as f64 * STEP;
    let series = |of: &dyn Fn(f64) -> f64| (0..20_000).map(|index| of(phase(index))).collect();
    StripRecord {
        force: series(&|phase| 100.0 + 30.0 * phase.sin()),
        strip_vz: series(&|phase| amplitude * TAU * frequency * (phase + 1.0).cos()),
        ..StripRecord::default()
    }
}

/// Amplitude and phase (rad) of a signal at a frequency, over the last 10 s.
fn tone(signal: &[f64], frequency: f64) -> (f64, f64) {
    let part = &signal[10_000..20_000];
    let of = |wave: fn(f64) -> f64| {
        let term = |(index, value): (usize, &f64)| value * wave(TAU * frequency * index as f64 * STEP);
        2.0 * part.iter().enumerate().map(term).sum::<f64>() / part.len() as f64
    };
    let (sine, cosine) = (of(f64::sin), of(f64::cos));
    (sine.hypot(cosine), cosine.atan2(sine))
}

#[test]
fn a_rigid_head_measures_the_contact_force_itself() {
    let head = head(7.0, 0.02);
    let measured = rigid().measured(&head, STEP);
    for (measured, force) in measured.iter().zip(&head.force) {
        // The inertia force of up to 155 N is added and taken away.
        assert!((measured - force).abs() < 1e-12 * 300.0, "{measured} {force}");
    }
    let sampled = Instrument { stride: 5, ..rigid() }.measured(&head, STEP);
    assert_eq!(sampled.len(), 4000);
    assert!((sampled[7] - head.force[35]).abs() < 1e-9);
}

#[test]
fn a_strip_that_bends_shows_the_gain_of_an_oscillator() {
    for frequency in [2.0, 10.0, 20.0, 45.0] {
        let measured = bends().measured(&head(frequency, 0.0), STEP);
        let (amplitude, phase) = tone(&measured, frequency);
        // 1 + (4/π) r²/(1 − r² + 2iζr), as sum of real and imaginary parts.
        let (ratio, damping): (f64, f64) = (frequency / 60.0, 0.02);
        let (re, im) = (1.0 - ratio * ratio, 2.0 * damping * ratio);
        let excess = 4.0 / PI * ratio * ratio / (re * re + im * im);
        let (real, imaginary) = (1.0 + excess * re, -excess * im);
        let (gain, lag) = (real.hypot(imaginary), imaginary.atan2(real));
        // The mode sees the force as straight lines between samples: (ω h)²/12 of a sine is missing.
        let straight = (TAU * frequency * STEP).powi(2) / 12.0 + 1e-6;
        assert!(
            (amplitude / 30.0 / gain - 1.0).abs() < 2.0 * straight,
            "{frequency} Hz: {amplitude}"
        );
        assert!(
            (phase - lag).abs() < 2.0 * straight + 1e-6,
            "{frequency} Hz: {phase} {lag}"
        );
        assert!((bends().bending.unwrap().gain_at(frequency) / gain - 1.0).abs() < 1e-12);
    }
    // Whole beam, ½ (1/cos b + 1/cosh b): modes above the first add little below a third of f₀.
    for frequency in [2.0, 10.0, 20.0_f64] {
        let b = 0.5 * PI * (frequency / 60.0).sqrt();
        let beam = 0.5 * (1.0 / b.cos() + 1.0 / b.cosh());
        let mode = Bending {
            damping_ratio: 0.0,
            ..bends().bending.unwrap()
        }
        .gain_at(frequency);
        assert!((mode / beam - 1.0).abs() < 1e-3, "{frequency} Hz: {mode} {beam}");
    }
}

#[test]
fn motion_of_a_bending_strip_is_seen_as_force_and_that_of_a_rigid_one_is_not() {
    // Without force: ü = (4/π) r²/(1 − r²) a off resonance, with r = 10/60, and 2/π m_b ü on the cells.
    let mut head = head(10.0, 0.002);
    head.force.iter_mut().for_each(|force| *force = 0.0);
    let (seen, phase) = tone(&bends().measured(&head, STEP), 10.0);
    let acceleration = 0.002 * (TAU * 10.0_f64).powi(2);
    let ratio: f64 = 10.0 / 60.0;
    let expected = 2.0 / PI * 4.0 * 4.0 / PI * acceleration * ratio.powi(2) / (1.0 - ratio.powi(2));
    // Damping of 2 % and the central difference of the acceleration, (ω h)²/6.
    assert!((seen / expected - 1.0).abs() < 2e-3, "{seen} {expected}");
    // −sin(2π f t + 1) is the acceleration: in phase with it.
    assert!((phase - (1.0 - PI)).abs() < 0.02, "{phase}");
    let (seen, _) = tone(&rigid().measured(&head, STEP), 10.0);
    assert!(seen < 1e-12);
}

#[test]
fn errors_of_mass_and_cells_and_a_lift_without_correction_show_as_they_must() {
    let head = head(5.0, 0.01);
    let heavy = Instrument {
        mass_error: 0.1,
        ..rigid()
    };
    let difference: Vec<f64> = (heavy.measured(&head, STEP).iter().zip(&head.force))
        .map(|(measured, force)| measured - force)
        .collect();
    // 0.1 · 4 kg · 0.01 m · (2π 5 Hz)²
    let expected = 0.1 * 4.0 * 0.01 * (TAU * 5.0_f64).powi(2);
    let (seen, phase) = tone(&difference, 5.0);
    assert!((seen / expected - 1.0).abs() < 2e-4, "{seen} {expected}"); // central difference: (ω h)²/6
    // −m a with a = −(2π f)² z: in phase with the height.
    assert!((phase - 1.0).abs() < 1e-5, "{phase}"); // ends of the record
    let gain = Instrument {
        cell_error: 0.02,
        ..rigid()
    };
    let still = self::head(5.0, 0.0);
    let (seen, _) = tone(&gain.measured(&still, STEP), 5.0);
    assert!((seen - 30.6).abs() < 1e-9);

    let mut lifted = still;
    let lift: Vec<f64> = (0..20_000).map(|index| 8.0 + (index % 2) as f64).collect();
    lifted.wind = Some(WindRecord {
        drag: lift.clone(),
        lift,
    });
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let without = rigid().measured(&lifted, STEP);
    let with = Instrument {
        aerodynamic_correction: true,
        ..rigid()
    }
    .measured(&lifted, STEP);
    assert!((mean(&without) - 91.5).abs() < 1e-9 && (mean(&with) - 100.0).abs() < 1e-9);
}
