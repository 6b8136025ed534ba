//! Spread of a signal by frequency band.

use serde::{Deserialize, Serialize};
use std::ops::Range;

use super::{FilterError, ForceStatistics, LowPass};

/// Standard deviation of a signal in a frequency band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Lower end, Hz.
    pub from_hz: f64,
    /// Upper end, Hz.
    pub to_hz: f64,
    /// Standard deviation over the evaluation range, in the unit of the signal.
    pub std: Option<f64>,
}

/// Part of `signal` between `from` and `to` Hz, one sample every `step` s: what the low-pass filter without delay
/// leaves at `to`, less what it leaves of that at `from`.
///
/// Forward and backward, low-pass and high-pass of a Butterworth filter add up to one at every frequency, so that this
/// is the high-pass at `from`, and neighbouring bands add up to the whole. The variances do so up to twice the
/// covariance of the bands, as both pass a part of the frequencies around the end they share.
///
/// # Errors
/// [`FilterError`] for frequencies that the step does not resolve, and records that are too short.
pub fn band_pass(signal: &[f64], [from, to]: [f64; 2], step: f64) -> Result<Vec<f64>, FilterError> {
    let mut upper = LowPass::new(to, step)?.filter(signal)?;
    if from > 0.0 {
        let lower = LowPass::new(from, step)?.filter(&upper)?;
        upper.iter_mut().zip(lower).for_each(|(all, low)| *all -= low);
    }
    Ok(upper)
}

/// Standard deviations of `signal` in `bands` (Hz) over `range`.
#[must_use]
pub fn bands(signal: &[f64], bands: &[[f64; 2]], range: &Range<usize>, step: f64) -> Vec<Band> {
    let of = |&[from, to]: &[f64; 2]| {
        let part = band_pass(signal, [from, to], step).ok();
        let statistics = part.and_then(|part| ForceStatistics::of(part.get(range.clone())?));
        Band {
            from_hz: from,
            to_hz: to,
            std: statistics.map(|statistics| statistics.std),
        }
    };
    bands.iter().map(of).collect()
}
