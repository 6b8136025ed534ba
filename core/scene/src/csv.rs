//! Tables of comma-separated values with a place for each cell.

use crate::error::What;
use crate::files::Files;
use crate::keys::nearest;
use crate::tree::{At, Node, Value};

/// A table: its columns, and its rows with the line of the file that each stands in.
pub(crate) struct Csv {
    file: u16,
    columns: Vec<String>,
    rows: Vec<(usize, Vec<String>)>,
}

/// A problem and its place; the key is the column's name or empty.
pub(crate) type Wrong = (At, String, What);

fn wrong(at: At, key: impl Into<String>, value: impl Into<String>, expected: impl Into<String>) -> Wrong {
    let (value, expected) = (value.into(), expected.into());
    (at, key.into(), What::Refused { value, expected })
}

impl Csv {
    /// Reads `text`, whose first line that is neither empty nor begins with `#` names the columns, each one of `known`.
    pub fn read(text: &str, file: u16, files: &Files, known: &[&str]) -> Result<Self, Vec<Wrong>> {
        let line = |line: usize| At::Other {
            file,
            line,
            column: None,
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text.lines().enumerate().map(|(number, line)| (number + 1, line.trim()));
        let mut lines = lines
            .by_ref()
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((header_line, header)) = lines.next() else {
            return Err(vec![wrong(
                line(1),
                "table",
                "empty",
                "must begin with the names of its columns",
            )]);
        };
        if header.contains(';') || header.contains('\t') {
            let expected = "must be separated by commas, with points in decimals";
            return Err(vec![wrong(line(header_line), "table", header, expected)]);
        }
        let columns: Vec<String> = header.split(',').map(|name| name.trim().to_owned()).collect();
        let mut problems = Vec::new();
        for (index, name) in columns.iter().enumerate() {
            if columns[..index].contains(name) {
                problems.push(wrong(
                    line(header_line),
                    name.clone(),
                    "twice",
                    "must be one column of the table",
                ));
            }
            if !known.contains(&name.as_str()) {
                let nearest = nearest(name, known.iter().copied());
                let known = known.iter().map(|&name| name.to_owned()).collect();
                problems.push((line(header_line), name.clone(), What::UnknownKey { nearest, known }));
            }
        }
        files.name_columns(file, columns.clone());
        let mut rows = Vec::new();
        for (number, row) in lines {
            let cells: Vec<String> = row.split(',').map(|cell| cell.trim().to_owned()).collect();
            if cells.len() != columns.len() {
                let expected = format!("must have {}, one per column", columns.len());
                problems.push(wrong(line(number), "row", format!("{} cells", cells.len()), expected));
            }
            rows.push((number, cells));
        }
        if rows.is_empty() {
            problems.push(wrong(
                line(header_line),
                "table",
                "without rows",
                "must have a row for each entry",
            ));
        }
        if problems.is_empty() {
            Ok(Self { file, columns, rows })
        } else {
            Err(problems)
        }
    }

    /// True where the table has a column.
    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|column| column == name)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Place of a row, or of a cell in it.
    pub fn at(&self, row: usize, column: Option<&str>) -> At {
        let column = column.and_then(|name| self.columns.iter().position(|column| column == name));
        At::Other {
            file: self.file,
            line: self.rows[row].0,
            column: column.map(|column| column as u16),
        }
    }

    /// A cell; empty where the table has no such column.
    pub fn cell(&self, row: usize, name: &str) -> &str {
        let column = self.columns.iter().position(|column| column == name);
        column.map_or("", |column| &self.rows[row].1[column])
    }

    /// The number in a cell times `factor`; none where it is empty.
    pub fn number(&self, row: usize, name: &str, factor: f64) -> Result<Option<f64>, Wrong> {
        let cell = self.cell(row, name);
        if cell.is_empty() {
            return Ok(None);
        }
        // A straight track has an infinite radius.
        let good = |number: &f64| number.is_finite() || (name == "curve_radius_m" && !number.is_nan());
        match cell.parse::<f64>().ok().filter(good) {
            Some(number) if factor == 1.0 => Ok(Some(number)),
            Some(number) => Ok(Some(number * factor)),
            None => {
                let at = self.at(row, Some(name));
                let expected = "must be a number, with a point in decimals";
                Err(wrong(at, name, format!("{cell:?}"), expected))
            }
        }
    }

    /// A number as an entry of a list, at its cell.
    pub fn node(&self, row: usize, name: &str, number: f64) -> Node {
        Node {
            at: self.at(row, Some(name)),
            value: Value::Float(number),
        }
    }
}
