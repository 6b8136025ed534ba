//! `stability.html`.

use plotly::common::{DashType, HoverInfo, Line as Stroke, Marker, MarkerSymbol, Mode as Draw};

use super::judge::{ALGORITHMS, Line, StabilityTable};
use super::maps::{CurveKind, Map};
use super::text::{by_case, counts, ways};
use crate::engine::export::{grouped, incomplete, run_lines, status_rule, status_word};
use results::report::format::{count, fixed, number, step};
use results::report::plots::{axis, colour, curve, decades_of, figure, points};
use results::report::{Page, PageColumn, cell, escape, heads, lined, scrolled, spanning};

/// The page of the hard cases.
pub(super) fn page(table: &StabilityTable) -> Page {
    let mut page = Page::new("Hard cases");
    let cases = by_case(table).count();
    let lead = format!("<p><b>{cases} cases</b> · {}</p>\n", counts(table));
    page.lead(&(lead + &incomplete(table, "")));
    page.section("Status", &overview(table));
    page.section("What is not stable, and why", &reasons(table));
    for (index, map) in table.maps.iter().enumerate() {
        page.section(&map.title, &drawn(map, index));
    }
    page.section("Figures", &table_of_figures(table));
    page.section("How to read this", &legend());
    page
}

/// A line of cells per case, coloured by status.
fn overview(table: &StabilityTable) -> String {
    let ways = ways(table);
    let line = |lines: &[Line]| {
        let [case, about] = [&lines[0].case, &lines[0].about].map(|text| escape(text));
        let name = format!("<b>{case}</b><br><span class=\"soft\">{about}</span>");
        let in_way = |way: &String| match lines.iter().find(|line| line.way() == *way) {
            Some(line) => status_cell(line),
            None => cell("", ""),
        };
        cell("name", &name) + &ways.iter().map(in_way).collect::<String>()
    };
    let head: String = ways.iter().map(|way| format!("<th>{}</th>", escape(way))).collect();
    format!(
        "{}<p class=\"caption\">In the cells: rms error of the filtered force in percent of the reference's standard \
         deviation. Under the pointer: what ran and why.</p>\n",
        lined(&format!("<th>case</th>{head}"), by_case(table).map(line))
    )
}

fn status_cell(line: &Line) -> String {
    let status = status_word(line.row.status);
    let error = line.row.filtered_error.filter(|error| error.is_finite());
    let error = error.map_or_else(String::new, |error| format!("<br>{} %", number(Some(error))));
    format!(
        "<td class=\"c {status}\" title=\"{}\">{status}{error}</td>",
        escape(&line.row.reason)
    )
}

/// One line per case and reason.
fn reasons(table: &StabilityTable) -> String {
    let mut said = Vec::new();
    for lines in by_case(table) {
        let ended = lines.iter().filter_map(|line| {
            let status = line.row.trouble()?;
            let mut reason = line.row.reason.clone();
            if !line.figures.boundary.is_empty() {
                reason.push_str(&format!(" – {}", line.figures.boundary));
            }
            Some(((status.name(), reason), line.way()))
        });
        said.extend(grouped(ended).into_iter().map(|((status, reason), ways)| {
            let (case, ways) = (escape(&lines[0].case), escape(&ways.join(", ")));
            cell("s", &case) + &cell("c", status) + &cell("", &ways) + &cell("remark", &escape(&reason))
        }));
    }
    if said.is_empty() {
        return String::new();
    }
    lined(
        "<th>case</th><th>status</th><th>run</th><th>reason – boundary</th>",
        said,
    )
}

fn drawn(map: &Map, index: usize) -> String {
    let mut traces = Vec::new();
    let only_line = map.curves.iter().all(|curve| curve.kind == CurveKind::ShortLine);
    for found in &map.curves {
        let place = ALGORITHMS.iter().position(|name| *name == found.algorithm).unwrap_or(0);
        let colour = colour(place);
        // A logarithmic axis has no place for zero: a step that was not found is left out.
        let points = found.points.iter().filter(|(_, step)| *step > 0.0);
        let (x, y): (Vec<f64>, Vec<f64>) = points.map(|(x, step)| (*x, 1e3 * step)).unzip();
        if x.is_empty() {
            continue;
        }
        let (what, width, mode, symbol) = match found.kind {
            CurveKind::Theory => (", theory", 1.2, Draw::Lines, MarkerSymbol::Circle),
            CurveKind::ShortLine if !only_line => (", line", 0.0, Draw::Markers, MarkerSymbol::X),
            _ => ("", 2.0, Draw::LinesMarkers, MarkerSymbol::Circle),
        };
        let mut stroke = Stroke::new().color(colour).width(width);
        if found.kind == CurveKind::Theory {
            stroke = stroke.dash(DashType::Dot);
        }
        let name = format!("{}{what}", found.algorithm);
        let said = x.iter().zip(&y);
        let said = said.map(|(x, step)| format!("{name}: {} → {} ms", number(Some(*x)), number(Some(*step))));
        let said: Vec<String> = said.collect();
        traces.push(
            curve(x, y, &name, colour, width)
                .mode(mode)
                .legend_group(found.algorithm)
                .show_legend(found.kind != CurveKind::Theory)
                .hover_text_array(said)
                .hover_info(HoverInfo::Text)
                .line(stroke)
                .marker(Marker::new().color(colour).size(7).symbol(symbol)),
        );
    }
    let all = || map.curves.iter().flat_map(|curve| &curve.points);
    let x = if map.logarithmic {
        decades_of(&map.x, all().map(|(x, _)| *x))
    } else {
        axis(&map.x).zero_line(false)
    };
    let y = decades_of(&map.y, all().map(|(_, step)| 1e3 * step));
    let id = format!("plot-map-{index}");
    figure(traces, points(x, y), (&id, 440), &escape(&map.caption))
}

/// Columns of the table of all runs.
const COLUMNS: &[PageColumn<Line>] = &[
    ("run", "", "s", |line| escape(&line.way())),
    ("status", "", "c", |line| status_word(line.row.status).to_owned()),
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
    let of_case = |lines: &[Line]| {
        let [case, about] = [&lines[0].case, &lines[0].about].map(|text| escape(text));
        spanning(COLUMNS, &format!("{case}: {about}")) + &run_lines(COLUMNS, lines, |line| &line.row)
    };
    let body: String = by_case(table).map(of_case).collect();
    format!(
        "<details><summary>All runs</summary>{}</details>\n<p class=\"caption\">All columns are in \
         stability.csv.</p>\n",
        scrolled(&heads(COLUMNS), &body)
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
