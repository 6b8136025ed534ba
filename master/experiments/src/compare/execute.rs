//! Making the runs of a plan.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use scene::Scene;
use serde::Serialize;

use super::plan::{Group, Planned, groups, plan};
use crate::table_of_runs::{
    AUTO, Curve, Errors, Keys, Performed, Row, Stage, Status, observed_orders, perform, pointwise_rms, settled,
};
use results::LineGeometry;
use results::report::Progress;
use simulation::sliding_joint;
use simulation::{Mode, SetupError, prepare};
use system::run::Watch;

/// A comparison that can begin.
pub struct Script {
    /// The resolved scene, as far as it is run.
    pub scene: Scene,
    /// Groups of macro steps.
    pub groups: Vec<Group>,
    /// Runs.
    pub runs: Vec<Planned>,
    /// Coordinates of the track for plots.
    pub line: LineGeometry,
}

/// A comparison, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// Whether every run was made.
    pub complete: bool,
    /// Remarks.
    pub notes: Vec<String>,
    /// One row per run.
    pub rows: Vec<Row>,
    /// Contact forces of each row's run.
    #[serde(skip)]
    pub curves: Vec<Vec<Curve>>,
    /// Where supports and droppers stand.
    #[serde(skip)]
    pub line: LineGeometry,
}

impl Comparison {
    /// Number of runs that were made.
    #[must_use]
    pub fn made(&self) -> usize {
        self.rows.iter().filter(|row| row.status.is_some()).count()
    }
}

/// Solves the statics of a scene, which was read with these overrides, and plans its runs.
///
/// The runs end when the last strip has left the evaluation range and the low-pass filter has settled.
///
/// # Errors
/// What `master check` refuses.
pub fn script(
    mut scene: Scene,
    name: &str,
    base: &Path,
    macro_steps: &[f64],
    overrides: &[String],
    logging: bool,
) -> Result<Script, SetupError> {
    sliding_joint::refuse(&scene, "master compare")?;
    scene.run.duration = settled(&scene);
    let scene = prepare(scene, name, base, logging)?.scene;
    let groups = groups(macro_steps, scene.solver.micro_step);
    let runs = plan(&groups, scene.run.duration, &Keys::of(&scene, overrides));
    let line = scene
        .modelled_line()
        .map_or_else(LineGeometry::default, |(line, _)| LineGeometry {
            support_x: line.supports_x(),
            dropper_x: line.droppers_x(),
        });
    Ok(Script {
        scene,
        groups,
        runs,
        line,
    })
}

/// Place of a row in the table: modes, then algorithms in their order, then the macro step.
fn place(run: &Planned, row: &Row) -> (u8, usize, u64) {
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

/// What a run is called as a reference.
fn reference_name(row: &Row) -> String {
    let micro = row.micro_step.unwrap_or(f64::NAN);
    match row.macro_step {
        None => format!("{}, micro step {micro:?} s", row.mode),
        Some(step) => format!(
            "{}, {}, macro step {step:?} s, micro step {micro:?} s",
            row.mode, row.algorithm
        ),
    }
}

/// Makes the runs of a script, one at a time; `keep` is given the table after each, so that nothing computed is lost.
///
/// Rows without a status have not been run.
///
/// # Errors
/// FMUs that cannot be made, and what `keep` returns.
pub fn compare<E: From<SetupError>>(
    script: &Script,
    stage: &Stage<'_>,
    interrupted: &AtomicBool,
    progress: &Progress,
    keep: &mut dyn FnMut(&Comparison) -> Result<(), E>,
) -> Result<Comparison, E> {
    let rows: Vec<Row> = script.runs.iter().map(|run| run.variant.planned(stage)).collect();
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_key(|&index| place(&script.runs[index], &rows[index]));
    let mut at = vec![0; rows.len()];
    for (position, &index) in order.iter().enumerate() {
        at[index] = position;
    }
    let mut comparison = Comparison {
        scene: stage.name.to_owned(),
        title: script.scene.title.clone(),
        source: script.scene.source.clone().unwrap_or_default(),
        rows: order.iter().map(|&index| rows[index].clone()).collect(),
        curves: vec![Vec::new(); rows.len()],
        line: script.line.clone(),
        ..Comparison::default()
    };
    let weights: f64 = script.runs.iter().map(|run| run.weight).sum();
    let mut done = 0.0;
    let mut stopped = false;
    keep(&comparison)?;
    'groups: for group in 0..script.groups.len() {
        let mut pending: Vec<usize> = (0..script.runs.len())
            .filter(|&index| script.runs[index].group == group)
            .collect();
        let mut reference: Option<(String, Performed)> = None;
        while let Some(next) = next(script, &pending, reference.is_some()) {
            let index = pending.remove(next);
            let run = &script.runs[index];
            let row = &comparison.rows[at[index]];
            progress.message(&label(row));
            let share = run.weight / weights;
            let part = progress.part(done, done + share, script.scene.run.duration);
            let watch = Watch::new(interrupted, &part);
            let with = reference.as_ref().map(|(name, run)| (name.as_str(), run));
            let performed = perform(stage, &run.variant, with, &watch)?;
            done += share;
            progress.set(done);
            comparison.rows[at[index]] = performed.row.clone();
            comparison.curves[at[index]].clone_from(&performed.curves);
            stopped |= performed.interrupted || interrupted.load(std::sync::atomic::Ordering::Relaxed);
            let stable = performed.row.status == Some(Status::Stable);
            if reference.is_none() && run.reference.is_some() && stable && !performed.curves.is_empty() {
                reference = Some((reference_name(&performed.row), performed));
            }
            observed_orders(&mut comparison.rows);
            keep(&comparison)?;
            if stopped {
                break 'groups;
            }
        }
    }
    between_references(&mut comparison);
    same_bits(&mut comparison);
    comparison.complete = comparison.rows.iter().all(|row| row.status.is_some());
    keep(&comparison)?;
    Ok(comparison)
}

/// What is run next: while there is no reference, the best that could become one; then everything in turn.
fn next(script: &Script, pending: &[usize], has_reference: bool) -> Option<usize> {
    let candidates = (0..pending.len()).filter(|&k| script.runs[pending[k]].reference.is_some());
    let best = candidates.min_by_key(|&k| script.runs[pending[k]].reference);
    match best {
        Some(best) if !has_reference => Some(best),
        _ => (!pending.is_empty()).then_some(0),
    }
}

fn label(row: &Row) -> String {
    match row.macro_step {
        None => row.mode.clone(),
        Some(step) => format!("{} {} {} ms", row.mode, row.algorithm, 1e3 * step),
    }
}

/// Compares the monolithic runs with the finest of them: what the micro step alone is worth.
fn between_references(comparison: &mut Comparison) {
    let monolithic = |row: &Row| row.mode == Mode::Monolithic.name() && row.status == Some(Status::Stable);
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

/// Says where the FMUs compute the same as the subsystems without them.
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
        comparison.notes.push(if same == compared {
            format!("In process and with FMUs: the same bits at all {compared} macro steps compared.")
        } else {
            format!("In process and with FMUs: the same bits at {same} of {compared} macro steps compared.")
        });
    }
}
