//! The plan of a reproduction carried out, and its judge.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use super::plan::{Mesh, ReproductionRun, RunGroup, plan};
use super::published::Case;
use super::relation::{Relation, relations};
use super::spread::{Spread, spreads};
use super::wind;
use crate::engine::table::RunRow;
use crate::engine::{Attempt, Bench, Experiment, Planned, Run, Sheet, Stage, Table, Unmade};
use results::WindRecord;
use results::curve::ForceCurve;
use results::report::Page;
use results::statistics::ForceStatistics;
use simulation::Mode;

/// One run of a reproduction.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Purpose.
    pub group: RunGroup,
    /// The published case that it is a variant of.
    pub case: &'static Case,
    /// Mesh of the line.
    pub mesh: Mesh,
    /// Quantity that was changed besides the mesh.
    pub quantity: &'static str,
    /// To what, with its unit.
    pub value: String,
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: RunRow,
    /// Standard deviation of the raw force, N.
    #[serde(rename = "raw_std_N")]
    pub raw_std: Option<f64>,
    /// The wind on the pan-head over the evaluation range, where one acts.
    pub head: Option<HeadWind>,
    /// Drag and lift of a pan-head that moves with the train [Thesis, Eq. (18)], N, where a steady wind acts.
    #[serde(rename = "even_head_N")]
    pub even_head: Option<[f64; 2]>,
    /// Contact force, whole run.
    #[serde(skip)]
    pub curve: Option<ForceCurve>,
    /// The wind on the pan-head, whole run.
    #[serde(skip)]
    pub wind: Option<WindRecord>,
    /// Time between its samples, s.
    #[serde(skip)]
    pub output_step: f64,
}

/// Smallest, mean and largest value of a force, N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extent {
    /// Smallest.
    #[serde(rename = "min_N")]
    pub min: f64,
    /// Mean.
    #[serde(rename = "mean_N")]
    pub mean: f64,
    /// Largest.
    #[serde(rename = "max_N")]
    pub max: f64,
}

/// The wind on the pan-head.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadWind {
    /// Drag, along the air that meets it.
    pub drag: Extent,
    /// Lift, across it, positive upward.
    pub lift: Extent,
}

impl HeadWind {
    /// Over some samples of a record.
    fn of(wind: &WindRecord, range: Range<usize>) -> Option<Self> {
        let extent = |force: &[f64]| {
            let force = ForceStatistics::of(force.get(range.clone())?)?;
            Some(Extent {
                min: force.min,
                mean: force.mean,
                max: force.max,
            })
        };
        Some(Self {
            drag: extent(&wind.drag)?,
            lift: extent(&wind.lift)?,
        })
    }
}

/// The table of a reproduction, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Reproduction {
    /// `true` where every run was made.
    pub complete: bool,
    /// One per run.
    pub lines: Vec<Line>,
    /// Changes between cases.
    pub relations: Vec<Relation>,
    /// Standard deviations over the ranges of the open quantities.
    pub spreads: Vec<Spread>,
}

impl Reproduction {
    /// With what the runs say.
    pub(super) fn new(lines: Vec<Line>) -> Self {
        Self {
            complete: lines.iter().all(|line| line.row.status.is_some()),
            relations: relations(&lines),
            spreads: spreads(&lines),
            lines,
        }
    }
}

impl Table for Reproduction {
    fn sheet(&self) -> Sheet {
        self.columns()
    }

    fn made(&self) -> (usize, usize) {
        let made = self.lines.iter().filter(|line| line.row.status.is_some());
        (made.count(), self.lines.len())
    }

    fn text(&self) -> String {
        super::text::text(self)
    }

    fn sections(&self) -> Page {
        super::page::page(self)
    }
}

/// A published piece of work to be computed again.
pub struct Reproduce {
    /// Runs in the order of the table.
    pub planned: Vec<ReproductionRun>,
    stages: BTreeMap<&'static str, Arc<Stage>>,
}

impl Reproduce {
    /// The plan for scenes with these texts, by their names; `scenes` is the folder that paths in them are relative to,
    /// `fmus` that of packages. A quick plan is a part of the whole one; `overrides` hold for all runs.
    #[must_use]
    pub fn new(
        texts: &BTreeMap<&'static str, String>,
        scenes: &Path,
        fmus: &Path,
        quick: bool,
        overrides: &[String],
    ) -> Self {
        let stage = |(name, text): (&&'static str, &String)| {
            let stage = Stage {
                name: (*name).to_owned(),
                base: scenes.to_owned(),
                scene: text.clone(),
                fmus: fmus.join(name),
                logging: false,
            };
            (*name, Arc::new(stage))
        };
        Self {
            planned: plan(quick, overrides),
            stages: texts.iter().map(stage).collect(),
        }
    }

    fn run(&self, planned: &ReproductionRun) -> Run {
        Run::of(&self.stages[&*planned.case.scene], planned.variant.clone())
    }
}

impl Experiment for Reproduce {
    type Job = ReproductionRun;
    type Found = Line;
    type Table = Reproduction;

    fn plan(&self) -> Vec<Planned<ReproductionRun>> {
        let planned = self.planned.iter();
        planned.map(|run| Planned::beside(run.clone(), 1.0)).collect()
    }

    fn make(&self, planned: &ReproductionRun, bench: &Bench<'_>) -> Result<Line, Unmade> {
        let run = self.run(planned);
        let mut line = Line::new(planned, &run);
        let made = bench.run(&run)?;
        line.take(&made);
        Ok(line)
    }

    fn judge(&self, found: &[Option<Line>]) -> Reproduction {
        let line = |(planned, line): (&ReproductionRun, &Option<Line>)| {
            line.clone().unwrap_or_else(|| Line::new(planned, &self.run(planned)))
        };
        Reproduction::new(self.planned.iter().zip(found).map(line).collect())
    }
}

impl Line {
    /// The line of a run that has not been made.
    fn new(planned: &ReproductionRun, run: &Run) -> Self {
        // A scene that is refused says so in its row.
        let scene = run.scene().ok();
        Self {
            group: planned.group,
            case: planned.case,
            mesh: planned.mesh,
            quantity: planned.quantity,
            value: planned.value.clone(),
            row: run.planned(),
            raw_std: None,
            head: None,
            even_head: scene.as_ref().and_then(wind::on_even_head),
            curve: None,
            wind: None,
            output_step: scene.map_or(f64::NAN, |scene| scene.run.output_step),
        }
    }

    /// The run of a published case on a mesh, in one system.
    pub(super) fn of<'a>(lines: &'a [Self], case: &Case, mesh: Mesh) -> Option<&'a Self> {
        lines.iter().find(|line| line.computes(case) && line.mesh == mesh)
    }

    /// `true` where it is a run of a published case in one system, as published or on another mesh.
    pub(super) fn computes(&self, case: &Case) -> bool {
        self.group.is_case() && self.case.scene == case.scene && self.row.mode == Mode::Monolithic.name()
    }

    /// Mean and standard deviation over the published ones, %.
    pub(super) fn differences(&self) -> [Option<f64>; 2] {
        let difference = |computed: Option<f64>, published: f64| Some(100.0 * (computed? / published - 1.0));
        [
            difference(self.row.mean, self.case.mean.value),
            difference(self.row.std, self.case.std.value),
        ]
    }

    /// Takes in a run.
    fn take(&mut self, made: &Attempt) {
        self.row = made.judged(None);
        let curve = made.curves.first();
        let raw = curve.and_then(|curve| curve.raw.get(curve.range.clone()));
        self.raw_std = raw.and_then(ForceStatistics::of).map(|force| force.std);
        let wind = made.winds.first().and_then(Option::as_ref);
        let evaluated = wind.zip(curve);
        self.head = evaluated.and_then(|(wind, curve)| HeadWind::of(wind, curve.range.clone()));
        // Only what may be drawn is kept.
        if self.group.is_case() {
            (self.curve, self.wind) = (curve.cloned(), wind.cloned());
        }
    }
}
