//! Tables as JSON.

use std::path::Path;

use super::{Exporter, Table};
use results::ResultsError;

/// The whole table, indented.
#[derive(Clone, Copy, Debug)]
pub struct Json;

impl Exporter for Json {
    fn string(&self, table: &impl Table) -> Result<String, ResultsError> {
        let mut bytes = Vec::new();
        results::write_json(&mut bytes, Path::new(""), table)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
