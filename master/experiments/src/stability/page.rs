//! `stability.html`.

use plotly::Scatter;
use plotly::common::{DashType, HoverInfo, Line as Stroke, Marker, MarkerSymbol, Mode as Draw};
use plotly::layout::HoverMode;

use super::judge::{ALGORITHMS, Line, StabilityTable};
use super::maps::{CurveKind, Map};
use super::text::{by_case, heading, ways};
use crate::engine::export::{
    PageColumn, cells, count, fixed, grouped, heads, incomplete, number, scrolled, status_rule, status_word, step,
};
use crate::engine::table::Status;
use crate::engine::table::significant;
use results::report::plots::{COLOURS, axis, decades_of, finished, layout};
use results::report::{Page, escape, head_cells};

/// The page of the hard cases.
#[must_use]
pub fn page(table: &StabilityTable) -> Page {
    let mut page = Page::new("Hard cases");
    page.lead(&lead(table));
    page.section("Status", &overview(table));
    page.section("What is not stable, and why", &reasons(table));
    for (index, map) in table.maps.iter().enumerate() {
        page.section(map.title, &drawn(map, index));
    }
    page.section("Figures", &table_of_figures(table));
    page.section("How to read this", &legend());
    page
}

fn lead(table: &StabilityTable) -> String {
    let counts: Vec<String> = Status::ALL
        .iter()
        .map(|status| format!("{} {}", table.count(*status), status.name()))
        .collect();
    let cases = by_case(table).len();
    let runs = table.lines.len();
    let mut html = format!("<p><b>{cases} cases</b> · {runs} runs: {}</p>\n", counts.join(", "));
    html.push_str(&incomplete(table, ""));
    html
}

/// A line of cells per case, coloured by status.
fn overview(table: &StabilityTable) -> String {
    let ways = ways(table);
    let head: String = ways
        .iter()
        .map(|way| format!("<th>{}</th>", escape(&heading(way))))
        .collect();
    let mut body = String::new();
    for lines in by_case(table) {
        let first = &lines[0];
        body.push_str(&format!(
            "<tr><td class=\"name\"><b>{}</b><br><span class=\"soft\">{}</span></td>",
            escape(&first.case),
            escape(&first.about)
        ));
        for way in &ways {
            let line = lines
                .iter()
                .find(|line| (&line.row.mode, &line.row.algorithm) == (&way.0, &way.1));
            body.push_str(&line.map_or_else(|| "<td></td>".to_owned(), cell));
        }
        body.push_str("</tr>\n");
    }
    format!(
        "{}<p class=\"caption\">In the cells: rms error of the filtered force in percent of the reference's standard \
         deviation. Under the pointer: what ran and why.</p>\n",
        scrolled(&format!("<th>case</th>{head}"), &body)
    )
}

fn cell(line: &Line) -> String {
    let status = status_word(line.row.status);
    let error = line.row.filtered_error.and_then(|error| significant(Some(error)));
    let error = error.map_or_else(String::new, |error| format!("<br>{error} %"));
    format!(
        "<td class=\"c {status}\" title=\"{}\">{status}{error}</td>",
        escape(&line.row.reason)
    )
}

/// One line per case and reason.
fn reasons(table: &StabilityTable) -> String {
    let mut body = String::new();
    for lines in by_case(table) {
        let ended = lines.iter().filter_map(|line| {
            let status = line.row.status.filter(|status| *status != Status::Stable)?;
            let mut reason = line.row.reason.clone();
            if !line.figures.boundary.is_empty() {
                reason.push_str(&format!(" – {}", line.figures.boundary));
            }
            let way = heading(&(line.row.mode.clone(), line.row.algorithm.clone()));
            Some(((status.name(), reason), way))
        });
        for ((status, reason), ways) in grouped(ended) {
            body.push_str(&format!(
                "<tr><td class=\"s\">{}</td><td class=\"c {status}\">{status}</td><td>{}</td><td \
                 class=\"remark\">{}</td></tr>\n",
                escape(&lines[0].case),
                escape(&ways.join(", ")),
                escape(&reason)
            ));
        }
    }
    if body.is_empty() {
        return String::new();
    }
    scrolled(
        "<th>case</th><th>status</th><th>run</th><th>reason – boundary</th>",
        &body,
    )
}

fn drawn(map: &Map, index: usize) -> String {
    let mut traces = Vec::new();
    for curve in &map.curves {
        let place = ALGORITHMS.iter().position(|name| *name == curve.algorithm).unwrap_or(0);
        let colour = COLOURS[place % COLOURS.len()];
        // A logarithmic axis has no place for zero: a step that was not found is left out.
        let found = || curve.points.iter().filter(|(_, step)| *step > 0.0);
        let x: Vec<f64> = found().map(|(x, _)| *x).collect();
        let y: Vec<f64> = found().map(|(_, step)| 1e3 * step).collect();
        if x.is_empty() {
            continue;
        }
        let (what, stroke, mode) = match curve.kind {
            CurveKind::TestProblem => ("", Stroke::new().color(colour).width(2.0), Draw::LinesMarkers),
            CurveKind::Theory => (
                ", theory",
                Stroke::new().color(colour).width(1.2).dash(DashType::Dot),
                Draw::Lines,
            ),
            CurveKind::ShortLine if map.curves.iter().any(|other| other.kind != CurveKind::ShortLine) => {
                (", line", Stroke::new().color(colour).width(0.0), Draw::Markers)
            }
            CurveKind::ShortLine => ("", Stroke::new().color(colour).width(2.0), Draw::LinesMarkers),
        };
        let name = format!("{}{what}", curve.algorithm);
        let said: Vec<String> = found()
            .map(|(x, step)| format!("{name}: {} → {} ms", number(Some(*x)), number(Some(1e3 * step))))
            .collect();
        let symbol = if matches!(mode, Draw::Markers) {
            MarkerSymbol::X
        } else {
            MarkerSymbol::Circle
        };
        traces.push(
            Scatter::new(x, y)
                .mode(mode)
                .name(name)
                .legend_group(curve.algorithm)
                .show_legend(curve.kind != CurveKind::Theory)
                .hover_text_array(said)
                .hover_info(HoverInfo::Text)
                .line(stroke)
                .marker(Marker::new().color(colour).size(7).symbol(symbol)),
        );
    }
    if traces.is_empty() {
        return String::new();
    }
    let points = || map.curves.iter().flat_map(|curve| &curve.points);
    let x = if map.logarithmic {
        decades_of(map.x, points().map(|(x, _)| *x))
    } else {
        axis(map.x).zero_line(false)
    };
    let y = decades_of(map.y, points().map(|(_, step)| 1e3 * step));
    format!(
        "{}<p class=\"caption\">{}</p>\n",
        finished(
            traces,
            layout(x, y).hover_mode(HoverMode::Closest),
            &format!("plot-map-{index}"),
            440
        ),
        escape(map.caption)
    )
}

/// Columns of numbers in the table of all runs.
const NUMBERS: &[PageColumn<Line>] = &[
    ("macro step", "ms", "n", |line| step(line.row.macro_step)),
    ("micro step", "ms", "n", |line| step(line.row.micro_step)),
    ("ω h", "", "n", |line| fixed(line.figures.omega_h, 2)),
    ("growth", "per step", "n", |line| fixed(line.figures.amplification, 4)),
    ("energy made", "W", "n", |line| number(line.figures.energy_growth)),
    ("share", "%", "n", |line| number(line.figures.energy_share)),
    ("filtered error", "% of σ", "n", |line| number(line.row.filtered_error)),
    ("raw error", "% of σ", "n", |line| number(line.row.raw_error)),
    ("mean", "N", "n", |line| fixed(line.row.mean, 1)),
    ("σ", "N", "n", |line| fixed(line.row.std, 2)),
    ("loss", "%", "n", |line| fixed(line.row.loss, 2)),
    ("largest", "N", "n", |line| fixed(line.figures.largest_force, 0)),
    ("Newton", "most", "n", |line| count(line.figures.most_iterations)),
    ("drift", "m", "n", |line| number(line.figures.drift)),
    ("slack", "most", "n", |line| count(line.figures.slack_droppers)),
];

fn table_of_figures(table: &StabilityTable) -> String {
    let head = head_cells([("run", "", false), ("status", "", false)]) + &heads(NUMBERS);
    let mut body = String::new();
    for lines in by_case(table) {
        body.push_str(&format!(
            "<tr><th colspan=\"{}\">{}: {}</th></tr>\n",
            2 + NUMBERS.len(),
            escape(&lines[0].case),
            escape(&lines[0].about)
        ));
        for line in lines {
            body.push_str(&figures(line));
        }
    }
    format!(
        "<details><summary>All runs</summary>{}</details>\n<p class=\"caption\">All columns are in \
         stability.csv.</p>\n",
        scrolled(&head, &body)
    )
}

fn figures(line: &Line) -> String {
    let row = &line.row;
    let status = status_word(row.status);
    let cells = cells(NUMBERS, line);
    format!(
        "<tr title=\"{}\"><td class=\"s\">{}</td><td class=\"c {status}\">{status}</td>{cells}</tr>\n",
        escape(&row.reason),
        escape(&heading(&(row.mode.clone(), row.algorithm.clone())))
    )
}

fn legend() -> String {
    format!(
        "<p>{}.</p>\n\
         <p>A coupled run is compared with the monolithic one at the same micro step, so that only the coupling \
         differs; the monolithic one with itself at half the micro step. The monolithic one is also <b>limit</b> where \
         the time integration made more than 1 % of the energy that was exchanged; a coupled one is at most \
         <b>limit</b> where the monolithic one is. A run that is limit or diverged is repeated with shorter steps: its \
         boundary.</p>\n\
         <p>Energy made: by the coupling, or in one system by the time integration, per second; there kinetic and \
         potential energy are followed from step to step, together with the work of prescribed motion and the heat of \
         all dampers and friction, and numerical damping shows as a loss. Share: of the work that crossed the contact, \
         or of work and heat. ω h: circular frequency of the collector head on the contact's spring times the macro \
         step (one system: the micro step). Growth: spectral radius of the coupling on that oscillation without \
         damping. Newton: most iterations of one internal step. Drift: largest violation of a joint. Slack: most \
         droppers without tension at one time.</p>\n",
        status_rule()
    )
}
