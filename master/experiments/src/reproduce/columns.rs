//! `reproduction.csv`: the runs, and behind them what they say, told apart by the column `group`.
//!
//! | `group` | a row is |
//! | --- | --- |
//! | `published`, `mesh`, `reading`, `open` | a run |
//! | `relation` | published change on one mesh: `quantity` (mean or std) of `case`, from the case of `value` |
//! | `spread` | an open `quantity` over its values (`value`) on one mesh, in `case` |
//!
//! The last two have a `verdict`, its figures in `reason`, mesh and step of the runs that they stand on, and the worst
//! of their status.

use super::judge::{HeadWind, Line, Reproduction};
use super::plan::RunGroup;
use super::published::Case;
use super::relation::Relation;
use super::spread::Spread;
use crate::engine::Sheet;
use crate::engine::table::{Columns, RunRow, Status};

/// A row of the table: a run, or what runs say.
struct Entry<'a> {
    group: &'static str,
    case: &'static Case,
    quantity: &'static str,
    value: String,
    row: RunRow,
    verdict: &'static str,
    /// The run.
    run: Option<&'a Line>,
    /// Published and computed change of a relation, %.
    changes: [Option<f64>; 2],
    /// Smallest and largest standard deviation of a spread, N.
    ends: [Option<f64>; 2],
}

impl<'a> Entry<'a> {
    fn new(group: &'static str, case: &'static Case, quantity: &'static str, value: String, row: RunRow) -> Self {
        Self {
            group,
            case,
            quantity,
            value,
            row,
            verdict: "",
            run: None,
            changes: [None; 2],
            ends: [None; 2],
        }
    }

    fn of_run(line: &'a Line) -> Self {
        let (value, row) = (line.value.clone(), line.row.clone());
        Self {
            run: Some(line),
            ..Self::new(line.group.name(), line.case, line.quantity, value, row)
        }
    }

    fn of_relation(relation: &Relation, lines: &[Line]) -> Self {
        let runs = [relation.from, relation.to].map(|case| Line::of(lines, case, relation.mesh));
        let row = derived(runs[1], runs.into_iter().flatten(), relation.why.clone());
        let value = format!("change from {}", relation.from.title);
        Self {
            verdict: relation.verdict.name(),
            changes: [Some(relation.published), relation.computed],
            ..Self::new("relation", relation.to, relation.of, value, row)
        }
    }

    fn of_spread(spread: &Spread, lines: &[Line]) -> Self {
        let own = Line::of(lines, spread.case, spread.mesh);
        let changed = lines.iter().filter(|line| line.is_in(spread));
        let row = derived(own, changed.chain(own), spread.why());
        Self {
            verdict: spread.verdict(),
            ends: spread.std().map_or([None; 2], |std| std.map(Some)),
            ..Self::new("spread", spread.case, spread.quantity, spread.values.join("; "), row)
        }
    }
}

/// A row without figures of its own, on the mesh of this run, with the worst status of some runs; no status while one
/// of them has none.
fn derived<'a>(like: Option<&Line>, of: impl Iterator<Item = &'a Line>, reason: String) -> RunRow {
    let run = like.map(|line| line.row.clone()).unwrap_or_default();
    let all: Option<Vec<Status>> = of.map(|line| line.row.status).collect();
    RunRow {
        scene: run.scene,
        mode: run.mode,
        micro_step: run.micro_step,
        elements_per_span: run.elements_per_span,
        mesh: run.mesh,
        reduction: run.reduction,
        element_length: run.element_length,
        status: all.and_then(|all| all.into_iter().max()),
        reason,
        ..RunRow::default()
    }
}

impl Reproduction {
    /// The rows, one per run, then one per relation, then one per spread, and the columns of this table alone.
    pub(super) fn columns(&self) -> Sheet {
        let lines = &self.lines;
        let relations = self
            .relations
            .iter()
            .map(|relation| Entry::of_relation(relation, lines));
        let spreads = self.spreads.iter().map(|spread| Entry::of_spread(spread, lines));
        let entries: Vec<Entry<'_>> = lines
            .iter()
            .map(Entry::of_run)
            .chain(relations)
            .chain(spreads)
            .collect();
        let head = |entry: &Entry<'_>, figure: fn(&HeadWind) -> f64| entry.run?.head.as_ref().map(figure);
        let leading = Columns::of(&entries)
            .column("group", |entry| entry.group.to_owned())
            .column("case", |entry| entry.case.title.to_owned())
            .column("quantity", |entry| entry.quantity.to_owned())
            .column("value", |entry| entry.value.clone());
        let trailing = Columns::of(&entries)
            .column("raw_std_N", |entry| entry.run?.raw_std)
            .column("head_drag_min_N", |entry| head(entry, |head| head.drag.min))
            .column("head_drag_mean_N", |entry| head(entry, |head| head.drag.mean))
            .column("head_drag_max_N", |entry| head(entry, |head| head.drag.max))
            .column("head_lift_min_N", |entry| head(entry, |head| head.lift.min))
            .column("head_lift_mean_N", |entry| head(entry, |head| head.lift.mean))
            .column("head_lift_max_N", |entry| head(entry, |head| head.lift.max))
            .column("published_mean_N", |entry| entry.case.mean.printed())
            .column("published_std_N", |entry| entry.case.std.printed())
            .column("mean_difference_percent", |entry| entry.run?.differences()[0])
            .column("std_difference_percent", |entry| entry.run?.differences()[1])
            .column("source", |entry| entry.case.source.to_owned())
            .column("published_change_percent", |entry| entry.changes[0])
            .column("computed_change_percent", |entry| entry.changes[1])
            .column("smallest_std_N", |entry| entry.ends[0])
            .column("largest_std_N", |entry| entry.ends[1])
            .column("verdict", |entry| entry.verdict.to_owned());
        Sheet {
            leading: leading.finish(),
            trailing: trailing.finish(),
            rows: entries.into_iter().map(|entry| entry.row).collect(),
        }
    }
}

impl Line {
    /// `true` where it is one of the runs of a spread.
    pub(super) fn is_in(&self, spread: &Spread) -> bool {
        self.group == RunGroup::Open && self.quantity == spread.quantity && self.mesh == spread.mesh
    }
}
