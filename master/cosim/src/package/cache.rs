//! FMUs kept from run to run: in the source tree or in the user's cache folder, never in the current directory.
//!
//! A kept FMU is a shortcut, not a source: each of its files is compared with the one that would be packed, in the
//! private folder that the archive is unpacked to, before any of them is loaded.

use std::path::{Path, PathBuf};

use fmi2::archive::Package;
use fmi2::import::Fmu;
use scene::Scene;

use super::{Libraries, PackageError, archives, source_tree};

/// Folder of the FMUs of a scene within the source tree and below the current directory.
const PRODUCTS: &str = "target/fmu";

/// Folder that keeps the FMUs of runs of a scene: that of the source tree, else the user's cache folder.
#[must_use]
pub fn folder(scene: &str) -> PathBuf {
    if let Some(tree) = source_tree() {
        return tree.join(PRODUCTS).join(scene);
    }
    let cache = kept::folder().unwrap_or_else(|| std::env::temp_dir().join("pantoline"));
    cache.join("fmu").join(scene)
}

/// Folder that `master package` writes the FMUs of a scene to: an output, which no run reads.
#[must_use]
pub fn output(scene: &str) -> PathBuf {
    source_tree().unwrap_or_default().join(PRODUCTS).join(scene)
}

/// Opens the FMUs of a resolved scene, file name and FMU, and keeps them in `folder`.
///
/// A kept FMU is used where all of its files are those that would be packed; any other one is packed anew. A folder
/// that cannot be written to costs time only.
///
/// # Errors
/// See [`PackageError`].
pub fn ensure(scene: &Scene, libraries: &Libraries, folder: &Path) -> Result<Vec<(String, Fmu)>, PackageError> {
    let mut fmus = Vec::new();
    for (name, package) in archives(scene, libraries)? {
        let path = folder.join(&name);
        let fmu = match kept(&package, &path)? {
            Some(fmu) => fmu,
            None => {
                let written = package.write(&path).is_ok();
                match written.then(|| kept(&package, &path)).transpose()?.flatten() {
                    Some(fmu) => fmu,
                    // Another run has just written its own FMU to the same place, or nothing can be written there.
                    None => privately(&package, &name)?,
                }
            }
        };
        fmus.push((name, fmu));
    }
    Ok(fmus)
}

/// The FMU at `path`, where all of its files are those of `package`.
fn kept(package: &Package, path: &Path) -> Result<Option<Fmu>, PackageError> {
    let Ok(fmu) = Fmu::open(path) else { return Ok(None) };
    let same = package.is_content_of(fmu.folder(), path)?;
    Ok(same.then_some(fmu))
}

/// The FMU from a folder of its own.
fn privately(package: &Package, name: &str) -> Result<Fmu, PackageError> {
    let folder = fmi2::scratch::Scratch::new().map_err(|source| PackageError::Read {
        path: std::env::temp_dir(),
        source,
    })?;
    let path = folder.path().join(name);
    package.write(&path)?;
    Ok(Fmu::open(&path)?)
}
