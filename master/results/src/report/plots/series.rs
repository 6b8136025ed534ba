//! Contact force against position, uplift against time.

use plotly::Scatter;
use plotly::common::{DashType, HoverInfo, Line, Mode, Visible};
use plotly::layout::RangeMode;

use super::{
    Curve, MARK, PALE, Trace, axis, band, colour, curve, figure, finished, layout, mark, name, rounded, stride,
    thinned, vertical,
};
use crate::LineGeometry;
use crate::report::escape;
use crate::report::label::NamedRun;

/// The first line geometry that is known.
fn geometry<'a>(curves: &[Curve<'a>]) -> Option<&'a LineGeometry> {
    curves
        .iter()
        .map(|c| &c.run.record.line)
        .find(|line| !line.support_x.is_empty())
}

pub(super) fn force(curves: &[Curve]) -> String {
    let finite = |c: &&Curve| !c.strip.force.is_empty();
    if !curves.iter().any(|c| finite(&c)) {
        return String::new();
    }
    let mut raw = Vec::new();
    let mut filtered = Vec::new();
    let mut shapes = Vec::new();
    let mut notes = Vec::new();
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut bands: Vec<(f64, f64)> = Vec::new();
    for (i, c) in curves.iter().enumerate().filter(|(_, c)| finite(c)) {
        let x = rounded(&c.strip.contact_x, 1e3);
        for v in x.iter().filter(|v| v.is_finite()) {
            from = from.min(*v);
            to = to.max(*v);
        }
        // One raw curve is helpful, several hide each other: they can be switched on.
        let visible = if curves.len() > 1 {
            Visible::LegendOnly
        } else {
            Visible::True
        };
        raw.push(
            curve(
                x.clone(),
                rounded(&c.strip.force, 1e2),
                &name("raw", &c.label),
                PALE[i % PALE.len()],
                1.0,
            )
            .visible(visible),
        );
        let evaluation = &c.run.summary.evaluation;
        if let Ok(force) = evaluation.filtered(&c.strip.force) {
            let what = format!("filtered {} Hz", evaluation.low_pass_hz);
            let stride = stride(evaluation);
            filtered.push(curve(
                thinned(&x, stride),
                rounded(&thinned(&force, stride), 1e2),
                &name(&what, &c.label),
                colour(i),
                1.8,
            ));
        }
        let range = evaluation.samples(&c.run.record.time, c.pantograph);
        if let Some(part) = x.get(range).filter(|part| !part.is_empty()) {
            let ends = (part[0], part[part.len() - 1]);
            // Pantographs of one run are evaluated over the same spans: one band for all of them.
            if !bands
                .iter()
                .any(|b| (b.0 - ends.0).abs() < 1.0 && (b.1 - ends.1).abs() < 1.0)
            {
                bands.push(ends);
            }
        }
    }
    shapes.extend(bands.iter().map(|(a, b)| band(*a, *b)));
    if let Some(line) = geometry(curves) {
        let inside = |x: &f64| (from..=to).contains(x);
        for (k, x) in line.support_x.iter().enumerate().filter(|(_, x)| inside(x)) {
            shapes.push(vertical(*x, 1.0, MARK, DashType::Dot));
            notes.push(mark(*x, &(k + 1).to_string()));
        }
        for x in line.dropper_x.iter().filter(|x| inside(x)) {
            shapes.push(vertical(*x, 0.035, MARK, DashType::Solid));
        }
    }
    raw.extend(filtered);
    let elevation = elevation(curves, (from, to));
    let drawn = !elevation.is_empty();
    raw.extend(elevation);
    // Grid lines would hide the supports.
    let x_axis = axis("position of the contact along the track [m]")
        .zero_line(false)
        .show_grid(false);
    let y_axis = axis("contact force [N]").range_mode(RangeMode::ToZero);
    let mut layout = layout(x_axis, if drawn { y_axis.domain(&[0.0, 0.68]) } else { y_axis });
    let above = if drawn {
        "Above: the line at the start of the run, heights enlarged. "
    } else {
        ""
    };
    if drawn {
        let heights = axis("height [m]").zero_line(false).domain(&[0.74, 1.0]);
        layout = layout.y_axis2(heights);
    }
    figure(
        raw,
        layout.shapes(shapes).annotations(notes),
        ("plot-force", if drawn { 540 } else { 420 }),
        &format!(
            "{above}Dotted lines: supports with their numbers. Ticks along the axis: droppers. Shaded: evaluation \
             range. In all plots: drag to zoom, double-click to go back, click in the legend to switch a curve."
        ),
    )
}

/// Wires and droppers at the start of the first run that has pictures, from `from` to `to` (m), over the upper axis;
/// nothing without pictures.
fn elevation(curves: &[Curve], (from, to): (f64, f64)) -> Vec<Trace> {
    let frames = curves.iter().map(|c| &c.run.record.animation.frames);
    let Some(frame) = frames.filter_map(|frames| frames.first()).next() else {
        return Vec::new();
    };
    let inside = |x: f64| (from..=to).contains(&x);
    let line = |points: &[(f64, f64)], name: &str, colour: &'static str, width: f64| {
        let shown: Vec<(f64, f64)> = points.iter().copied().filter(|(x, _)| inside(*x)).collect();
        let (x, z): (Vec<f64>, Vec<f64>) = shown.into_iter().unzip();
        curve(rounded(&x, 1e2), rounded(&z, 1e4), name, colour, width)
            .y_axis("y2")
            .show_legend(false)
            .hover_info(HoverInfo::Skip)
    };
    const WIRE: &str = "#5b6675";
    let mut traces = vec![
        line(&frame.messenger_wire, "messenger wire", WIRE, 1.0),
        line(&frame.contact_wire, "contact wire", WIRE, 1.8),
    ];
    traces.extend((frame.further_wires.iter()).map(|(contact, points)| {
        let (name, width) = if *contact { ("contact wire", 1.8) } else { ("wire", 1.0) };
        line(points, name, WIRE, width)
    }));
    // Gaps between droppers are values that are none.
    let ends = (frame.droppers.iter())
        .filter(|dropper| inside(dropper.top.0))
        .flat_map(|dropper| [dropper.top, dropper.bottom, (dropper.bottom.0, f64::NAN)]);
    let (x, z): (Vec<f64>, Vec<f64>) = ends.unzip();
    let droppers = curve(rounded(&x, 1e2), rounded(&z, 1e4), "droppers", WIRE, 0.7);
    traces.push(droppers.y_axis("y2").show_legend(false).hover_info(HoverInfo::Skip));
    traces
}

/// Filtered force of each further run less that of the first one at the same place, over the evaluation range of both;
/// nothing for one run.
pub(super) fn difference(curves: &[Curve]) -> String {
    let filtered = |c: &Curve| {
        let (evaluation, time) = (&c.run.summary.evaluation, &c.run.record.time);
        let force = evaluation.evaluated(time, c.pantograph, &c.strip.force)?;
        let x = c.strip.contact_x.get(evaluation.samples(time, c.pantograph))?;
        Some((x.to_vec(), force))
    };
    let mut traces = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        let first = curves.iter().find(|other| other.pantograph == c.pantograph);
        let Some(first) = first.filter(|first| !std::ptr::eq(first.run, c.run)) else {
            continue;
        };
        let (Some((places, reference)), Some((x, force))) = (filtered(first), filtered(c)) else {
            continue;
        };
        let points = x.iter().zip(&force).filter_map(|(x, force)| {
            let reference = at_place(&places, &reference, *x)?;
            Some((*x, force - reference))
        });
        let (x, difference): (Vec<f64>, Vec<f64>) = points.unzip();
        if x.is_empty() {
            continue;
        }
        let stride = stride(&c.run.summary.evaluation);
        let label = format!("{} less {}", c.label, first.label);
        let (x, difference) = (thinned(&x, stride), thinned(&difference, stride));
        traces.push(curve(
            rounded(&x, 1e3),
            rounded(&difference, 1e3),
            &label,
            colour(i),
            1.4,
        ));
    }
    let x_axis = axis("position of the contact along the track [m]").zero_line(false);
    figure(
        traces,
        layout(x_axis, axis("difference of the filtered force [N]")),
        ("plot-difference", 300),
        "Filtered force less that of the first run that has the same pantograph, at the same place.",
    )
}

/// Value at place `x` between samples whose places rise; nothing beyond them.
fn at_place(places: &[f64], values: &[f64], x: f64) -> Option<f64> {
    let next = places.partition_point(|place| *place < x);
    if next == 0 {
        return (places.first() == Some(&x)).then(|| values[0]);
    }
    let (to, from) = (*places.get(next)?, places[next - 1]);
    let share = if to > from { (x - from) / (to - from) } else { 1.0 };
    Some(values[next - 1] + share * (values[next] - values[next - 1]))
}

/// Filtered force as instruments measure it beside the true one, over the evaluation range; nothing without
/// instruments.
pub(super) fn measured(curves: &[Curve]) -> String {
    let mut traces = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        let (evaluation, time) = (&c.run.summary.evaluation, &c.run.record.time);
        let Some(instrument) = &c.run.summary.instrument else {
            continue;
        };
        let Some((times, force)) = instrument.filtered(c.strip, evaluation, time) else {
            continue;
        };
        let Ok(truth) = evaluation.filtered(&c.strip.force) else {
            continue;
        };
        let sampled = thinned(&c.strip.contact_x, instrument.stride);
        let mut add = |x: &[f64], force: &[f64], range: std::ops::Range<usize>, what: &str, colour| {
            if let (Some(x), Some(force)) = (x.get(range.clone()), force.get(range)) {
                let (x, force) = (rounded(x, 1e3), rounded(force, 1e2));
                traces.push(curve(x, force, &name(what, &c.label), colour, 1.6));
            }
        };
        let range = evaluation.samples(time, c.pantograph);
        add(&c.strip.contact_x, &truth, range, "contact force", PALE[i % PALE.len()]);
        add(
            &sampled,
            &force,
            evaluation.samples(&times, c.pantograph),
            "measured",
            colour(i),
        );
    }
    let x_axis = axis("position of the contact along the track [m]").zero_line(false);
    figure(
        traces,
        layout(x_axis, axis("filtered force [N]")),
        ("plot-measured", 320),
        "Both filtered alike, over the evaluation range.",
    )
}

pub(super) fn uplift(runs: &[NamedRun<'_>]) -> String {
    let mut traces = Vec::new();
    const DASHES: [DashType; 4] = [DashType::Solid, DashType::Dash, DashType::Dot, DashType::DashDot];
    for (r, run) in runs.iter().enumerate() {
        for (k, support) in run.record.supports.iter().enumerate() {
            if support.uplift.is_empty() {
                continue;
            }
            // One run: colours tell the supports apart. Several: colours are runs, dashes supports.
            let (index, dash) = if runs.len() > 1 { (r, k % DASHES.len()) } else { (k, 0) };
            let line = Line::new().color(colour(index)).width(1.6).dash(DASHES[dash].clone());
            let label = if runs.len() > 1 {
                escape(&run.label)
            } else {
                String::new()
            };
            let millimetres: Vec<f64> = support.uplift.iter().map(|u| 1e3 * u).collect();
            let stride = stride(&run.summary.evaluation);
            let [time, rise] = [&run.record.time, &millimetres].map(|series| thinned(series, stride));
            let trace = Scatter::new(rounded(&time, 1e4), rounded(&rise, 1e2))
                .mode(Mode::Lines)
                .name(name(&format!("support {}", support.number), &label))
                .line(line);
            traces.push(trace);
        }
    }
    if traces.is_empty() {
        return String::new();
    }
    finished(
        traces,
        layout(axis("time [s]").zero_line(false), axis("uplift [mm]")),
        "plot-uplift",
        320,
    )
}

/// Height of the contact wire where it is touched, against the position.
pub(super) fn heights(curves: &[Curve]) -> String {
    let touched = curves.iter().enumerate().filter(|(_, c)| !c.strip.wire_z.is_empty());
    let traces = touched.map(|(i, c)| {
        let stride = stride(&c.run.summary.evaluation);
        let [x, z] = [&c.strip.contact_x, &c.strip.wire_z].map(|series| thinned(series, stride));
        let (x, z) = (rounded(&x, 1e3), rounded(&z, 1e4));
        curve(x, z, &name("contact wire", &c.label), colour(i), 1.4)
    });
    let traces: Vec<_> = traces.collect();
    let mut shapes = Vec::new();
    let mut notes = Vec::new();
    if let Some(line) = geometry(curves) {
        for (k, x) in line.support_x.iter().enumerate() {
            let passed = curves.iter().any(|c| {
                let at = c.strip.contact_x.partition_point(|place| place < x);
                at > 0 && at < c.strip.contact_x.len()
            });
            if passed {
                shapes.push(vertical(*x, 1.0, MARK, DashType::Dot));
                notes.push(mark(*x, &(k + 1).to_string()));
            }
        }
    }
    let x_axis = axis("position of the contact along the track [m]")
        .zero_line(false)
        .show_grid(false);
    let y_axis = axis("height above the rail [m]").zero_line(false);
    figure(
        traces,
        layout(x_axis, y_axis).shapes(shapes).annotations(notes),
        ("plot-height", 300),
        "Height of the contact wire at the strip. Dotted lines: supports.",
    )
}

/// Drag and lift of the wind on the bodies that carry the strips; empty where there is none.
pub(super) fn wind(curves: &[Curve]) -> String {
    let mut traces = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        let Some(wind) = &c.strip.wind else { continue };
        let time = rounded(&c.run.record.time, 1e4);
        for (what, force, index) in [("drag", &wind.drag, 2 * i), ("lift", &wind.lift, 2 * i + 1)] {
            let name = name(what, &c.label);
            traces.push(curve(time.clone(), rounded(force, 1e2), &name, colour(index), 1.4));
        }
    }
    figure(
        traces,
        layout(axis("time [s]").zero_line(false), axis("force of the wind [N]")),
        ("plot-wind", 320),
        "On the body that carries the strip: drag along the air that meets it, lift across it, positive upward.",
    )
}

/// Force of controlled drives; empty where there is none.
pub(super) fn control(curves: &[Curve]) -> String {
    let mut traces = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        let Some(force) = &c.strip.control else { continue };
        let time = rounded(&c.run.record.time, 1e4);
        traces.push(curve(
            time,
            rounded(force, 1e2),
            &name("drive", &c.label),
            colour(i),
            1.4,
        ));
    }
    figure(
        traces,
        layout(axis("time [s]").zero_line(false), axis("drive [N, on a joint N m]")),
        ("plot-control", 320),
        "Force of the drive that the controller commands, positive upward, beside the constant raising force; its \
         moment where it turns a joint.",
    )
}
