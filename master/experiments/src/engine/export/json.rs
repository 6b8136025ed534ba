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
        results::write_json(out, path, table)
    }
}
