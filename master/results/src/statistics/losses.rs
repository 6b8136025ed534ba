//! Losses of contact one by one.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// A loss of contact: samples without force between two with force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loss {
    /// Time of its first sample, s.
    #[serde(rename = "start_s")]
    pub start: f64,
    /// Duration, s: each sample without force stands for one step.
    #[serde(rename = "duration_s")]
    pub duration: f64,
    /// Place of its first sample along the track, m.
    #[serde(rename = "x_m")]
    pub x: f64,
    /// Span of its first sample, from 1; absent where the line is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<usize>,
}

/// Losses of contact by their duration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LossClass {
    /// Shortest duration of the class, s.
    pub from_s: f64,
    /// Duration that all of the class are shorter than, s; absent for the longest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below_s: Option<f64>,
    /// Number of losses.
    pub count: usize,
    /// Share of the evaluation time, %.
    pub percent: f64,
}

/// Bounds of the classes of durations, s: the first is the shortest arc that counts, the others are chosen.
const CLASSES: [f64; 4] = [0.005, 0.01, 0.02, 0.05];

/// Samples of `force` (N) without contact, run by run.
pub(super) fn runs(force: &[f64]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut first = 0;
    for part in force.chunk_by(|a, b| (*a <= 0.0) == (*b <= 0.0)) {
        let last = first + part.len();
        if part[0] <= 0.0 {
            runs.push(first..last);
        }
        first = last;
    }
    runs
}

/// Fewest samples of a loss that lasts `shortest` s.
pub(super) fn fewest(shortest: f64, step: f64) -> usize {
    // A rest of rounding in the quotient makes no further sample.
    (shortest / step - 1e-9).ceil().max(1.0) as usize
}

/// Losses of contact that begin, last or end inside `range`, with their whole durations: `time` in s, `force` in N, `x`
/// in m, one sample every `step` s; `span_at` is the span at a place.
#[must_use]
pub fn losses(
    [time, force, x]: [&[f64]; 3],
    range: &Range<usize>,
    step: f64,
    span_at: impl Fn(f64) -> Option<usize>,
) -> Vec<Loss> {
    let inside = |run: &Range<usize>| run.start < range.end && run.end > range.start;
    let loss = |run: Range<usize>| Loss {
        start: time[run.start],
        duration: run.len() as f64 * step,
        x: x[run.start],
        span: span_at(x[run.start]),
    };
    runs(force).into_iter().filter(inside).map(loss).collect()
}

/// Losses of `force` (N) by duration, with the parts of them that lie inside `range`.
#[must_use]
pub fn loss_classes(force: &[f64], range: &Range<usize>, step: f64) -> Vec<LossClass> {
    let bounds: Vec<f64> = std::iter::once(0.0).chain(CLASSES).collect();
    let mut classes: Vec<LossClass> = (bounds.iter().enumerate())
        .map(|(k, from)| LossClass {
            from_s: *from,
            below_s: bounds.get(k + 1).copied(),
            count: 0,
            percent: 0.0,
        })
        .collect();
    for run in runs(force) {
        let part = run.end.min(range.end).saturating_sub(run.start.max(range.start));
        if part > 0 {
            let class = CLASSES
                .iter()
                .filter(|bound| run.len() >= fewest(**bound, step))
                .count();
            classes[class].count += 1;
            classes[class].percent += 100.0 * part as f64 / range.len() as f64;
        }
    }
    classes
}
