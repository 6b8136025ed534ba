//! Turbulence along the track: a Gaussian field made of harmonics, tabulated once.
use super::spectrum::TurbulenceSpectrum;
use crate::SplitMix64;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Options of a field of turbulence; components are those along the mean wind, across it (to the left of its
/// direction), and vertical.
#[derive(Clone, Debug, PartialEq)]
pub struct TurbulenceOptions {
    /// Shape of the spectra.
    pub spectrum: TurbulenceSpectrum,
    /// Speed of the mean wind, m/s, positive.
    pub speed: f64,
    /// The components' directions as columns, world axes.
    pub axes: Matrix3<f64>,
    /// `σ` of each component, m/s.
    pub deviations: [f64; 3],
    /// `L` of each component, m, positive.
    pub length_scales: [f64; 3],
    /// `C` of each component, –: the coherence of two places is `exp(−C f |Δx|/U)`.
    pub coherence_decays: [f64; 3],
    /// Any number.
    pub seed: u64,
    /// Step of the table in time, s: half its inverse is the highest frequency.
    pub time_step: f64,
    /// Steps of the table in time, a power of two; the field repeats itself after them.
    pub steps: usize,
    /// x of the first station, m.
    pub start: f64,
    /// Distance of the stations, m.
    pub spacing: f64,
    /// Number of stations; a field with more of them is the same at those that both have.
    pub stations: usize,
}

/// Turbulence with the spectra and the coherence [Davenport, Quart. J. R. Met. Soc. 87 (1961)] of its options.
///
/// At station j it is the sum of the harmonics that the spectral representation [Shinozuka & Deodatis, Appl. Mech. Rev.
/// 44 (1991)] gives a vector of coherent processes:
///
/// ```text
/// u_j(t) = Re Σ_l √(2 S(f_l) Δf) z_jl exp(2π i f_l t)
/// z_jl = Σ_m H_jm(f_l) exp(i φ_ml),   H Hᵀ = [ρ^|j−k|],   ρ = exp(−C f Δx/U)
/// ```
///
/// with independent phases `φ`. Fluctuations slower than half of `f_1` have no harmonic of their own and are in the
/// first one, so that the standard deviations are those asked for, without the part above the highest frequency. The
/// triangular factor `H` of a correlation that falls exponentially has a closed form, which makes `z` a recursion from
/// station to station (derived here: both sides have the same correlations ρ^|j−k|):
///
/// ```text
/// z_0 = exp(i φ_0),   z_j = ρ z_{j−1} + √(1 − ρ²) exp(i φ_j)
/// ```
///
/// The sums are Fourier transforms. Between stations and steps the field is interpolated by cubics through four
/// neighbours, C¹ in both directions; beyond the ends it is that of the last station. Fluctuations shorter than the
/// distance of the stations are thereby weakened. The coherence is real: eddies are not carried along the track by the
/// mean wind.
#[derive(Clone, Debug)]
pub struct Turbulence {
    time_step: f64,
    steps: usize,
    start: f64,
    spacing: f64,
    stations: usize,
    /// World axes, m/s, step by step within station after station.
    table: Vec<Vector3<f64>>,
}

/// `∫ S df` from 0 to half of a frequency step, below the band of the first harmonic; by the midpoints of a few
/// hundredths of it.
fn slower(density: impl Fn(f64) -> f64, frequency_step: f64) -> f64 {
    const PARTS: usize = 64;
    let width = 0.5 * frequency_step / PARTS as f64;
    (0..PARTS).map(|k| density((k as f64 + 0.5) * width) * width).sum()
}

impl Turbulence {
    /// Tabulates the field.
    ///
    /// # Panics
    /// When `steps` is not a power of two or there is no station.
    #[must_use]
    pub fn new(options: &TurbulenceOptions) -> Self {
        let TurbulenceOptions { steps, stations, .. } = *options;
        assert!(steps.is_power_of_two() && steps > 1, "{steps} steps");
        assert!(stations > 0, "no station");
        let frequency_step = 1.0 / (steps as f64 * options.time_step);
        // The mean and the highest frequency, which has no phase, are left out.
        let frequencies: Vec<f64> = (1..steps / 2).map(|l| l as f64 * frequency_step).collect();
        let twiddles = twiddles(steps);
        let mut table = vec![Vector3::zeros(); steps * stations];
        let mut series = vec![Complex::default(); steps];
        for component in 0..3 {
            let sigma = options.deviations[component];
            if sigma == 0.0 {
                continue;
            }
            let direction = options.axes.column(component).into_owned();
            let time_scale = options.length_scales[component] / options.speed;
            let decay = options.coherence_decays[component] * options.spacing / options.speed;
            let density = |f: f64| options.spectrum.density(component, f, time_scale);
            let mut shares: Vec<f64> = frequencies.iter().map(|&f| density(f) * frequency_step).collect();
            if let Some(longest) = shares.first_mut() {
                *longest += slower(density, frequency_step);
            }
            let amplitudes: Vec<f64> = shares.iter().map(|share| sigma * (2.0 * share).sqrt()).collect();
            let correlations: Vec<f64> = frequencies.iter().map(|f| (-decay * f).exp()).collect();
            let mut z = vec![Complex::default(); frequencies.len()];
            for station in 0..stations {
                let mut random = SplitMix64::stream(options.seed, (3 * station + component) as u64);
                series.fill(Complex::default());
                for (l, z) in z.iter_mut().enumerate() {
                    let (im, re) = (TAU * random.unit()).sin_cos();
                    let rho = if station == 0 { 0.0 } else { correlations[l] };
                    let rest = (1.0 - rho * rho).sqrt();
                    *z = Complex {
                        re: rho * z.re + rest * re,
                        im: rho * z.im + rest * im,
                    };
                    series[l + 1] = Complex {
                        re: amplitudes[l] * z.re,
                        im: amplitudes[l] * z.im,
                    };
                }
                transform(&mut series, &twiddles);
                let row = &mut table[station * steps..][..steps];
                for (velocity, value) in row.iter_mut().zip(&series) {
                    *velocity += direction * value.re;
                }
            }
        }
        Self {
            time_step: options.time_step,
            steps,
            start: options.start,
            spacing: options.spacing,
            stations,
            table,
        }
    }

    /// Velocity at time `t` (s) over `x` (m), m/s.
    #[must_use]
    pub fn velocity(&self, t: f64, x: f64) -> Vector3<f64> {
        let time = t / self.time_step;
        let (step, weights_t) = (time.floor(), cubic(time - time.floor()));
        let last = (self.stations - 1) as f64;
        let place = ((x - self.start) / self.spacing).clamp(0.0, last);
        let (station, weights_x) = (place.floor(), cubic(place - place.floor()));
        let steps = self.steps as i64;
        let columns: [usize; 4] = std::array::from_fn(|k| (step as i64 + k as i64 - 1).rem_euclid(steps) as usize);
        let mut velocity = Vector3::zeros();
        for (k, weight_x) in weights_x.iter().enumerate() {
            let row = (station + k as f64 - 1.0).clamp(0.0, last) as usize;
            let row = &self.table[row * self.steps..][..self.steps];
            let mut at_station = Vector3::zeros();
            for (&column, weight_t) in columns.iter().zip(weights_t) {
                at_station += row[column] * weight_t;
            }
            velocity += at_station * *weight_x;
        }
        velocity
    }
}

/// Weights of four neighbours for the share `u` of the way from the second to the third (Catmull–Rom).
fn cubic(u: f64) -> [f64; 4] {
    let (u2, u3) = (u * u, u * u * u);
    [
        0.5 * (-u + 2.0 * u2 - u3),
        0.5 * (2.0 - 5.0 * u2 + 3.0 * u3),
        0.5 * (u + 4.0 * u2 - 3.0 * u3),
        0.5 * (u3 - u2),
    ]
}

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Complex {
    re: f64,
    im: f64,
}

/// `exp(2π i k/n)`, k up to n/2.
fn twiddles(n: usize) -> Vec<Complex> {
    (0..n / 2)
        .map(|k| {
            let (im, re) = (TAU * k as f64 / n as f64).sin_cos();
            Complex { re, im }
        })
        .collect()
}

/// `X_k = Σ_l x_l exp(2π i k l/n)` in place, n a power of two [Cooley & Tukey, Math. Comp. 19 (1965)].
fn transform(x: &mut [Complex], twiddles: &[Complex]) {
    let n = x.len();
    let bits = n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            x.swap(i, j);
        }
    }
    let mut half = 1;
    while half < n {
        let stride = n / (2 * half);
        for block in x.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let w = twiddles[k * stride];
                let turned = Complex {
                    re: w.re * b.re - w.im * b.im,
                    im: w.re * b.im + w.im * b.re,
                };
                *b = Complex {
                    re: a.re - turned.re,
                    im: a.im - turned.im,
                };
                *a = Complex {
                    re: a.re + turned.re,
                    im: a.im + turned.im,
                };
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_transform_is_the_sum_of_its_harmonics() {
        let n = 16;
        let given: Vec<Complex> = (0..n)
            .map(|l| Complex {
                re: (1.3 * l as f64).sin(),
                im: (0.7 * l as f64).cos(),
            })
            .collect();
        let mut fast = given.clone();
        transform(&mut fast, &twiddles(n));
        for (k, fast) in fast.iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (l, x) in given.iter().enumerate() {
                let (s, c) = (TAU * (k * l) as f64 / n as f64).sin_cos();
                re += c * x.re - s * x.im;
                im += s * x.re + c * x.im;
            }
            // Rounding of 16 terms of the order of one.
            assert!((fast.re - re).abs() < 1e-13 && (fast.im - im).abs() < 1e-13, "{k}");
        }
    }
}
