//! Tables as CSV.

use std::path::PathBuf;

use super::{Exporter, Sheet, Table};
use crate::engine::table::{Column, RunRow};
use results::ResultsError;

/// One row per run; a column without meaning for a row is empty.
#[derive(Clone, Copy, Debug)]
pub struct Csv;

impl Exporter for Csv {
    fn string(&self, table: &impl Table) -> Result<String, ResultsError> {
        table.sheet().csv().map_err(|source| ResultsError::Csv {
            path: PathBuf::new(),
            source,
        })
    }
}

impl Sheet {
    /// The sheet as CSV.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn csv(&self) -> Result<String, csv::Error> {
        let mut bytes = Vec::new();
        let mut writer = csv::Writer::from_writer(&mut bytes);
        let names = |columns: &[Column]| -> Vec<&'static str> { columns.iter().map(|(name, _)| *name).collect() };
        writer.write_record([&names(&self.leading)[..], RunRow::COLUMNS, &names(&self.trailing)].concat())?;
        for (index, row) in self.rows.iter().enumerate() {
            let cells = |columns: &[Column]| -> Vec<String> {
                let cell = |(_, cells): &Column| cells.get(index).cloned().unwrap_or_default();
                columns.iter().map(cell).collect()
            };
            writer.write_record([cells(&self.leading), row.cells(), cells(&self.trailing)].concat())?;
        }
        writer.flush()?;
        drop(writer);
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
