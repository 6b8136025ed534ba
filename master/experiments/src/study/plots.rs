//! The diagrams of the page.

use plotly::Scatter;
use plotly::common::{DashType, Font, Line, Marker, Mode as Draw, Position};
use plotly::layout::HoverMode;

use super::labels::Labels;
use super::options::Sweep;
use super::outcome::{Entry, Study};
use super::pareto::point;
use super::run_spec::{Class, Family};
use super::text::shortened;
use crate::engine::export::plot::{BOUND, Trace, dotted, marked, open_points};
use crate::engine::export::{grouped, number};
use crate::engine::table::{RunRow, Status, milliseconds};
use results::report::plots::{COLOURS, decades_of, finished, layout, logarithmic};

/// Title of axes of error.
const ERROR: &str = "rms error of the filtered force [% of σ]";

fn hover(study: &Study, row: &RunRow) -> String {
    format!(
        "{}<br>{} % of σ, real-time factor {}, {} s",
        study.label(row),
        number(row.filtered_error),
        number(row.real_time_factor),
        number(row.wall)
    )
}

/// Name of a point of the front: elements per dropper interval or their length, micro step, what differs from the best
/// mesh, coupling.
fn short_name(study: &Study, row: &RunRow, usual: &str) -> String {
    let mut name = match (row.element_length, row.elements_per_span) {
        (Some(length), _) => format!("{length:.2} m, "),
        (None, Some(count)) => format!("{}, ", count / study.intervals.max(1) as u64),
        (None, None) => String::new(),
    };
    name.push_str(&format!("{} ms", milliseconds(row.micro_step)));
    if row.mesh != usual {
        name.push_str(&format!(", {}", shortened(&row.mesh)));
    }
    if let Some(step) = row.macro_step {
        name.push_str(&format!(", {} {} ms", row.algorithm, milliseconds(Some(step))));
    }
    name
}

/// The mesh that most rows of the front have.
fn usual_mesh(study: &Study) -> String {
    let front = || {
        study
            .rows
            .iter()
            .filter(|entry| entry.pareto)
            .map(|entry| entry.row.mesh.as_str())
    };
    let most = front().max_by_key(|mesh| front().filter(|other| other == mesh).count());
    most.unwrap_or("plain").to_owned()
}

/// Error against real-time factor: every run that has both, the front of each class as a line.
pub(super) fn precision(study: &Study) -> String {
    let points: Vec<(&Entry, (f64, f64))> = study
        .rows
        .iter()
        .filter(|entry| entry.sweep != Sweep::Vehicle.name())
        .filter_map(|entry| Some((entry, point(&entry.row)?)))
        .filter(|(_, (_, error))| *error > 0.0)
        .collect();
    if points.is_empty() {
        return String::new();
    }
    let usual = usual_mesh(study);
    let mut classes: Vec<Class> = points
        .iter()
        .map(|(entry, _)| Class::of(&entry.row.reduction))
        .collect();
    classes.sort();
    classes.dedup();
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = || points.iter().map(move |(_, point)| of(point));
        (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max))
    };
    let ((fastest, slowest), (best, worst)) = (range(|point| point.0), range(|point| point.1));
    let (low, high) = (fastest / 1.3, slowest * 1.6);
    let mut labels = Labels::new((low, best), (high, worst));
    let mut traces = Vec::new();
    for (index, class) in classes.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let of_class = || {
            points
                .iter()
                .filter(|(entry, _)| Class::of(&entry.row.reduction) == *class)
        };
        let others: Vec<_> = of_class().filter(|(entry, _)| !entry.pareto).collect();
        let said = others.iter().map(|(entry, _)| hover(study, &entry.row)).collect();
        traces.push(open_points(others.iter().map(|(_, point)| *point), said, colour));
        let mut front: Vec<_> = of_class().filter(|(entry, _)| entry.pareto).collect();
        front.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let said = front.iter().map(|(entry, _)| hover(study, &entry.row)).collect();
        let names = front
            .iter()
            .map(|(entry, at)| labels.set(*at, short_name(study, &entry.row, &usual)))
            .collect();
        let curve = marked(
            front.iter().map(|(_, point)| *point),
            said,
            (colour, 2.2),
            vec![colour; front.len()],
        );
        traces.push(
            curve
                .mode(Draw::LinesMarkersText)
                .name(class.name())
                .text_array(names)
                .text_position(Position::TopRight)
                .text_font(Font::new().size(11).color(colour)),
        );
    }
    if let Some(reference) = study.reference(Family::Nonlinear)
        && let Some(uncertainty) = reference.uncertainty_percent.filter(|percent| *percent > 0.0)
    {
        let name = format!("what is not known of the nonlinear reference: {uncertainty:.2} %");
        traces.push(dotted(vec![low, high], vec![uncertainty; 2], &name, BOUND));
    }
    let layout = layout(
        decades_of(
            "real-time factor: wall time of the time loop over simulated time",
            [fastest, slowest],
        ),
        decades_of(ERROR, [best, worst]),
    );
    format!(
        "{}<p class=\"caption\">Lower left is better. Filled: the Pareto front of its class, named where there is room \
         (elements per dropper interval or their length, micro step{}); open: all other runs. Each class is judged by \
         the reference of its own model. Wall time in seconds is {:.2} times the real-time factor.</p>\n",
        finished(traces, layout.hover_mode(HoverMode::Closest), "plot-precision", 560),
        match usual.as_str() {
            "plain" => String::new(),
            _ => format!(
                "; mesh {} = {} unless another one is named",
                shortened(&usual),
                results::report::escape(&usual)
            ),
        },
        study.simulated_s
    )
}

/// Curves of error over `x` through the rows of a sweep, one for each name.
fn sweep(
    study: &Study,
    rows: &[&Entry],
    x: impl Fn(&RunRow) -> Option<f64>,
    name: impl Fn(&RunRow) -> String,
) -> Vec<Trace> {
    let curves = grouped(rows.iter().filter_map(|entry| {
        let row = &entry.row;
        let ended = matches!(row.status, Some(Status::Stable | Status::Limit | Status::Diverged));
        let at = x(row).zip(row.filtered_error);
        let (at, error) = at.filter(|(at, error)| ended && *at > 0.0 && *error > 0.0)?;
        Some((name(row), (at, error, entry)))
    }));
    let mut traces = Vec::new();
    for (index, (name, mut points)) in curves.into_iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let marks = points.iter().map(|(_, _, entry)| match entry.row.status {
            Some(Status::Stable) => colour,
            _ => "#ffffff",
        });
        let marks: Vec<&str> = marks.collect();
        let said = points.iter().map(|(_, _, entry)| {
            let order = entry
                .row
                .order
                .map_or_else(String::new, |order| format!("<br>order {order:.1}"));
            format!("{}{order}", hover(study, &entry.row))
        });
        let said: Vec<String> = said.collect();
        let points = points.iter().map(|point| (point.0, point.1));
        traces.push(marked(points, said, (colour, 1.8), marks).name(name));
    }
    traces
}

/// An axis with marks at values that were run, and no others.
fn marked_axis(
    title: &str,
    rows: &[&Entry],
    x: impl Fn(&RunRow) -> Option<f64>,
    text: impl Fn(f64) -> String,
) -> plotly::layout::Axis {
    let mut values: Vec<f64> = rows.iter().filter_map(|entry| x(&entry.row)).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let texts = values.iter().map(|value| text(*value)).collect();
    logarithmic(title).tick_values(values).tick_text(texts)
}

/// A figure of the errors of these rows.
fn drawn(traces: Vec<Trace>, x: plotly::layout::Axis, rows: &[&Entry], id: &str) -> String {
    let errors = decades_of(ERROR, rows.iter().filter_map(|entry| entry.row.filtered_error));
    finished(traces, layout(x, errors).hover_mode(HoverMode::Closest), id, 420)
}

/// Error over elements.
pub(super) fn mesh(study: &Study) -> String {
    let rows: Vec<&Entry> = study
        .of(Sweep::Mesh)
        .filter(|entry| entry.row.macro_step.is_none())
        .collect();
    let x = |row: &RunRow| row.elements_per_span.map(|count| count as f64);
    let traces = sweep(study, &rows, x, |row| row.mesh.clone());
    if traces.is_empty() {
        return String::new();
    }
    let axis = marked_axis("elements per span and wire", &rows, x, |value| format!("{value}"));
    let micro = rows.first().and_then(|entry| entry.row.micro_step);
    format!(
        "{}<p class=\"caption\">Micro step {} ms: where a curve flattens, the time step is what is left. Open marks: \
         limit or diverged.</p>\n",
        drawn(traces, axis, &rows, "plot-mesh"),
        milliseconds(micro)
    )
}

/// Error over the micro step.
pub(super) fn micro_step(study: &Study) -> String {
    let rows: Vec<&Entry> = study.of(Sweep::MicroStep).collect();
    let x = |row: &RunRow| Some(1e3 * row.micro_step?);
    let traces = sweep(study, &rows, x, |row| row.mesh.clone());
    if traces.is_empty() {
        return String::new();
    }
    let axis = marked_axis("micro step [ms]", &rows, x, |value| {
        format!("{}", (1e6 * value).round() / 1e6)
    });
    let elements = rows.iter().find_map(|entry| entry.row.elements_per_span);
    format!(
        "{}<p class=\"caption\">{}Where a curve flattens, the mesh is what is left.</p>\n",
        drawn(traces, axis, &rows, "plot-micro"),
        elements.map_or_else(String::new, |count| format!("{count} elements per span. "))
    )
}

/// Error over the macro step.
pub(super) fn coupling(study: &Study) -> String {
    let rows: Vec<&Entry> = study.of(Sweep::Coupling).collect();
    let x = |row: &RunRow| Some(1e3 * row.macro_step?);
    let name = |row: &RunRow| match row.extrapolation {
        Some(degree) if row.algorithm != crate::engine::table::AUTO => {
            format!("{}, extrapolation {degree}", row.algorithm)
        }
        _ => row.algorithm.clone(),
    };
    let mut traces = sweep(study, &rows, x, name);
    if traces.is_empty() {
        return String::new();
    }
    let alone = study.of(Sweep::Mesh).find(|entry| {
        let same = |other: &&Entry| {
            other.row.elements_per_span == entry.row.elements_per_span
                && other.row.mesh == entry.row.mesh
                && other.row.micro_step == entry.row.micro_step
        };
        entry.row.macro_step.is_none() && rows.iter().any(same)
    });
    if let Some(error) = alone
        .and_then(|entry| entry.row.filtered_error)
        .filter(|error| *error > 0.0)
    {
        let steps = || rows.iter().filter_map(|entry| x(&entry.row));
        let ends = [steps().fold(f64::INFINITY, f64::min), steps().fold(0.0, f64::max)];
        traces.push(dotted(
            ends.to_vec(),
            vec![error; 2],
            &format!("one system: {error:.2} %"),
            BOUND,
        ));
    }
    let axis = marked_axis("macro step [ms]", &rows, x, |value| {
        format!("{}", (1e6 * value).round() / 1e6)
    });
    format!(
        "{}<p class=\"caption\">In process, same mesh and micro step: what lies above the dotted line is the \
         coupling's. FMUs compute the same.</p>\n",
        drawn(traces, axis, &rows, "plot-coupling")
    )
}

/// Cost against the length of the line.
pub(super) fn growth(study: &Study) -> String {
    let rows: Vec<&Entry> = study
        .of(Sweep::Spans)
        .filter(|entry| entry.row.status == Some(Status::Stable))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let draw = |value: &dyn Fn(&Entry) -> Option<f64>, what: &str, dash: DashType| -> Vec<Trace> {
        let mut traces: Vec<Trace> = Vec::new();
        for (index, window) in [false, true].into_iter().enumerate() {
            let colour = COLOURS[index];
            let mut points: Vec<(f64, f64)> = rows
                .iter()
                .filter(|entry| Class::of(&entry.row.reduction).window == window)
                .filter_map(|entry| Some((entry.spans? as f64, value(entry).filter(|value| *value > 0.0)?)))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            if points.is_empty() {
                continue;
            }
            let name = format!("{}{what}", if window { "window" } else { "whole line" });
            traces.push(
                Scatter::new(
                    points.iter().map(|point| point.0).collect(),
                    points.iter().map(|point| point.1).collect(),
                )
                .mode(Draw::LinesMarkers)
                .name(name)
                .line(Line::new().color(colour).width(1.8).dash(dash.clone()))
                .marker(Marker::new().color(colour).size(8)),
            );
        }
        traces
    };
    let spans = |title: &str| {
        let mut counts: Vec<f64> = rows
            .iter()
            .filter_map(|entry| entry.spans)
            .map(|count| count as f64)
            .collect();
        counts.sort_by(f64::total_cmp);
        counts.dedup();
        let texts = counts.iter().map(|count| format!("{count}")).collect();
        logarithmic(title).tick_values(counts).tick_text(texts)
    };
    let mut time = draw(
        &|entry| entry.row.real_time_factor,
        ", time loop per simulated second",
        DashType::Solid,
    );
    time.extend(draw(&|entry| entry.setup_s, ", statics and loading", DashType::Dot));
    let memory = draw(
        &|entry| entry.working_memory_bytes.map(|bytes| bytes as f64 / 1e6),
        "",
        DashType::Solid,
    );
    let walls = rows
        .iter()
        .flat_map(|entry| [entry.row.real_time_factor, entry.setup_s])
        .flatten();
    let axes = layout(spans("spans"), decades_of("wall time [s]", walls)).hover_mode(HoverMode::Closest);
    let mut html = finished(time, axes, "plot-growth", 400);
    if !memory.is_empty() {
        let touched = rows
            .iter()
            .filter_map(|entry| Some(entry.working_memory_bytes? as f64 / 1e6));
        let axes = layout(
            spans("spans"),
            decades_of("memory touched by the time loop [MB]", touched),
        );
        html.push_str(&finished(
            memory,
            axes.hover_mode(HoverMode::Closest),
            "plot-memory",
            340,
        ));
    }
    html.push_str(
        "<p class=\"caption\">The base case on lines of other lengths, one simulated second. Statics, loading and \
         result files are not part of the time loop. Memory: pages that the time loop has touched.</p>\n",
    );
    html
}
