//! Files that tables of a scene are left to: their rows are taken into the scene, which then needs no file.

use std::cell::Cell;
use std::path::Path;

use scene::Scene;

use crate::SetupError;

/// Takes the rows of all such files into the scene, which is checked again where there are any; it is called `name` in
/// messages. Paths are relative to `base`.
///
/// # Errors
/// [`SetupError::NotAvailable`] with the key, the file and what is wrong with it; [`SetupError::Scene`] where what was
/// read contradicts the scene.
pub fn read(scene: &mut Scene, name: &str, base: &Path) -> Result<(), SetupError> {
    let any = Cell::new(false);
    let open = |path: &str| {
        any.set(true);
        std::fs::read_to_string(base.join(path)).map_err(|error| format!("cannot be read: {error}"))
    };
    scene.fill_tables(&open).map_err(SetupError::NotAvailable)?;
    if any.get() {
        catenary::mesh::check(scene, name)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::AerodynamicMarker;

    fn scene() -> Scene {
        let text = include_str!("../../../scenes/thesis-wind-pantograph.toml");
        let keys = [
            "wind.file=\"wind.csv\"",
            "wind.pantograph.surfaces.3.marker_file=\"head.csv\"",
        ];
        system::load(text, "scene.toml", &keys.map(str::to_owned)).unwrap()
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
        assert_eq!(scene.unread_files_mut().len(), 2);
        read(&mut scene, "scene.toml", folder.path()).unwrap();
        assert!(scene.unread_files_mut().is_empty());
        let wind = scene.wind.as_ref().unwrap();
        assert_eq!(wind.record, [[0.0, 1.0, 2.0, 3.0], [5.0, 2.0, 3.0, 4.0]]);
        assert_eq!(wind.pantograph.as_ref().unwrap().surfaces[3].markers, [marker, marker]);
        let again = system::load(&scene.to_toml(), "again", &[]).unwrap();
        assert_eq!(again, scene);
    }

    #[test]
    fn a_bad_file_is_refused_with_key_file_and_reason() {
        let folder = tempfile::tempdir().unwrap();
        let refusal = || read(&mut scene(), "scene.toml", folder.path()).unwrap_err().to_string();
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
