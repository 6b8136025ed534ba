//! Figures of a force by stretch of track: spans, tension lengths.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{ForceStatistics, loss_of_contact_percent};

/// Figures of one pantograph on a stretch of track.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    /// Number of the span or tension length, from 1.
    pub number: usize,
    /// First place that was evaluated, m.
    pub from_m: f64,
    /// Last place that was evaluated, m.
    pub to_m: f64,
    /// Filtered force, N.
    pub filtered: Option<ForceStatistics>,
    /// Share of the time without raw force, %.
    pub loss_of_contact_percent: Option<f64>,
}

/// Figures on the stretches between these places (m), as far as samples of `range` lie there: places of the contact in
/// m, `filtered` and `raw` force in N. A place that two stretches share belongs to the second, that of the end to the
/// last.
#[must_use]
pub fn stretches(ends: &[(f64, f64)], x: &[f64], [filtered, raw]: [&[f64]; 2], range: &Range<usize>) -> Vec<Stretch> {
    let last = ends.iter().fold(f64::NEG_INFINITY, |last, (_, to)| last.max(*to));
    let mut found = Vec::new();
    for (number, (from, to)) in (1..).zip(ends) {
        let inside = |k: &usize| x[*k] >= *from && (x[*k] < *to || (x[*k] == *to && *to == last));
        let samples: Vec<usize> = range.clone().filter(inside).collect();
        let (Some(first), Some(end)) = (samples.first(), samples.last()) else {
            continue;
        };
        // The sample on the edge of the evaluated range is no figure of the stretch before.
        if first == end && range.len() > 1 {
            continue;
        }
        let of = |force: &[f64]| samples.iter().map(|k| force[*k]).collect::<Vec<_>>();
        found.push(Stretch {
            number,
            from_m: x[*first],
            to_m: x[*end],
            filtered: (filtered.len() == x.len())
                .then(|| ForceStatistics::of(&of(filtered)))
                .flatten(),
            loss_of_contact_percent: loss_of_contact_percent(&of(raw)),
        });
    }
    found
}
