//! `master reproduce`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::experiment::{Files, Outputs};
use super::{CommandError, found, scene_text};
use crate::cli::Common;
use experiments::reproduce::{CASES, Reproduce};

/// Table and page of the reproduction.
const FILES: Files = Files {
    csv: "reproduction.csv",
    page: "reproduction.html",
};

/// Computes the thesis again, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn thesis(quick: bool, common: &Common) -> Result<(), CommandError> {
    let path = |scene: &str| Path::new("scenes").join(format!("{scene}.toml"));
    let mut texts = BTreeMap::new();
    let mut scenes = PathBuf::new();
    for case in CASES.iter() {
        let path = path(&case.scene);
        let file = found(&path);
        texts.insert(&*case.scene, scene_text(&file, &path)?);
        scenes = file.parent().unwrap_or(Path::new("")).to_owned();
    }
    // The same message for all runs, before the first.
    for case in CASES.iter() {
        let origin = path(&case.scene).display().to_string();
        system::load(&texts[&*case.scene], &origin, &common.overrides).map_err(simulation::SetupError::from)?;
    }
    let directory = common.out.clone().unwrap_or_else(|| "results/reproduce".into());
    let outputs = Outputs::open(&directory, "reproduce", FILES, common)?;
    // The libraries are made before runs that need them stand side by side.
    cosim::package::Libraries::find()?;
    let reproduce = Reproduce::new(&texts, &scenes, &directory.join("fmu"), quick, &common.overrides);
    outputs.finish(&outputs.run(&reproduce, "thesis", &|_| Ok(()))?)
}
