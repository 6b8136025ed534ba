//! Making the runs of a reproduction, side by side.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::Serialize;

use super::plan::{Group, Mesh, Planned};
use super::published::Case;
use super::relation::{Relation, relations};
use super::spread::{Spread, spreads};
use super::wind;
use crate::table_of_runs::{Attempt, Curve, Row, Stage, attempt};
use results::WindRecord;
use results::report::Progress;
use results::statistics::ForceStatistics;
use simulation::{Mode, SetupError};
use system::run::Watch;

/// One run of a reproduction.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// What it is for.
    pub group: Group,
    /// The published case that it is a variant of.
    pub case: &'static Case,
    /// Mesh of the line.
    pub mesh: Mesh,
    /// What was changed besides the mesh.
    pub quantity: &'static str,
    /// To what, with its unit.
    pub value: String,
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: Row,
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
    pub curve: Option<Curve>,
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
    /// Whether every run was made.
    pub complete: bool,
    /// One per run.
    pub lines: Vec<Line>,
    /// Changes between cases.
    pub relations: Vec<Relation>,
    /// What the open quantities do to the standard deviation.
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

    /// Number of runs that were made.
    #[must_use]
    pub fn made(&self) -> usize {
        self.lines.iter().filter(|line| line.row.status.is_some()).count()
    }
}

impl Line {
    /// The line of a run that has not been made.
    fn new(planned: &Planned, stage: &Stage<'_>) -> Self {
        let scene = planned.variant.scene(stage);
        Self {
            group: planned.group,
            case: planned.case,
            mesh: planned.mesh,
            quantity: planned.quantity,
            value: planned.value.clone(),
            row: planned.variant.planned(stage),
            raw_std: None,
            head: None,
            // A scene that is refused says so in its row.
            even_head: scene.ok().as_ref().and_then(wind::on_even_head),
            curve: None,
            wind: None,
            output_step: f64::NAN,
        }
    }

    /// The run of a published case on a mesh, in one system.
    pub(super) fn of<'a>(lines: &'a [Self], case: &Case, mesh: Mesh) -> Option<&'a Self> {
        lines.iter().find(|line| {
            line.group.is_case()
                && line.case.scene == case.scene
                && line.mesh == mesh
                && line.row.mode == Mode::Monolithic.name()
        })
    }

    /// Takes in a run, of a scene with this output step (s).
    fn take(&mut self, mut made: Attempt, output_step: f64) {
        self.row = made.judged(None);
        let curve = (!made.curves.is_empty()).then(|| made.curves.swap_remove(0));
        let raw = curve.as_ref().and_then(|curve| curve.raw.get(curve.range.clone()));
        self.raw_std = raw.and_then(ForceStatistics::of).map(|force| force.std);
        let wind = made.winds.into_iter().next().flatten();
        let range = curve.as_ref().map(|curve| curve.range.clone());
        self.head = wind
            .as_ref()
            .zip(range)
            .and_then(|(wind, range)| HeadWind::of(wind, range));
        // Only what may be drawn is kept.
        self.curve = curve.filter(|_| self.group.is_case());
        self.wind = wind.filter(|_| self.group.is_case());
        self.output_step = output_step;
    }
}

/// A computed figure over the published one, %.
pub(super) fn difference(computed: Option<f64>, published: f64) -> Option<f64> {
    computed.map(|computed| 100.0 * (computed / published - 1.0))
}

/// What is run and where.
pub struct Site<'a> {
    /// Folder of the scenes.
    pub scenes: &'a Path,
    /// Text of each scene by its name.
    pub texts: &'a BTreeMap<&'static str, String>,
    /// Folder for FMUs.
    pub fmus: &'a Path,
    /// Runs made side by side.
    pub workers: usize,
}

impl Site<'_> {
    /// What the runs of each scene share.
    fn stages(&self) -> BTreeMap<&'static str, Stage<'_>> {
        let stage = |(name, text): (&&'static str, &String)| {
            let stage = Stage {
                name,
                base: self.scenes,
                scene: text.clone(),
                fmus: self.fmus.join(name),
                logging: false,
                repeats: 1,
            };
            (*name, stage)
        };
        self.texts.iter().map(stage).collect()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes all runs; `keep` is given the table from time to time, so that nothing computed is lost.
///
/// # Errors
/// FMUs that cannot be made, and what `keep` returns.
pub fn execute<E: From<SetupError>>(
    planned: &[Planned],
    site: &Site<'_>,
    interrupted: &AtomicBool,
    progress: &Progress,
    keep: &mut dyn FnMut(&Reproduction) -> Result<(), E>,
) -> Result<Reproduction, E> {
    let share = 1.0 / planned.len().max(1) as f64;
    let (next, ended) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let stop = AtomicBool::new(false);
    let stages = site.stages();
    let lines: Vec<Mutex<Line>> = planned
        .iter()
        .map(|run| Mutex::new(Line::new(run, &stages[run.case.scene])))
        .collect();
    let failed = Mutex::new(None);
    let table = || Reproduction::new(lines.iter().map(|line| lock(line).clone()).collect());
    keep(&table())?;
    let work = || {
        let stages = site.stages();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(run) = planned.get(index) else { break };
            if interrupted.load(Ordering::Relaxed) || stop.load(Ordering::Relaxed) {
                break;
            }
            let stage = &stages[run.case.scene];
            let scene = run.variant.scene(stage);
            let (duration, output_step) =
                scene.map_or((1.0, f64::NAN), |scene| (scene.run.duration, scene.run.output_step));
            let part = progress.beside(share, duration);
            let watch = Watch::new(interrupted, &part);
            let made = attempt(stage, &run.variant, &watch);
            part.fill();
            match made {
                Ok(made) => lock(&lines[index]).take(made, output_step),
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    *lock(&failed) = Some(error);
                }
            }
            ended.fetch_add(1, Ordering::Release);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..site.workers.max(1)).map(|_| scope.spawn(work)).collect();
        let mut kept = 0;
        while !workers.iter().all(|worker| worker.is_finished()) {
            std::thread::sleep(Duration::from_millis(100));
            let so_far = ended.load(Ordering::Acquire);
            if so_far > kept {
                kept = so_far;
                if let Err(error) = keep(&table()) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
        Ok(())
    })?;
    let reproduction = table();
    keep(&reproduction)?;
    if let Some(error) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error.into());
    }
    Ok(reproduction)
}
