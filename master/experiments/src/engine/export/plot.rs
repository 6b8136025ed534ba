//! Curves of the pages' plots.

use plotly::common::{DashType, HoverInfo, Line, Marker, Mode};
use plotly::layout::{Axis, HoverMode};
use plotly::{Layout, Scatter};

use crate::engine::table::{RunRow, Status};
use results::report::plots::{Trace, layout, logarithmic};

/// Colour of bounds and of published values.
pub(crate) const BOUND: &str = "#5b6675";

/// Title of axes of errors.
pub(crate) const ERROR: &str = "rms error of the filtered force [% of σ]";

/// An axis with marks at values that were run, and no others.
pub(crate) fn marked_axis(title: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    // Without rounding noise.
    let texts = values.iter().map(|value| format!("{}", (1e6 * value).round() / 1e6));
    logarithmic(title).tick_text(texts.collect()).tick_values(values)
}

/// Layout of a figure whose points are pointed at one by one.
pub(crate) fn points(x: Axis, y: Axis) -> Layout {
    layout(x, y).hover_mode(HoverMode::Closest)
}

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

/// A curve through points with this text under the pointer: a line of a colour and a width in px, marks in colours of
/// their own.
pub(crate) fn marked(
    points: impl IntoIterator<Item = (f64, f64)>,
    said: Vec<String>,
    (colour, width): (&'static str, f64),
    marks: Vec<&'static str>,
) -> Trace {
    let (x, y) = points.into_iter().unzip();
    let rim = Line::new().color(colour).width(1.6);
    Scatter::new(x, y)
        .mode(Mode::LinesMarkers)
        .hover_text_array(said)
        .hover_info(HoverInfo::Text)
        .line(Line::new().color(colour).width(width))
        .marker(Marker::new().color_array(marks).size(8).line(rim))
}

/// Points alone, open, with this text under the pointer.
pub(crate) fn open_points(
    points: impl IntoIterator<Item = (f64, f64)>,
    said: Vec<String>,
    colour: &'static str,
) -> Trace {
    let (x, y) = points.into_iter().unzip();
    let rim = Line::new().color(colour).width(1.4);
    Scatter::new(x, y)
        .mode(Mode::Markers)
        .hover_text_array(said)
        .hover_info(HoverInfo::Text)
        .show_legend(false)
        .marker(Marker::new().color("#ffffff").size(7).line(rim))
}

/// A dotted line with a name, which stands under the pointer too.
pub(crate) fn dotted(x: Vec<f64>, y: Vec<f64>, name: &str, colour: &'static str) -> Trace {
    Scatter::new(x, y)
        .mode(Mode::Lines)
        .name(name)
        .hover_info(HoverInfo::Name)
        .line(Line::new().color(colour).width(1.4).dash(DashType::Dot))
}
