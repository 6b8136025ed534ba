//! `master compare`.

use std::path::Path;

use super::experiment::{Files, Outputs};
use super::{CommandError, SceneFile, nothing_to_set};
use crate::cli::Common;
use cosim::package;
use experiments::compare::{Compare, TestProblem};
use experiments::engine::Stage;

/// Table and page of the comparison.
const FILES: Files = Files {
    csv: "compare.csv",
    page: "compare.html",
};

/// Folder of the runs.
const RUNS: &str = "compare";

/// Runs a scene in all modes and with all algorithms, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn compare(path: &Path, macro_steps: &[f64], repeats: usize, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let in_scene = |error: CommandError| error.in_scene(path);
    let stage = Stage {
        name: file.name.clone(),
        base: file.base.clone(),
        scene: String::new(),
        fmus: package::folder(&format!("{}-compare", file.name)),
        logging: common.verbose > 1,
    };
    let compare = Compare::new(file.scene, stage, macro_steps, &common.overrides, repeats);
    let compare = compare.map_err(|error| in_scene(error.into()))?;
    let outputs = Outputs::open(&directory, RUNS, FILES, common)?;
    let table = outputs.run(&compare, &file.name, &|_| Ok(()));
    outputs.finish(&table.map_err(|error| in_scene(error.into()))?)
}

/// Runs the coupling test problem instead of a scene.
///
/// # Errors
/// See [`CommandError`].
pub fn test_problem(macro_steps: &[f64], repeats: usize, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master compare --test-problem", common)?;
    let directory = common.out.clone().unwrap_or_else(|| "results/compare".into());
    let outputs = Outputs::open(&directory, RUNS, FILES, common)?;
    let problem = TestProblem {
        macro_steps: macro_steps.to_vec(),
        repeats,
    };
    outputs.finish(&outputs.run(&problem, "test problem", &|_| Ok(()))?)
}
