//! `compare.html`.

use plotly::color::NamedColor;
use plotly::common::Visible;
use plotly::layout::Axis;

use super::Comparison;
use super::plan::algorithms;
use crate::engine::export::plot::{ERROR, run_curve};
use crate::engine::export::{
    grouped, over_steps, reasons, run_lines, scene_lead, scene_page, status_rule, status_span,
};
use crate::engine::table::{AUTO, RunRow, Status};
use results::report::format::{fixed, milliseconds, number, step};
use results::report::plots::{
    Trace, axis, colour, curve, decades_of, dotted, extent, figure, layout, marked_axis, points, rounded,
};
use results::report::{Page, PageColumn, cell, escape, heads, remarks, scrolled, spanning};
use simulation::{Mode, SETTLE};

/// Colour of the monolithic runs.
const REFERENCE: &str = "#1c2430";

/// Macro step whose curves are drawn at first, s: long enough to tell the algorithms apart.
const SHOWN: f64 = 5e-3;

/// The page of a comparison.
pub(super) fn page(comparison: &Comparison) -> Page {
    let mut page = scene_page("Coupling compared", &comparison.scene, &comparison.title);
    page.lead(&lead(comparison));
    page.section("", &best(comparison));
    page.section("Error against macro step", &error_plot(comparison));
    page.section("Error against cost", &cost_plot(comparison));
    page.section("Energy added by the coupling", &energy_plot(comparison));
    page.section("Contact force", &force_plot(comparison));
    page.section("All runs", &table(comparison));
    page.section("How to read this", &legend());
    page
}

fn lead(comparison: &Comparison) -> String {
    let html = scene_lead(&comparison.scene, &comparison.source, comparison, "", "");
    // Good news needs no warning.
    if comparison.same_bits == Some(true) {
        let good = |note: &String| format!("<p class=\"good\">{}</p>\n", escape(note));
        html + &comparison.notes.iter().map(good).collect::<String>()
    } else {
        html + &remarks(&comparison.notes)
    }
}

/// Error over macro step as a matrix: one line per algorithm.
fn best(comparison: &Comparison) -> String {
    let steps = steps(comparison);
    if steps.is_empty() {
        return String::new();
    }
    let line = |(index, name): (usize, &'static str)| {
        let colour = colour(index);
        let swatch = format!("<span class=\"swatch\" style=\"background:{colour}\"></span>{name}");
        let error = |step: &f64| {
            let mut rows = coupled(comparison);
            let row = rows.find(|row| row.algorithm == name && row.macro_step == Some(*step));
            row.map_or_else(String::new, |row| match row.is_stable() {
                true => number(row.filtered_error),
                false => status_span(row.status),
            })
        };
        (cell("s", &swatch), steps.iter().map(error).collect())
    };
    let lines = algorithms().into_iter().enumerate().map(line);
    over_steps("rms error of the filtered force, % of σ", &steps, lines)
}

/// The rows with FMUs.
fn coupled(comparison: &Comparison) -> impl Iterator<Item = &RunRow> {
    let rows = comparison.rows.iter();
    rows.filter(|row| row.mode == Mode::Cosimulation.name())
}

/// Errors of these that a logarithmic axis has a place for, %.
fn filtered_errors(comparison: &Comparison) -> impl Iterator<Item = f64> {
    coupled(comparison).filter_map(|row| row.filtered_error.filter(|error| *error > 0.0))
}

/// Macro steps of these, s.
fn steps(comparison: &Comparison) -> Vec<f64> {
    let mut steps: Vec<f64> = coupled(comparison).filter_map(|row| row.macro_step).collect();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    steps
}

fn macro_step_axis(comparison: &Comparison) -> Axis {
    marked_axis("macro step [ms]", steps(comparison).iter().map(|step| 1e3 * step))
}

/// One curve per algorithm through `point` of each row.
fn curves(comparison: &Comparison, point: impl Fn(&RunRow) -> Option<(f64, f64)>) -> Vec<Trace> {
    let said = |row: &RunRow| {
        let order = row
            .order
            .map_or_else(String::new, |order| format!(", order {order:.1}"));
        format!(
            "{}, {} ms: {} % of σ{order}, {} J, {} s, {}",
            row.algorithm,
            milliseconds(row.macro_step),
            number(row.filtered_error),
            number(row.energy_residual),
            number(row.wall),
            row.status.map_or("", Status::name)
        )
    };
    let curve = |(index, name): (usize, &'static str)| {
        let rows = coupled(comparison).filter(|row| row.algorithm == name);
        let runs = rows.filter_map(|row| Some((point(row)?, row)));
        let width = if name == AUTO { 3.0 } else { 1.6 };
        Some(run_curve(runs, said, colour(index), width)?.name(name))
    };
    algorithms().into_iter().enumerate().filter_map(curve).collect()
}

fn error_plot(comparison: &Comparison) -> String {
    let traces = curves(comparison, |row| Some((1e3 * row.macro_step?, row.filtered_error?)));
    let errors = decades_of(ERROR, filtered_errors(comparison));
    figure(
        traces,
        points(macro_step_axis(comparison), errors),
        ("plot-error", 420),
        "Filled marks: stable; open marks: limit or diverged. The orders between the marks are in the table below and \
         under the pointer. Where the micro step changes (column micro step), the references change with it.",
    )
}

fn cost_plot(comparison: &Comparison) -> String {
    let mut traces = curves(comparison, |row| Some((row.wall?, row.filtered_error?)));
    if traces.is_empty() {
        return String::new();
    }
    // The cost of one system at each micro step, over the whole range of errors.
    let range = extent(filtered_errors(comparison)).to_vec();
    for row in comparison.rows.iter().filter(|row| row.mode == Mode::Monolithic.name()) {
        let Some(wall) = row.wall else { continue };
        let (step, cost) = (milliseconds(row.micro_step), number(row.wall));
        let name = format!("monolithic, micro step {step} ms: {cost} s");
        traces.push(dotted(vec![wall; 2], range.clone(), &name, REFERENCE));
    }
    let walls = comparison.rows.iter().filter_map(|row| row.wall);
    figure(
        traces,
        points(
            decades_of("wall time of the time loop [s]", walls),
            decades_of(ERROR, filtered_errors(comparison)),
        ),
        ("plot-cost", 420),
        "Lower left is better. Dotted: what the monolithic runs cost.",
    )
}

fn energy_plot(comparison: &Comparison) -> String {
    let energy = |row: &RunRow| row.energy_residual.map(f64::abs);
    let residuals = decades_of("|energy residual| [J]", coupled(comparison).filter_map(energy));
    figure(
        curves(comparison, |row| Some((1e3 * row.macro_step?, energy(row)?))),
        points(macro_step_axis(comparison), residuals),
        ("plot-energy", 360),
        "Work of the strip on the line plus work of the contact on the strip, whole run: a coupling without error has \
         0, a positive value is energy that it has added. The sign is in the table and under the pointer.",
    )
}

/// Reference of the coarsest group and the algorithms at one long macro step; the automatic choice at the others, and
/// the other algorithms, can be switched on.
fn force_plot(comparison: &Comparison) -> String {
    let drawn = |index: usize, name: &str, colour: &'static str, width: f64| {
        let force = comparison.curves[index].first()?;
        let range = force.range.clone();
        let x = rounded(&force.x[range.clone()], 1e3);
        Some(curve(x, rounded(&force.filtered[range], 1e2), name, colour, width))
    };
    let steps = coupled(comparison).filter_map(|row| row.macro_step);
    let Some(step) = steps.min_by(|a, b| (a / SHOWN).ln().abs().total_cmp(&(b / SHOWN).ln().abs())) else {
        return String::new();
    };
    let mut at_step = coupled(comparison).filter(|row| row.macro_step == Some(step));
    let micro = at_step.next().and_then(|row| row.micro_step);
    let rows = || comparison.rows.iter().enumerate();
    let mut traces = Vec::new();
    // The colours of the algorithms, the reference on top in black.
    for (place, name) in algorithms().into_iter().enumerate() {
        for (index, row) in rows().filter(|(_, row)| row.mode == Mode::Cosimulation.name() && row.algorithm == name) {
            let at_step = row.macro_step == Some(step);
            if !at_step && name != AUTO {
                continue;
            }
            let name = format!("{name} {} ms", milliseconds(row.macro_step));
            let hidden = (!at_step || !row.is_stable()).then_some(Visible::LegendOnly);
            let trace = drawn(index, &name, colour(place), 1.8);
            traces.extend(trace.map(|trace| match hidden {
                Some(hidden) => trace.visible(hidden),
                None => trace,
            }));
        }
    }
    let monolithic = |row: &RunRow| row.mode == Mode::Monolithic.name() && row.is_stable();
    let near = |(own, micro): (f64, f64)| (own / micro - 1.0).abs() < 0.5;
    let mut whole = rows().filter(|(_, row)| monolithic(row) && row.micro_step.zip(micro).is_some_and(near));
    traces.extend(
        whole
            .next()
            .and_then(|(index, _)| drawn(index, "monolithic", REFERENCE, 1.2)),
    );
    let axes = layout(
        axis("position of the contact along the track [m]").zero_line(false),
        axis("filtered contact force [N]"),
    );
    figure(
        traces,
        axes.paper_background_color(NamedColor::White),
        ("plot-force", 420),
        "First pantograph, evaluation range. Click in the legend to switch a curve; drag to zoom, double-click to go \
         back.",
    )
}

/// Columns of the table of all runs.
const COLUMNS: &[PageColumn<RunRow>] = &[
    ("algorithm", "", "s", |row| row.algorithm.clone()),
    ("macro step", "ms", "n", |row| step(row.macro_step)),
    ("micro step", "ms", "n", |row| step(row.micro_step)),
    ("status", "", "s", |row| status_span(row.status)),
    ("filtered error", "% of σ", "n", |row| number(row.filtered_error)),
    ("order", "", "n", |row| fixed(row.order, 1)),
    ("raw error", "% of σ", "n", |row| number(row.raw_error)),
    ("σ error", "%", "n", |row| number(row.std_error)),
    ("mean", "N", "n", |row| fixed(row.mean, 2)),
    ("σ", "N", "n", |row| fixed(row.std, 3)),
    ("max", "N", "n", |row| fixed(row.max, 1)),
    ("min", "N", "n", |row| fixed(row.min, 1)),
    ("loss", "%", "n", |row| fixed(row.loss, 2)),
    ("uplift", "mm", "n", |row| {
        fixed(row.uplift.map(|uplift| 1e3 * uplift), 1)
    }),
    ("energy added", "J", "n", |row| number(row.energy_residual)),
    ("wall time", "s", "n", |row| fixed(row.wall, 2)),
];

fn table(comparison: &Comparison) -> String {
    let of_mode = |rows: &[RunRow]| spanning(COLUMNS, &rows[0].mode) + &run_lines(COLUMNS, rows, |row| row);
    let modes = comparison.rows.chunk_by(|a, b| a.mode == b.mode);
    let body: String = modes.map(of_mode).collect();
    let said = comparison.rows.iter().filter(|row| !row.reason.is_empty());
    let said = grouped(said.map(|row| {
        let run = format!("{} {} {} ms", row.mode, row.algorithm, milliseconds(row.macro_step));
        (row.reason.as_str(), run)
    }));
    let said = said.into_iter().map(|(reason, runs)| (runs.join(", "), reason));
    format!(
        "{}{}<p class=\"caption\">All columns, the work of the solvers among them, are in compare.csv.</p>\n",
        scrolled(&heads(COLUMNS), &body),
        reasons("What ran and why, and why runs ended", "", said.collect())
    )
}

fn legend() -> String {
    format!(
        "<p>Every coupled run is compared with the monolithic run at the same micro step, so that only the coupling \
         differs. Errors are pointwise: rms of the difference of the forces at equal positions over the evaluation \
         range, in percent of the standard deviation σ of the reference's filtered force. The monolithic runs \
         themselves are compared with the finest of them: that is the error of the micro step.</p>\n\
         <p>{}.</p>\n\
         <p>Order: slope of the logarithm of the error over that of the macro step, from the next smaller macro step. \
         Mean, σ, extremes: filtered force of the first pantograph; loss: raw force. Runs end {SETTLE} periods of the \
         low-pass filter's cut-off behind the evaluation range. Wall time: time loop only, one run at a time.</p>\n",
        status_rule()
    )
}
