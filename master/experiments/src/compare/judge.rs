//! The plan of a comparison carried out, and its judge.

use std::sync::Arc;

use scene::Scene;
use serde::Serialize;

use super::plan::{ComparedRun, StepGroup, groups, plan};
use crate::engine::table::{AUTO, Errors, ForceCurve, Keys, RunRow, Status, observed_orders, pointwise_rms};
use crate::engine::{Bench, Experiment, ExperimentError, Planned, Run, Sheet, Stage, Table, Timed, Timing, settled};
use results::LineGeometry;
use results::report::Page;
use simulation::sliding_joint;
use simulation::{Mode, SetupError, prepare};

/// A comparison that can begin.
pub struct Compare {
    /// The resolved scene, as far as it is run.
    pub scene: Scene,
    /// Groups of macro steps.
    pub groups: Vec<StepGroup>,
    /// Runs.
    pub runs: Vec<ComparedRun>,
    /// Times that every run is timed.
    pub repeats: usize,
    /// Coordinates of the track for plots.
    line: LineGeometry,
    stage: Arc<Stage>,
}

/// A comparison, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Source of the scene.
    pub source: String,
    /// `true` where every run was made.
    pub complete: bool,
    /// Remarks.
    pub notes: Vec<String>,
    /// One row per run.
    pub rows: Vec<RunRow>,
    /// `true` where FMUs and the subsystems without them computed the same bits wherever both ran; nothing where
    /// neither did.
    #[serde(skip)]
    pub same_bits: Option<bool>,
    /// Contact forces of each row's run.
    #[serde(skip)]
    pub curves: Vec<Vec<ForceCurve>>,
    /// Positions of supports and droppers.
    #[serde(skip)]
    pub line: LineGeometry,
}

impl Table for Comparison {
    fn sheet(&self) -> Sheet {
        Sheet {
            rows: self.rows.clone(),
            ..Sheet::default()
        }
    }

    fn is_complete(&self) -> bool {
        self.complete
    }

    fn text(&self) -> String {
        super::text(self)
    }

    fn sections(&self) -> Page {
        super::page(self)
    }
}

impl Compare {
    /// Solves the statics of a scene, which was read with these overrides, and plans its runs; `stage` says all of them
    /// but the scene.
    ///
    /// The runs end when the last strip has left the evaluation range and the low-pass filter has settled.
    ///
    /// # Errors
    /// Scenes that `master check` refuses.
    pub fn new(
        mut scene: Scene,
        stage: Stage,
        macro_steps: &[f64],
        overrides: &[String],
        repeats: usize,
    ) -> Result<Self, SetupError> {
        sliding_joint::refuse(&scene, "master compare")?;
        scene.run.duration = settled(&scene);
        let scene = prepare(scene, &stage.name, &stage.base, stage.logging)?.scene;
        let groups = groups(macro_steps, scene.solver.micro_step);
        let runs = plan(&groups, scene.run.duration, &Keys::of(&scene, overrides));
        let line = scene
            .modelled_line()
            .map_or_else(LineGeometry::default, |(line, _)| LineGeometry {
                support_x: line.supports_x(),
                dropper_x: line.droppers_x(),
            });
        let stage = Arc::new(Stage {
            scene: scene.to_toml(),
            ..stage
        });
        Ok(Self {
            scene,
            groups,
            runs,
            repeats,
            line,
            stage,
        })
    }

    fn run(&self, run: &ComparedRun) -> Run {
        Run::of(&self.stage, run.variant.clone())
    }

    /// The run that the others of a group are compared with: the first in rank that is stable.
    fn reference<'a>(&self, group: usize, found: &'a [Option<Timed>]) -> Option<(u8, usize, RunRow, &'a Timed)> {
        let candidates = self.runs.iter().enumerate().filter(|(_, run)| run.group == group);
        let stable = |(index, run): (usize, &ComparedRun)| {
            let timed = found[index].as_ref().filter(|timed| !timed.made.curves.is_empty())?;
            let row = timed.made.judged(None);
            (row.status == Some(Status::Stable)).then_some((run.reference?, index, row, timed))
        };
        candidates.filter_map(stable).min_by_key(|(rank, ..)| *rank)
    }

    /// The row of a run, compared with the reference of its group.
    fn row(&self, index: usize, found: &[Option<Timed>]) -> RunRow {
        let run = &self.runs[index];
        let Some(timed) = &found[index] else {
            return self.run(run).planned();
        };
        // A candidate that others were preferred to for want of stability has no reference.
        let reference = self.reference(run.group, found);
        let reference = reference.filter(|(rank, at, ..)| *at != index && run.reference.is_none_or(|own| own > *rank));
        let name = reference.as_ref().map(|(_, _, row, _)| reference_name(row));
        let against = reference.as_ref().zip(name.as_deref());
        let against = against.map(|((_, _, row, timed), name)| (name, row, &*timed.made.curves));
        let mut row = timed.made.judged(against);
        let mut walls = timed.times.walls.clone();
        if !walls.is_empty() {
            row.timed(&mut walls);
        }
        row
    }
}

impl Experiment for Compare {
    type Job = Run;
    type Found = Timed;
    type Table = Comparison;

    fn plan(&self) -> Vec<Planned<Run>> {
        let planned = |run: &ComparedRun| Planned {
            job: self.run(run),
            work: run.weight,
            timing: Timing::Alone,
        };
        self.runs.iter().map(planned).collect()
    }

    fn make(&self, run: &Run, bench: &Bench<'_>) -> Result<Option<Timed>, ExperimentError> {
        bench.timed(run, self.repeats, false)
    }

    fn label(&self, run: &Run) -> String {
        let row = run.planned();
        match row.macro_step {
            None => row.mode,
            Some(step) => format!("{} {} {} ms", row.mode, row.algorithm, 1e3 * step),
        }
    }

    fn judge(&self, found: &[Option<Timed>]) -> Comparison {
        let rows: Vec<RunRow> = (0..found.len()).map(|index| self.row(index, found)).collect();
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&index| place(&self.runs[index], &rows[index]));
        let curves = |index: &usize| {
            found[*index]
                .as_ref()
                .map_or_else(Vec::new, |timed| timed.made.curves.clone())
        };
        let mut comparison = Comparison {
            scene: self.stage.name.clone(),
            title: self.scene.title.clone(),
            source: self.scene.source.clone().unwrap_or_default(),
            complete: rows.iter().all(|row| row.status.is_some()),
            curves: order.iter().map(curves).collect(),
            rows: order.iter().map(|&index| rows[index].clone()).collect(),
            line: self.line.clone(),
            ..Comparison::default()
        };
        observed_orders(&mut comparison.rows);
        between_references(&mut comparison);
        same_bits(&mut comparison);
        comparison
    }
}

/// Place of a row in the table: modes, then algorithms in their order, then the macro step.
fn place(run: &ComparedRun, row: &RunRow) -> (u8, usize, u64) {
    let mode = match run.variant.mode {
        Mode::Monolithic => 0,
        Mode::Inprocess => 1,
        Mode::Cosimulation => 2,
    };
    let algorithm = super::algorithms()
        .iter()
        .position(|name| *name == run.variant.algorithm)
        .unwrap_or(0);
    // Steps are positive, so that their bits are in their order.
    let step = row.macro_step.or(row.micro_step).unwrap_or(0.0);
    (mode, algorithm, step.to_bits())
}

/// Name of a run as a reference.
fn reference_name(row: &RunRow) -> String {
    let micro = row.micro_step.unwrap_or(f64::NAN);
    match row.macro_step {
        None => format!("{}, micro step {micro:?} s", row.mode),
        Some(step) => format!(
            "{}, {}, macro step {step:?} s, micro step {micro:?} s",
            row.mode, row.algorithm
        ),
    }
}

/// Compares the monolithic runs with the finest of them: the error of the micro step alone.
fn between_references(comparison: &mut Comparison) {
    let monolithic = |row: &RunRow| row.mode == Mode::Monolithic.name() && row.status == Some(Status::Stable);
    let finest = (0..comparison.rows.len())
        .filter(|&index| monolithic(&comparison.rows[index]))
        .min_by_key(|&index| comparison.rows[index].micro_step.map(f64::to_bits));
    let Some(finest) = finest else { return };
    let name = reference_name(&comparison.rows[finest]);
    for index in (0..comparison.rows.len()).filter(|&index| index != finest) {
        if monolithic(&comparison.rows[index]) {
            let errors = Errors::between(&comparison.curves[finest], &comparison.curves[index]);
            comparison.rows[index].take_errors(&errors, &name);
        }
    }
}

/// Notes where the FMUs compute the same as the subsystems without them.
fn same_bits(comparison: &mut Comparison) {
    let find = |mode: Mode, step: Option<f64>| {
        comparison.rows.iter().position(|row| {
            row.mode == mode.name() && row.algorithm == AUTO && row.macro_step == step && row.status.is_some()
        })
    };
    let mut remarks = Vec::new();
    let (mut same, mut compared) = (0, 0);
    for (index, row) in comparison.rows.iter().enumerate() {
        if row.mode != Mode::Inprocess.name() || row.status.is_none() {
            continue;
        }
        let Some(other) = find(Mode::Cosimulation, row.macro_step) else {
            continue;
        };
        let (here, there) = (&comparison.curves[index], &comparison.curves[other]);
        if here.is_empty() || there.is_empty() {
            continue;
        }
        compared += 1;
        if here == there {
            same += 1;
            remarks.push((index, "the same bits as with FMUs".to_owned()));
        } else {
            let rms = here
                .iter()
                .zip(there)
                .filter_map(|(here, there)| pointwise_rms((&there.x, &there.raw), (&here.x, &here.raw)));
            let rms = rms.fold(0.0, f64::max);
            remarks.push((
                index,
                format!("the raw force differs from that with FMUs by {rms:.1e} N (rms)"),
            ));
        }
    }
    for (index, remark) in remarks {
        comparison.rows[index].remark(&remark);
    }
    if compared > 0 {
        comparison.same_bits = Some(same == compared);
        comparison.notes.push(if same == compared {
            format!("In process and with FMUs: the same bits at all {compared} macro steps compared.")
        } else {
            format!("In process and with FMUs: the same bits at {same} of {compared} macro steps compared.")
        });
    }
}
