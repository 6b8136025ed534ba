//! `master inspect`.

use std::path::Path;

use fmi2::import::Fmu;

use super::{CommandError, print, print_json};
use crate::cli::Common;
use crate::inspect;

/// Shows what an FMU offers. Nothing of it is executed.
///
/// # Errors
/// See [`CommandError`].
pub fn inspect(path: &Path, common: &Common) -> Result<(), CommandError> {
    let fmu = Fmu::open(path).map_err(|error| CommandError::FmuFile(Box::new(error)))?;
    if common.json {
        print_json(&inspect::json(fmu.description()))?;
    } else if !common.quiet {
        print(&inspect::text(path, &fmu))?;
    }
    Ok(())
}
