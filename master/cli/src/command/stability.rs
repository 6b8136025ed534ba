//! `master stability`.

use super::experiment::{Files, Outputs};
use super::{CommandError, nothing_to_set};
use crate::cli::Common;
use experiments::stability::{self, Case, Stability};

/// Table and page of the hard cases.
const FILES: Files = Files {
    csv: "stability.csv",
    page: "stability.html",
};

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
    let outputs = Outputs::open(&directory, "stability", FILES, common)?;
    // The libraries are made before runs that need them stand side by side.
    cosim::package::Libraries::find()?;
    let resolution = if names.is_empty() && !quick { RESOLUTION } else { 0 };
    let temporary = |source| CommandError::Directory(results::io(&std::env::temp_dir(), "write")(source));
    let stability = Stability::new(cases, true, true, resolution).map_err(temporary)?;
    outputs.finish(&outputs.run(&stability, "stability", &|_| Ok(()))?)
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
