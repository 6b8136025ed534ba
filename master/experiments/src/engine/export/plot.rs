//! Curves of the pages' plots.

use crate::engine::table::{RunRow, Status};
use results::report::plots::{Trace, marked};

/// Title of axes of errors.
pub(crate) const ERROR: &str = "rms error of the filtered force [% of σ]";

/// `true` where a run that has ended has a place on logarithmic axes.
pub(crate) fn is_shown((at, row): &((f64, f64), &RunRow)) -> bool {
    let ended = row.status.is_some_and(|status| status != Status::Refused);
    ended && at.0 > 0.0 && at.1 > 0.0
}

/// A curve through the runs that are shown, each with its place and a text under the pointer; open marks where a run is
/// not stable. Nothing where none is shown.
pub(crate) fn run_curve<'a>(
    runs: impl IntoIterator<Item = ((f64, f64), &'a RunRow)>,
    said: impl Fn(&RunRow) -> String,
    colour: &'static str,
    width: f64,
) -> Option<Trace> {
    let runs: Vec<_> = runs.into_iter().filter(is_shown).collect();
    let mark = |(_, row): &(_, &RunRow)| if row.is_stable() { colour } else { "#ffffff" };
    let said = runs.iter().map(|(_, row)| said(row)).collect();
    let points = runs.iter().map(|(at, _)| *at);
    let curve = || marked(points, said, (colour, width), runs.iter().map(mark).collect());
    (!runs.is_empty()).then(curve)
}
