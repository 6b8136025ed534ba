//! The diagrams of the page.

use plotly::common::{DashType, Font, Line, Marker, Mode as Draw, Position};

use super::options::Sweep;
use super::outcome::{Entry, Study};
use super::pareto::point;
use super::run_spec::{Class, Family};
use super::text::shortened;
use crate::engine::export::grouped;
use crate::engine::export::plot::{ERROR, is_shown, run_curve};
use crate::engine::table::{AUTO, RunRow};
use results::report::format::{milliseconds, number};
use results::report::plots::{
    BOUND, Labels, Trace, colour, curve, decades_of, dotted, extent, figure, finished, marked, marked_axis,
    open_points, points,
};

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
fn usual_mesh(study: &Study) -> &str {
    let on_front = || study.rows.iter().filter(|entry| entry.pareto);
    let meshes = || on_front().map(|entry| entry.row.mesh.as_str());
    let most = meshes().max_by_key(|mesh| meshes().filter(|other| other == mesh).count());
    most.unwrap_or("plain")
}

/// Error against real-time factor: every run that has both, the front of each class as a line.
pub(super) fn precision(study: &Study) -> String {
    let rows = study.rows.iter();
    let rows = rows.filter(|entry| entry.sweep != Sweep::Vehicle.name());
    let placed = rows.filter_map(|entry| Some((Class::of(&entry.row.reduction), (entry, point(&entry.row)?))));
    let placed: Vec<_> = placed.filter(|(_, (_, (_, error)))| *error > 0.0).collect();
    if placed.is_empty() {
        return String::new();
    }
    let usual = usual_mesh(study);
    let points_of = || placed.iter().map(|(_, (_, point))| point);
    let [fastest, slowest] = extent(points_of().map(|point| point.0));
    let [best, worst] = extent(points_of().map(|point| point.1));
    let (low, high) = (fastest / 1.3, slowest * 1.6);
    let mut classes = grouped(placed);
    classes.sort_by_key(|(class, _)| *class);
    let mut labels = Labels::new((low, best), (high, worst));
    let said = |runs: &[(&Entry, (f64, f64))]| runs.iter().map(|(entry, _)| hover(study, &entry.row)).collect();
    let mut traces = Vec::new();
    for (index, (class, runs)) in classes.into_iter().enumerate() {
        let colour = colour(index);
        let (mut front, others): (Vec<_>, Vec<_>) = runs.into_iter().partition(|(entry, _)| entry.pareto);
        traces.push(open_points(others.iter().map(|run| run.1), said(&others), colour));
        front.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let names = front.iter();
        let names = names.map(|(entry, at)| labels.set(*at, short_name(study, &entry.row, usual)));
        let names = names.collect();
        let places = front.iter().map(|run| run.1);
        let line = marked(places, said(&front), (colour, 2.2), vec![colour; front.len()]);
        traces.push(
            line.mode(Draw::LinesMarkersText)
                .name(class.name())
                .text_array(names)
                .text_position(Position::TopRight)
                .text_font(Font::new().size(11).color(colour)),
        );
    }
    let reference = study.reference(Family::Nonlinear);
    let uncertainty = reference.and_then(|found| found.uncertainty_percent);
    if let Some(uncertainty) = uncertainty.filter(|percent| *percent > 0.0) {
        let name = format!("what is not known of the nonlinear reference: {uncertainty:.2} %");
        traces.push(dotted(vec![low, high], vec![uncertainty; 2], &name, BOUND));
    }
    let factors = "real-time factor: wall time of the time loop over simulated time";
    let (factors, errors) = (
        decades_of(factors, [fastest, slowest]),
        decades_of(ERROR, [best, worst]),
    );
    let mesh = match usual {
        "plain" => String::new(),
        usual => format!(
            "; mesh {} = {} unless another one is named",
            shortened(usual),
            results::report::escape(usual)
        ),
    };
    let caption = format!(
        "Lower left is better. Filled: the Pareto front of its class, named where there is room (elements per dropper \
         interval or their length, micro step{mesh}); open: all other runs. Each class is judged by the reference of \
         its own model. Wall time in seconds is {:.2} times the real-time factor.",
        study.simulated_s
    );
    figure(traces, points(factors, errors), ("plot-precision", 560), &caption)
}

/// Error over a quantity `x` of the rows of a sweep, one curve for each name.
struct SweepPlot<'a> {
    rows: Vec<&'a Entry>,
    x: fn(&RunRow) -> Option<f64>,
    traces: Vec<Trace>,
}

impl<'a> SweepPlot<'a> {
    fn new(
        study: &Study,
        rows: impl Iterator<Item = &'a Entry>,
        x: fn(&RunRow) -> Option<f64>,
        name: impl Fn(&RunRow) -> String,
    ) -> Self {
        let rows: Vec<&Entry> = rows.collect();
        let said = |row: &RunRow| {
            let order = row
                .order
                .map_or_else(String::new, |order| format!("<br>order {order:.1}"));
            format!("{}{order}", hover(study, row))
        };
        let placed = rows.iter().filter_map(|entry| {
            let at = x(&entry.row).zip(entry.row.filtered_error)?;
            Some((name(&entry.row), (at, &entry.row)))
        });
        let mut traces = Vec::new();
        let curves = grouped(placed.filter(|(_, run)| is_shown(run)));
        for (index, (name, mut runs)) in curves.into_iter().enumerate() {
            runs.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
            traces.extend(run_curve(runs, said, colour(index), 1.8).map(|curve| curve.name(name)));
        }
        Self { rows, x, traces }
    }

    fn places(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().filter_map(|entry| (self.x)(&entry.row))
    }

    fn figure(self, title: &str, id: &str, caption: &str) -> String {
        let errors = decades_of(ERROR, self.rows.iter().filter_map(|entry| entry.row.filtered_error));
        let axes = points(marked_axis(title, self.places()), errors);
        figure(self.traces, axes, (id, 420), caption)
    }
}

/// Error over elements.
pub(super) fn mesh(study: &Study) -> String {
    let rows = study.of(Sweep::Mesh).filter(|entry| entry.row.macro_step.is_none());
    let x = |row: &RunRow| row.elements_per_span.map(|count| count as f64);
    let plot = SweepPlot::new(study, rows, x, |row| row.mesh.clone());
    let micro = plot.rows.first().and_then(|entry| entry.row.micro_step);
    let caption = format!(
        "Micro step {} ms: where a curve flattens, the time step is what is left. Open marks: limit or diverged.",
        milliseconds(micro)
    );
    plot.figure("elements per span and wire", "plot-mesh", &caption)
}

/// Error over the micro step.
pub(super) fn micro_step(study: &Study) -> String {
    let x = |row: &RunRow| Some(1e3 * row.micro_step?);
    let plot = SweepPlot::new(study, study.of(Sweep::MicroStep), x, |row| row.mesh.clone());
    let elements = plot.rows.iter().find_map(|entry| entry.row.elements_per_span);
    let elements = elements.map_or_else(String::new, |count| format!("{count} elements per span. "));
    let caption = format!("{elements}Where a curve flattens, the mesh is what is left.");
    plot.figure("micro step [ms]", "plot-micro", &caption)
}

/// Error over the macro step.
pub(super) fn coupling(study: &Study) -> String {
    let x = |row: &RunRow| Some(1e3 * row.macro_step?);
    let name = |row: &RunRow| match row.extrapolation {
        Some(degree) if row.algorithm != AUTO => format!("{}, extrapolation {degree}", row.algorithm),
        _ => row.algorithm.clone(),
    };
    let mut plot = SweepPlot::new(study, study.of(Sweep::Coupling), x, name);
    if plot.traces.is_empty() {
        return String::new();
    }
    let discretisation = |row: &RunRow| (row.elements_per_span, row.mesh.clone(), row.micro_step);
    let alone = study.of(Sweep::Mesh).map(|entry| &entry.row).find(|row| {
        let same = |other: &&Entry| discretisation(&other.row) == discretisation(row);
        row.macro_step.is_none() && plot.rows.iter().any(same)
    });
    let error = alone.and_then(|row| row.filtered_error);
    if let Some(error) = error.filter(|error| *error > 0.0) {
        let ends = extent(plot.places()).to_vec();
        let name = format!("one system: {error:.2} %");
        plot.traces.push(dotted(ends, vec![error; 2], &name, BOUND));
    }
    plot.figure(
        "macro step [ms]",
        "plot-coupling",
        "In process, same mesh and micro step: what lies above the dotted line is the coupling's. FMUs compute the \
         same.",
    )
}

/// Cost against the length of the line.
pub(super) fn growth(study: &Study) -> String {
    let rows: Vec<&Entry> = study.of(Sweep::Spans).filter(|entry| entry.row.is_stable()).collect();
    if rows.is_empty() {
        return String::new();
    }
    let spans = || marked_axis("spans", rows.iter().filter_map(|entry| Some(entry.spans? as f64)));
    let draw = |value: fn(&Entry) -> Option<f64>, what: &str, dash: DashType| {
        let line = |(index, line): (usize, &str)| {
            let of_line = |entry: &&&Entry| usize::from(Class::of(&entry.row.reduction).window) == index;
            let at = |entry: &&Entry| Some((entry.spans? as f64, value(entry).filter(|value| *value > 0.0)?));
            let mut places: Vec<(f64, f64)> = rows.iter().filter(of_line).filter_map(at).collect();
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (x, y): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
            let stroke = Line::new().color(colour(index)).width(1.8).dash(dash.clone());
            let mark = Marker::new().color(colour(index)).size(8);
            let drawn = (!x.is_empty()).then(|| curve(x, y, &format!("{line}{what}"), colour(index), 1.8))?;
            Some(drawn.mode(Draw::LinesMarkers).line(stroke).marker(mark))
        };
        let lines = ["whole line", "window"].into_iter().enumerate();
        lines.filter_map(line).collect::<Vec<Trace>>()
    };
    let factor = |entry: &Entry| entry.row.real_time_factor;
    let memory = |entry: &Entry| Some(entry.working_memory_bytes? as f64 / 1e6);
    let mut time = draw(factor, ", time loop per simulated second", DashType::Solid);
    time.extend(draw(|entry| entry.setup_s, ", statics and loading", DashType::Dot));
    let walls = rows.iter().flat_map(|entry| [factor(entry), entry.setup_s]).flatten();
    let touched = rows.iter().filter_map(|entry| memory(entry));
    let time_axes = points(spans(), decades_of("wall time [s]", walls));
    let memory_axes = points(spans(), decades_of("memory touched by the time loop [MB]", touched));
    let mut html = finished(time, time_axes, "plot-growth", 400);
    let memory = draw(memory, "", DashType::Solid);
    if !memory.is_empty() {
        html.push_str(&finished(memory, memory_axes, "plot-memory", 340));
    }
    html.push_str(
        "<p class=\"caption\">The base case on lines of other lengths, one simulated second. Statics, loading and \
         result files are not part of the time loop. Memory: pages that the time loop has touched.</p>\n",
    );
    html
}
