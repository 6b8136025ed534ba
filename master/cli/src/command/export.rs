//! `master export`.

use std::path::Path;

use super::{CommandError, SceneFile, print, print_json, say};
use crate::cli::Common;
use cosim::package::{Libraries, archives};
use simulation::prepare;
use simulation::sliding_joint;
use suppliers::SuppliedPantograph;
use suppliers::ssp;

/// Writes the co-simulation of a scene as an `.ssp`.
///
/// # Errors
/// See [`CommandError`].
pub fn export(path: &Path, common: &Common) -> Result<(), CommandError> {
    let say = say(common);
    let file = SceneFile::read(path, common)?;
    file.notes.iter().for_each(|note| say(note));
    let folder = file.output(common);
    let apart = sliding_joint::refuse(&file.scene, "master export");
    apart.map_err(|error| CommandError::from(error).in_scene(path))?;
    let prepared = prepare(file.scene, &file.name, &file.base, false);
    let prepared = prepared.map_err(|error| CommandError::from(error).in_scene(path))?;
    let libraries = Libraries::find()?;
    let target = folder.join(format!("{}.ssp", prepared.name));
    let own = archives(&prepared.scene, &libraries)?;
    let aligned: Vec<Option<f64>> = prepared.supplied.iter().map(aligned_offset).collect();
    let exported = ssp::export(&prepared.scene, &prepared.name, &own, &file.base, &aligned, &target)?;
    fmi2::archive::write(&target, &exported.archive).map_err(CommandError::Unwritten)?;
    exported.notes.iter().for_each(|note| say(note));
    if common.json {
        let target = target.display().to_string();
        print_json(&serde_json::json!({ "scene": prepared.name, "ssp": target, "notes": exported.notes }))?;
    } else if !common.quiet {
        print(&format!("{}\n", target.display()))?;
    }
    Ok(())
}

/// Offset of a pantograph's height as it stands under the wire, m.
fn aligned_offset(pantograph: &Option<SuppliedPantograph>) -> Option<f64> {
    let outputs = &pantograph.as_ref()?.wiring().outputs;
    outputs
        .iter()
        .find(|wire| wire.name == "height")
        .map(|wire| wire.offset)
}
