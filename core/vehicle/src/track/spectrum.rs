//! Irregularities made from power spectral densities.
use super::{RailShape, Reach, TrackShape};
use dynamics::RestingSpline;
use dynamics::SplitMix64;
use scene::Spectrum;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Waves per spectrum: fewer waves leave visible lines in the spectrum of one realisation.
const WAVES: usize = 400;

/// Samples per shortest wavelength: a cubic spline then misses a wave by (2π/16)⁴/384 of its amplitude, 6e-5.
const SAMPLES: f64 = 16.0;

/// `√(2 S ΔΩ) cos(Ω x + φ)`: amplitude (m or rad), Ω (rad/m), φ (rad).
struct Wave {
    amplitude: f64,
    number: f64,
    phase: f64,
}

/// Waves of the one-sided density `density(Ω)`, in bands of equal ratio, with the wave number anywhere within each
/// band.
fn waves(wavelengths: [f64; 2], random: &mut SplitMix64, density: impl Fn(f64) -> f64) -> Vec<Wave> {
    let [shortest, longest] = wavelengths;
    let (from, ratio) = (TAU / longest, longest / shortest);
    (0..WAVES)
        .map(|i| {
            let edge = |i: usize| from * ratio.powf(i as f64 / WAVES as f64);
            let (low, high) = (edge(i), edge(i + 1));
            let number = low + (high - low) * random.unit();
            Wave {
                amplitude: (2.0 * density(number) * (high - low)).sqrt(),
                number,
                phase: TAU * random.unit(),
            }
        })
        .collect()
}

fn sum(waves: &[Wave], x: f64) -> f64 {
    waves
        .iter()
        .map(|wave| wave.amplitude * (wave.number * x + wave.phase).cos())
        .sum()
}

/// One realisation; see [`Spectrum`] for the densities.
pub(super) fn realise(entry: &Spectrum, reach: Reach) -> TrackShape {
    let [rise, shift, tilt] = densities(entry, reach.rail_distance);
    let mut random = SplitMix64::new(entry.seed as u64);
    let rise = waves(entry.wavelengths, &mut random, rise);
    let shift = waves(entry.wavelengths, &mut random, shift);
    let tilt = waves(entry.wavelengths, &mut random, tilt);
    let step = entry.wavelengths[0] / SAMPLES;
    let count = ((reach.end - reach.start) / step).ceil().max(1.0) as usize + 1;
    let half = 0.5 * reach.rail_distance;
    let (mut x, mut y) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let (mut left, mut right) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for i in 0..count {
        let along = i as f64 * step;
        // Value, slope and curvature at the begin are those of the ideal line.
        let part = (along / entry.fade).min(1.0);
        let grown = part.powi(3) * (10.0 + part * (6.0 * part - 15.0));
        let at = reach.start + along;
        let (rise, roll) = (grown * sum(&rise, at), grown * half * sum(&tilt, at));
        x.push(at);
        y.push(grown * sum(&shift, at));
        left.push(rise + roll);
        right.push(rise - roll);
    }
    let rail = |z: Vec<f64>| {
        Arc::new(RailShape {
            z: RestingSpline::new(x.clone(), z),
            y: RestingSpline::new(x.clone(), y.clone()),
        })
    };
    TrackShape {
        rails: [rail(left), rail(right)],
    }
}

/// One-sided densities of the rise of the middle (m²/(rad/m)), of the lateral displacement, and of the cant angle
/// (1/(rad/m)).
fn densities(entry: &Spectrum, rail_distance: f64) -> [impl Fn(f64) -> f64; 3] {
    let [r, c, s] = entry.corners.map(|corner| corner * corner);
    let half_squared = 0.25 * rail_distance * rail_distance;
    let density = move |roughness: f64, tilts: bool| {
        move |number: f64| {
            let square = number * number;
            let level = roughness * c / ((square + r) * (square + c));
            if tilts {
                level * square / (half_squared * (square + s))
            } else {
                level
            }
        }
    };
    [
        density(entry.vertical_roughness, false),
        density(entry.lateral_roughness, false),
        density(entry.vertical_roughness, true),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(seed: usize) -> Spectrum {
        Spectrum {
            seed,
            wavelengths: [3.0, 100.0],
            vertical_roughness: 4.032e-7,
            lateral_roughness: 2.119e-7,
            corners: [0.0206, 0.8246, 0.4380],
            fade: 50.0,
        }
    }

    const REACH: Reach = Reach {
        start: 100.0,
        end: 2100.0,
        rail_distance: 1.5,
    };

    #[test]
    fn a_seed_gives_one_track_and_another_seed_another_one() {
        let rise = |seed| realise(&entry(seed), REACH).rails[0].rise(700.0)[0];
        assert_eq!(rise(1), rise(1));
        assert_ne!(rise(1), rise(2));
    }

    #[test]
    fn the_variance_of_many_realisations_is_the_integral_of_the_density() {
        let given = entry(0);
        let [low, high] = [TAU / 100.0, TAU / 3.0];
        let [rise, shift, tilt] = densities(&given, REACH.rail_distance);
        let integral = |density: &dyn Fn(f64) -> f64| {
            let n = 200_000;
            let step = (high - low) / f64::from(n);
            (0..n)
                .map(|i| density(low + (f64::from(i) + 0.5) * step) * step)
                .sum::<f64>()
        };
        let expected = [integral(&rise), integral(&shift), 0.5625 * integral(&tilt)];
        let mut found = [0.0; 3];
        let (tracks, places) = (20, 200);
        for seed in 1..=tracks {
            let track = realise(&entry(seed), REACH);
            for i in 0..places {
                let x = 200.0 + 9.4 * f64::from(i);
                let (left, right) = (track.rails[0].rise(x)[0], track.rails[1].rise(x)[0]);
                found[0] += (0.5 * (left + right)).powi(2);
                found[1] += track.rails[0].lateral(x)[0].powi(2);
                found[2] += (0.5 * (left - right)).powi(2);
            }
        }
        for (found, expected) in found.iter().zip(expected) {
            let ratio = found / (tracks as f64 * f64::from(places)) / expected;
            // 20 tracks of some 20 long waves each: scatter of 1/√400 of the variance and its correlation.
            assert!((0.85..1.15).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn the_track_is_ideal_up_to_its_start() {
        let track = realise(&entry(3), REACH);
        for rail in &track.rails {
            assert_eq!(rail.rise(REACH.start), [0.0, 0.0, rail.rise(REACH.start)[2]]);
            assert_eq!(rail.rise(50.0), [0.0; 3]);
            assert_eq!(rail.lateral(99.0), [0.0; 3]);
        }
    }
}
