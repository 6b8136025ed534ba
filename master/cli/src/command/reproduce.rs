//! `master reproduce`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{CommandError, found, interrupted, print, print_json, scene_text};
use crate::cli::Common;
use experiments::reproduce::{self, CASES, Reproduction, Site};
use experiments::table_of_runs;
use results::OutputDirectory;
use results::report::{Progress, Show};

/// Table of the runs.
const CSV: &str = "reproduction.csv";
/// Page of the reproduction.
const PAGE: &str = "reproduction.html";

/// Computes the thesis again, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn thesis(quick: bool, common: &Common) -> Result<(), CommandError> {
    let path = |scene: &str| Path::new("scenes").join(format!("{scene}.toml"));
    let mut texts = BTreeMap::new();
    let mut scenes = PathBuf::new();
    for case in &CASES {
        let path = path(case.scene);
        let file = found(&path);
        texts.insert(case.scene, scene_text(&file, &path)?);
        scenes = file.parent().unwrap_or(Path::new("")).to_owned();
    }
    let planned = reproduce::plan(quick, &common.overrides);
    // The same message for all runs, before the first.
    for case in &CASES {
        let origin = path(case.scene).display().to_string();
        system::load(&texts[case.scene], &origin, &common.overrides).map_err(simulation::SetupError::from)?;
    }
    let directory = common.out.clone().unwrap_or_else(|| "results/reproduce".into());
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    output.remove(PAGE).map_err(CommandError::Directory)?;
    // The libraries are made before runs that need them stand side by side.
    cosim::package::Libraries::find()?;
    let interrupted = interrupted(common);
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share("thesis", show);
    let site = Site {
        scenes: &scenes,
        texts: &texts,
        fmus: &directory.join("fmu"),
        workers: std::thread::available_parallelism().map_or(1, usize::from),
    };
    let mut keep = |reproduction: &Reproduction| write_table(&output, reproduction);
    let reproduction = reproduce::execute(&planned, &site, interrupted, &progress, &mut keep)?;
    progress.finish();
    output
        .write_page(PAGE, &reproduce::page(&reproduction))
        .map_err(CommandError::Results)?;
    if common.json {
        print_json(&reproduction)?;
    } else if !common.quiet {
        let text = reproduce::text(&reproduction);
        print(&format!("{text}\n  {CSV} and {PAGE} in {}\n", directory.display()))?;
    }
    if reproduction.complete {
        return Ok(());
    }
    Err(CommandError::Incomplete {
        directory,
        reason: format!("{} of {} runs were made", reproduction.made(), planned.len()),
    })
}

fn write_table(output: &OutputDirectory, reproduction: &Reproduction) -> Result<(), CommandError> {
    let (leading, trailing) = reproduction.columns();
    output
        .replace(CSV, |out, path| {
            table_of_runs::write(out, path, &reproduction.rows(), &leading, &trailing)
        })
        .map_err(CommandError::Results)
}
