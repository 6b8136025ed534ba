//! `master study`.

use std::path::Path;

use super::{CommandError, SceneFile, interrupted, print, print_json, say};
use crate::cli::Common;
use experiments::study::{self, CSV, Options, PAGE, Study, StudyError, Sweep};
use experiments::table_of_runs;
use results::report::{Progress, Show};
use results::{OutputDirectory, ResultsError};

impl From<StudyError> for CommandError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Setup(error) => Self::Setup(error),
            StudyError::Results(error) => Self::Results(error),
        }
    }
}

/// Refuses flags, each with its sweep and whether it was typed, of which `sweeps` leaves out the sweep.
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
pub fn study(path: &Path, options: Options, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let in_scene = |error: CommandError| error.in_scene(path);
    let interrupted = interrupted(common);
    file.notes.iter().for_each(|note| say(common)(note));
    let script = study::script(file.scene, &file.name, &file.base, &common.overrides, options);
    let script = script.map_err(|error| in_scene(error.into()))?;
    if script.planned.is_empty() {
        let why = script.empty_sweeps().join("; ");
        let file = path.to_owned();
        return Err(CommandError::NothingToStudy { file, why });
    }
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let store = script.store(&directory).map_err(CommandError::Directory)?;
    // A page that was there may be of another study than the table.
    output.remove(PAGE).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&file.name, show);
    let mut keep = |study: &Study| write_table(&output, study).map_err(StudyError::from);
    let study = study::study(&script, &store, interrupted, &progress, &mut keep);
    let study = study.map_err(|error| in_scene(error.into()))?;
    progress.finish();
    output
        .write_page(PAGE, &study::page(&study))
        .map_err(CommandError::Results)?;
    if common.json {
        print_json(&study)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n  {CSV} and {PAGE} in {}\n",
            study::text(&study),
            directory.display()
        ))?;
    }
    if study.complete {
        return Ok(());
    }
    Err(CommandError::Incomplete {
        reason: format!(
            "{} of {} runs were made; the same command goes on from there",
            study.made(),
            study.rows.len()
        ),
        directory,
    })
}

fn write_table(output: &OutputDirectory, study: &Study) -> Result<(), ResultsError> {
    let (rows, columns) = study.table();
    output.replace(CSV, |out, path| table_of_runs::write(out, path, &rows, &[], &columns))
}
