//! Names of scenes, and paths in a scene seen from a folder of results.

use std::path::{Component, Path, PathBuf};

use scene::Scene;

/// Name of a scene: the file's without extension; the folder's for `scene.toml`, which every result directory has.
#[must_use]
pub fn scene_name(path: &Path) -> String {
    let stem = path
        .file_stem()
        .map_or_else(|| "scene".into(), |stem| stem.to_string_lossy());
    if stem == "scene" {
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if let Some(folder) = absolute.parent().and_then(Path::file_name) {
            return folder.to_string_lossy().into_owned();
        }
    }
    stem.into_owned()
}

/// The scene with the paths of its FMUs relative to `directory`.
#[must_use]
pub fn relative_to(scene: &Scene, directory: &Path) -> Scene {
    let mut scene = scene.clone();
    for side in scene.supplied_sides_mut() {
        side.fmu = relative(Path::new(&side.fmu), directory).display().to_string();
    }
    scene
}

/// `path` seen from `folder`; as it is where the two have no common root.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let (path, folder) = (real(path), real(folder));
    let (to, from): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (path.components().collect(), folder.components().collect());
    let shared = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return path;
    }
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - shared);
    up.chain(to[shared..].iter().copied()).collect()
}

/// `path` without links and `..`, as far as it exists: the way up from a folder leads where the system says.
#[must_use]
pub fn real(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let found = absolute
        .ancestors()
        .find_map(|there| Some((there, there.canonicalize().ok()?)));
    match found {
        Some((there, real)) => match absolute.strip_prefix(there) {
            Ok(rest) if !rest.as_os_str().is_empty() => real.join(rest),
            _ => real,
        },
        None => absolute,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_named_after_its_file_or_its_result_directory() {
        assert_eq!(scene_name(Path::new("scenes/en50318-250.toml")), "en50318-250");
        assert_eq!(scene_name(Path::new("results/thesis/scene.toml")), "thesis");
    }

    #[test]
    fn a_way_through_another_folder_is_not_kept() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        std::fs::create_dir_all(at("results/first")).unwrap();
        std::fs::write(at("x.fmu"), "").unwrap();
        let seen = relative(&at("results/first/../../x.fmu"), &at("results/second"));
        assert_eq!(seen, Path::new("../../x.fmu"));
    }

    #[test]
    fn paths_are_seen_from_the_output_directory() {
        let seen = |path: &str, folder: &str| relative(Path::new(path), Path::new(folder));
        assert_eq!(seen("/a/vendor/x.fmu", "/a/results/s"), Path::new("../../vendor/x.fmu"));
        assert_eq!(seen("/a/results/s/x.fmu", "/a/results/s"), Path::new("x.fmu"));
    }
}
