//! `master report`.

use std::path::PathBuf;

use super::{CommandError, nothing_to_set, print, print_json};
use crate::cli::Common;
use results::report::{self, table};
use results::{OutputDirectory, RunBundle, SUMMARY};

/// Renders the page of finished runs again: one into its own directory, several overlaid into another one.
///
/// # Errors
/// See [`CommandError`].
pub fn report(directories: &[PathBuf], common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master report", common)?;
    if let Some(path) = directories.iter().find(|path| !path.join(SUMMARY).is_file()) {
        return Err(CommandError::NoResults { path: path.clone() });
    }
    let runs: Result<Vec<RunBundle>, _> = directories.iter().map(|directory| RunBundle::read(directory)).collect();
    let runs = runs.map_err(CommandError::Directory)?;
    let target = match (&common.out, directories) {
        (Some(out), _) => out.clone(),
        (None, [one]) => one.clone(),
        (None, _) => PathBuf::from("results/report"),
    };
    let output = OutputDirectory::open(&target).map_err(CommandError::Directory)?;
    output
        .write_report(&report::render(&runs))
        .map_err(CommandError::Results)?;
    if common.json {
        let summaries: Vec<_> = runs.iter().map(|run| &run.summary).collect();
        print_json(&summaries)?;
    } else if !common.quiet {
        let named = runs.iter().zip(report::labels(&runs));
        let tables: String = match runs.as_slice() {
            [one] => table(&one.summary),
            _ => named
                .map(|(run, label)| format!("{label}\n{}\n", table(&run.summary)))
                .collect(),
        };
        print(&format!("{tables}{}\n", target.join("report.html").display()))?;
    }
    Ok(())
}
