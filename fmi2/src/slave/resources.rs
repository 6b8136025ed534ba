//! Location of the resources of an instance.

use super::library;
use super::model::{ModelError, ModelResult};
use crate::location;
use std::path::{Path, PathBuf};

/// Resource with the GUID of the model description that the library was packaged with.
pub const GUID_FILE: &str = "guid.txt";

/// Content of `guid.txt` in the resources.
pub(super) fn resource_guid(resources: Option<&Path>) -> ModelResult<String> {
    let Some(folder) = resources else {
        return Err(ModelError::unusable(
            "no resource location was passed and none lies beside the library",
        ));
    };
    let path = folder.join(GUID_FILE);
    let text =
        std::fs::read_to_string(&path).map_err(|error| ModelError::unusable(format!("{}: {error}", path.display())))?;
    Ok(text.trim().to_owned())
}

/// The existing folder that `location` means; without a location the one beside this library.
pub(super) fn resolved(location: Option<&str>) -> ModelResult<Option<PathBuf>> {
    let location = location.unwrap_or_default();
    let candidates = location::candidates(location);
    if candidates.is_empty() {
        return Ok(beside_library());
    }
    candidates
        .into_iter()
        .find(|path| path.is_dir())
        .map(Some)
        .ok_or_else(|| ModelError::unusable(format!("the resource location {location} is no existing folder")))
}

/// `resources` of the unpacked FMU this library was loaded from: `<fmu>/binaries/<platform>/<library>`.
fn beside_library() -> Option<PathBuf> {
    let library = library::path()?;
    let resources = library.parent()?.parent()?.parent()?.join("resources");
    resources.is_dir().then_some(resources)
}
