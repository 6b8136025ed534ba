//! `master stability`.

use super::{CommandError, interrupted, nothing_to_set, print, print_json};
use crate::cli::Common;
use experiments::stability::{self, Case, Plan, StabilityTable};
use experiments::table_of_runs;
use results::OutputDirectory;
use results::report::{Progress, Show};

/// Table of the hard cases.
const CSV: &str = "stability.csv";
/// Page of the hard cases.
const PAGE: &str = "stability.html";

/// Points of a map's curve.
const RESOLUTION: usize = 9;

/// Runs the hard cases of these names, all where there are none, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn stability(names: &[String], quick: bool, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master stability", common)?;
    let cases = chosen(names, quick)?;
    let directory = common.out.clone().unwrap_or_else(|| "results/stability".into());
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    output.remove(PAGE).map_err(CommandError::Directory)?;
    // The libraries are made before runs that need them stand side by side.
    cosim::package::Libraries::find()?;
    let interrupted = interrupted(common);
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share("stability", show);
    let plan = Plan {
        cases,
        fmus: true,
        boundaries: true,
        resolution: if names.is_empty() && !quick { RESOLUTION } else { 0 },
        workers: std::thread::available_parallelism().map_or(1, usize::from),
    };
    let mut keep = |table: &StabilityTable| write_table(&output, table);
    let table = stability::execute(&plan, interrupted, &progress, &mut keep)?;
    progress.finish();
    output
        .write_page(PAGE, &stability::page(&table))
        .map_err(CommandError::Results)?;
    if common.json {
        print_json(&table)?;
    } else if !common.quiet {
        let text = stability::text(&table);
        print(&format!("{text}\n  {CSV} and {PAGE} in {}\n", directory.display()))?;
    }
    if table.complete {
        return Ok(());
    }
    let made = table.lines.iter().filter(|line| line.row.status.is_some()).count();
    Err(CommandError::Incomplete {
        directory,
        reason: format!("{made} of {} runs were made", table.lines.len()),
    })
}

/// The cases of these names in the order of the table.
fn chosen(names: &[String], quick: bool) -> Result<Vec<Case>, CommandError> {
    let all = stability::cases(quick);
    for name in names {
        if all.iter().all(|case| case.name != *name) {
            let known: Vec<&str> = all.iter().map(|case| case.name.as_str()).collect();
            let near = known
                .iter()
                .find(|known| known.contains(name.as_str()) || name.contains(**known));
            return Err(CommandError::NoCase {
                name: name.clone(),
                nearest: near.map_or_else(String::new, |near| format!(", did you mean {near}?")),
                known: known.join(", "),
            });
        }
    }
    let wanted = |case: &Case| names.is_empty() || names.contains(&case.name);
    Ok(all.into_iter().filter(wanted).collect())
}

fn write_table(output: &OutputDirectory, table: &StabilityTable) -> Result<(), CommandError> {
    let (leading, trailing) = table.columns();
    output
        .replace(CSV, |out, path| {
            table_of_runs::write(out, path, &table.rows(), &leading, &trailing)
        })
        .map_err(CommandError::Results)
}
