//! The plots of the report.

mod distribution;
mod labels;
mod points;
mod series;

pub use distribution::density;

use plotly::color::NamedColor;
use plotly::common::{Anchor, DashType, ExponentFormat, Font, Line, Mode, Orientation, Title};
use plotly::configuration::DisplayModeBar;
use plotly::layout::{Annotation, Axis, AxisType, HoverMode, Legend, Margin, Shape, ShapeLayer, ShapeLine, ShapeType};
use plotly::{Configuration, Layout, Plot, Scatter};

use serde_json::Value;

use super::{Library, escape, figure_html};
use crate::report::label::NamedRun;
use crate::{Evaluation, RunBundle, StripRecord};

pub use labels::Labels;
pub use points::{BOUND, dotted, marked, marked_axis, open_points, points};

/// Colours of the curves, told apart with colour-blind eyes too; repeated when used up.
pub const COLOURS: [&str; 7] = [
    "#1f5fa8", "#d1661b", "#1d7a46", "#a0338a", "#8a6d00", "#3aa0c4", "#b3261e",
];

/// Colours of the raw force behind the filtered one of the same run.
const PALE: [&str; 7] = [
    "#b5cbe4", "#f0cbae", "#b3d6c1", "#e0bcd9", "#dcd09f", "#bfe1ed", "#e6b8b5",
];

/// A curve as plots take it.
pub type Trace = Box<Scatter<f64, f64>>;

const GRID: &str = "#e6eaee";
const MARK: &str = "#aeb7c2";
const TEXT: &str = "#5b6675";
const SHADE: &str = "#eef4fa";

/// One contact of one run.
struct Curve<'a> {
    label: String,
    strip: &'a StripRecord,
    /// Number among the pantographs of its run, from 0.
    pantograph: usize,
    run: &'a RunBundle,
}

/// The contacts of all runs.
fn curves<'a>(runs: &'a [NamedRun<'a>]) -> Vec<Curve<'a>> {
    let mut curves = Vec::new();
    for run in runs {
        let several = run.record.pantographs.len() > 1;
        for (pantograph, strip) in run.record.pantographs.iter().enumerate() {
            let mut parts = Vec::new();
            if runs.len() > 1 {
                parts.push(escape(&run.label));
            }
            if several {
                parts.push(format!("pantograph {}", pantograph + 1));
            }
            curves.push(Curve {
                label: parts.join(", "),
                strip,
                pantograph,
                run: run.bundle,
            });
        }
    }
    curves
}

/// Joins what is drawn and the label of a curve.
fn name(what: &str, label: &str) -> String {
    if label.is_empty() {
        what.to_owned()
    } else {
        format!("{what}, {label}")
    }
}

/// Rounds for drawing, which keeps the page small: `per` steps per unit.
pub fn rounded(values: &[f64], per: f64) -> Vec<f64> {
    values.iter().map(|v| (v * per).round() / per).collect()
}

/// Samples of a filtered signal that draw it: ten in a period of the cut-off frequency.
pub(super) fn stride(evaluation: &Evaluation) -> usize {
    let wanted = 0.1 / (evaluation.low_pass_hz * evaluation.output_step);
    if wanted.is_finite() {
        (wanted as usize).max(1)
    } else {
        1
    }
}

/// Every `stride`-th value.
fn thinned(values: &[f64], stride: usize) -> Vec<f64> {
    values.iter().step_by(stride).copied().collect()
}

/// Axis with a title and a light grid.
pub fn axis(title: &str) -> Axis {
    Axis::new()
        .title(Title::with_text(title))
        .grid_color(GRID)
        .zero_line_color(MARK)
        .line_color(MARK)
        .show_line(true)
        .auto_margin(true)
}

/// Powers of ten only.
pub fn decades(title: &str) -> Axis {
    logarithmic(title).dtick(1.0)
}

/// Powers of ten, and where these values span less than two of them also twice and five times as much: one number alone
/// is no scale.
pub fn decades_of(title: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    match ticks(values) {
        Some(ticks) => {
            let texts = ticks.iter().map(|tick| format!("{tick}")).collect();
            logarithmic(title).tick_values(ticks).tick_text(texts)
        }
        None => decades(title),
    }
}

/// Smallest and largest of these values, which are positive.
pub fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let values = values.into_iter();
    values.fold([f64::INFINITY, 0.0], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Ticks at once, twice and five times the powers of ten around these values; nothing where they span two decades or
/// more, or none is positive.
fn ticks(values: impl IntoIterator<Item = f64>) -> Option<Vec<f64>> {
    let shown = values.into_iter().filter(|value| value.is_finite() && *value > 0.0);
    let [low, high] = extent(shown);
    if high <= 0.0 || high >= 100.0 * low {
        return None;
    }
    let [from, to] = [low, high].map(|value| value.log10().floor() as i32);
    let ticks = (from - 1..=to + 1).flat_map(|power| {
        // Read as decimal numbers, so that they are written as such.
        ["1", "2", "5"].map(|digit| format!("{digit}e{power}").parse().expect("a digit and a power of ten"))
    });
    Some(ticks.collect())
}

/// Logarithmic, powers of ten written as powers.
pub fn logarithmic(title: &str) -> Axis {
    axis(title)
        .type_(AxisType::Log)
        .zero_line(false)
        .exponent_format(ExponentFormat::Power)
}

/// Layout of a figure with these axes.
pub fn layout(x: Axis, y: Axis) -> Layout {
    Layout::new()
        .x_axis(x)
        .y_axis(y)
        .auto_size(true)
        .margin(Margin::new().left(56).right(12).top(30).bottom(46))
        .font(
            Font::new()
                .family("system-ui, -apple-system, Segoe UI, Roboto, sans-serif")
                .size(13),
        )
        .hover_mode(HoverMode::X)
        .plot_background_color(NamedColor::White)
        .legend(
            Legend::new()
                .orientation(Orientation::Horizontal)
                .x(0.0)
                .y(1.06)
                .y_anchor(Anchor::Bottom),
        )
        .show_legend(true)
}

/// Colour of the curve of this number.
pub fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}

/// [`finished`] with its caption, which is HTML; nothing where nothing is drawn.
pub fn figure(traces: Vec<Trace>, layout: Layout, (id, height): (&str, u32), caption: &str) -> String {
    if traces.is_empty() {
        return String::new();
    }
    let drawn = finished(traces, layout, id, height);
    format!("{drawn}<p class=\"caption\">{caption}</p>\n")
}

/// Figure of `height` px as HTML with this `id`; plotly.js itself is elsewhere on the page.
pub fn finished(traces: impl IntoIterator<Item = Trace>, layout: Layout, id: &str, height: u32) -> String {
    let mut plot = Plot::new();
    for trace in traces {
        plot.add_trace(trace);
    }
    plot.set_layout(layout);
    plot.set_configuration(
        Configuration::new()
            .responsive(true)
            .display_logo(false)
            .display_mode_bar(DisplayModeBar::False),
    );
    let figure = plot.to_json();
    figure_html(&figure, (id, &axes_text(&figure)), height, Library::Curves)
}

/// Titles of the axes of a figure, in words.
fn axes_text(figure: &str) -> String {
    let figure: Value = serde_json::from_str(figure).unwrap_or_default();
    let title = |axis: &str| {
        let title = &figure["layout"][axis]["title"];
        title["text"].as_str().unwrap_or_default().to_owned()
    };
    format!("{} over {}", title("yaxis"), title("xaxis"))
}

/// A line through points, with a name, of a colour and a width in px.
pub fn curve(x: Vec<f64>, y: Vec<f64>, name: &str, colour: &'static str, width: f64) -> Trace {
    Scatter::new(x, y)
        .mode(Mode::Lines)
        .name(name)
        .line(Line::new().color(colour).width(width))
}

/// A vertical line over the whole height, or over the lowest `share` of it.
fn vertical(x: f64, share: f64, colour: &'static str, dash: DashType) -> Shape {
    Shape::new()
        .shape_type(ShapeType::Line)
        .layer(ShapeLayer::Below)
        .x_ref("x")
        .y_ref("paper")
        .x0(x)
        .x1(x)
        .y0(0.0)
        .y1(share)
        .line(ShapeLine::new().color(colour).width(1.0).dash(dash))
}

/// A shaded band from `a` to `b` on the x axis.
fn band(a: f64, b: f64) -> Shape {
    Shape::new()
        .shape_type(ShapeType::Rect)
        .layer(ShapeLayer::Below)
        .x_ref("x")
        .y_ref("paper")
        .x0(a)
        .x1(b)
        .y0(0.0)
        .y1(1.0)
        .fill_color(SHADE)
        .line(ShapeLine::new().width(0.0))
}

/// A small text above the plot area at `x`, in the coordinates of the axis.
fn mark(x: f64, text: &str) -> Annotation {
    Annotation::new()
        .x_ref("x")
        .y_ref("paper")
        .x(x)
        .y(1.0)
        .y_anchor(Anchor::Bottom)
        .text(text)
        .show_arrow(false)
        .font(Font::new().size(11).color(TEXT))
}

/// Figures of the report, as HTML; empty where there are no data.
pub(super) struct Figures {
    /// Force along the track.
    pub force: String,
    /// Measured force beside the true one.
    pub measured: String,
    /// Uplift at the supports, height of the contact along the track.
    pub heights: String,
    /// Wind on the heads.
    pub wind: String,
    /// Force of controlled drives.
    pub control: String,
    /// Spectrum and histogram.
    pub distribution: String,
}

impl Figures {
    /// Figures of `runs`.
    pub(super) fn of(runs: &[NamedRun<'_>]) -> Self {
        let curves = curves(runs);
        let spectrum = distribution::spectrum(&curves);
        let histogram = distribution::histogram_plot(&curves);
        let pair = if spectrum.is_empty() && histogram.is_empty() {
            String::new()
        } else {
            format!(
                "<div class=\"pair\"><div><h3>Power spectral density of the raw force</h3>{spectrum}</div>\n\
                 <div><h3>Histogram</h3>{histogram}</div></div>\n\
                 <p class=\"caption\">Both over the evaluation range. Spectrum: mean removed, Hann window.</p>\n"
            )
        };
        Self {
            force: series::force(&curves) + &series::difference(&curves),
            measured: series::measured(&curves),
            heights: series::heights(&curves) + &series::uplift(runs),
            wind: series::wind(&curves),
            control: series::control(&curves),
            distribution: pair,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_axis_has_more_ticks_than_its_powers_of_ten() {
        let found = ticks([0.3, 2.0, 0.0, f64::NAN]).unwrap();
        assert_eq!(found[..4], [0.01, 0.02, 0.05, 0.1]);
        assert_eq!(found.iter().filter(|tick| (0.3..=2.0).contains(*tick)).count(), 3);
        assert_eq!(ticks([0.01, 1.0]), None);
        assert_eq!(ticks([0.0]), None);
    }
}
