//! `reproduction.csv`: the runs, and behind them what they say, told apart by the column `group`.
//!
//! | `group` | a row is |
//! | --- | --- |
//! | `published`, `mesh`, `reading`, `open` | a run |
//! | `relation` | a published change between two cases on one mesh: `quantity` (mean or std) of `case`, from the case that `value` names |
//! | `spread` | an open `quantity` over its values (`value`) on one mesh, in `case` |
//!
//! The last two have a `verdict`, its figures in `reason`, mesh and step of the runs that they stand on, and the worst of their status.

use super::execute::{HeadWind, Line, Reproduction, difference};
use super::plan::Group;
use super::published::Case;
use super::relation::Relation;
use super::spread::Spread;
use crate::table_of_runs::{Cell, Column, Row, Status};

/// What a row of the table is about.
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
    let rank = |status: &Status| match status {
        Status::Stable => 0,
        Status::Limit => 1,
        Status::Diverged => 2,
        Status::Refused => 3,
    };
    let all: Option<Vec<Status>> = lines.map(|line| line.row.status).collect();
    all?.into_iter().max_by_key(rank)
}

impl Reproduction {
    fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let runs = self.lines.iter().map(Entry::Run);
        let relations = self.relations.iter().map(Entry::Relation);
        runs.chain(relations).chain(self.spreads.iter().map(Entry::Spread))
    }

    /// A row without figures of its own, on the mesh of this run.
    fn derived(like: Option<&Line>, status: Option<Status>, reason: String) -> Row {
        let run = like.map(|line| line.row.clone()).unwrap_or_default();
        Row {
            scene: run.scene,
            mode: run.mode,
            micro_step: run.micro_step,
            elements_per_span: run.elements_per_span,
            mesh: run.mesh,
            reduction: run.reduction,
            element_length: run.element_length,
            status,
            reason,
            ..Row::default()
        }
    }

    /// The rows: one per run, then one per relation, then one per spread.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        let row = |entry: Entry<'_>| match entry {
            Entry::Run(line) => line.row.clone(),
            Entry::Relation(relation) => {
                let runs = [relation.from, relation.to].map(|case| Line::of(&self.lines, case, relation.mesh));
                let status = worst(runs.iter().flatten().copied());
                Self::derived(runs[1], status, relation.why.clone())
            }
            Entry::Spread(spread) => {
                let own = Line::of(&self.lines, spread.case, spread.mesh);
                let changed = self.lines.iter().filter(|line| line.is_in(spread));
                let status = worst(changed.chain(own));
                Self::derived(own, status, spread.why())
            }
        };
        self.entries().map(row).collect()
    }

    /// The columns before and behind the common ones.
    #[must_use]
    pub fn columns(&self) -> (Vec<Column>, Vec<Column>) {
        let cells = |cell: &dyn Fn(&Entry<'_>) -> String| self.entries().map(|entry| cell(&entry)).collect();
        let run = |cell: &dyn Fn(&Line) -> String| {
            cells(&|entry| match entry {
                Entry::Run(line) => cell(line),
                _ => String::new(),
            })
        };
        let head = |figure: &dyn Fn(&HeadWind) -> f64| run(&|line| line.head.as_ref().map(figure).cell());
        let change = |figure: &dyn Fn(&Relation) -> Option<f64>| {
            cells(&|entry| match entry {
                Entry::Relation(relation) => figure(relation).cell(),
                _ => String::new(),
            })
        };
        let end = |which: usize| {
            cells(&|entry| match entry {
                Entry::Spread(spread) => spread.std().map(|std| std[which]).cell(),
                _ => String::new(),
            })
        };
        let leading = vec![
            (
                "group",
                cells(&|entry| {
                    let name = match entry {
                        Entry::Run(line) => line.group.name(),
                        Entry::Relation(_) => "relation",
                        Entry::Spread(_) => "spread",
                    };
                    name.to_owned()
                }),
            ),
            ("case", cells(&|entry| entry.case().title.to_owned())),
            (
                "quantity",
                cells(&|entry| {
                    let quantity = match entry {
                        Entry::Run(line) => line.quantity,
                        Entry::Relation(relation) => relation.of,
                        Entry::Spread(spread) => spread.quantity,
                    };
                    quantity.to_owned()
                }),
            ),
            (
                "value",
                cells(&|entry| match entry {
                    Entry::Run(line) => line.value.clone(),
                    Entry::Relation(relation) => format!("change from {}", relation.from.title),
                    Entry::Spread(spread) => spread.values.join("; "),
                }),
            ),
        ];
        let trailing = vec![
            ("raw_std_N", run(&|line| line.raw_std.cell())),
            ("head_drag_min_N", head(&|head| head.drag.min)),
            ("head_drag_mean_N", head(&|head| head.drag.mean)),
            ("head_drag_max_N", head(&|head| head.drag.max)),
            ("head_lift_min_N", head(&|head| head.lift.min)),
            ("head_lift_mean_N", head(&|head| head.lift.mean)),
            ("head_lift_max_N", head(&|head| head.lift.max)),
            ("published_mean_N", cells(&|entry| entry.case().mean.printed())),
            ("published_std_N", cells(&|entry| entry.case().std.printed())),
            (
                "mean_difference_percent",
                run(&|line| difference(line.row.mean, line.case.mean.value).cell()),
            ),
            (
                "std_difference_percent",
                run(&|line| difference(line.row.std, line.case.std.value).cell()),
            ),
            ("source", cells(&|entry| entry.case().source.to_owned())),
            ("published_change_percent", change(&|relation| Some(relation.published))),
            ("computed_change_percent", change(&|relation| relation.computed)),
            ("smallest_std_N", end(0)),
            ("largest_std_N", end(1)),
            (
                "verdict",
                cells(&|entry| {
                    let verdict = match entry {
                        Entry::Run(_) => "",
                        Entry::Relation(relation) => relation.verdict.name(),
                        Entry::Spread(spread) => spread.verdict(),
                    };
                    verdict.to_owned()
                }),
            ),
        ];
        (leading, trailing)
    }
}

impl Line {
    /// Whether it is one of the runs of a spread.
    pub(super) fn is_in(&self, spread: &Spread) -> bool {
        self.group == Group::Open && self.quantity == spread.quantity && self.mesh == spread.mesh
    }
}
