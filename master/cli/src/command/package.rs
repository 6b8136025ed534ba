//! `master package`.

use std::path::Path;

use super::{CommandError, SceneFile, print, print_json, say};
use crate::cli::Common;
use cosim::package::{Libraries, archives, output};
use results::ResultsError;
use simulation::sliding_joint;
use simulation::{SetupError, prepare};

/// Writes the FMUs of a scene.
///
/// # Errors
/// See [`CommandError`].
pub fn package(path: &Path, descriptions: Option<&Path>, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    file.notes.iter().for_each(|note| say(common)(note));
    let apart = sliding_joint::refuse(&file.scene, "master package");
    apart.map_err(|error| CommandError::from(error).in_scene(path))?;
    let prepared = prepare(file.scene, &file.name, &file.base, false);
    let prepared = prepared.map_err(|error| CommandError::from(error).in_scene(path))?;
    let libraries = Libraries::find()?;
    let target = common.out.clone().unwrap_or_else(|| output(&file.name));
    let mut written = Vec::new();
    for (name, archive) in archives(&prepared.scene, &libraries)? {
        if let Some(descriptions) = descriptions {
            let path = descriptions.join(Path::new(&name).with_extension("xml"));
            std::fs::write(&path, &archive.description).map_err(|source| {
                CommandError::Directory(ResultsError::Io {
                    path,
                    action: "write",
                    source,
                })
            })?;
        }
        let path = target.join(name);
        archive
            .write(&path)
            .map_err(|error| SetupError::FmuFile(Box::new(error)))?;
        written.push(path);
    }
    if common.json {
        let paths: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
        print_json(&serde_json::json!({ "scene": prepared.name, "fmus": paths }))?;
    } else if !common.quiet {
        let lines: String = written.iter().map(|path| format!("{}\n", path.display())).collect();
        print(&lines)?;
    }
    Ok(())
}
