//! Curves of the pages' plots.

use plotly::Scatter;
use plotly::common::{DashType, HoverInfo, Line, Marker, Mode};

/// A curve as plots take it.
pub(crate) type Trace = Box<Scatter<f64, f64>>;

/// Colour of bounds and of published values.
pub(crate) const BOUND: &str = "#5b6675";

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
