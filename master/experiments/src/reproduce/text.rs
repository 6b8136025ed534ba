//! The tables on the terminal.

use super::judge::{Line, Reproduction};
use super::open::{OPEN, Open};
use super::plan::{Mesh, RunGroup};
use super::published::CASES;
use super::relation::{PAIRS, Relation};
use super::spread::Spread;
use super::verdict::{VERDICT_RULE, Verdict};
use super::wind;
use crate::engine::Table as _;
use crate::engine::table::Status;
use results::report::format::{decimals, or_dash, short, wrapped};
use results::report::{TextColumn, aligned, text_table};

/// Two decimals, where there is a number: the thesis prints its forces so.
pub(super) fn force(value: Option<f64>) -> String {
    decimals(value, 2)
}

/// A change with its sign.
fn percent(value: Option<f64>) -> String {
    or_dash(value.map(|value| format!("{value:+.2}")))
}

/// Columns of the published cases.
const CASE_COLUMNS: &[TextColumn<Line, 1>] = &[
    (["case"], |line| line.case.title.to_owned()),
    (["mesh"], |line| line.mesh.name()),
    (["mode"], |line| line.row.mode.clone()),
    (["mean [N]"], |line| force(line.row.mean)),
    (["published"], |line| line.case.mean.printed()),
    (["diff. %"], |line| percent(line.differences()[0])),
    (["std [N]"], |line| force(line.row.std)),
    (["published"], |line| line.case.std.printed()),
    (["diff. %"], |line| percent(line.differences()[1])),
    (["std, raw"], |line| force(line.raw_std)),
];

/// Case, how and on which mesh it was run, published and computed figures; for the groups of the published cases.
pub(super) fn cases(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let cases = reproduction.lines.iter().filter(|line| line.group.is_case());
    text_table(CASE_COLUMNS, cases)
}

/// The readings of the wind that were planned, the scene's own first, each with its run.
fn read(reproduction: &Reproduction) -> impl Iterator<Item = (&str, Option<&Line>)> {
    let own = Line::of(&reproduction.lines, &CASES[2], Mesh::ALL[0]);
    let readings = reproduction.lines.iter().filter(|line| line.group == RunGroup::Reading);
    std::iter::once((wind::OWN, own)).chain(readings.map(|line| (line.value.as_str(), Some(line))))
}

/// Changes of mean and standard deviation by each reading of the wind, the scene's own first; the published ones in the
/// head.
pub(super) fn readings(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let (calm, windy) = (&CASES[0], &CASES[2]);
    let [mean, std] =
        [[windy.mean, calm.mean], [windy.std, calm.std]].map(|[windy, calm]| percent(Some(windy.value - calm.value)));
    let head = vec![
        "reading".to_owned(),
        format!("mean {mean} N"),
        format!("std {std} N"),
        "std, raw".to_owned(),
    ];
    let published = [calm, windy].map(|case| Line::of(&reproduction.lines, case, Mesh::ALL[0]));
    let [Some(without), Some(_)] = published else {
        return Vec::new();
    };
    let figures = |line: &Line| [line.row.mean, line.row.std, line.raw_std];
    let row = |(name, line): (&str, Option<&Line>)| {
        let pairs = figures(line?).into_iter().zip(figures(without));
        let changes = pairs.map(|(with, without)| percent(with.zip(without).map(|(with, without)| with - without)));
        Some(std::iter::once(name.to_owned()).chain(changes).collect())
    };
    std::iter::once(head)
        .chain(read(reproduction).filter_map(row))
        .collect()
}

/// The wind on the pan-head in every reading, the scene's own first, over the evaluation range; what [Thesis, Eq. (18)]
/// gives for a pan-head that moves with the train beside it. The thesis prints these forces as curves only.
pub(super) fn head(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let head = ["reading", "drag, even travel [N]", "drag: min", "mean", "max"];
    let head = [&head[..], &["lift, even travel [N]", "lift: min", "mean", "max"]].concat();
    let mut table = vec![head.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    table.extend(read(reproduction).filter_map(|(name, line)| {
        let (line, found) = (line?, line?.head?);
        let mut row = vec![name.to_owned()];
        for (part, found) in [found.drag, found.lift].into_iter().enumerate() {
            row.push(force(line.even_head.map(|even| even[part])));
            row.extend([found.min, found.mean, found.max].map(|value| force(Some(value))));
        }
        Some(row)
    }));
    if table.len() == 1 { Vec::new() } else { table }
}

/// Columns of the changes between cases, in percent.
const CHANGE_COLUMNS: &[TextColumn<Relation, 1>] = &[
    (["from"], |relation| relation.from.title.to_owned()),
    (["to"], |relation| relation.to.title.to_owned()),
    (["mesh"], |relation| relation.mesh.name()),
    (["of"], |relation| relation.of.to_owned()),
    (["published"], |relation| percent(Some(relation.published))),
    (["computed"], |relation| percent(relation.computed)),
    (["verdict"], |relation| relation.verdict.name().to_owned()),
    (["why"], |relation| relation.why.clone()),
];

/// Changes between cases, published and computed.
pub(super) fn changes(reproduction: &Reproduction) -> Vec<Vec<String>> {
    text_table(CHANGE_COLUMNS, &reproduction.relations)
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
    let spreads = reproduction.spreads.iter();
    spreads.filter(|spread| spread.mesh == mesh).collect()
}

/// Columns of the ranges.
const SPREAD_COLUMNS: &[TextColumn<Spread, 1>] = &[
    (["quantity"], |spread| spread.quantity.to_owned()),
    (["smallest"], |spread| force(spread.std().map(|std| std[0]))),
    (["largest"], |spread| force(spread.std().map(|std| std[1]))),
    (["published"], |spread| spread.case.std.printed()),
    ([""], |spread| spread.verdict().to_owned()),
];

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
        let (case, mesh) = (&line.case.title, line.mesh.name());
        format!("{case}, {mesh}, {}: {}", what.trim(), line.row.reason)
    };
    reproduction.lines.iter().filter(not).map(said).collect()
}

/// The tables of a reproduction.
pub(super) fn text(reproduction: &Reproduction) -> String {
    let mut text = aligned(&cases(reproduction));
    text.push_str("\nchanges between cases, in percent\n");
    text.push_str(&aligned(&changes(reproduction)));
    text.push('\n');
    text.push_str(&aligned(&overall(reproduction)));
    text.push_str(&wrapped(VERDICT_RULE));
    let changes = "readings of the wind: changes in N, the published ones in the head";
    let on_head =
        "wind on the pan-head (Figs. 11 and 12), beside Eq. (18) with Table 5 for one that moves with the train";
    for (heading, rows) in [(changes, readings(reproduction)), (on_head, head(reproduction))] {
        if !rows.is_empty() {
            text.push_str(&format!("\n{heading}\n{}", aligned(&rows)));
        }
    }
    for mesh in Mesh::ALL {
        let spreads = spreads(reproduction, mesh);
        if spreads.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\nwhat the thesis leaves open, on {}: std [N] over the range, published std inside or outside\n{}",
            mesh.name(),
            aligned(&text_table(SPREAD_COLUMNS, spreads))
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
