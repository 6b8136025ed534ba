//! A scene with some keys changed, run and timed.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use scene::Scene;

use super::{Curve, Errors, Row, Status};
use crate::results::Summary;
use crate::run::Watch;
use crate::simulation::{FmuSource, Mode, SetupError, prepare};

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
    /// Is given what takes long.
    pub say: &'a dyn Fn(&str),
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
        Ok(Scene::from_toml(&stage.scene, stage.name, &self.overrides)?)
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
                reason: crate::simulation::chain(&error),
                ..Row::default()
            },
        }
    }
}

/// Makes the runs of a variant, one at a time, and compares the first of them with `reference`.
///
/// A run that cannot begin is refused, with its reason; what concerns all runs alike is an error.
///
/// # Errors
/// FMUs that cannot be made.
pub fn perform(
    stage: &Stage<'_>,
    variant: &Variant,
    reference: Option<(&str, &Performed)>,
    watch: &Watch<'_>,
) -> Result<Performed, SetupError> {
    let mut row = variant.planned(stage);
    let refused = |mut row: Row, reason: String| {
        row.status = Some(Status::Refused);
        row.remark(&reason);
        Performed {
            row,
            curves: Vec::new(),
            interrupted: false,
        }
    };
    let source = FmuSource {
        folder: stage.fmus.clone(),
        say: stage.say,
        logging: stage.logging,
    };
    let (mut walls, mut first) = (Vec::new(), None);
    for _ in 0..stage.repeats.max(1) {
        let run = variant.scene(stage).and_then(|scene| {
            let prepared = prepare(scene, stage.name, stage.base, stage.logging)?;
            prepared.run(variant.mode, &source, watch, |_| Ok::<(), SetupError>(()))
        });
        let finished = match run {
            Ok(finished) => finished,
            Err(error @ (SetupError::Package(_) | SetupError::FmuFile(_))) => return Err(error),
            Err(error) => return Ok(refused(row, crate::simulation::chain(&error))),
        };
        walls.push(finished.info.cost.wall_s);
        let failed = finished.failure.is_some();
        first.get_or_insert(finished);
        if failed {
            break;
        }
    }
    let finished = first.expect("at least one run");
    let complete = finished.failure.is_none();
    let interrupted = !complete && watch.interrupted.load(Ordering::Relaxed);
    let curves = Curve::of(&finished.info.evaluation, &finished.record);
    let summary = Summary::new(&finished.info, &finished.record);
    row.take(&finished.info, &summary, median(&mut walls), walls.len());
    let errors = reference
        .filter(|_| complete)
        .map(|(_, reference)| Errors::between(&reference.curves, &curves));
    if let (Some(errors), Some((name, _))) = (&errors, reference) {
        row.take_errors(errors, name);
    }
    let (status, reason) = Status::of(
        &row,
        complete,
        errors.as_ref(),
        reference.map(|(_, reference)| &reference.row),
    );
    row.remark(&reason);
    let (status, reason) = status.with_energy(finished.info.coupling.energy_share);
    row.remark(&reason);
    row.remark(&finished.info.incomplete_reason);
    if variant.mode != Mode::Monolithic {
        // That the table names it goes without saying; what follows may not.
        let coupling = &finished.info.coupling.reason;
        let said = coupling.strip_prefix("named in the scene").unwrap_or(coupling);
        row.remark(said.trim_start_matches("; "));
    }
    row.status = (!interrupted).then_some(status);
    Ok(Performed {
        row,
        curves,
        interrupted,
    })
}

/// Median of some numbers, the lower one of the middle two.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((values.len().max(1) - 1) / 2).copied().unwrap_or(f64::NAN)
}
