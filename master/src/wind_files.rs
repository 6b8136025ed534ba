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
            return Err(refused(format!(
                "has {} rows, must have at most {MOST_ROWS}",
                rows.len()
            )));
        }
        dynamics::WindRecord::from_rows(&rows).map_err(|error| refused(error.to_string()))?;
        wind.record = rows;
    }
    let surfaces = wind
        .pantograph
        .iter_mut()
        .flat_map(|pantograph| &mut pantograph.surfaces);
    for (index, surface) in surfaces.enumerate() {
        let Some(file) = surface.marker_file.take() else {
            continue;
        };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        let text = include_str!("../../scenes/thesis-wind-pantograph.toml");
        let keys = [
            "wind.file=\"wind.csv\"",
            "wind.pantograph.surfaces.3.marker_file=\"head.csv\"",
        ];
        Scene::from_toml(text, "scene.toml", &keys.map(str::to_owned)).unwrap()
    }

    #[test]
    fn files_end_up_in_the_scene_and_are_not_asked_for_again() {
        let folder = tempfile::tempdir().unwrap();
        let marker = AerodynamicMarker {
            position: [0.0, 0.4, 0.1],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            area: 0.5,
        };
        std::fs::write(
            folder.path().join("head.csv"),
            AerodynamicMarker::write(&[marker, marker]),
        )
        .unwrap();
        std::fs::write(folder.path().join("wind.csv"), "time,vx,vy,vz\n0,1,2,3\n5,2,3,4\n").unwrap();
        let mut scene = scene();
        assert_eq!(scene.wind.as_ref().unwrap().unread_files().count(), 2);
        read(&mut scene, folder.path()).unwrap();
        let wind = scene.wind.as_ref().unwrap();
        assert_eq!(wind.unread_files().count(), 0);
        assert_eq!(wind.record, [[0.0, 1.0, 2.0, 3.0], [5.0, 2.0, 3.0, 4.0]]);
        assert_eq!(wind.pantograph.as_ref().unwrap().surfaces[3].markers, [marker, marker]);
        let again = Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap();
        assert_eq!(again, scene);
    }

    #[test]
    fn a_bad_file_is_refused_with_key_file_and_reason() {
        let folder = tempfile::tempdir().unwrap();
        let refusal = || read(&mut scene(), folder.path()).unwrap_err().to_string();
        assert!(
            refusal().starts_with("wind.file = \"wind.csv\": cannot be read: "),
            "{}",
            refusal()
        );
        std::fs::write(folder.path().join("wind.csv"), "0,1,2,3\n0,1,2,3\n").unwrap();
        assert_eq!(
            refusal(),
            "wind.file = \"wind.csv\": row 2: time = 0 s: must be after 0 s, the time before it at the same place"
        );
        std::fs::write(folder.path().join("wind.csv"), "0,1,2,3\n").unwrap();
        std::fs::write(folder.path().join("head.csv"), "0,0,0,1\n").unwrap();
        let expected = "wind.pantograph.surfaces[4].marker_file = \"head.csv\": row 1 has 4 numbers: must have 13";
        assert!(refusal().starts_with(expected), "{}", refusal());
    }
}
