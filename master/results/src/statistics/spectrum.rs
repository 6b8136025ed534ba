//! Power spectral density of a recorded signal.

use realfft::RealFftPlanner;

/// One-sided power spectral density of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz, from 0 to half of the sampling frequency.
    pub frequency: Vec<f64>,
    /// Density, unit of the signal squared per Hz.
    pub density: Vec<f64>,
}

/// Density of `signal` sampled every `step` s, with its mean removed and a periodic Hann window.
///
/// ```text
/// S(f_j) = 2 |Σ w_i (x_i − x̄) e^(−2πi ij/n)|² / (f_s Σ w_i²)     f_j = j f_s/n
/// w_i = (1 − cos(2π i/n))/2
/// ```
///
/// The factor 2 is left out at `f = 0` and, for even `n`, at `f_s/2`, which have no mirror image.
/// `∫ S df` is the variance of the windowed signal. `None` for fewer than 8 samples or where one
/// is not finite.
#[must_use]
pub fn power_spectral_density(signal: &[f64], step: f64) -> Option<Spectrum> {
    let n = signal.len();
    if n < 8 || signal.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let mean = signal.iter().sum::<f64>() / n as f64;
    let window = |i: usize| 0.5 - 0.5 * (2.0 * std::f64::consts::PI * i as f64 / n as f64).cos();
    let mut windowed: Vec<f64> = signal.iter().enumerate().map(|(i, x)| window(i) * (x - mean)).collect();
    let power: f64 = (0..n).map(|i| window(i).powi(2)).sum();

    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let mut lines = transform.make_output_vec();
    // The only error is a wrong buffer length; both buffers come from the plan's own length.
    transform.process(&mut windowed, &mut lines).ok()?;

    let density = lines
        .iter()
        .enumerate()
        .map(|(j, line)| {
            let sides = if j == 0 || 2 * j == n { 1.0 } else { 2.0 };
            sides * line.norm_sqr() * step / power
        })
        .collect();
    let frequency = (0..lines.len()).map(|j| j as f64 / (n as f64 * step)).collect();
    Some(Spectrum { frequency, density })
}
