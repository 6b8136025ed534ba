//! The field against its own statistics.
use super::*;
use nalgebra::Matrix3;
use std::f64::consts::TAU;

fn options(seed: u64) -> TurbulenceOptions {
    TurbulenceOptions {
        spectrum: TurbulenceSpectrum::VonKarman,
        speed: 20.0,
        axes: Matrix3::identity(),
        deviations: [3.0, 2.4, 1.5],
        length_scales: [120.0, 60.0, 20.0],
        coherence_decays: [10.0, 7.0, 7.0],
        seed,
        time_step: 0.1,
        steps: 512,
        start: 0.0,
        spacing: 5.0,
        stations: 6,
    }
}

/// One Fourier coefficient `(2/N) Σ u(t_n) exp(−2π i f t_n)` of a component at a station over one period of the table.
fn coefficient(turbulence: &Turbulence, options: &TurbulenceOptions, component: usize, x: f64, l: usize) -> [f64; 2] {
    let n = options.steps;
    let mut sum = [0.0; 2];
    for step in 0..n {
        let (s, c) = (TAU * (l * step % n) as f64 / n as f64).sin_cos();
        let u = turbulence.velocity(step as f64 * options.time_step, x)[component];
        sum[0] += c * u;
        sum[1] -= s * u;
    }
    sum.map(|sum| 2.0 * sum / n as f64)
}

#[test]
fn the_spectra_integrate_to_the_variance() {
    for spectrum in [TurbulenceSpectrum::VonKarman, TurbulenceSpectrum::Kaimal] {
        for component in 0..3 {
            // f = exp(y): the trapezoid in y over 16 decades; what is cut off is (1e-8)^(2/3) of it.
            let step = 1e-3;
            let range = (1e-8_f64.ln(), 1e8_f64.ln());
            let count = ((range.1 - range.0) / step) as usize;
            let area: f64 = (0..count)
                .map(|i| (range.0 + step * i as f64).exp())
                .map(|f| f * spectrum.density(component, f, 3.0) * step)
                .sum();
            // The constants of the formulas are rounded to four digits.
            assert!((area - 1.0).abs() < 3e-4, "{spectrum:?}, component {component}: {area}");
        }
    }
}

#[test]
fn spectrum_and_coherence_of_many_fields_are_those_asked_for() {
    const FIELDS: u64 = 400;
    let lines = [2, 5, 12, 40];
    let (near, far) = (10.0, 15.0);
    for component in [0, 2] {
        for l in lines {
            let f = l as f64 / (512.0 * 0.1);
            let (mut power, mut cross) = ([0.0; 2], [0.0; 2]);
            for seed in 0..FIELDS {
                let options = options(seed);
                let turbulence = Turbulence::new(&options);
                let a = coefficient(&turbulence, &options, component, near, l);
                let b = coefficient(&turbulence, &options, component, far, l);
                power[0] += a[0] * a[0] + a[1] * a[1];
                power[1] += b[0] * b[0] + b[1] * b[1];
                cross[0] += a[0] * b[0] + a[1] * b[1];
                cross[1] += a[1] * b[0] - a[0] * b[1];
            }
            let options = options(0);
            let time_scale = options.length_scales[component] / options.speed;
            let sigma = options.deviations[component];
            // The amplitude of a line of width Δf has the mean square 2 S Δf.
            let expected = 2.0 * sigma * sigma * options.spectrum.density(component, f, time_scale) / (512.0 * 0.1);
            for power in power {
                let ratio = power / FIELDS as f64 / expected;
                // |z|² has at most the deviation 1 of an exponential distribution: 4 deviations of the mean of 400.
                assert!((ratio - 1.0).abs() < 0.2, "component {component}, {f} Hz: {ratio}");
            }
            let coherence = cross[0].hypot(cross[1]) / (power[0] * power[1]).sqrt();
            let expected = (-options.coherence_decays[component] * f * (far - near) / options.speed).exp();
            // Deviation of an estimate from 400 pairs: (1 − γ²)/√800 about γ, and a bias of √(π/1600) where there is
            // none; 4 of them.
            assert!(
                (coherence - expected).abs() < 4.0 * (1.0 - expected * expected) / 800_f64.sqrt() + 0.05,
                "component {component}, {f} Hz: {coherence} instead of {expected}"
            );
        }
    }
}

/// Kaimal's spectrum for the component across the wind, and distances of up to four stations.
#[test]
fn kaimals_spectrum_and_the_coherence_over_several_stations_are_those_asked_for() {
    const FIELDS: u64 = 400;
    const COMPONENT: usize = 1;
    let places = [5.0, 10.0, 15.0, 25.0];
    let of = |seed| TurbulenceOptions {
        spectrum: TurbulenceSpectrum::Kaimal,
        ..options(seed)
    };
    for l in [2, 5, 12, 40] {
        let f = l as f64 / (512.0 * 0.1);
        let (mut power, mut cross) = ([0.0; 4], [[0.0; 2]; 4]);
        for seed in 0..FIELDS {
            let options = of(seed);
            let turbulence = Turbulence::new(&options);
            let found = places.map(|x| coefficient(&turbulence, &options, COMPONENT, x, l));
            let [re, im] = found[0];
            for (k, at) in found.iter().enumerate() {
                power[k] += at[0] * at[0] + at[1] * at[1];
                cross[k][0] += re * at[0] + im * at[1];
                cross[k][1] += im * at[0] - re * at[1];
            }
        }
        // [IEC 61400-1, annex B]: f S/σ² = 4 n/(1 + 6 n)^(5/3), n = f L/U, written out here.
        let options = of(0);
        let (sigma, length) = (options.deviations[COMPONENT], options.length_scales[COMPONENT]);
        let n = f * length / options.speed;
        let expected = 2.0 * sigma * sigma * 4.0 * (n / f) / (1.0 + 6.0 * n).powf(5.0 / 3.0) / (512.0 * 0.1);
        let ratios = power.map(|power| power / FIELDS as f64 / expected);
        let coherences = [1, 2, 3].map(|k: usize| {
            let found = cross[k][0].hypot(cross[k][1]) / (power[0] * power[k]).sqrt();
            let decay = options.coherence_decays[COMPONENT] * f * (places[k] - places[0]) / options.speed;
            (found, (-decay).exp())
        });
        println!("{f:.3} Hz: power {ratios:.3?}, coherence at 5, 10, 20 m (expected) {coherences:.3?}");
        for ratio in ratios {
            assert!((ratio - 1.0).abs() < 0.2, "{f} Hz: {ratio}"); // four deviations, see above
        }
        for (found, expected) in coherences {
            let band = 4.0 * (1.0 - expected * expected) / 800_f64.sqrt() + 0.05; // see above
            assert!((found - expected).abs() < band, "{f} Hz: {found} instead of {expected}");
        }
    }
}

#[test]
fn two_fields_of_the_same_numbers_are_equal_bit_for_bit_and_other_seeds_give_others() {
    let wind = |seed| Wind {
        turbulence: Some(Turbulence::new(&options(seed))),
        ..Wind::uniform(Vector3::new(-19.3, 5.2, 0.0))
    };
    let (a, b, other) = (wind(7), wind(7), wind(8));
    let mut differ = false;
    for i in 0..500 {
        let (t, x) = (0.0137 * f64::from(i), 0.31 * f64::from(i) - 20.0);
        let (a, b, other) = (a.velocity(t, x), b.velocity(t, x), other.velocity(t, x));
        assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
        differ |= a != other;
    }
    assert!(differ);
}

#[test]
fn a_longer_line_sees_the_same_turbulence_where_both_are() {
    let short = Turbulence::new(&options(3));
    let long = Turbulence::new(&TurbulenceOptions {
        stations: 9,
        ..options(3)
    });
    // Up to the last but one station the neighbours of the interpolation are the same.
    for x in [0.0, 2.5, 11.0, 19.9] {
        assert_eq!(short.velocity(1.234, x), long.velocity(1.234, x));
    }
}

#[test]
fn the_interpolated_field_passes_through_its_table_and_has_no_kinks() {
    let turbulence = Turbulence::new(&options(5));
    let h = 1e-6;
    for (t, x) in [(0.3, 5.0), (0.7, 10.0), (51.2 + 0.3, 5.0)] {
        for (dt, dx) in [(h, 0.0), (0.0, h)] {
            let before = (turbulence.velocity(t, x) - turbulence.velocity(t - dt, x - dx)) / h;
            let after = (turbulence.velocity(t + dt, x + dx) - turbulence.velocity(t, x)) / h;
            // Second derivatives of some 3 m/s per (0.1 s)² times h, and rounding of 1e-15/h.
            assert!((after - before).amax() < 5e-3, "{before} {after}");
        }
    }
    let period = turbulence.velocity(0.3, 5.0) - turbulence.velocity(51.2 + 0.3, 5.0);
    // The share of a step is rounded by the ulp of 515 steps.
    assert!(period.amax() < 1e-11);
}

#[test]
fn a_gust_rises_to_its_peak_and_falls_to_nothing() {
    let peak = Vector3::new(0.0, 8.0, 1.0);
    let in_time = Gust {
        peak,
        profile: GustProfile::InTime {
            start: 2.0,
            duration: 4.0,
        },
    };
    let in_place = Gust {
        peak,
        profile: GustProfile::InPlace {
            start: 100.0,
            length: 50.0,
        },
    };
    assert_eq!(in_time.velocity(4.0, 0.0), peak);
    assert!((in_time.velocity(3.0, 0.0) - peak * 0.5).amax() < 1e-15); // (1 − cos(π/2))/2, rounding
    assert_eq!(in_time.velocity(1.9, 0.0), Vector3::zeros());
    assert_eq!(in_time.velocity(6.1, 0.0), Vector3::zeros());
    assert_eq!(in_place.velocity(0.0, 125.0), peak);
    assert_eq!(in_place.velocity(0.0, 151.0), Vector3::zeros());
}

#[test]
fn a_record_is_read_between_its_times_and_places_and_refused_where_it_is_none() {
    let rows = |rows: &[&[f64]]| WindRecord::from_rows(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>());
    let record = rows(&[
        &[0.0, 1.0, 0.0, 0.0, 100.0],
        &[2.0, 3.0, 0.0, 0.0, 100.0],
        &[0.0, 0.0, 4.0, 0.0, 0.0],
    ])
    .unwrap();
    assert_eq!(record.velocity(1.0, 100.0), Vector3::new(2.0, 0.0, 0.0));
    assert_eq!(record.velocity(1.0, 50.0), Vector3::new(1.0, 2.0, 0.0));
    assert_eq!(record.velocity(9.0, 200.0), Vector3::new(3.0, 0.0, 0.0));
    assert_eq!(record.velocity(-1.0, -5.0), Vector3::new(0.0, 4.0, 0.0));
    assert!(matches!(rows(&[]), Err(WindRecordError::Empty)));
    assert!(matches!(
        rows(&[&[0.0, 1.0, 2.0]]),
        Err(WindRecordError::Width { row: 1, found: 3, .. })
    ));
    let mixed = rows(&[&[0.0, 1.0, 2.0, 3.0], &[1.0, 1.0, 2.0, 3.0, 4.0]]);
    assert!(matches!(mixed, Err(WindRecordError::Width { row: 2, found: 5, .. })));
    let back = rows(&[&[1.0, 1.0, 2.0, 3.0], &[1.0, 1.0, 2.0, 3.0]]);
    assert!(matches!(back, Err(WindRecordError::Order { row: 2, .. })));
    assert!(matches!(
        rows(&[&[f64::NAN, 1.0, 2.0, 3.0]]),
        Err(WindRecordError::NotFinite { row: 1 })
    ));
}

#[test]
fn a_field_has_the_standard_deviations_asked_for_over_its_period() {
    for (speed, steps) in [(20.0, 1024), (10.0, 1024), (20.0, 8192)] {
        let options = TurbulenceOptions {
            speed,
            steps,
            ..options(3)
        };
        let field = Turbulence::new(&options);
        for component in 0..3 {
            let direction = options.axes.column(component).into_owned();
            // At the first station all harmonics have their own amplitude, whatever their phases.
            let samples = (0..steps).map(|step| {
                field
                    .velocity(step as f64 * options.time_step, options.start)
                    .dot(&direction)
            });
            let variance = samples.map(|u| u * u).sum::<f64>() / steps as f64;
            // Fluctuations faster than ten times a second are left out.
            let ratio = variance.sqrt() / options.deviations[component];
            assert!(
                (0.9..1.005).contains(&ratio),
                "{speed} m/s, {steps} steps, {component}: {ratio}"
            );
        }
    }
}
