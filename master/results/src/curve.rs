//! The contact force of a run against position, and differences of runs.

use std::ops::Range;

use crate::statistics::ForceStatistics;
use crate::{Evaluation, Record};

/// The contact force of one strip against position, whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceCurve {
    /// Position of the contact, m.
    pub x: Vec<f64>,
    /// Force as recorded, N.
    pub raw: Vec<f64>,
    /// Force after the low-pass filter, N.
    pub filtered: Vec<f64>,
    /// Samples of the evaluation range.
    pub range: Range<usize>,
}

impl ForceCurve {
    /// Curve of a pantograph (from 0); nothing where its force cannot be filtered.
    fn of_pantograph(evaluation: &Evaluation, record: &Record, index: usize) -> Option<Self> {
        let strip = record.pantographs.get(index)?;
        Some(Self {
            x: strip.contact_x.clone(),
            raw: strip.force.clone(),
            filtered: evaluation.filtered(&strip.force).ok()?,
            range: evaluation.samples(&record.time, index),
        })
    }

    /// One curve per pantograph; none where a force cannot be filtered or the evaluation range holds no sample.
    #[must_use]
    pub fn of(evaluation: &Evaluation, record: &Record) -> Vec<Self> {
        let curve = |index: usize| {
            let curve = Self::of_pantograph(evaluation, record, index)?;
            let finite = curve.filtered.iter().all(|force| force.is_finite());
            (finite && !curve.range.is_empty()).then_some(curve)
        };
        let curves = (0..record.pantographs.len()).map(curve).collect::<Option<_>>();
        curves.unwrap_or_default()
    }

    /// Standard deviation of the filtered force over the evaluation range, N.
    fn sigma(&self) -> Option<f64> {
        let samples = self.filtered.get(self.range.clone())?;
        ForceStatistics::of(samples).map(|force| force.std)
    }

    /// `true` where a force varies so little that no other one has an error in percent of it.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.sigma().is_some_and(|sigma| sigma <= STILL)
    }

    /// The evaluation range with a few samples on both sides, so that every position of it lies between two samples of
    /// another run: all that a comparison needs.
    #[must_use]
    pub fn cut(&self) -> Self {
        /// Samples beyond the range, –: a strip swings along the track by less than it travels in these.
        const MARGIN: usize = 16;
        let from = self.range.start.saturating_sub(MARGIN);
        let to = (self.range.end + MARGIN).min(self.x.len());
        Self {
            x: self.x[from..to].to_vec(),
            raw: self.raw[from..to].to_vec(),
            filtered: self.filtered[from..to].to_vec(),
            range: self.range.start - from..self.range.end - from,
        }
    }
}

/// Standard deviation of the filtered force below which a force does not vary, N: there is no contact, or next to none,
/// and a percentage of it says nothing.
const STILL: f64 = 1e-6;

/// Remark on a force that does not vary: no errors in percent of it.
pub const NO_ERRORS: &str =
    "the contact force of the reference does not vary: there is no error in percent of its standard deviation";

/// Differences of a run from its reference, % of the reference's standard deviation of the filtered force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// rms of the filtered force at equal positions, %.
    pub filtered: Option<f64>,
    /// rms of the raw force at equal positions, %.
    pub raw: Option<f64>,
    /// Difference of the standard deviations of the filtered force, %.
    pub std: Option<f64>,
}

impl Errors {
    /// Errors of the curves of a run against those of its reference, the largest of all pantographs.
    ///
    /// A quantity is `None` where a curve is missing or does not reach over the evaluation range, or where the
    /// reference does not vary.
    #[must_use]
    pub fn between(reference: &[ForceCurve], run: &[ForceCurve]) -> Self {
        if reference.is_empty() || reference.len() != run.len() {
            return Self::default();
        }
        let (mut filtered, mut raw, mut std) = (Some(0.0_f64), Some(0.0_f64), Some(0.0_f64));
        let larger = |so_far: Option<f64>, error: Option<f64>| {
            let (so_far, error) = (so_far?, error.filter(|error| !error.is_nan())?);
            Some(if error.abs() > so_far.abs() { error } else { so_far })
        };
        for (reference, run) in reference.iter().zip(run) {
            let (Some(expected), Some(found)) = (reference.sigma(), run.sigma()) else {
                return Self::default();
            };
            if expected <= STILL {
                return Self::default();
            }
            let percent = |rms: Option<f64>| rms.map(|rms| 100.0 * rms / expected);
            let at = &reference.x[reference.range.clone()];
            let wanted = |force: &Vec<f64>| force[reference.range.clone()].to_vec();
            let rms = |expected: &Vec<f64>, found: &Vec<f64>| pointwise_rms((at, &wanted(expected)), (&run.x, found));
            filtered = larger(filtered, percent(rms(&reference.filtered, &run.filtered)));
            raw = larger(raw, percent(rms(&reference.raw, &run.raw)));
            std = larger(std, Some(100.0 * (found / expected - 1.0)));
        }
        Self { filtered, raw, std }
    }
}

/// Root mean square of the difference of two signals that are given as values at rising positions in m: taken at the
/// positions of the first, the second is interpolated linearly.
///
/// `None` where there is nothing to compare, or the second does not reach over the first; half a sample is allowed at
/// the ends.
#[must_use]
pub fn pointwise_rms((x, expected): (&[f64], &[f64]), (x_other, found): (&[f64], &[f64])) -> Option<f64> {
    if x.is_empty() || x.len() != expected.len() || x_other.len() < 2 || x_other.len() != found.len() {
        return None;
    }
    let last = x_other.len() - 1;
    let (mut sum, mut left) = (0.0, 0);
    for (&x, &expected) in x.iter().zip(expected) {
        while left + 2 <= last && x_other[left + 1] <= x {
            left += 1;
        }
        // A strip swings along the track by less than it travels; back by a sample or two all the same.
        while left > 0 && x_other[left] > x {
            left -= 1;
        }
        let width = x_other[left + 1] - x_other[left];
        let share = if width > 0.0 { (x - x_other[left]) / width } else { 0.0 };
        if !(-0.5..=1.5).contains(&share) {
            return None;
        }
        let value = found[left] + share * (found[left + 1] - found[left]);
        sum += (value - expected).powi(2);
    }
    Some((sum / x.len() as f64).sqrt())
}
