//! `reproduction.html`.

use plotly::Scatter;
use plotly::common::{HoverInfo, Line as Stroke, Marker, Mode as Draw};

use super::figures::figures;
use super::judge::{Line, Reproduction};
use super::open::OPEN;
use super::plan::{Mesh, RunGroup};
use super::published::{CASES, Case};
use super::spread::Spread;
use super::text::{cases, changes, force, head, left_out, missing, overall, readings, spreads};
use super::verdict::VERDICT_RULE;
use crate::engine::export::plot::{BOUND, Trace, dotted, open_points};
use crate::engine::export::{incomplete, scrolled};
use results::report::plots::{COLOURS, axis, finished, layout};
use results::report::{Page, escape, remarks};
use simulation::Mode;

/// The page of a reproduction.
#[must_use]
pub fn page(reproduction: &Reproduction) -> Page {
    let mut page = Page::new("Kulkarni 2016, computed again");
    page.lead(&lead(reproduction));
    page.section("Mean and standard deviation", &table(&cases(reproduction)));
    page.section("Standard deviation against the mesh", &meshes(reproduction));
    page.section("Changes between cases, in percent", &relations(reproduction));
    page.section(
        "Readings of the wind: changes, the published ones in the head",
        &table(&readings(reproduction)),
    );
    page.section("Wind on the pan-head", &wind_on_head(reproduction));
    for mesh in Mesh::ALL {
        let heading = format!("What the thesis leaves open, {}", mesh.name());
        page.section(&heading, &open(reproduction, mesh));
    }
    for (heading, body) in figures(reproduction) {
        page.section(heading, &body);
    }
    page.section("What was not computed", &remarks(&missing(reproduction)));
    page
}

fn lead(reproduction: &Reproduction) -> String {
    let mut html = "<p>Published: S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, \
                    University of Illinois at Chicago, 2016: Table 6 and section 5.1. Forces are positive in \
                    compression. The mean is calibrated by the point where the uplift force acts; nothing is tuned to \
                    the standard deviation or to a change under wind.</p>\n"
        .to_owned();
    html.push_str(&incomplete(reproduction, ""));
    html
}

/// Rows of plain text as a table; the first one is its head.
fn table(rows: &[Vec<String>]) -> String {
    let cells = |cells: &Vec<String>, tag: &str| -> String {
        let cell = |cell: &String| format!("<{tag}>{}</{tag}>", escape(cell));
        cells.iter().map(cell).collect()
    };
    let Some((head, body)) = rows.split_first() else {
        return String::new();
    };
    let body: String = body
        .iter()
        .map(|row| format!("<tr>{}</tr>\n", cells(row, "td")))
        .collect();
    scrolled(&cells(head, "th"), &body)
}

/// Standard deviation of each case on each plain mesh.
fn meshes(reproduction: &Reproduction) -> String {
    let elements = |line: &Line| match line.mesh {
        Mesh::Plain(count) => Some(9.0 * count as f64),
        Mesh::Corrected => None,
    };
    let mut traces: Vec<Trace> = Vec::new();
    for (case, colour) in CASES.iter().zip(COLOURS) {
        let points: Vec<(f64, f64)> = computed(reproduction, case)
            .filter_map(|line| Some((elements(line)?, line.row.std?)))
            .collect();
        let (x, y) = points.into_iter().unzip();
        let curve = Scatter::new(x, y).mode(Draw::LinesMarkers).name(case.title);
        traces.push(
            curve
                .line(Stroke::new().color(colour))
                .marker(Marker::new().color(colour)),
        );
    }
    let value = CASES[0].std.value;
    traces.push(dotted(vec![9.0, 72.0], vec![value; 2], "published, no wind", BOUND));
    let converged = reproduction
        .lines
        .iter()
        .find(|line| line.mesh == Mesh::Corrected && line.group == RunGroup::Mesh && line.case.scene == CASES[0].scene)
        .and_then(|line| line.row.std);
    let converged = converged.map_or_else(String::new, |std| {
        format!(
            "<p>Converged, {}: {std:.2} N without wind.</p>\n",
            Mesh::Corrected.name()
        )
    });
    let drawn = finished(
        traces,
        layout(axis("elements per span"), axis("standard deviation [N]")),
        "meshes",
        360,
    );
    drawn + &converged
}

/// Runs of a case in one system, as published and on other meshes.
fn computed<'a>(reproduction: &'a Reproduction, case: &'a Case) -> impl Iterator<Item = &'a Line> {
    reproduction.lines.iter().filter(|line| {
        line.group.is_case() && line.case.scene == case.scene && line.row.mode == Mode::Monolithic.name()
    })
}

/// Verdicts on the published changes, over all meshes and on each.
fn relations(reproduction: &Reproduction) -> String {
    if reproduction.relations.is_empty() {
        return String::new();
    }
    format!(
        "{}<p>{}</p>\n{}",
        table(&overall(reproduction)),
        escape(VERDICT_RULE),
        table(&changes(reproduction))
    )
}

/// Runs of a spread, in the order of the values.
fn runs<'a>(reproduction: &'a Reproduction, spread: &'a Spread) -> impl Iterator<Item = &'a Line> {
    reproduction.lines.iter().filter(|line| line.is_in(spread))
}

/// The spreads on one mesh as bars, every run as a point, the published value of each as a dotted line.
fn bars(reproduction: &Reproduction, spreads: &[&Spread], id: &str) -> String {
    let mut traces: Vec<Trace> = Vec::new();
    let count = spreads.len() as f64;
    let mut names = Vec::new();
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (index, spread) in spreads.iter().enumerate() {
        let at = count - index as f64;
        names.push((at, spread.quantity));
        x.extend([spread.case.std.value; 2]);
        y.extend([at + 0.5, at - 0.5]);
        let Some(ends) = spread.std() else { continue };
        traces.push(
            Scatter::new(ends.to_vec(), vec![at; 2])
                .mode(Draw::Lines)
                .show_legend(false)
                .hover_info(HoverInfo::Skip)
                .line(Stroke::new().color(COLOURS[0]).width(6.0)),
        );
        let runs: Vec<(&Line, f64)> = runs(reproduction, spread)
            .filter_map(|line| Some((line, line.row.std?)))
            .collect();
        let said = runs
            .iter()
            .map(|(line, std)| format!("{} {}: {std:.2} N", line.quantity, line.value))
            .collect();
        traces.push(open_points(runs.iter().map(|(_, std)| (*std, at)), said, COLOURS[0]));
    }
    traces.push(dotted(x, y, "published", BOUND));
    let quantities = axis("")
        .tick_values(names.iter().map(|(y, _)| *y).collect())
        .tick_text(names.iter().map(|(_, name)| *name).collect::<Vec<_>>())
        .range(vec![0.4, count + 0.6]);
    finished(
        traces,
        layout(axis("standard deviation [N]"), quantities).hover_mode(plotly::layout::HoverMode::Closest),
        id,
        120 + 26 * spreads.len() as u32,
    )
}

/// Each spread with the values at its ends.
fn ends(spreads: &[&Spread]) -> Vec<Vec<String>> {
    let head = [
        "quantity",
        "smallest std [N]",
        "at",
        "largest std [N]",
        "at",
        "published",
        "",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for spread in spreads {
        let mut row = vec![spread.quantity.to_owned()];
        for end in spread
            .ends
            .as_ref()
            .map_or([None; 2], |[low, high]| [Some(low), Some(high)])
        {
            row.push(force(end.map(|end| end.std)));
            row.push(end.map_or_else(String::new, |end| end.at.clone()));
        }
        row.extend([spread.case.std.printed(), spread.verdict().to_owned()]);
        rows.push(row);
    }
    rows
}

/// The open quantities on one mesh: spreads as bars, every one and every run in a table.
fn open(reproduction: &Reproduction, mesh: Mesh) -> String {
    let spreads = spreads(reproduction, mesh);
    if spreads.is_empty() {
        return String::new();
    }
    let id = format!("open-{}", if mesh == Mesh::Corrected { "corrected" } else { "plain" });
    let with = |held: Option<bool>| -> Vec<&str> {
        let of = spreads.iter().filter(|spread| spread.holds_published() == held);
        of.map(|spread| spread.quantity).collect()
    };
    let inside = with(Some(true));
    let mut said = if inside.is_empty() {
        "The published standard deviation lies inside the range of none of them.".to_owned()
    } else {
        format!(
            "The published standard deviation lies inside the range of {} of {}: {}.",
            inside.len(),
            spreads.len(),
            inside.join(", ")
        )
    };
    let unknown = with(None);
    if !unknown.is_empty() {
        said.push_str(&format!(" Not computed: {}.", unknown.join(", ")));
    }
    let head = ["quantity", "value", "mean [N]", "std [N]", "std, raw", "why this range"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for spread in &spreads {
        let why = OPEN.iter().find(|open| open.quantity == spread.quantity);
        for (index, line) in runs(reproduction, spread).enumerate() {
            let first = |text: &str| if index == 0 { text.to_owned() } else { String::new() };
            rows.push(vec![
                first(spread.quantity),
                line.value.clone(),
                force(line.row.mean),
                force(line.row.std),
                force(line.raw_std),
                first(why.map_or("", |open| &open.range)),
            ]);
        }
    }
    format!(
        "{}<p>{}</p>\n{}{}{}",
        bars(reproduction, &spreads, &id),
        escape(&said),
        table(&ends(&spreads)),
        remarks(&left_out(reproduction, mesh)),
        table(&rows)
    )
}

/// Drag and lift in every reading of the wind.
fn wind_on_head(reproduction: &Reproduction) -> String {
    let rows = head(reproduction);
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "{}<p>Over the evaluation range, in N; \u{201c}even travel\u{201d}: Eq. (18) with Table 5 for a pan-head that \
         moves with the train, in the air of the scene. The thesis prints Figs. 11 and 12 without a figure in its \
         text; it says that the forces are nonlinear, depend on the speeds of train and wind, and that the lift is \
         positive, upward. By Eq. (18) drag and lift are 5 to 2 at all times.</p>\n",
        table(&rows)
    )
}
