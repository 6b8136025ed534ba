//! `reproduction.html`.

use plotly::Scatter;
use plotly::common::{DashType, HoverInfo, Line as Stroke, Marker, Mode as Draw};
use plotly::layout::Axis;

use super::execute::{Line, Reproduction};
use super::open::OPEN;
use super::plan::{Group, Mesh};
use super::published::{CASES, Case};
use super::text::{cases, changes, force, head, missing, published as case_of, readings, spreads};
use crate::report::plots::{COLOURS, axis, finished, layout, rounded};
use crate::report::{Page, escape, remarks};
use crate::simulation::Mode;

/// A curve as the plots take it.
type Trace = Box<Scatter<f64, f64>>;

/// Colour of published values.
const PUBLISHED: &str = "#5b6675";

/// The page of a reproduction.
#[must_use]
pub fn page(reproduction: &Reproduction) -> String {
    let mut page = Page::new("Kulkarni 2016, computed again");
    page.lead(&lead(reproduction));
    page.section("Mean and standard deviation", &table(&cases(reproduction)));
    page.section("Standard deviation against the mesh", &meshes(reproduction));
    page.section("Changes between cases, in percent", &table(&changes(reproduction)));
    page.section(
        "Readings of the wind: changes, the published ones in the head",
        &table(&readings(reproduction)),
    );
    page.section("Wind on the pan-head", &wind_on_head(reproduction));
    for mesh in Mesh::ALL {
        let heading = format!("What the thesis leaves open, {}", mesh.name());
        page.section(&heading, &open(reproduction, mesh));
    }
    for (heading, shown, times) in FIGURES {
        let body = match shown {
            Shown::Contact(cases) => figure(reproduction, heading, cases, *times),
            Shown::Drag => wind_figure(reproduction, heading, 0),
            Shown::Lift => wind_figure(reproduction, heading, 1),
        };
        page.section(heading, &body);
    }
    page.section("What was not computed", &remarks(&missing(reproduction)));
    page.finish()
}

fn lead(reproduction: &Reproduction) -> String {
    let mut html = "<p>Published: S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of \
                    Illinois at Chicago, 2016: Table 6 and section 5.1. Forces are positive in compression. The mean is calibrated by the \
                    point where the uplift force acts; nothing is tuned to the standard deviation or to a change under wind.</p>\n"
        .to_owned();
    if !reproduction.complete {
        html.push_str(&format!(
            "<p class=\"warning\">Incomplete: {} of {} runs were made.</p>\n",
            reproduction.made(),
            reproduction.lines.len()
        ));
    }
    html
}

/// Rows of plain text as a table; the first one is its head.
fn table(rows: &[Vec<String>]) -> String {
    let row = |cells: &Vec<String>, tag: &str| -> String {
        let cells: String = cells
            .iter()
            .map(|cell| format!("<{tag}>{}</{tag}>", escape(cell)))
            .collect();
        format!("<tr>{cells}</tr>\n")
    };
    let Some((head, body)) = rows.split_first() else {
        return String::new();
    };
    let body: String = body.iter().map(|cells| row(cells, "td")).collect();
    format!(
        "<div class=\"scroll\"><table><thead>{}</thead><tbody>{body}</tbody></table></div>\n",
        row(head, "th")
    )
}

/// A dotted line with a name.
fn published(x: [f64; 2], y: [f64; 2], name: &str) -> Trace {
    Scatter::new(x.to_vec(), y.to_vec())
        .mode(Draw::Lines)
        .name(name)
        .hover_info(HoverInfo::Name)
        .line(Stroke::new().color(PUBLISHED).width(1.4).dash(DashType::Dot))
}

/// Standard deviation of each case on each plain mesh.
fn meshes(reproduction: &Reproduction) -> String {
    let elements = |line: &Line| match line.mesh {
        Mesh::Plain(count) => Some(9.0 * count as f64),
        Mesh::Cured => None,
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
    traces.push(published([9.0, 72.0], [value, value], "published, no wind"));
    let converged = reproduction
        .lines
        .iter()
        .find(|line| line.mesh == Mesh::Cured && line.group == Group::Mesh && line.case.scene == CASES[0].scene)
        .and_then(|line| line.row.std);
    let converged = converged.map_or_else(String::new, |std| {
        format!("<p>Converged, {}: {std:.2} N without wind.</p>\n", Mesh::Cured.name())
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

/// The open quantities on one mesh: ranges as bars, every run in a table.
fn open(reproduction: &Reproduction, mesh: Mesh) -> String {
    let spreads = spreads(reproduction, mesh);
    if spreads.is_empty() {
        return String::new();
    }
    let mut traces: Vec<Trace> = Vec::new();
    let count = spreads.len() as f64;
    let mut names = Vec::new();
    for (index, spread) in spreads.iter().enumerate() {
        let y = count - index as f64;
        names.push((y, spread.quantity));
        let Some([low, high]) = spread.std else { continue };
        traces.push(
            Scatter::new(vec![low, high], vec![y, y])
                .mode(Draw::Lines)
                .show_legend(false)
                .hover_info(HoverInfo::Skip)
                .line(Stroke::new().color(COLOURS[0]).width(6.0)),
        );
        let runs: Vec<&&Line> = spread.lines.iter().filter(|line| line.row.std.is_some()).collect();
        let said = runs
            .iter()
            .map(|line| format!("{} {}: {} N", line.quantity, line.value, force(line.row.std)))
            .collect();
        traces.push(
            Scatter::new(
                runs.iter().filter_map(|line| line.row.std).collect(),
                vec![y; runs.len()],
            )
            .mode(Draw::Markers)
            .show_legend(false)
            .hover_text_array(said)
            .hover_info(HoverInfo::Text)
            .marker(
                Marker::new()
                    .color("#ffffff")
                    .size(7)
                    .line(Stroke::new().color(COLOURS[0]).width(1.4)),
            ),
        );
    }
    let value = CASES[0].std.value;
    traces.push(published([value, value], [0.5, count + 0.5], "published"));
    let quantities = axis("")
        .tick_values(names.iter().map(|(y, _)| *y).collect())
        .tick_text(names.iter().map(|(_, name)| *name).collect::<Vec<_>>())
        .range(vec![0.4, count + 0.6]);
    let id = format!("open-{}", if mesh == Mesh::Cured { "cured" } else { "plain" });
    let plot = finished(
        traces,
        layout(axis("standard deviation [N]"), quantities).hover_mode(plotly::layout::HoverMode::Closest),
        &id,
        120 + 26 * spreads.len() as u32,
    );
    let head = ["quantity", "value", "mean [N]", "std [N]", "std, raw", "why this range"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for spread in &spreads {
        let why = OPEN.iter().find(|open| open.quantity == spread.quantity);
        for (index, line) in spread.lines.iter().enumerate() {
            let why = why.filter(|_| index == 0).map_or("", |open| open.range);
            rows.push(vec![
                if index == 0 {
                    spread.quantity.to_owned()
                } else {
                    String::new()
                },
                line.value.clone(),
                force(line.row.mean),
                force(line.row.std),
                force(line.raw_std),
                why.to_owned(),
            ]);
        }
    }
    let inside: Vec<&str> = spreads
        .iter()
        .filter(|spread| spread.holds(value))
        .map(|spread| spread.quantity)
        .collect();
    let verdict = if inside.is_empty() {
        "The published standard deviation lies inside the range of none of them.".to_owned()
    } else {
        format!(
            "The published standard deviation lies inside the range of: {}.",
            inside.join(", ")
        )
    };
    format!("{plot}<p>{}</p>\n{}", escape(&verdict), table(&rows))
}

/// What a figure of the thesis shows.
enum Shown {
    /// Contact forces of these cases.
    Contact(&'static [usize]),
    /// Drag of the wind on the pan-head, with wind on the pantograph.
    Drag,
    /// Its lift.
    Lift,
}

use Shown::{Contact, Drag, Lift};

/// Figures of the thesis that show computed forces: heading, what of which cases, time range in s.
const FIGURES: &[(&str, Shown, [f64; 2])] = &[
    ("Fig. 6: contact force without wind", Contact(&[0]), [0.0, 10.0]),
    ("Fig. 7: the same, 7 to 10 s", Contact(&[0]), [7.0, 10.0]),
    ("Fig. 8: penalty force and sliding joint", Contact(&[0, 1]), [0.0, 10.0]),
    ("Fig. 9: the same, 7 to 10 s", Contact(&[0, 1]), [7.0, 10.0]),
    ("Fig. 10: wind on the pantograph", Contact(&[2]), [0.0, 10.0]),
    ("Fig. 11: drag on the pan-head", Drag, [0.0, 10.0]),
    ("Fig. 12: lift on the pan-head", Lift, [0.0, 10.0]),
    (
        "Fig. 13: with wind on the pantograph and without",
        Contact(&[0, 2]),
        [0.0, 10.0],
    ),
    ("Fig. 14: the same, 7 to 10 s", Contact(&[0, 2]), [7.0, 10.0]),
    ("Fig. 15: wind on pantograph and wires", Contact(&[3]), [0.0, 10.0]),
    (
        "Fig. 16: with wind on pantograph and wires and without",
        Contact(&[0, 3]),
        [0.0, 10.0],
    ),
    ("Fig. 17: the same, 7 to 10 s", Contact(&[0, 3]), [7.0, 10.0]),
];

/// Drag and lift in every reading of the wind.
fn wind_on_head(reproduction: &Reproduction) -> String {
    let rows = head(reproduction);
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "{}<p>Over the evaluation range, in N; \u{201c}even travel\u{201d}: Eq. (18) with Table 5 for a pan-head that moves with the \
         train, in the air of the scene. The thesis prints Figs. 11 and 12 without a figure in its text; it says that the forces are \
         nonlinear, depend on the speeds of train and wind, and that the lift is positive, upward. By Eq. (18) drag and lift are 5 to 2 \
         at all times.</p>\n",
        table(&rows)
    )
}

/// Drag (`part` = 0) or lift (1) of the wind on the pan-head; that of even travel as a line.
fn wind_figure(reproduction: &Reproduction, heading: &str, part: usize) -> String {
    let line = case_of(reproduction, 2);
    let Some((line, wind)) = line.and_then(|line| Some((line, line.wind.as_ref()?))) else {
        return String::new();
    };
    let (name, force) = [("drag", &wind.drag), ("lift", &wind.lift)][part];
    let time: Vec<f64> = (0..force.len()).map(|index| index as f64 * line.output_step).collect();
    let end = time.last().copied().unwrap_or_default();
    let computed = Scatter::new(rounded(&time, 1e3), rounded(force, 1e2))
        .mode(Draw::Lines)
        .name(name)
        .line(Stroke::new().color(COLOURS[0]).width(1.1));
    let mut traces: Vec<Trace> = vec![computed];
    if let Some(even) = line.even_head.map(|even| even[part]) {
        traces.push(published([0.0, end], [even, even], "Eq. (18), even travel"));
    }
    let y = axis(&format!("{name} on the pan-head [N]"));
    finished(traces, layout(axis("time [s]"), y), &figure_id(heading), 320)
}

/// Name of a figure in the page.
fn figure_id(heading: &str) -> String {
    let number: String = heading.chars().filter(char::is_ascii_digit).take(2).collect();
    format!("figure-{number}")
}

/// Contact forces of some cases, as the time integration gives them; the published mean as a line. Its curves are printed as
/// pictures only.
fn figure(reproduction: &Reproduction, heading: &str, shown: &[usize], [from, to]: [f64; 2]) -> String {
    let mut traces: Vec<Trace> = Vec::new();
    for (&index, colour) in shown.iter().zip(COLOURS) {
        let case = &CASES[index];
        let run = computed(reproduction, case).find(|line| line.group == Group::Published);
        let Some((line, curve)) = run.and_then(|line| Some((line, line.curve.as_ref()?))) else {
            continue;
        };
        let samples = curve.raw.iter().enumerate();
        let samples = samples.map(|(index, force)| (index as f64 * line.output_step, *force));
        let (time, force): (Vec<f64>, Vec<f64>) = samples.filter(|(time, _)| (from..=to).contains(time)).unzip();
        traces.push(
            Scatter::new(rounded(&time, 1e3), rounded(&force, 1e1))
                .mode(Draw::Lines)
                .name(case.title)
                .line(Stroke::new().color(colour).width(1.1)),
        );
    }
    let Some(&last) = shown.last().filter(|_| !traces.is_empty()) else {
        return String::new();
    };
    let mean = CASES[last].mean.value;
    let name = format!("published mean, {}", CASES[last].title);
    traces.push(published([from, to], [mean, mean], &name));
    let time: Axis = axis("time [s]").range(vec![from, to]);
    finished(
        traces,
        layout(time, axis("contact force [N]")),
        &figure_id(heading),
        320,
    )
}
