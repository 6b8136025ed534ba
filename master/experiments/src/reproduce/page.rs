//! `reproduction.html`.

use plotly::Scatter;
use plotly::common::{HoverInfo, Line as Stroke, Marker, Mode as Draw};

use super::figures::figures;
use super::judge::{Line, Reproduction};
use super::open::OPEN;
use super::plan::{Mesh, RunGroup};
use super::published::CASES;
use super::spread::Spread;
use super::text::{cases, changes, force, head, left_out, missing, overall, readings, spreads};
use super::verdict::VERDICT_RULE;
use crate::engine::export::incomplete;
use results::report::plots::{BOUND, COLOURS, Trace, axis, dotted, finished, layout, open_points, points};
use results::report::{Page, TextColumn, cell, escape, lined, remarks, text_table};

/// The page of a reproduction.
pub(super) fn page(reproduction: &Reproduction) -> Page {
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
        page.section(&heading, &body);
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
    let Some((head, body)) = rows.split_first() else {
        return String::new();
    };
    let head: String = head.iter().map(|name| format!("<th>{}</th>", escape(name))).collect();
    let line = |cells: &Vec<String>| cells.iter().map(|text| cell("", &escape(text))).collect();
    lined(&head, body.iter().map(line))
}

/// Standard deviation of each case on each plain mesh.
fn meshes(reproduction: &Reproduction) -> String {
    let lines = || reproduction.lines.iter();
    let on_plain = |line: &Line| match line.mesh {
        Mesh::Plain(count) => Some((9.0 * count as f64, line.row.std?)),
        Mesh::Corrected => None,
    };
    let mut traces: Vec<Trace> = Vec::new();
    for (case, colour) in CASES.iter().zip(COLOURS) {
        let (x, y) = lines().filter(|line| line.computes(case)).filter_map(on_plain).unzip();
        let curve = Scatter::new(x, y).mode(Draw::LinesMarkers).name(&case.title);
        let marker = Marker::new().color(colour);
        traces.push(curve.line(Stroke::new().color(colour)).marker(marker));
    }
    let value = CASES[0].std.value;
    traces.push(dotted(vec![9.0, 72.0], vec![value; 2], "published, no wind", BOUND));
    let converged = |line: &&Line| {
        line.mesh == Mesh::Corrected && line.group == RunGroup::Mesh && line.case.scene == CASES[0].scene
    };
    let converged = lines().find(converged).and_then(|line| line.row.std).map(|std| {
        let mesh = Mesh::Corrected.name();
        format!("<p>Converged, {mesh}: {std:.2} N without wind.</p>\n")
    });
    let axes = layout(axis("elements per span"), axis("standard deviation [N]"));
    finished(traces, axes, "meshes", 360) + &converged.unwrap_or_default()
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
        let bar = Scatter::new(ends.to_vec(), vec![at; 2]).mode(Draw::Lines);
        let stroke = Stroke::new().color(COLOURS[0]).width(6.0);
        traces.push(bar.show_legend(false).hover_info(HoverInfo::Skip).line(stroke));
        let runs = runs(reproduction, spread).filter_map(|line| Some((line, line.row.std?)));
        let point = |(line, std): (&Line, f64)| ((std, at), format!("{} {}: {std:.2} N", line.quantity, line.value));
        let (places, said): (Vec<(f64, f64)>, Vec<String>) = runs.map(point).unzip();
        traces.push(open_points(places, said, COLOURS[0]));
    }
    traces.push(dotted(x, y, "published", BOUND));
    let quantities = axis("")
        .tick_values(names.iter().map(|(y, _)| *y).collect())
        .tick_text(names.iter().map(|(_, name)| *name).collect::<Vec<_>>())
        .range(vec![0.4, count + 0.6]);
    let axes = points(axis("standard deviation [N]"), quantities);
    finished(traces, axes, id, 120 + 26 * spreads.len() as u32)
}

/// Columns of the spreads with the values at their ends.
const END_COLUMNS: &[TextColumn<Spread, 1>] = &[
    (["quantity"], |spread| spread.quantity.to_owned()),
    (["smallest std [N]"], |spread| force(spread.end(0).map(|end| end.std))),
    (["at"], |spread| spread.end(0).map_or("", |end| &end.at).to_owned()),
    (["largest std [N]"], |spread| force(spread.end(1).map(|end| end.std))),
    (["at"], |spread| spread.end(1).map_or("", |end| &end.at).to_owned()),
    (["published"], |spread| spread.case.std.printed()),
    ([""], |spread| spread.verdict().to_owned()),
];

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
    let (count, all) = (inside.len(), spreads.len());
    let of = match count {
        0 => "none of them".to_owned(),
        _ => format!("{count} of {all}: {}", inside.join(", ")),
    };
    let mut said = format!("The published standard deviation lies inside the range of {of}.");
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
        table(&text_table(END_COLUMNS, spreads.iter().copied())),
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
