//! A scene with some keys changed, run once.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use scene::Scene;
use serde::{Deserialize, Serialize};

use super::table::{RunRow, Status};
use results::curve::{Errors, ForceCurve, NO_ERRORS};
use results::{Summary, WindRecord};
use simulation::{Finished, FmuSource, Mode, SetupError, prepare};
use suppliers::settling::SettlingError;
use system::disturbance::Disturbance;
use system::one_system::Evidence;
use system::run::Watch;

/// Parts that several runs have in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// Name of the scene.
    pub name: String,
    /// Folder that paths in the scene are relative to.
    pub base: PathBuf,
    /// Scene as text; a resolved one saves its runs the search for statics and start.
    pub scene: String,
    /// Folder for packages of FMUs; the scene's own stay as they are.
    pub fmus: PathBuf,
    /// `true` where FMUs are asked for their debug messages.
    pub logging: bool,
}

/// Changes that make a run of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Composition of line and pantographs.
    pub mode: Mode,
    /// Algorithm as it is called in the table.
    pub algorithm: String,
    /// Keys, in the form of the command line.
    pub overrides: Vec<String>,
}

/// A run to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Shared parts.
    pub stage: Arc<Stage>,
    /// Changes.
    pub variant: Variant,
    /// Disturbance besides the scene.
    pub disturbance: Disturbance,
}

/// Run that another one is compared with: name, row, contact forces.
pub type Judge<'a> = (&'a str, &'a RunRow, &'a [ForceCurve]);

/// One run, not judged yet; its series are kept apart from the rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Figures and cost; a status only where the run was refused.
    pub row: RunRow,
    /// Contact forces; none where the run cannot be compared.
    #[serde(skip)]
    pub curves: Vec<ForceCurve>,
    /// The wind on each strip, whole run, where one acts.
    #[serde(skip)]
    pub winds: Vec<Option<WindRecord>>,
    /// `true` where it reached its end.
    pub complete: bool,
    /// `true` where it was ended from outside: there is nothing to judge then.
    #[serde(skip)]
    pub interrupted: bool,
    /// `true` where it ended early because the process of an isolated FMU did: another time it may not.
    #[serde(skip)]
    pub lost: bool,
    /// Energy that the coupling added, as a share of the work that crossed the contact (–).
    pub energy_share: f64,
    /// Reasons of an early end and of automatic choices.
    pub remarks: Vec<String>,
    /// Wall time of statics and loading, s.
    pub setup: f64,
    /// Simulated time, s.
    pub simulated: f64,
    /// Largest contact force of the whole run, N.
    pub largest_force: Option<f64>,
    /// Most Newton iterations of one internal step; nothing where FMUs do not say.
    pub most_iterations: Option<u64>,
    /// Figures of one system that was audited.
    pub evidence: Option<Evidence>,
}

impl Run {
    /// A run without disturbance.
    #[must_use]
    pub fn of(stage: &Arc<Stage>, variant: Variant) -> Self {
        Self {
            stage: Arc::clone(stage),
            variant,
            disturbance: Disturbance::default(),
        }
    }

    /// The scene of this run.
    ///
    /// # Errors
    /// Overrides with wrong values.
    pub fn scene(&self) -> Result<Scene, SetupError> {
        let Stage { scene, name, .. } = &*self.stage;
        Ok(system::load(scene, name, &self.variant.overrides)?)
    }

    /// Its row before it is made; a refused one where the scene does not allow it.
    #[must_use]
    pub fn planned(&self) -> RunRow {
        let Variant { mode, algorithm, .. } = &self.variant;
        match self.scene() {
            Ok(scene) => RunRow::planned(&self.stage.name, &scene, *mode, algorithm),
            Err(error) => RunRow {
                scene: self.stage.name.clone(),
                mode: mode.name().to_owned(),
                algorithm: algorithm.clone(),
                status: Some(Status::Refused),
                reason: cosim::chain(&error),
                ..RunRow::default()
            },
        }
    }

    /// Makes the run. One that cannot begin is refused, one that panics has diverged, each with its reason.
    ///
    /// # Errors
    /// FMUs that cannot be made: they concern all runs alike.
    pub fn attempt(&self, watch: &Watch<'_>) -> Result<Attempt, SetupError> {
        self.caught(|| self.attempt_unguarded(watch))
    }

    /// The attempt that `make` returns, or that its panic ended.
    pub(crate) fn caught(&self, make: impl FnOnce() -> Result<Attempt, SetupError>) -> Result<Attempt, SetupError> {
        catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Ok(Attempt {
                row: self.planned(),
                remarks: vec![format!("panicked: {}", text.unwrap_or_default())],
                ..Attempt::default()
            })
        })
    }

    fn attempt_unguarded(&self, watch: &Watch<'_>) -> Result<Attempt, SetupError> {
        let Self { stage, variant, .. } = self;
        let mut attempt = Attempt {
            row: self.planned(),
            ..Attempt::default()
        };
        let source = FmuSource {
            folder: stage.fmus.clone(),
            logging: stage.logging,
        };
        let run = self.scene().and_then(|scene| {
            let mut prepared = prepare(scene, &stage.name, &stage.base, stage.logging)?;
            prepared.disturbance = self.disturbance.clone();
            prepared.pictures = false;
            prepared.run(variant.mode, &source, watch, |_| Ok::<(), SetupError>(()))
        });
        match run {
            Ok(finished) => attempt.take(&finished, variant.mode, watch),
            Err(error) if error.concerns_all_runs() => return Err(error),
            Err(error) => {
                attempt.interrupted = matches!(error, SetupError::Settling(SettlingError::Interrupted { .. }));
                attempt.lost = simulation::lost_a_process(&error);
                attempt.row.status = (!attempt.interrupted).then_some(Status::Refused);
                attempt.row.remark(&cosim::chain(&error));
            }
        }
        Ok(attempt)
    }
}

impl Attempt {
    fn take(&mut self, finished: &Finished, mode: Mode, watch: &Watch<'_>) {
        let (info, record) = (&finished.info, &finished.record);
        self.complete = finished.failure.is_none();
        self.interrupted = !self.complete && watch.interrupted.load(Ordering::Relaxed);
        let failure = finished.failure.as_deref();
        self.lost = failure.is_some_and(|failure| simulation::lost_a_process(failure));
        self.curves = ForceCurve::of(&info.evaluation, record);
        self.winds = record.pantographs.iter().map(|strip| strip.wind.clone()).collect();
        self.energy_share = info.coupling.energy_share;
        (self.setup, self.simulated) = (info.cost.setup_s, info.cost.simulated_s);
        self.row.take(info, &Summary::without_detail(info, record));
        self.remarks.push(info.incomplete_reason.clone());
        if mode != Mode::Monolithic {
            // That the table names it goes without saying; what follows may not.
            let coupling = &info.coupling.reason;
            let said = coupling.strip_prefix("named in the scene").unwrap_or(coupling);
            self.remarks.push(said.trim_start_matches("; ").to_owned());
        }
        let forces = record.pantographs.iter().flat_map(|strip| &strip.force);
        self.largest_force = Some(forces.fold(0.0_f64, |max, force| max.max(*force)));
        self.most_iterations = Some(finished.most_iterations).filter(|count| *count > 0);
        self.evidence = finished.evidence;
    }

    /// The row with status and errors; `reference` is what the run is compared with.
    #[must_use]
    pub fn judged(&self, reference: Option<Judge<'_>>) -> RunRow {
        let mut row = self.compared(reference);
        if row.status == Some(Status::Refused) || self.interrupted {
            return row;
        }
        if self.complete && reference.is_some_and(is_still) {
            row.remark(NO_ERRORS);
        }
        row.judge_energy(self.energy_share);
        self.remarks.iter().for_each(|remark| row.remark(remark));
        row
    }

    /// The row with errors, and status by them alone.
    pub(crate) fn compared(&self, reference: Option<Judge<'_>>) -> RunRow {
        let mut row = self.row.clone();
        if row.status == Some(Status::Refused) || self.interrupted {
            return row;
        }
        let complete = reference.filter(|_| self.complete);
        let errors = complete.map(|(name, _, curves)| {
            let errors = Errors::between(curves, &self.curves);
            row.take_errors(&errors, name);
            errors
        });
        let errors = errors.filter(|_| !reference.is_some_and(is_still));
        let status = Status::of(&row, self.complete, errors.as_ref(), reference.map(|(_, row, _)| row));
        row.judge(status);
        row
    }
}

/// `true` where a force of a run varies so little that no other one has an error in percent of it.
fn is_still((_, _, curves): Judge<'_>) -> bool {
    curves.iter().any(ForceCurve::is_still)
}

/// Median of some numbers, the lower one of the middle two.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get((values.len().max(1) - 1) / 2).copied()
}
