//! The plan of a comparison carried out, and its judge.

use std::sync::Arc;

use scene::Scene;
use serde::Serialize;

use super::plan::{ComparedRun, groups, plan};
use crate::engine::table::{AUTO, Keys, RunRow, observed_orders};
use crate::engine::{Bench, Experiment, Planned, Run, Sheet, Stage, Table, Timed, Unmade};
use results::curve::{Errors, ForceCurve, pointwise_rms};
use results::report::Page;
use simulation::sliding_joint;
use simulation::{Mode, SetupError, prepare, settled};

/// A comparison that can begin.
pub struct Compare {
    /// The resolved scene, as far as it is run.
    pub scene: Scene,
    /// Runs.
    pub runs: Vec<ComparedRun>,
    /// Times that every run is timed.
    pub repeats: usize,
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
}

impl Table for Comparison {
    fn sheet(&self) -> Sheet {
        Sheet {
            rows: self.rows.clone(),
            ..Sheet::default()
        }
    }

    fn text(&self) -> String {
        super::text::text(self)
    }

    fn sections(&self) -> Page {
        super::page::page(self)
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
        let stage = Arc::new(Stage {
            scene: scene.to_toml(),
            ..stage
        });
        Ok(Self {
            scene,
            runs,
            repeats,
            stage,
        })
    }

    fn run(&self, run: &ComparedRun) -> Run {
        Run::of(&self.stage, run.variant.clone())
    }

    /// The run that the others of a group are compared with: the first in rank that is stable. Its rank, its place, its
    /// row.
    fn reference<'a>(&self, group: usize, found: &'a [Option<Timed>]) -> Option<(u8, usize, RunRow, &'a Timed)> {
        let stable = |(index, run): (usize, &ComparedRun)| {
            let timed = found[index].as_ref().filter(|timed| !timed.made.curves.is_empty())?;
            let row = timed.made.judged(None);
            (run.group == group && row.is_stable()).then_some((run.reference?, index, row, timed))
        };
        let candidates = self.runs.iter().enumerate().filter_map(stable);
        candidates.min_by_key(|(rank, ..)| *rank)
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
        row.timed(&timed.times.walls);
        row
    }
}

impl Experiment for Compare {
    type Job = Run;
    type Found = Timed;
    type Table = Comparison;

    fn plan(&self) -> Vec<Planned<Run>> {
        let planned = |run: &ComparedRun| Planned::alone(self.run(run), run.weight);
        self.runs.iter().map(planned).collect()
    }

    fn make(&self, run: &Run, bench: &Bench<'_>) -> Result<Timed, Unmade> {
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
        let curves = |index: &usize| found[*index].as_ref().map(|timed| timed.made.curves.clone());
        let mut comparison = Comparison {
            scene: self.stage.name.clone(),
            title: self.scene.title.clone(),
            source: self.scene.source.clone().unwrap_or_default(),
            complete: rows.iter().all(|row| row.status.is_some()),
            curves: order.iter().map(|index| curves(index).unwrap_or_default()).collect(),
            rows: order.iter().map(|&index| rows[index].clone()).collect(),
            ..Comparison::default()
        };
        observed_orders(&mut comparison.rows);
        between_references(&mut comparison);
        same_bits(&mut comparison);
        comparison
    }
}

/// Place of a row in the table: modes, then algorithms in their order, then the macro step.
fn place(run: &ComparedRun, row: &RunRow) -> (Option<usize>, Option<usize>, u64) {
    let modes = [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation];
    let mode = modes.iter().position(|mode| *mode == run.variant.mode);
    let named = |name: &&str| *name == run.variant.algorithm;
    let algorithm = super::algorithms().iter().position(named);
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
    let Comparison { rows, curves, .. } = comparison;
    let monolithic = |row: &RunRow| row.mode == Mode::Monolithic.name() && row.is_stable();
    let whole: Vec<usize> = (0..rows.len()).filter(|&index| monolithic(&rows[index])).collect();
    let finest = whole
        .iter()
        .min_by_key(|&&index| rows[index].micro_step.map(f64::to_bits));
    let Some(&finest) = finest else { return };
    let name = reference_name(&rows[finest]);
    for index in whole.into_iter().filter(|&index| index != finest) {
        rows[index].take_errors(&Errors::between(&curves[finest], &curves[index]), &name);
    }
}

/// Notes where the FMUs compute the same as the subsystems without them.
fn same_bits(comparison: &mut Comparison) {
    let Comparison { rows, curves, .. } = comparison;
    let (mut same, mut compared) = (0, 0);
    for index in 0..rows.len() {
        let row = &rows[index];
        let with_fmus = |other: &RunRow| {
            other.mode == Mode::Cosimulation.name() && other.algorithm == AUTO && other.macro_step == row.macro_step
        };
        let other = rows.iter().position(|other| with_fmus(other) && other.status.is_some());
        let Some(other) = other.filter(|_| row.mode == Mode::Inprocess.name() && row.status.is_some()) else {
            continue;
        };
        let (here, there) = (&curves[index], &curves[other]);
        if here.is_empty() || there.is_empty() {
            continue;
        }
        compared += 1;
        if here == there {
            same += 1;
            rows[index].remark("the same bits as with FMUs");
        } else {
            let rms = here
                .iter()
                .zip(there)
                .filter_map(|(here, there)| pointwise_rms((&there.x, &there.raw), (&here.x, &here.raw)));
            let rms = rms.fold(0.0, f64::max);
            rows[index].remark(&format!(
                "the raw force differs from that with FMUs by {rms:.1e} N (rms)"
            ));
        }
    }
    if compared > 0 {
        let all = same == compared;
        comparison.same_bits = Some(all);
        let same = if all { "all".to_owned() } else { format!("{same} of") };
        let note = format!("In process and with FMUs: the same bits at {same} {compared} macro steps compared.");
        comparison.notes.push(note);
    }
}
