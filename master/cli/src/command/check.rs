//! `master check`.

use std::path::Path;

use super::{CommandError, SceneFile, print, print_json, say};
use crate::cli::Common;
use simulation::check::Report;
use simulation::prepare;

/// Solves the statics of a scene and prints what will be modelled; no time integration.
///
/// # Errors
/// See [`CommandError`].
pub fn check(path: &Path, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    file.notes.iter().for_each(|note| say(common)(note));
    let prepared = prepare(file.scene, &file.name, &file.base, false);
    let prepared = prepared.map_err(|error| CommandError::from(error).in_scene(path))?;
    let report = Report::of(&prepared).map_err(|error| CommandError::from(error).in_scene(path))?;
    if common.json {
        print_json(&report)?;
    } else if !common.quiet {
        print(&report.text(&prepared))?;
    }
    Ok(())
}
