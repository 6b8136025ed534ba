//! Statistics of a contact force over the evaluation range.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::losses::{fewest, runs};

/// Mean, spread and extremes of a force over the evaluation range, all in N.
///
/// ```text
/// std² = 1/n Σ (Fᵢ − mean)²                       population standard deviation
/// statistical max, min = mean ± 3 std             [EN 50317]
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceStatistics {
    /// Mean, N.
    pub mean: f64,
    /// Population standard deviation, N.
    pub std: f64,
    /// Largest sample, N.
    pub max: f64,
    /// Smallest sample, N.
    pub min: f64,
    /// `mean + 3 std`, N.
    pub statistical_max: f64,
    /// `mean − 3 std`, N.
    pub statistical_min: f64,
}

impl ForceStatistics {
    /// Statistics of `force` in N; `None` where there is no sample or one that is not finite.
    #[must_use]
    pub fn of(force: &[f64]) -> Option<Self> {
        if force.is_empty() || force.iter().any(|f| !f.is_finite()) {
            return None;
        }
        let n = force.len() as f64;
        // Two passes: the second sum is not a difference of large numbers.
        let mean = force.iter().sum::<f64>() / n;
        let std = (force.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / n).sqrt();
        Some(Self {
            mean,
            std,
            max: force.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            min: force.iter().copied().fold(f64::INFINITY, f64::min),
            statistical_max: mean + 3.0 * std,
            statistical_min: mean - 3.0 * std,
        })
    }
}

/// Root mean square of the difference of two series; `None` for series that are empty or differ in length.
#[must_use]
pub fn rms_difference(first: &[f64], other: &[f64]) -> Option<f64> {
    if first.len() != other.len() || first.is_empty() {
        return None;
    }
    let sum: f64 = first.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    Some((sum / first.len() as f64).sqrt())
}

/// Share of the samples with zero `force` (N), in percent; `None` without samples.
///
/// The raw force is meant: the filtered one passes zero smoothly and hides short separations.
#[must_use]
pub fn loss_of_contact_percent(force: &[f64]) -> Option<f64> {
    if force.is_empty() || force.iter().any(|f| !f.is_finite()) {
        return None;
    }
    let lost = force.iter().filter(|f| **f <= 0.0).count();
    Some(100.0 * lost as f64 / force.len() as f64)
}

/// Share of the samples in `range` that belong to losses of contact of at least `shortest` s, in percent; `None`
/// without samples in it or where one of the record is not finite.
///
/// `force` is the whole raw record, N, one sample every `step` s: a loss that reaches beyond the range keeps its
/// duration, and counts with the part of it that lies inside. Each sample without force stands for one step.
#[must_use]
pub fn long_loss_of_contact_percent(force: &[f64], range: Range<usize>, step: f64, shortest: f64) -> Option<f64> {
    if range.is_empty() || range.end > force.len() || force.iter().any(|f| !f.is_finite()) {
        return None;
    }
    let long = runs(force)
        .into_iter()
        .filter(|run| run.len() >= fewest(shortest, step));
    let inside = long.map(|run| run.end.min(range.end).saturating_sub(run.start.max(range.start)));
    let lost: usize = inside.sum();
    Some(100.0 * lost as f64 / range.len() as f64)
}

/// Largest minus smallest value of `signal`, in its unit; `None` without samples or where one is
/// not finite.
#[must_use]
pub fn peak_to_peak(signal: &[f64]) -> Option<f64> {
    let statistics = ForceStatistics::of(signal)?;
    Some(statistics.max - statistics.min)
}

/// Indices of the samples with `from ≤ time ≤ to` (s); empty where the record ends before.
///
/// `time` rises. A millionth of the first step is allowed for the rounding of `n · step`.
#[must_use]
pub fn sample_range(time: &[f64], from: f64, to: f64) -> Range<usize> {
    let slack = if time.len() > 1 {
        1e-6 * (time[1] - time[0])
    } else {
        0.0
    };
    let start = time.partition_point(|t| *t < from - slack);
    let end = time.partition_point(|t| *t <= to + slack);
    start..end.max(start)
}

/// Shares of samples in intervals of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Left end of the first interval, in the unit of the signal.
    pub start: f64,
    /// Width of an interval, in the unit of the signal.
    pub width: f64,
    /// Percent of the samples in each interval.
    pub percent: Vec<f64>,
}

/// Counts `signal` in intervals of `width` (same unit) that begin at multiples of it; `None`
/// without samples, where one is not finite or `width` is not positive.
#[must_use]
pub fn histogram(signal: &[f64], width: f64) -> Option<Histogram> {
    let statistics = ForceStatistics::of(signal)?;
    if !(width > 0.0 && width.is_finite()) {
        return None;
    }
    let first = (statistics.min / width).floor();
    let bins = ((statistics.max / width).floor() - first) as usize + 1;
    let mut counts = vec![0_usize; bins];
    for value in signal {
        let bin = ((value / width).floor() - first) as usize;
        counts[bin.min(bins - 1)] += 1;
    }
    let n = signal.len() as f64;
    Some(Histogram {
        start: first * width,
        width,
        percent: counts.iter().map(|c| 100.0 * *c as f64 / n).collect(),
    })
}

/// Value that a share of the samples lies below.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// Share of the samples, %.
    pub percent: f64,
    /// Value, in the unit of the signal.
    pub value: f64,
}

/// Quantiles of `signal` at shares of 0 to 100 %, linear between the samples in order; nothing without samples or where
/// one is not finite.
#[must_use]
pub fn quantiles(signal: &[f64], percents: &[f64]) -> Vec<Quantile> {
    if signal.is_empty() || signal.iter().any(|value| !value.is_finite()) {
        return Vec::new();
    }
    let mut sorted = signal.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |percent: &f64| {
        let place = percent / 100.0 * (sorted.len() - 1) as f64;
        let below = (place.floor() as usize).min(sorted.len() - 1);
        let above = (below + 1).min(sorted.len() - 1);
        Quantile {
            percent: *percent,
            value: sorted[below] + (place - below as f64) * (sorted[above] - sorted[below]),
        }
    };
    percents.iter().map(at).collect()
}

/// Largest slope of `signal` against places `x` in m, without its sign; nothing where `x` does not change.
#[must_use]
pub fn largest_slope(signal: &[f64], x: &[f64]) -> Option<f64> {
    let slopes = signal.windows(2).zip(x.windows(2));
    let slopes = slopes.filter(|(_, x)| x[1] != x[0]);
    let slopes = slopes.map(|(value, x)| ((value[1] - value[0]) / (x[1] - x[0])).abs());
    slopes.reduce(f64::max)
}
