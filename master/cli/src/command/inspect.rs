//! `master inspect`.

use std::path::Path;

use fmi2::import::Fmu;

use super::{CommandError, nothing_to_set, nothing_to_write, print, print_json};
use crate::cli::Common;
use suppliers::inspect;

/// Shows what an FMU offers, and what it can do: that is tried in another process, which it may crash.
///
/// # Errors
/// See [`CommandError`].
pub fn inspect(path: &Path, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master inspect", common)?;
    nothing_to_write("master inspect", common)?;
    let fmu = Fmu::open(path).map_err(|error| CommandError::FmuFile(Box::new(error)))?;
    let inspection = inspect::Inspection::of(&fmu);
    if common.json {
        print_json(&inspect::json(path, fmu.description(), &inspection))?;
    } else if !common.quiet {
        print(&inspect::text(path, &fmu, &inspection))?;
    }
    Ok(())
}
