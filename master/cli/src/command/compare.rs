//! `master compare`.

use std::path::Path;

use super::{CommandError, SceneFile, interrupted, nothing_to_set, print, print_json};
use crate::cli::Common;
use cosim::package;
use experiments::compare::{self, Comparison, Trial};
use experiments::table_of_runs::{self, Stage};
use results::OutputDirectory;
use results::report::{Progress, Show};

/// Table of the comparison.
const CSV: &str = "compare.csv";
/// Page of the comparison.
const PAGE: &str = "compare.html";

/// Runs a scene in all modes and with all algorithms, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn compare(path: &Path, macro_steps: &[f64], repeats: usize, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let in_scene = |error: CommandError| error.in_scene(path);
    let logging = common.verbose > 1;
    let interrupted = interrupted(common);
    let script = compare::script(
        file.scene,
        &file.name,
        &file.base,
        macro_steps,
        &common.overrides,
        logging,
    );
    let script = script.map_err(|error| in_scene(error.into()))?;
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    output.remove(PAGE).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&file.name, show);
    let stage = Stage {
        name: &file.name,
        base: &file.base,
        scene: script.scene.to_toml(),
        fmus: package::folder(&format!("{}-compare", file.name)),
        logging,
        repeats,
    };
    let mut keep = |comparison: &Comparison| write_table(&output, comparison);
    let comparison = compare::compare(&script, &stage, interrupted, &progress, &mut keep).map_err(in_scene)?;
    progress.finish();
    finish(&output, &comparison, common)
}

/// Runs the coupling test problem instead of a scene.
///
/// # Errors
/// See [`CommandError`].
pub fn test_problem(macro_steps: &[f64], repeats: usize, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master compare --test-problem", common)?;
    let directory = common.out.clone().unwrap_or_else(|| "results/compare".into());
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    output.remove(PAGE).map_err(CommandError::Directory)?;
    let interrupted = interrupted(common);
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share("test problem", show);
    let mut keep = |trial: &Trial| {
        let (leading, trailing) = trial.columns();
        output
            .replace(CSV, |out, path| {
                table_of_runs::write(out, path, &trial.rows(), &leading, &trailing)
            })
            .map_err(CommandError::Results)
    };
    let trial = compare::trial(macro_steps, repeats, interrupted, &progress, &mut keep)?;
    progress.finish();
    output
        .write_page(PAGE, &compare::trial_page(&trial))
        .map_err(CommandError::Results)?;
    if common.json {
        print_json(&trial)?;
    } else if !common.quiet {
        let text = compare::trial_text(&trial);
        print(&format!("{text}\n  {CSV} and {PAGE} in {}\n", directory.display()))?;
    }
    if trial.complete {
        return Ok(());
    }
    Err(CommandError::Incomplete {
        directory,
        reason: format!("{} runs were made", trial.runs.len()),
    })
}

/// Writes the page and prints the table; an incomplete comparison is a failure.
fn finish(output: &OutputDirectory, comparison: &Comparison, common: &Common) -> Result<(), CommandError> {
    output
        .write_page(PAGE, &compare::page(comparison))
        .map_err(CommandError::Results)?;
    let directory = output.path();
    if common.json {
        print_json(comparison)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n  {} and {PAGE} in {}\n",
            compare::text(comparison),
            CSV,
            directory.display()
        ))?;
    }
    if comparison.complete {
        return Ok(());
    }
    let made = comparison.made();
    Err(CommandError::Incomplete {
        directory: directory.to_owned(),
        reason: format!("{made} of {} runs were made", comparison.rows.len()),
    })
}

fn write_table(output: &OutputDirectory, comparison: &Comparison) -> Result<(), CommandError> {
    output
        .replace(CSV, |out, path| {
            table_of_runs::write(out, path, &comparison.rows, &[], &[])
        })
        .map_err(CommandError::Results)
}
