//! An archive to a scene.

use std::path::{Path, PathBuf};

use fmi2::archive::{Limits, extract};
use fmi2::scratch::Scratch;
use scene::Scene;

use super::digest::digest;
use super::foreign::Foreign;
use super::unpacked::Unpacked;
use super::{STRUCTURE_FILE, SspError, read};

/// A scene made of an archive.
pub struct Imported {
    /// The scene; paths of FMUs are relative to [`Imported::base`].
    pub scene: Scene,
    /// Folder that they are relative to.
    pub base: PathBuf,
    /// Notes on how the archive was read, and on unused parts.
    pub notes: Vec<String>,
    /// The unpacked archive, removed when this is dropped.
    pub folder: Scratch,
}

/// Reads an `.ssp`; `overrides` are those of the command line.
///
/// An archive of [`export`](super::export()) left unchanged gives the scene that it was made of. Any other one, of one
/// line and one or more pantographs, becomes a scene of supplied FMUs.
///
/// # Errors
/// See [`SspError`].
pub fn import(path: &Path, overrides: &[String]) -> Result<Imported, SspError> {
    let folder = extract(path, STRUCTURE_FILE, &Limits::default()).map_err(|problem| SspError::Archive {
        path: path.to_owned(),
        problem,
    })?;
    let unpacked = Unpacked {
        archive: path,
        folder: folder.path(),
    };
    let file = unpacked.structure();
    let bytes = unpacked.content(STRUCTURE_FILE, 1)?;
    let description = read::description(&bytes, file)?;
    let mut notes = Vec::new();
    if let Some(own) = &description.own {
        let text = unpacked.content(&own.scene, 1)?;
        let text = String::from_utf8_lossy(&text);
        let origin = format!("{}: {}", path.display(), own.scene);
        if digest(&description, unpacked)? == own.digest {
            let scene = system::load(&text, &origin, overrides)?;
            let base = unpacked.file(&own.scene).ok();
            let base = base
                .as_deref()
                .and_then(Path::parent)
                .unwrap_or(folder.path())
                .to_owned();
            return Ok(Imported {
                scene,
                base,
                notes,
                folder,
            });
        }
        notes.push(
            "the system was changed since `master export`: its FMUs and parameters are used as they are now, with the \
             run and the coupling of the exported scene"
                .to_owned(),
        );
    }
    if let Some(start) = description.experiment.start.filter(|start| *start != 0.0) {
        return Err(SspError::Shape {
            path: path.to_owned(),
            problem: format!("startTime = {start} s of the default experiment: a run starts at t = 0"),
        });
    }
    let foreign = Foreign::of(&description, unpacked, &mut notes)?;
    let origin = format!("{} as a scene", path.display());
    let scene = match &description.own {
        Some(own) => foreign.in_place_of(own, &description, unpacked, &origin, overrides)?,
        None => system::load(&foreign.to_toml(&description), &origin, overrides)?,
    };
    Ok(Imported {
        scene,
        base: folder.path().to_owned(),
        notes,
        folder,
    })
}
