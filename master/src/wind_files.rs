//! Files that a scene's wind names: their rows are taken into the scene, which then needs no file.

use std::path::Path;

use scene::{AerodynamicMarker, Scene, rows_of};

use crate::simulation::SetupError;

/// Most rows of a file: what a scene can still hold as text.
const MOST_ROWS: usize = 200_000;

/// Takes the rows of `wind.file` and of the marker files into the scene. Paths are relative to `base`.
///
/// # Errors
/// [`SetupError::NotAvailable`] with the key, the file and what is wrong with it.
pub fn read(scene: &mut Scene, base: &Path) -> Result<(), SetupError> {
    let Some(wind) = &mut scene.wind else { return Ok(()) };
    if let Some(file) = wind.file.take() {
        let refused = |reason: String| refused("wind.file", &file, &reason);
        let rows = rows_of(&text(base, &file).map_err(refused)?).map_err(|error| refused(error.to_string()))?;
        if rows.len() > MOST_ROWS {
            return Err(refused(format!("has {} rows, must have at most {MOST_ROWS}", rows.len())));
        }
        dynamics::WindRecord::from_rows(&rows).map_err(|error| refused(error.to_string()))?;
        wind.record = rows;
    }
    let surfaces = wind.pantograph.iter_mut().flat_map(|pantograph| &mut pantograph.surfaces);
    for (index, surface) in surfaces.enumerate() {
        let Some(file) = surface.marker_file.take() else { continue };
        let key = format!("wind.pantograph.surfaces[{}].marker_file", index + 1);
        let text = text(base, &file).map_err(|reason| refused(&key, &file, &reason))?;
        surface.markers = AerodynamicMarker::read(&text).map_err(|error| refused(&key, &file, &error.to_string()))?;
    }
    Ok(())
}

fn text(base: &Path, file: &str) -> Result<String, String> {
    std::fs::read_to_string(base.join(file)).map_err(|error| format!("cannot be read: {error}"))
}

fn refused(key: &str, file: &str, reason: &str) -> SetupError {
    SetupError::NotAvailable(format!("{key} = {file:?}: {reason}"))
}
