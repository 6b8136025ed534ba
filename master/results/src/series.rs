//! The time series file.

use std::path::Path;

use super::record::{COLUMNS, control_name, strip_names, support_name, wind_names};
use super::{Record, ResultsError, StripRecord, SupportRecord, WindRecord, head};

/// Writes the series of `record` as CSV to `out`; `path` is named in errors.
///
/// Numbers are written with the fewest digits that read back to the same `f64`.
///
/// # Errors
///
/// [`ResultsError::Length`] where a series has not the length of the time, else what `out` reports.
pub fn write_timeseries(out: impl std::io::Write, path: &Path, record: &Record) -> Result<(), ResultsError> {
    use std::fmt::Write as _;
    record.check()?;
    // A table that cannot be written is none that is wrong.
    let failed = |source: csv::Error| ResultsError::Io {
        path: path.to_owned(),
        action: "write",
        source: source.into(),
    };
    let columns = record.columns();
    let mut writer = csv::Writer::from_writer(out);
    writer.write_field("time").map_err(failed)?;
    for (name, _) in &columns {
        writer.write_field(name).map_err(failed)?;
    }
    writer.write_record(None::<&[u8]>).map_err(failed)?;
    let mut cell = String::new();
    for (row, time) in record.time.iter().enumerate() {
        for value in std::iter::once(time).chain(columns.iter().map(|(_, values)| &values[row])) {
            cell.clear();
            // Writing to a string cannot fail. `{:?}` is the shortest text that reads back.
            let _ = write!(cell, "{value:?}");
            writer.write_field(&cell).map_err(failed)?;
        }
        writer.write_record(None::<&[u8]>).map_err(failed)?;
    }
    writer.flush().map_err(|source| ResultsError::Io {
        path: path.to_owned(),
        action: "write",
        source,
    })
}

/// Reads a time series file; line geometry and animation of the record stay empty.
///
/// # Errors
///
/// [`ResultsError`] names file, line and column of what is wrong.
pub fn read_timeseries(path: &Path) -> Result<Record, ResultsError> {
    let failed = |source| ResultsError::Csv {
        path: path.to_owned(),
        source,
    };
    let file = std::fs::File::open(path).map_err(|source| ResultsError::Io {
        path: path.to_owned(),
        action: "read",
        source,
    })?;
    let mut reader = csv::Reader::from_reader(std::io::BufReader::new(file));
    let names: Vec<String> = reader.headers().map_err(failed)?.iter().map(str::to_owned).collect();

    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(failed)? {
        for ((cell, name), values) in row.iter().zip(&names).zip(&mut columns) {
            values.push(cell.parse().map_err(|_| ResultsError::Number {
                path: path.to_owned(),
                line: row.position().map_or(0, |p| p.line() as usize),
                column: name.clone(),
                value: cell.to_owned(),
            })?);
        }
    }

    let wrong = |position: usize, expected: &str| ResultsError::Column {
        path: path.to_owned(),
        position: position + 1,
        found: names.get(position).cloned().unwrap_or_default(),
        expected: expected.to_owned(),
    };
    let mut record = Record::default();
    let mut columns = columns.into_iter();
    if names.first().map(String::as_str) != Some("time") {
        return Err(wrong(0, "time"));
    }
    record.time = columns.next().unwrap_or_default();
    let mut at = 1;
    let after_supports = |name: &String| name.contains("].wind.") || name.contains("].control.");
    let behind = |name: &String| name.starts_with("support[") || after_supports(name);
    let several = names.get(at) == Some(&head::names(1)[0]);
    let mut number = 0;
    while names.get(at).is_some_and(|name| !behind(name)) {
        let head = several && names.get(at) == Some(&head::names(record.pantographs.len() + 1)[0]);
        let expected = if head {
            head::names(record.pantographs.len() + 1)
        } else {
            number += 1;
            strip_names(number)
        };
        for (k, expected) in expected.iter().enumerate() {
            if names.get(at + k) != Some(expected) {
                return Err(wrong(at + k, expected));
            }
        }
        let series = std::array::from_fn(|_| columns.next().unwrap_or_default());
        let series = StripRecord::from_columns(series);
        match record.pantographs.last_mut() {
            Some(pantograph) if several && !head => pantograph.strips.push(series),
            _ => record.pantographs.push(series),
        }
        at += COLUMNS;
    }
    // The series of a head with one strip are those of the strip.
    for pantograph in &mut record.pantographs {
        if pantograph.strips.len() == 1 {
            pantograph.strips.clear();
        }
    }
    let winds = names.iter().position(after_supports).unwrap_or(names.len());
    for (name, uplift) in names[at..winds].iter().zip(&mut columns) {
        let number = name
            .split(['[', ']'])
            .nth(1)
            .and_then(|number| number.parse().ok())
            .filter(|&number| support_name(number) == *name)
            .ok_or_else(|| wrong(at + record.supports.len(), "support[k].uplift"))?;
        record.supports.push(SupportRecord { number, uplift });
    }
    at = winds;
    for (i, pantograph) in record.pantographs.iter_mut().enumerate() {
        let expected = wind_names(i + 1);
        if names.get(at..at + expected.len()) == Some(&expected) {
            let [drag, lift] = std::array::from_fn(|_| columns.next().unwrap_or_default());
            pantograph.wind = Some(WindRecord { drag, lift });
            at += expected.len();
        }
    }
    for (i, pantograph) in record.pantographs.iter_mut().enumerate() {
        if names.get(at) == Some(&control_name(i + 1)) {
            pantograph.control = columns.next();
            at += 1;
        }
    }
    if at < names.len() {
        return Err(wrong(at, "strip[i].wind.drag"));
    }
    Ok(record)
}
