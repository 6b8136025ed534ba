//! A scene with some keys changed, run and timed.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use scene::Scene;

use super::{Curve, Errors, NO_ERRORS, Row, Status};
use cosim::fmu_slave::CosimulationError;
use fmi2::instance::InstanceError;
use fmi2::isolation::IsolationError;
use results::{Summary, WindRecord};
use simulation::{FmuSource, Mode, SetupError, prepare};
use suppliers::SupplierError;
use suppliers::settling::SettlingError;
use system::run::Watch;

/// What all runs of a table have in common.
pub struct Stage<'a> {
    /// Name of the scene.
    pub name: &'a str,
    /// Folder that paths in the scene are relative to.
    pub base: &'a Path,
    /// Resolved scene as text: statics and start are found once.
    pub scene: String,
    /// Folder for the FMUs of the table; the scene's own stay as they are.
    pub fmus: PathBuf,
    /// Whether FMUs are asked for their debug messages.
    pub logging: bool,
    /// Times that every run is timed.
    pub repeats: usize,
}

/// A run of the scene with other keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// How line and pantographs are put together.
    pub mode: Mode,
    /// Algorithm as it is called in the table.
    pub algorithm: String,
    /// Keys, in the form of the command line.
    pub overrides: Vec<String>,
}

/// A run that was made.
pub struct Performed {
    /// Its row, status and errors included.
    pub row: Row,
    /// Its contact forces; none where it cannot be compared.
    pub curves: Vec<Curve>,
    /// Whether it was ended from outside: it has no status then.
    pub interrupted: bool,
}

impl Variant {
    /// The scene of this variant.
    ///
    /// # Errors
    /// What is wrong with the values of the overrides.
    pub fn scene(&self, stage: &Stage<'_>) -> Result<Scene, SetupError> {
        Ok(system::load(&stage.scene, stage.name, &self.overrides)?)
    }

    /// Its row before it is run; a refused one where the scene does not allow it.
    #[must_use]
    pub fn planned(&self, stage: &Stage<'_>) -> Row {
        match self.scene(stage) {
            Ok(scene) => Row::planned(stage.name, &scene, self.mode, &self.algorithm),
            Err(error) => Row {
                scene: stage.name.to_owned(),
                mode: self.mode.name().to_owned(),
                algorithm: self.algorithm.clone(),
                status: Some(Status::Refused),
                reason: cosim::chain(&error),
                ..Row::default()
            },
        }
    }
}

/// One run of a variant, not judged yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// Its figures and its cost; a status only where it was refused.
    pub row: Row,
    /// Its contact forces; none where it cannot be compared.
    pub curves: Vec<Curve>,
    /// The wind on each strip, whole run, where one acts.
    pub winds: Vec<Option<WindRecord>>,
    /// Whether it reached its end.
    pub complete: bool,
    /// Whether it was ended from outside: there is nothing to judge then.
    pub interrupted: bool,
    /// Whether it ended early because the process of an isolated FMU did: another time it may not.
    pub lost: bool,
    /// Energy that the coupling added, as a share of the work that crossed the contact (–).
    pub energy_share: f64,
    /// Why it ended early, what an automatic choice came to.
    pub remarks: Vec<String>,
    /// Wall time of statics and loading, s.
    pub setup: f64,
}

impl Attempt {
    /// The row with status and errors; `reference` is what the run is compared with: name, row, contact forces.
    #[must_use]
    pub fn judged(&self, reference: Option<(&str, &Row, &[Curve])>) -> Row {
        let mut row = self.row.clone();
        if row.status == Some(Status::Refused) || self.interrupted {
            return row;
        }
        let errors = reference
            .filter(|_| self.complete)
            .map(|(_, _, curves)| Errors::between(curves, &self.curves));
        if let (Some(errors), Some((name, _, _))) = (&errors, reference) {
            row.take_errors(errors, name);
        }
        let still = reference.is_some_and(|(_, _, curves)| curves.iter().any(Curve::is_still));
        let errors = errors.filter(|_| !still);
        let (status, reason) = Status::of(&row, self.complete, errors.as_ref(), reference.map(|(_, row, _)| row));
        row.remark(&reason);
        if still && self.complete {
            row.remark(NO_ERRORS);
        }
        let (status, reason) = status.with_energy(self.energy_share);
        row.remark(&reason);
        self.remarks.iter().for_each(|remark| row.remark(remark));
        row.status = Some(status);
        row
    }
}

/// Makes one run of a variant.
///
/// A run that cannot begin is refused, with its reason; what concerns all runs alike is an error.
///
/// # Errors
/// FMUs that cannot be made.
pub fn attempt(stage: &Stage<'_>, variant: &Variant, watch: &Watch<'_>) -> Result<Attempt, SetupError> {
    let mut attempt = Attempt {
        row: variant.planned(stage),
        curves: Vec::new(),
        winds: Vec::new(),
        complete: false,
        interrupted: false,
        lost: false,
        energy_share: 0.0,
        remarks: Vec::new(),
        setup: 0.0,
    };
    let source = FmuSource {
        folder: stage.fmus.clone(),
        logging: stage.logging,
    };
    let run = variant.scene(stage).and_then(|scene| {
        let prepared = prepare(scene, stage.name, stage.base, stage.logging)?;
        prepared.run(variant.mode, &source, watch, |_| Ok::<(), SetupError>(()))
    });
    let finished = match run {
        Ok(finished) => finished,
        Err(error @ (SetupError::Package(_) | SetupError::FmuFile(_) | SetupError::SceneFmu { .. })) => {
            return Err(error);
        }
        Err(error) => {
            attempt.interrupted = matches!(error, SetupError::Settling(SettlingError::Interrupted { .. }));
            attempt.lost = lost_a_process(&error);
            attempt.row.status = (!attempt.interrupted).then_some(Status::Refused);
            attempt.row.remark(&cosim::chain(&error));
            return Ok(attempt);
        }
    };
    attempt.complete = finished.failure.is_none();
    attempt.interrupted = !attempt.complete && watch.interrupted.load(Ordering::Relaxed);
    attempt.lost = finished
        .failure
        .as_deref()
        .is_some_and(|failure| lost_a_process(failure));
    attempt.curves = Curve::of(&finished.info.evaluation, &finished.record);
    let strips = finished.record.pantographs.iter();
    attempt.winds = strips.map(|strip| strip.wind.clone()).collect();
    attempt.energy_share = finished.info.coupling.energy_share;
    attempt.setup = finished.info.cost.setup_s;
    let summary = Summary::new(&finished.info, &finished.record);
    attempt.row.take(&finished.info, &summary, finished.info.cost.wall_s, 1);
    attempt.remarks.push(finished.info.incomplete_reason.clone());
    if variant.mode != Mode::Monolithic {
        // That the table names it goes without saying; what follows may not.
        let coupling = &finished.info.coupling.reason;
        let said = coupling.strip_prefix("named in the scene").unwrap_or(coupling);
        attempt.remarks.push(said.trim_start_matches("; ").to_owned());
    }
    Ok(attempt)
}

/// Whether an error comes of the process of an isolated FMU: it was killed or crashed, took too long, or did not start.
fn lost_a_process(error: &(dyn Error + 'static)) -> bool {
    if let Some(error) = error.downcast_ref::<IsolationError>() {
        return !matches!(error, IsolationError::Reported { .. } | IsolationError::NotHere);
    }
    // An error that shows the message of the one that it holds shows its source too, and not the one itself.
    let held: Option<&(dyn Error + 'static)> = if let Some(InstanceError::Isolation(held)) = error.downcast_ref() {
        Some(held)
    } else if let Some(CosimulationError::Isolation(held)) = error.downcast_ref() {
        Some(held)
    } else if let Some(SupplierError::Fmu(held)) = error.downcast_ref() {
        Some(held)
    } else {
        match error.downcast_ref() {
            Some(SetupError::Cosimulation(held)) => Some(held),
            Some(SetupError::Wiring { source, .. }) => Some(&**source),
            _ => error.source(),
        }
    };
    held.is_some_and(lost_a_process)
}

/// Makes the runs of a variant, one at a time, and compares the first of them with `reference`.
///
/// # Errors
/// FMUs that cannot be made.
pub fn perform(
    stage: &Stage<'_>,
    variant: &Variant,
    reference: Option<(&str, &Performed)>,
    watch: &Watch<'_>,
) -> Result<Performed, SetupError> {
    let first = attempt(stage, variant, watch)?;
    let mut walls: Vec<f64> = first.row.wall.into_iter().collect();
    for _ in 1..stage.repeats {
        if !first.complete {
            break;
        }
        let again = attempt(stage, variant, watch)?;
        walls.extend(again.row.wall);
        if !again.complete {
            break;
        }
    }
    let mut row = first.judged(reference.map(|(name, run)| (name, &run.row, &*run.curves)));
    if !walls.is_empty() {
        row.timed(&mut walls);
    }
    Ok(Performed {
        row,
        curves: first.curves,
        interrupted: first.interrupted,
    })
}

/// Periods of the low-pass filter's cut-off that a run goes on after the evaluation range, –: what follows has no part in the
/// figures, and the filter has forgotten its end by a factor of exp(−24).
pub const SETTLE: f64 = 10.0;

/// Duration of a run in s that ends when the last strip has left the evaluation range and the low-pass filter has settled; not
/// longer than the scene's.
#[must_use]
pub fn settled(scene: &Scene) -> f64 {
    let evaluated = (0..scene.pantographs.len()).map(|index| scene.evaluation_time(index).1);
    let end = evaluated.fold(0.0, f64::max) + SETTLE / scene.run.low_pass_hz;
    scene.run.duration.min(end)
}

/// Median of some numbers, the lower one of the middle two.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((values.len().max(1) - 1) / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cosim::algorithm::CouplingError;
    use cosim::slave::SlaveError;
    use system::run::Failure;

    #[test]
    fn a_run_whose_fmu_lost_its_process_is_told_from_one_that_its_fmu_refused() {
        let gone = || IsolationError::Gone {
            instance: "pantograph".to_owned(),
        };
        let refused = || IsolationError::Reported {
            message: "no".to_owned(),
            kind: fmi2::isolation::Reported::Refused,
        };
        let in_a_step = |error: IsolationError| {
            let source = Box::new(InstanceError::Isolation(error));
            SlaveError::Step {
                slave: "pantograph".to_owned(),
                t: 0.5,
                h: 1e-3,
                retryable: false,
                source,
            }
        };
        let wired = |error: IsolationError| SetupError::Wiring {
            key: "pantograph[1]".to_owned(),
            source: Box::new(SupplierError::Fmu(CosimulationError::Isolation(error))),
        };
        let ways: [fn(SlaveError) -> Box<dyn Error>; 3] = [
            |error| Box::new(Failure::Step(CouplingError::Slave(error))),
            |error| Box::new(SetupError::Settling(SettlingError::Step(error))),
            |error| Box::new(SetupError::Cosimulation(CosimulationError::Slave(error))),
        ];
        for way in ways {
            assert!(lost_a_process(&*way(in_a_step(gone()))));
            assert!(!lost_a_process(&*way(in_a_step(refused()))));
        }
        assert!(lost_a_process(&wired(gone())) && !lost_a_process(&wired(refused())));
    }
}
