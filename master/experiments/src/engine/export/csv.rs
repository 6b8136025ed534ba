//! Tables as CSV.

use std::io::Write;
use std::path::Path;

use super::{Exporter, Sheet, Table};
use crate::engine::table::{Column, RunRow};
use results::ResultsError;

/// One row per run; a column without meaning for a row is empty.
#[derive(Clone, Copy, Debug)]
pub struct Csv;

impl Exporter for Csv {
    fn export(&self, table: &impl Table, out: &mut dyn Write, path: &Path) -> Result<(), ResultsError> {
        write(out, path, &table.sheet())
    }
}

/// Writes a sheet as CSV to `out`; `path` is named in errors.
///
/// # Errors
/// Reports of `out`.
pub fn write(out: impl Write, path: &Path, sheet: &Sheet) -> Result<(), ResultsError> {
    let failed = |source| ResultsError::Csv {
        path: path.to_owned(),
        source,
    };
    let mut writer = csv::Writer::from_writer(out);
    let names = |columns: &[Column]| -> Vec<&'static str> { columns.iter().map(|(name, _)| *name).collect() };
    let head = names(&sheet.leading)
        .into_iter()
        .chain(RunRow::COLUMNS.iter().copied())
        .chain(names(&sheet.trailing));
    writer.write_record(head).map_err(failed)?;
    for (index, row) in sheet.rows.iter().enumerate() {
        let cells = |columns: &[Column]| -> Vec<String> {
            let cell = |(_, cells): &Column| cells.get(index).cloned().unwrap_or_default();
            columns.iter().map(cell).collect()
        };
        let record = cells(&sheet.leading)
            .into_iter()
            .chain(row.cells())
            .chain(cells(&sheet.trailing));
        writer.write_record(record).map_err(failed)?;
    }
    writer.flush().map_err(results::io(path, "write"))
}
