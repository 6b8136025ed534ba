//! `master check`.

use std::path::Path;

use super::{CommandError, SceneFile, print, print_json, say};
use crate::cli::Common;
use results::OutputDirectory;
use simulation::check::Report;
use simulation::{check_page, prepare};

/// Solves the statics of a scene, prints what will be modelled and draws the line; no time integration.
///
/// # Errors
/// See [`CommandError`].
pub fn check(path: &Path, no_report: bool, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    let file_output = file.output(common);
    file.notes.iter().for_each(|note| say(common)(note));
    let prepared = prepare(file.scene, &file.name, &file.base, false);
    let prepared = prepared.map_err(|error| CommandError::from(error).in_scene(path))?;
    let report = Report::of(&prepared).map_err(|error| CommandError::from(error).in_scene(path))?;
    if common.json {
        print_json(&report)?;
    } else if !common.quiet {
        print(&report.text(&prepared))?;
    }
    // A tool that reads the report gets files where it names a folder for them.
    let wanted = !no_report && (!common.json || common.out.is_some());
    let Some(page) = wanted.then(|| check_page::page(&prepared, &report)).flatten() else {
        return Ok(());
    };
    let folder = match OutputDirectory::open(file_output) {
        Ok(folder) => folder,
        // A folder that nobody asked for may be one that cannot be written to.
        Err(error) if common.out.is_none() => {
            say(common)(&format!("the line is not drawn: {error}"));
            return Ok(());
        }
        Err(error) => return Err(CommandError::Directory(error)),
    };
    let files = [
        ("check.html", page.render()),
        ("line.svg", page.picture()),
        ("droppers.csv", page.droppers_csv()),
        ("supports.csv", page.supports_csv()),
    ];
    for (name, text) in files {
        folder.write_page(name, &text).map_err(CommandError::Results)?;
    }
    say(common)(&format!("line drawn in {}", folder.path().join("check.html").display()));
    Ok(())
}
