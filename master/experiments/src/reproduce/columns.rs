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

use super::judge::{HeadWind, Line, Reproduction, difference};
use super::plan::RunGroup;
use super::published::Case;
use super::relation::Relation;
use super::spread::Spread;
use crate::engine::Sheet;
use crate::engine::table::{Columns, RunRow, Status};

/// Subject of a row of the table.
enum Entry<'a> {
    Run(&'a Line),
    Relation(&'a Relation),
    Spread(&'a Spread),
}

impl Entry<'_> {
    fn case(&self) -> &'static Case {
        match self {
            Self::Run(line) => line.case,
            Self::Relation(relation) => relation.to,
            Self::Spread(spread) => spread.case,
        }
    }
}

/// The worst status of some runs; nothing while one has none.
fn worst<'a>(lines: impl Iterator<Item = &'a Line>) -> Option<Status> {
    let all: Option<Vec<Status>> = lines.map(|line| line.row.status).collect();
    all?.into_iter().max()
}

impl Entry<'_> {
    /// A figure of a run.
    fn of_run(&self, figure: impl Fn(&Line) -> Option<f64>) -> Option<f64> {
        match self {
            Self::Run(line) => figure(line),
            _ => None,
        }
    }

    /// A figure of a relation.
    fn of_relation(&self, figure: impl Fn(&Relation) -> Option<f64>) -> Option<f64> {
        match self {
            Self::Relation(relation) => figure(relation),
            _ => None,
        }
    }

    /// One end of a spread.
    fn end(&self, which: usize) -> Option<f64> {
        match self {
            Self::Spread(spread) => spread.std().map(|std| std[which]),
            _ => None,
        }
    }

    fn group(&self) -> &'static str {
        match self {
            Self::Run(line) => line.group.name(),
            Self::Relation(_) => "relation",
            Self::Spread(_) => "spread",
        }
    }

    fn quantity(&self) -> &'static str {
        match self {
            Self::Run(line) => line.quantity,
            Self::Relation(relation) => relation.of,
            Self::Spread(spread) => spread.quantity,
        }
    }

    fn value(&self) -> String {
        match self {
            Self::Run(line) => line.value.clone(),
            Self::Relation(relation) => format!("change from {}", relation.from.title),
            Self::Spread(spread) => spread.values.join("; "),
        }
    }

    fn verdict(&self) -> &'static str {
        match self {
            Self::Run(_) => "",
            Self::Relation(relation) => relation.verdict.name(),
            Self::Spread(spread) => spread.verdict(),
        }
    }

    /// The row of a run; of the others one without figures of its own, on the mesh of their runs.
    fn row(&self, lines: &[Line]) -> RunRow {
        match self {
            Self::Run(line) => line.row.clone(),
            Self::Relation(relation) => {
                let runs = [relation.from, relation.to].map(|case| Line::of(lines, case, relation.mesh));
                let status = worst(runs.iter().flatten().copied());
                derived(runs[1], status, relation.why.clone())
            }
            Self::Spread(spread) => {
                let own = Line::of(lines, spread.case, spread.mesh);
                let changed = lines.iter().filter(|line| line.is_in(spread));
                derived(own, worst(changed.chain(own)), spread.why())
            }
        }
    }
}

/// A row without figures of its own, on the mesh of this run.
fn derived(like: Option<&Line>, status: Option<Status>, reason: String) -> RunRow {
    let run = like.map(|line| line.row.clone()).unwrap_or_default();
    RunRow {
        scene: run.scene,
        mode: run.mode,
        micro_step: run.micro_step,
        elements_per_span: run.elements_per_span,
        mesh: run.mesh,
        reduction: run.reduction,
        element_length: run.element_length,
        status,
        reason,
        ..RunRow::default()
    }
}

impl Reproduction {
    /// The rows, one per run, then one per relation, then one per spread, and the columns of this table alone.
    pub(super) fn columns(&self) -> Sheet {
        let runs = self.lines.iter().map(Entry::Run);
        let relations = self.relations.iter().map(Entry::Relation);
        let entries: Vec<Entry<'_>> = runs
            .chain(relations)
            .chain(self.spreads.iter().map(Entry::Spread))
            .collect();
        let head =
            |entry: &Entry<'_>, figure: fn(&HeadWind) -> f64| entry.of_run(|line| line.head.as_ref().map(figure));
        let leading = Columns::of(&entries)
            .text("group", |entry| entry.group().to_owned())
            .text("case", |entry| entry.case().title.to_owned())
            .text("quantity", |entry| entry.quantity().to_owned())
            .text("value", Entry::value);
        let trailing = Columns::of(&entries)
            .value("raw_std_N", |entry| entry.of_run(|line| line.raw_std))
            .value("head_drag_min_N", |entry| head(entry, |head| head.drag.min))
            .value("head_drag_mean_N", |entry| head(entry, |head| head.drag.mean))
            .value("head_drag_max_N", |entry| head(entry, |head| head.drag.max))
            .value("head_lift_min_N", |entry| head(entry, |head| head.lift.min))
            .value("head_lift_mean_N", |entry| head(entry, |head| head.lift.mean))
            .value("head_lift_max_N", |entry| head(entry, |head| head.lift.max))
            .text("published_mean_N", |entry| entry.case().mean.printed())
            .text("published_std_N", |entry| entry.case().std.printed())
            .value("mean_difference_percent", |entry| {
                entry.of_run(|line| difference(line.row.mean, line.case.mean.value))
            })
            .value("std_difference_percent", |entry| {
                entry.of_run(|line| difference(line.row.std, line.case.std.value))
            })
            .text("source", |entry| entry.case().source.to_owned())
            .value("published_change_percent", |entry| {
                entry.of_relation(|relation| Some(relation.published))
            })
            .value("computed_change_percent", |entry| {
                entry.of_relation(|relation| relation.computed)
            })
            .value("smallest_std_N", |entry| entry.end(0))
            .value("largest_std_N", |entry| entry.end(1))
            .text("verdict", |entry| entry.verdict().to_owned());
        Sheet {
            leading: leading.finish(),
            rows: entries.iter().map(|entry| entry.row(&self.lines)).collect(),
            trailing: trailing.finish(),
        }
    }
}

impl Line {
    /// `true` where it is one of the runs of a spread.
    pub(super) fn is_in(&self, spread: &Spread) -> bool {
        self.group == RunGroup::Open && self.quantity == spread.quantity && self.mesh == spread.mesh
    }
}
