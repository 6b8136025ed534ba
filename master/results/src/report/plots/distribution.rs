//! Spectrum and histogram of the contact force.

use plotly::common::{DashType, ExponentFormat, Fill, Line, LineShape};
use plotly::layout::{AxisType, ShapeLayer};

use super::{COLOURS, Curve, PALE, TEXT, Trace, axis, curve, finished, layout, mark, name, rounded, vertical};
use crate::statistics::{Spectrum, histogram, power_spectral_density};
use crate::{Evaluation, LineGeometry};

/// Highest frequency in the spectrum, Hz: contact forces are simulated and measured below it.
const MAX_FREQUENCY: f64 = 100.0;

/// Force of the evaluation range, as recorded.
fn evaluated<'a>(c: &Curve<'a>) -> &'a [f64] {
    let range = c.run.summary.evaluation.samples(&c.run.record.time, c.pantograph);
    c.strip.force.get(range).unwrap_or_default()
}

/// Frequency at which spans are passed, Hz; `None` where supports are not known.
fn span_frequency(line: &LineGeometry, evaluation: &Evaluation) -> Option<f64> {
    let [first, .., last] = line.support_x.as_slice() else {
        return None;
    };
    let span = (last - first) / (line.support_x.len() - 1) as f64;
    (span > 0.0 && evaluation.speed > 0.0).then_some(evaluation.speed / span)
}

/// Density up to the frequency `highest` (Hz), for logarithmic axes.
pub fn density(spectrum: &Spectrum, highest: f64, name: &str, colour: &'static str) -> Trace {
    let last = spectrum.frequency.partition_point(|frequency| *frequency <= highest);
    // Four significant digits; the line at zero frequency has no place on a logarithmic axis.
    let lines = 1..last.max(1);
    let density = spectrum.density[lines.clone()].iter();
    let density = density.map(|d| format!("{d:.3e}").parse().unwrap_or(*d)).collect();
    curve(rounded(&spectrum.frequency[lines], 1e4), density, name, colour, 1.3)
}

pub(super) fn spectrum(curves: &[Curve]) -> String {
    let mut traces = Vec::new();
    let mut shapes = Vec::new();
    let mut notes = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        let evaluation = &c.run.summary.evaluation;
        let Some(spectrum) = power_spectral_density(evaluated(c), evaluation.output_step) else {
            continue;
        };
        let label = if c.label.is_empty() { "raw" } else { &c.label };
        traces.push(density(&spectrum, MAX_FREQUENCY, label, COLOURS[i % COLOURS.len()]));
        if shapes.is_empty() {
            let span = span_frequency(&c.run.record.line, evaluation);
            for (f, text) in [(span, "span passing"), (Some(evaluation.low_pass_hz), "low-pass")] {
                if let Some(f) = f.filter(|f| *f > 0.0) {
                    shapes.push(vertical(f, 1.0, TEXT, DashType::Dash).layer(ShapeLayer::Above));
                    // Annotations on a logarithmic axis are placed by the logarithm.
                    notes.push(mark(f.log10(), text));
                }
            }
        }
    }
    if traces.is_empty() {
        return String::new();
    }
    let x = axis("frequency [Hz]").type_(AxisType::Log);
    let y = axis("density [N²/Hz]")
        .type_(AxisType::Log)
        .exponent_format(ExponentFormat::Power);
    let layout = layout(x, y)
        .shapes(shapes)
        .annotations(notes)
        .show_legend(curves.len() > 1);
    finished(traces, layout, "plot-spectrum", 340)
}

/// A width from 1, 2, 5, 10, 20 … N that divides `range` (N) into about forty intervals.
fn bin_width(range: f64) -> f64 {
    let wanted = (range / 40.0).max(1e-3);
    let decade = 10.0_f64.powf(wanted.log10().floor());
    let digit = wanted / decade;
    decade
        * if digit <= 1.0 {
            1.0
        } else if digit <= 2.0 {
            2.0
        } else if digit <= 5.0 {
            5.0
        } else {
            10.0
        }
}

pub(super) fn histogram_plot(curves: &[Curve]) -> String {
    let samples: Vec<(usize, &Curve, &[f64])> = curves.iter().enumerate().map(|(i, c)| (i, c, evaluated(c))).collect();
    let values = || {
        samples
            .iter()
            .flat_map(|(_, _, force)| force.iter().copied())
            .filter(|f| f.is_finite())
    };
    let (Some(low), Some(high)) = (values().reduce(f64::min), values().reduce(f64::max)) else {
        return String::new();
    };
    let width = bin_width(high - low);
    let mut traces = Vec::new();
    let mut add = |force: &[f64], name: &str, colour: &'static str, fill: bool| {
        let Some(h) = histogram(force, width) else {
            return;
        };
        // A closed outline: zero on both sides.
        let edges = (0..=h.percent.len() + 1).map(|j| h.start + h.width * (j as f64 - 1.0));
        let mut x: Vec<f64> = edges.collect();
        let mut y = vec![0.0];
        y.extend(&h.percent);
        y.push(0.0);
        x = rounded(&x, 1e4);
        let mut trace = curve(x, rounded(&y, 1e3), name, colour, 1.6)
            .line(Line::new().color(colour).width(1.6).shape(LineShape::Hv));
        if fill {
            trace = trace.fill(Fill::ToZeroY).fill_color(PALE[0]);
        }
        traces.push(trace);
    };
    let one = curves.len() == 1;
    for (i, c, raw) in &samples {
        let evaluation = &c.run.summary.evaluation;
        if let Some(part) = evaluation.evaluated(&c.run.record.time, c.pantograph, &c.strip.force) {
            add(&part, &name("filtered", &c.label), COLOURS[i % COLOURS.len()], one);
        }
        if one {
            add(raw, &name("raw", &c.label), COLOURS[1], false);
        }
    }
    let x = axis("contact force [N]").zero_line(false);
    let y = axis("share of the samples [%]");
    finished(traces, layout(x, y), "plot-histogram", 340)
}
