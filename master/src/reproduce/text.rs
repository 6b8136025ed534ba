//! The tables on the terminal.

use super::execute::{Line, Reproduction, difference};
use super::plan::{Group, Mesh};
use super::wind;
use crate::report::aligned;
use crate::table_of_runs::{Status, short, wrapped};

/// Two decimals, where there is a number: the thesis prints its forces so.
pub(super) fn force(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

/// A change with its sign.
pub(super) fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.2}"))
}

/// Case, how and on which mesh it was run, published and computed figures; for the groups of the published cases.
pub(super) fn cases(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let head = [
        "case",
        "mesh",
        "mode",
        "mean [N]",
        "published",
        "diff. %",
        "std [N]",
        "published",
        "diff. %",
        "std, raw",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for line in &reproduction.lines {
        if !line.group.is_case() {
            continue;
        }
        let (case, row) = (line.case, &line.row);
        rows.push(vec![
            case.title.to_owned(),
            line.mesh.name(),
            row.mode.clone(),
            force(row.mean),
            case.mean.printed(),
            percent(difference(row.mean, case.mean.value)),
            force(row.std),
            case.std.printed(),
            percent(difference(row.std, case.std.value)),
            force(line.raw_std),
        ]);
    }
    rows
}

/// What each reading of the wind does to mean and standard deviation, the scene's own first; the published changes in the head.
pub(super) fn readings(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let [calm, _, windy, _] = super::CASES;
    let published = |windy: f64, calm: f64| percent(Some(windy - calm));
    let head = [
        "reading".to_owned(),
        format!("mean {} N", published(windy.mean.value, calm.mean.value)),
        format!("std {} N", published(windy.std.value, calm.std.value)),
        "std, raw".to_owned(),
    ];
    let own = |scene: &'static str| {
        let of = move |line: &&Line| line.group == Group::Published && line.case.scene == scene;
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
    let others = reproduction.lines.iter().filter(|line| line.group == Group::Reading);
    table.extend(others.map(|line| rows(line, &line.value)));
    table
}

/// The wind on the pan-head in every reading, the scene's own first, over the evaluation range; what [Thesis, Eq. (18)] gives for a
/// pan-head that moves with the train beside it. The thesis prints these forces as curves only.
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
        let of = |line: &&Line| line.group == Group::Reading && line.value == reading.name;
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
    let mut lines = reproduction.lines.iter();
    lines.find(|line| line.is(&super::CASES[case], Mesh::ALL[0]))
}

/// What an open quantity does to the standard deviation on one mesh.
pub(super) struct Spread<'a> {
    /// What it is called.
    pub quantity: &'static str,
    /// Runs, in the order of the values.
    pub lines: Vec<&'a Line>,
    /// Smallest and largest standard deviation over the range and the scene's own value, N; nothing where no run has one.
    pub std: Option<[f64; 2]>,
}

impl Spread<'_> {
    /// Whether the published standard deviation lies inside.
    pub fn holds(&self, published: f64) -> bool {
        self.std.is_some_and(|[low, high]| (low..=high).contains(&published))
    }
}

/// The spreads on one mesh.
pub(super) fn spreads(reproduction: &Reproduction, mesh: Mesh) -> Vec<Spread<'_>> {
    let of_mesh = |line: &&Line| line.mesh == mesh;
    let own = |line: &&Line| line.group.is_case() && line.case.scene == super::CASES[0].scene;
    let own = reproduction.lines.iter().filter(of_mesh).find(own);
    let open: Vec<&Line> = reproduction
        .lines
        .iter()
        .filter(of_mesh)
        .filter(|line| line.group == Group::Open)
        .collect();
    open.chunk_by(|a, b| a.quantity == b.quantity)
        .map(|lines| {
            let values = || lines.iter().copied().chain(own).filter_map(|line| line.row.std);
            Spread {
                quantity: lines[0].quantity,
                lines: lines.to_vec(),
                std: values().reduce(f64::min).zip(values().reduce(f64::max)).map(Into::into),
            }
        })
        .collect()
}

/// Changes between cases, published and computed, in percent.
pub(super) fn changes(reproduction: &Reproduction) -> Vec<Vec<String>> {
    let head = ["from", "to", "mesh", "of", "published", "computed", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(reproduction.relations.iter().map(|relation| {
        vec![
            relation.from.to_owned(),
            relation.to.to_owned(),
            relation.mesh.clone(),
            relation.of.to_owned(),
            percent(Some(relation.published)),
            percent(relation.computed),
            relation.verdict().to_owned(),
        ]
    }));
    rows
}

/// What was not computed, and why.
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
    let published = super::CASES[0].std;
    for mesh in Mesh::ALL {
        let spreads = spreads(reproduction, mesh);
        if spreads.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\nwhat the thesis leaves open, on {}: std [N] over the range, published {}\n",
            mesh.name(),
            published.printed()
        ));
        let mut rows = vec![["quantity", "smallest", "largest", ""].map(str::to_owned).to_vec()];
        for spread in &spreads {
            let [low, high] = spread.std.map_or([None; 2], |bounds| bounds.map(Some));
            let inside = if spread.holds(published.value) {
                "published inside"
            } else {
                ""
            };
            rows.push(vec![
                spread.quantity.to_owned(),
                force(low),
                force(high),
                inside.to_owned(),
            ]);
        }
        text.push_str(&aligned(&rows));
    }
    for note in missing(reproduction) {
        text.push_str(&wrapped(&note));
    }
    let slowest = reproduction.lines.iter().filter_map(|line| line.row.real_time_factor);
    text.push_str(&format!(
        "\n{} of {} runs made, side by side; largest real-time factor {}\n",
        reproduction.made(),
        reproduction.lines.len(),
        short(slowest.reduce(f64::max))
    ));
    text
}
