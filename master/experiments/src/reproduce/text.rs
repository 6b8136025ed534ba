//! The tables on the terminal.

use super::judge::{Line, Reproduction, difference};
use super::open::{OPEN, Open};
use super::plan::{Mesh, RunGroup};
use super::published::CASES;
use super::relation::{PAIRS, Relation};
use super::spread::Spread;
use super::verdict::{VERDICT_RULE, Verdict};
use super::wind;
use crate::engine::Table as _;
use crate::engine::export::{TextColumn, heading, text_cells, wrapped};
use crate::engine::table::{Status, short};
use results::report::aligned;

/// Two decimals, where there is a number: the thesis prints its forces so.
pub(super) fn force(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

/// A change with its sign.
pub(super) fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.2}"))
}

/// Columns of the published cases.
const CASE_COLUMNS: &[TextColumn<Line, 1>] = &[
    (["case"], |line| line.case.title.to_owned()),
    (["mesh"], |line| line.mesh.name()),
    (["mode"], |line| line.row.mode.clone()),
    (["mean [N]"], |line| force(line.row.mean)),
    (["published"], |line| line.case.mean.printed()),
    (["diff. %"], |line| {
        percent(difference(line.row.mean, line.case.mean.value))
    }),
    (["std [N]"], |line| force(line.row.std)),
    (["published"], |line| line.case.std.printed()),
    (["diff. %"], |line| {
        percent(difference(line.row.std, line.case.std.value))
    }),
    (["std, raw"], |line| force(line.raw_std)),
];

/// Case, how and on which mesh it was run, published and computed figures; for the groups of the published cases.
pub(super) fn cases(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let cases = reproduction.lines.iter().filter(|line| line.group.is_case());
    let mut rows = heading(CASE_COLUMNS);
    rows.extend(cases.map(|line| text_cells(CASE_COLUMNS, line)));
    rows
}

/// Changes of mean and standard deviation by each reading of the wind, the scene's own first; the published ones in the
/// head.
pub(super) fn readings(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let [calm, _, windy, _] = CASES;
    let published = |windy: f64, calm: f64| percent(Some(windy - calm));
    let head = [
        "reading".to_owned(),
        format!("mean {} N", published(windy.mean.value, calm.mean.value)),
        format!("std {} N", published(windy.std.value, calm.std.value)),
        "std, raw".to_owned(),
    ];
    let own = |scene: &'static str| {
        let of = move |line: &&Line| line.group == RunGroup::Published && line.case.scene == scene;
        reproduction.lines.iter().find(of)
    };
    let (Some(without), Some(with)) = (own(calm.scene), own(windy.scene)) else {
        return Vec::new();
    };
    let rows = |line: &Line, name: &str| {
        let change =
            |with: Option<f64>, without: Option<f64>| percent(with.zip(without).map(|(with, without)| with - without));
        vec![
            name.to_owned(),
            change(line.row.mean, without.row.mean),
            change(line.row.std, without.row.std),
            change(line.raw_std, without.raw_std),
        ]
    };
    let mut table = vec![head.to_vec(), rows(with, wind::own().name)];
    let others = reproduction.lines.iter().filter(|line| line.group == RunGroup::Reading);
    table.extend(others.map(|line| rows(line, &line.value)));
    table
}

/// The wind on the pan-head in every reading, the scene's own first, over the evaluation range; what [Thesis, Eq. (18)]
/// gives for a pan-head that moves with the train beside it. The thesis prints these forces as curves only.
pub(super) fn head(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let head = [
        "reading",
        "drag, even travel [N]",
        "drag: min",
        "mean",
        "max",
        "lift, even travel [N]",
        "lift: min",
        "mean",
        "max",
    ];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    let mut readings = vec![(wind::own(), published(reproduction, 2))];
    for reading in wind::readings() {
        let of = |line: &&Line| line.group == RunGroup::Reading && line.value == reading.name;
        let line = reproduction.lines.iter().find(of);
        readings.push((reading, line));
    }
    for (reading, line) in readings {
        let Some((line, found)) = line.and_then(|line| Some((line, line.head?))) else {
            continue;
        };
        let mut row = vec![reading.name.to_owned()];
        for (part, found) in [found.drag, found.lift].into_iter().enumerate() {
            row.push(force(line.even_head.map(|even| even[part])));
            row.extend([found.min, found.mean, found.max].map(|value| force(Some(value))));
        }
        table.push(row);
    }
    if table.len() == 1 { Vec::new() } else { table }
}

/// A published case as its scene has it, in one system.
pub(super) fn published(reproduction: &Reproduction, case: usize) -> Option<&Line> {
    Line::of(&reproduction.lines, &CASES[case], Mesh::ALL[0])
}

/// Changes between cases, published and computed, in percent.
pub(super) fn changes(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let head = ["from", "to", "mesh", "of", "published", "computed", "verdict", "why"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(reproduction.relations.iter().map(|relation| {
        vec![
            relation.from.title.to_owned(),
            relation.to.title.to_owned(),
            relation.mesh.name(),
            relation.of.to_owned(),
            percent(Some(relation.published)),
            percent(relation.computed),
            relation.verdict.name().to_owned(),
            relation.why.clone(),
        ]
    }));
    rows
}

/// Each published change with the smallest and the largest computed one, and the number of meshes with each verdict.
pub(super) fn overall(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let counted = [Verdict::Holds, Verdict::DirectionOnly, Verdict::Refuted];
    let mut head = ["from", "to", "of", "published", "smallest", "largest"]
        .map(str::to_owned)
        .to_vec();
    head.extend(counted.map(|verdict| format!("meshes: {}", verdict.name())));
    let mut rows = vec![head];
    let of = ["mean", "std"];
    for ((from, to), of) in PAIRS.iter().flat_map(|pair| of.map(|of| (pair, of))) {
        let (from, to) = (&CASES[*from], &CASES[*to]);
        let is = |relation: &&Relation| relation.from == from && relation.to == to && relation.of == of;
        let found: Vec<&Relation> = reproduction.relations.iter().filter(is).collect();
        let Some(first) = found.first() else { continue };
        let computed = || found.iter().filter_map(|relation| relation.computed);
        let mut row = vec![
            from.title.to_owned(),
            to.title.to_owned(),
            of.to_owned(),
            percent(Some(first.published)),
            percent(computed().reduce(f64::min)),
            percent(computed().reduce(f64::max)),
        ];
        row.extend(counted.map(|verdict| {
            let count = found.iter().filter(|relation| relation.verdict == verdict).count();
            format!("{count} of {}", found.len())
        }));
        rows.push(row);
    }
    rows
}

/// The ranges of the open quantities on one mesh.
pub(super) fn spreads(reproduction: &Reproduction, mesh: Mesh) -> Vec<&Spread> {
    reproduction
        .spreads
        .iter()
        .filter(|spread| spread.mesh == mesh)
        .collect()
}

/// Each range as a row; nothing, not even a head, where there is none.
fn open(reproduction: &Reproduction, mesh: Mesh) -> Vec<Vec<String>> {
    let spreads = spreads(reproduction, mesh);
    if spreads.is_empty() {
        return Vec::new();
    }
    let mut rows = vec![
        ["quantity", "smallest", "largest", "published", ""]
            .map(str::to_owned)
            .to_vec(),
    ];
    for spread in spreads {
        let [low, high] = spread.std().map_or([None; 2], |ends| ends.map(Some));
        rows.push(vec![
            spread.quantity.to_owned(),
            force(low),
            force(high),
            spread.case.std.printed(),
            spread.verdict().to_owned(),
        ]);
    }
    rows
}

/// Quantities that are not changed on a mesh on which others are, and why.
pub(super) fn left_out(reproduction: &Reproduction, mesh: Mesh) -> Vec<String> {
    if spreads(reproduction, mesh).is_empty() {
        return Vec::new();
    }
    let why = |open: &Open| {
        let why = open.thesis_mesh_only.as_ref().filter(|_| !open.is_on(mesh))?;
        Some(format!("{} is not changed on this mesh: {why}.", open.quantity))
    };
    OPEN.iter().filter_map(why).collect()
}

/// Runs that were not computed, with the reason.
pub(super) fn missing(reproduction: &Reproduction) -> Vec<String> {
    let not = |line: &&Line| matches!(line.row.status, Some(Status::Refused | Status::Diverged));
    let said = |line: &Line| {
        let what = format!("{} {}", line.quantity, line.value);
        let (case, mesh) = (line.case.title, line.mesh.name());
        format!("{case}, {mesh}, {}: {}", what.trim(), line.row.reason)
    };
    reproduction.lines.iter().filter(not).map(said).collect()
}

/// The tables of a reproduction.
#[must_use]
pub fn text(reproduction: &Reproduction) -> String {
    let mut text = aligned(&cases(reproduction));
    text.push_str("\nchanges between cases, in percent\n");
    text.push_str(&aligned(&changes(reproduction)));
    text.push('\n');
    text.push_str(&aligned(&overall(reproduction)));
    text.push_str(&wrapped(VERDICT_RULE));
    for (heading, rows) in [
        (
            "readings of the wind: changes in N, the published ones in the head",
            readings(reproduction),
        ),
        (
            "wind on the pan-head (Figs. 11 and 12), beside Eq. (18) with Table 5 for one that moves with the train",
            head(reproduction),
        ),
    ] {
        if !rows.is_empty() {
            text.push_str(&format!("\n{heading}\n{}", aligned(&rows)));
        }
    }
    for mesh in Mesh::ALL {
        let rows = open(reproduction, mesh);
        if rows.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\nwhat the thesis leaves open, on {}: std [N] over the range, published std inside or outside\n{}",
            mesh.name(),
            aligned(&rows)
        ));
        for note in left_out(reproduction, mesh) {
            text.push_str(&wrapped(&note));
        }
    }
    for note in missing(reproduction) {
        text.push_str(&wrapped(&note));
    }
    let slowest = reproduction.lines.iter().filter_map(|line| line.row.real_time_factor);
    text.push_str(&format!(
        "\n{} of {} runs made, side by side; largest real-time factor {}\n",
        reproduction.made().0,
        reproduction.lines.len(),
        short(slowest.reduce(f64::max))
    ));
    text
}
