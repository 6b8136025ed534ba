//! `compare.html`.

use plotly::Scatter;
use plotly::color::NamedColor;
use plotly::common::{Line, Mode as Draw, Visible};
use plotly::layout::{Axis, HoverMode};

use super::Comparison;
use super::plan::algorithms;
use crate::engine::export::plot::{Trace, dotted, marked};
use crate::engine::export::{
    PageColumn, cells, fixed, grouped, heads, incomplete, number, scrolled, status_counts, status_rule, status_span,
    step,
};
use crate::engine::run::SETTLE;
use crate::engine::table::{AUTO, RunRow, Status, milliseconds};
use results::report::plots::{COLOURS, axis, decades_of, finished, layout, logarithmic, rounded};
use results::report::{Page, escape, remarks};
use simulation::Mode;

/// Colour of the monolithic runs.
const REFERENCE: &str = "#1c2430";

/// Macro step whose curves are drawn at first, s: long enough to tell the algorithms apart.
const SHOWN: f64 = 5e-3;

/// Title of the axis of errors.
const ERROR: &str = "rms error of the filtered force [% of σ]";

/// The page of a comparison.
#[must_use]
pub fn page(comparison: &Comparison) -> Page {
    let mut page = Page::new(&format!("Coupling compared: {}", title(comparison)));
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

fn title(comparison: &Comparison) -> &str {
    if comparison.title.is_empty() {
        &comparison.scene
    } else {
        &comparison.title
    }
}

fn lead(comparison: &Comparison) -> String {
    let mut html = format!(
        "<p><b>{}</b> · {} runs",
        escape(&comparison.scene),
        comparison.rows.len()
    );
    html.push_str(&format!(": {}</p>\n", status_counts(&comparison.rows)));
    if !comparison.source.is_empty() {
        html.push_str(&format!("<p class=\"soft\">{}</p>\n", escape(&comparison.source)));
    }
    html.push_str(&incomplete(comparison, ""));
    // Good news needs no warning.
    if comparison.same_bits == Some(true) {
        let notes = comparison
            .notes
            .iter()
            .map(|note| format!("<p class=\"good\">{}</p>\n", escape(note)));
        html.extend(notes);
    } else {
        html.push_str(&remarks(&comparison.notes));
    }
    html
}

/// Error over macro step as a matrix: one line per algorithm.
fn best(comparison: &Comparison) -> String {
    let coupled: Vec<&RunRow> = coupled(comparison).collect();
    let steps = steps(comparison);
    if steps.is_empty() {
        return String::new();
    }
    let head: String = steps
        .iter()
        .map(|step| format!("<th class=\"n\">{} ms</th>", milliseconds(Some(*step))))
        .collect();
    let mut body = String::new();
    for (index, name) in algorithms().iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        body.push_str(&format!(
            "<tr><td class=\"s\"><span class=\"swatch\" style=\"background:{colour}\"></span>{name}</td>"
        ));
        for step in &steps {
            let row = coupled
                .iter()
                .find(|row| row.algorithm == *name && row.macro_step == Some(*step));
            let cell = match row {
                Some(row) if row.status == Some(Status::Stable) => number(row.filtered_error),
                Some(row) => status_span(row.status),
                None => String::new(),
            };
            body.push_str(&format!("<td class=\"n\">{cell}</td>"));
        }
        body.push_str("</tr>\n");
    }
    scrolled(
        &format!("<th>rms error of the filtered force, % of σ</th>{head}"),
        &body,
    )
}

/// The rows with FMUs.
fn coupled(comparison: &Comparison) -> impl Iterator<Item = &RunRow> {
    comparison
        .rows
        .iter()
        .filter(|row| row.mode == Mode::Cosimulation.name())
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

/// The macro steps that were run, and no others.
fn macro_step_axis(comparison: &Comparison) -> Axis {
    let steps = steps(comparison);
    logarithmic("macro step [ms]")
        .tick_values(steps.iter().map(|step| 1e3 * step).collect())
        .tick_text(steps.iter().map(|step| milliseconds(Some(*step))).collect())
}

/// One curve per algorithm through `point` of each row that ended; open marks where the run is not stable.
fn curves(comparison: &Comparison, point: impl Fn(&RunRow) -> Option<(f64, f64)>) -> Vec<Trace> {
    let mut traces = Vec::new();
    for (index, name) in algorithms().iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let ended = |row: &&RunRow| {
            row.algorithm == *name && matches!(row.status, Some(Status::Stable | Status::Limit | Status::Diverged))
        };
        let (mut points, mut marks, mut said) = (Vec::new(), Vec::new(), Vec::new());
        for row in coupled(comparison).filter(ended) {
            // A logarithmic axis has no place for zero.
            let Some((at, value)) = point(row).filter(|(at, value)| *at > 0.0 && *value > 0.0) else {
                continue;
            };
            points.push((at, value));
            let status = row.status.map_or("", Status::name);
            marks.push(if row.status == Some(Status::Stable) {
                colour
            } else {
                "#ffffff"
            });
            let order = row
                .order
                .map_or_else(String::new, |order| format!(", order {order:.1}"));
            said.push(format!(
                "{name}, {} ms: {} % of σ{order}, {} J, {} s, {status}",
                milliseconds(row.macro_step),
                number(row.filtered_error),
                number(row.energy_residual),
                number(row.wall),
            ));
        }
        if points.is_empty() {
            continue;
        }
        let wide = if *name == AUTO { 3.0 } else { 1.6 };
        traces.push(marked(points, said, (colour, wide), marks).name(*name));
    }
    traces
}

fn error_plot(comparison: &Comparison) -> String {
    let traces = curves(comparison, |row| Some((1e3 * row.macro_step?, row.filtered_error?)));
    if traces.is_empty() {
        return String::new();
    }
    let layout = layout(
        macro_step_axis(comparison),
        decades_of(ERROR, filtered_errors(comparison)),
    );
    format!(
        "{}<p class=\"caption\">Filled marks: stable; open marks: limit or diverged. The orders between the marks are \
         in the table below and under the pointer. Where the micro step changes (column micro step), the references \
         change with it.</p>\n",
        finished(traces, layout.hover_mode(HoverMode::Closest), "plot-error", 420)
    )
}

fn cost_plot(comparison: &Comparison) -> String {
    let mut traces = curves(comparison, |row| Some((row.wall?, row.filtered_error?)));
    if traces.is_empty() {
        return String::new();
    }
    // The cost of one system at each micro step, over the whole range of errors.
    let errors = || filtered_errors(comparison);
    let (low, high) = (errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max));
    for row in &comparison.rows {
        let (Some(wall), true) = (row.wall, row.mode == Mode::Monolithic.name()) else {
            continue;
        };
        let name = format!(
            "monolithic, micro step {} ms: {} s",
            milliseconds(row.micro_step),
            number(Some(wall))
        );
        traces.push(dotted(vec![wall, wall], vec![low, high], &name, REFERENCE));
    }
    let layout = layout(
        decades_of(
            "wall time of the time loop [s]",
            comparison.rows.iter().filter_map(|row| row.wall),
        ),
        decades_of(ERROR, errors()),
    );
    format!(
        "{}<p class=\"caption\">Lower left is better. Dotted: what the monolithic runs cost.</p>\n",
        finished(traces, layout.hover_mode(HoverMode::Closest), "plot-cost", 420)
    )
}

fn energy_plot(comparison: &Comparison) -> String {
    let traces = curves(comparison, |row| {
        Some((1e3 * row.macro_step?, row.energy_residual?.abs()))
    });
    if traces.is_empty() {
        return String::new();
    }
    let residuals = coupled(comparison).filter_map(|row| row.energy_residual.map(f64::abs));
    let layout = layout(
        macro_step_axis(comparison),
        decades_of("|energy residual| [J]", residuals),
    );
    format!(
        "{}<p class=\"caption\">Work of the strip on the line plus work of the contact on the strip, whole run: a \
         coupling without error has 0, a positive value is energy that it has added. The sign is in the table and \
         under the pointer.</p>\n",
        finished(traces, layout.hover_mode(HoverMode::Closest), "plot-energy", 360)
    )
}

/// Reference of the coarsest group and the algorithms at one long macro step; the automatic choice at the others, and
/// the other algorithms, can be switched on.
fn force_plot(comparison: &Comparison) -> String {
    let mut traces = Vec::new();
    let mut drawn = |index: usize, name: String, colour: &'static str, width: f64, visible: bool| {
        let Some(curve) = comparison.curves[index].first() else {
            return;
        };
        let range = curve.range.clone();
        let trace = Scatter::new(
            rounded(&curve.x[range.clone()], 1e3),
            rounded(&curve.filtered[range], 1e2),
        )
        .mode(Draw::Lines)
        .name(name)
        .line(Line::new().color(colour).width(width));
        traces.push(if visible {
            trace
        } else {
            trace.visible(Visible::LegendOnly)
        });
    };
    let steps = coupled(comparison).filter_map(|row| row.macro_step);
    let Some(step) = steps.min_by(|a, b| (a / SHOWN).ln().abs().total_cmp(&(b / SHOWN).ln().abs())) else {
        return String::new();
    };
    let rows = &comparison.rows;
    let of_step = |row: &RunRow| row.mode == Mode::Cosimulation.name() && row.macro_step == Some(step);
    let micro = rows.iter().find(|row| of_step(row)).and_then(|row| row.micro_step);
    // The colours of the algorithms, the reference on top in black.
    for (place, name) in algorithms().iter().enumerate() {
        let colour = COLOURS[place % COLOURS.len()];
        for (index, row) in rows.iter().enumerate() {
            if row.mode != Mode::Cosimulation.name() || row.algorithm != *name {
                continue;
            }
            let at_step = row.macro_step == Some(step);
            if at_step || *name == AUTO {
                let name = format!("{name} {} ms", milliseconds(row.macro_step));
                drawn(index, name, colour, 1.8, at_step && row.status == Some(Status::Stable));
            }
        }
    }
    let monolithic = |row: &RunRow| row.mode == Mode::Monolithic.name() && row.status == Some(Status::Stable);
    let same_micro = |row: &RunRow| match (row.micro_step, micro) {
        (Some(own), Some(micro)) => (own / micro - 1.0).abs() < 0.5,
        _ => false,
    };
    if let Some(index) = rows.iter().position(|row| monolithic(row) && same_micro(row)) {
        drawn(index, "monolithic".to_owned(), REFERENCE, 1.2, true);
    }
    if traces.is_empty() {
        return String::new();
    }
    let layout = layout(
        axis("position of the contact along the track [m]").zero_line(false),
        axis("filtered contact force [N]"),
    );
    format!(
        "{}<p class=\"caption\">First pantograph, evaluation range. Click in the legend to switch a curve; drag to \
         zoom, double-click to go back.</p>\n",
        finished(
            traces,
            layout.paper_background_color(NamedColor::White),
            "plot-force",
            420
        )
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
    let mut body = String::new();
    for rows in comparison.rows.chunk_by(|a, b| a.mode == b.mode) {
        let mode = &rows[0].mode;
        body.push_str(&format!("<tr><th colspan=\"{}\">{mode}</th></tr>\n", COLUMNS.len()));
        for row in rows {
            let cells = cells(COLUMNS, row);
            body.push_str(&format!("<tr title=\"{}\">{cells}</tr>\n", escape(&row.reason)));
        }
    }
    let said = comparison.rows.iter().filter(|row| !row.reason.is_empty());
    let reasons = grouped(said.map(|row| {
        let run = format!("{} {} {} ms", row.mode, row.algorithm, milliseconds(row.macro_step));
        (&row.reason, run)
    }));
    let reasons: String = reasons
        .iter()
        .map(|(reason, runs)| {
            format!(
                "<tr><td>{}</td><td class=\"remark\">{}</td></tr>\n",
                escape(&runs.join(", ")),
                escape(reason)
            )
        })
        .collect();
    let remarks = if reasons.is_empty() {
        String::new()
    } else {
        format!(
            "<details><summary>What ran and why, and why runs ended</summary>{}</details>\n",
            scrolled("<th>runs</th><th>reason</th>", &reasons)
        )
    };
    format!(
        "{}{remarks}<p class=\"caption\">All columns, the work of the solvers among them, are in compare.csv.</p>\n",
        scrolled(&heads(COLUMNS), &body)
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
