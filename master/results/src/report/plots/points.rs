//! Points that are pointed at one by one, and bounds beside them.

use plotly::common::{DashType, HoverInfo, Line, Marker, Mode};
use plotly::layout::{Axis, HoverMode};
use plotly::{Layout, Scatter};

use super::{TEXT, Trace, layout, logarithmic};

/// Colour of bounds and of published values.
pub const BOUND: &str = TEXT;

/// An axis with marks at values that were run, and no others.
pub fn marked_axis(title: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    // Without rounding noise.
    let texts = values.iter().map(|value| format!("{}", (1e6 * value).round() / 1e6));
    logarithmic(title).tick_text(texts.collect()).tick_values(values)
}

/// Layout of a figure whose points are pointed at one by one.
pub fn points(x: Axis, y: Axis) -> Layout {
    layout(x, y).hover_mode(HoverMode::Closest)
}

/// A curve through points with this text under the pointer: a line of a colour and a width in px, marks in colours of
/// their own.
pub fn marked(
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
pub fn open_points(points: impl IntoIterator<Item = (f64, f64)>, said: Vec<String>, colour: &'static str) -> Trace {
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
pub fn dotted(x: Vec<f64>, y: Vec<f64>, name: &str, colour: &'static str) -> Trace {
    Scatter::new(x, y)
        .mode(Mode::Lines)
        .name(name)
        .hover_info(HoverInfo::Name)
        .line(Line::new().color(colour).width(1.4).dash(DashType::Dot))
}
