//! Tables as JSON.

use std::io::Write;
use std::path::Path;

use super::{Exporter, Table};
use results::ResultsError;

/// The whole table, indented.
#[derive(Clone, Copy, Debug)]
pub struct Json;

impl Exporter for Json {
    fn export(&self, table: &impl Table, out: &mut dyn Write, path: &Path) -> Result<(), ResultsError> {
        serde_json::to_writer_pretty(&mut *out, table).map_err(|source| ResultsError::Json {
            path: path.to_owned(),
            source,
        })?;
        out.write_all(b"\n").map_err(results::io(path, "write"))
    }
}
