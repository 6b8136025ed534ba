//! `master study`.

use std::path::PathBuf;

use clap::Args;

use super::experiment::{Files, Outputs};
use super::{CommandError, SceneFile, say};
use crate::cli::Common;
use experiments::study::{self, CSV, FOLDER, Options, PAGE, Sweep};

/// Table and page of the study.
const FILES: Files = Files { csv: CSV, page: PAGE };

/// Refuses typed flags whose sweep `sweeps` leaves out; a flag comes with its sweep and true where it was typed.
///
/// # Errors
/// [`CommandError::NoSweep`], [`CommandError::NoSpans`].
pub fn check_flags(sweeps: &[Sweep], flags: &[(&'static str, Sweep, bool)]) -> Result<(), CommandError> {
    let typed = || flags.iter().filter(|(_, _, typed)| *typed);
    if sweeps.contains(&Sweep::Spans) && !typed().any(|(_, sweep, _)| *sweep == Sweep::Spans) {
        return Err(CommandError::NoSpans);
    }
    let idle = typed().find(|(_, sweep, _)| !sweeps.is_empty() && !sweeps.contains(sweep));
    let Some(&(flag, missing, _)) = idle else {
        return Ok(());
    };
    let names: Vec<&str> = sweeps.iter().map(|sweep| sweep.name()).collect();
    let sweeps = names.join(",");
    Err(CommandError::NoSweep { flag, sweeps, missing })
}

/// Studies speed against error of a scene, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn study(arguments: &StudyArguments, common: &Common) -> Result<(), CommandError> {
    let options = arguments.options()?;
    let path = arguments.scene.as_path();
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let in_scene = |error: CommandError| error.in_scene(path);
    file.notes.iter().for_each(|note| say(common)(note));
    let script = study::script(file.scene, &file.name, &file.base, &common.overrides, options);
    let script = script.map_err(|error| in_scene(error.into()))?;
    if script.planned.is_empty() {
        let why = script.empty_sweeps().join("; ");
        let file = path.to_owned();
        return Err(CommandError::NothingToStudy { file, why });
    }
    let outputs = Outputs::open(&directory, FOLDER, FILES, common)?;
    let table = outputs.run(&script, &file.name, &|study| study::keep_ranks(&outputs.store, study));
    outputs.finish(&table.map_err(|error| in_scene(error.into()))?)
}
