//! Tables of comma-separated values with a place for each cell.

use crate::error::What;
use crate::files::Files;
use crate::keys::nearest;
use crate::tree::{At, Node, Value};

/// Units of lengths as names of columns end with them, and how many of each are a metre.
const UNITS: [(&str, f64); 2] = [("_m", 1.0), ("_mm", 1000.0)];

/// A table: its columns, and its rows with the line of the file that each stands in.
pub(crate) struct Csv {
    file: u16,
    header_line: usize,
    columns: Vec<String>,
    rows: Vec<(usize, Vec<String>)>,
}

/// A problem and its place; the key is the column's name, or what else is wrong.
pub(crate) type Wrong = (At, String, What);

/// A problem with a value.
pub(crate) fn wrong(at: At, key: impl Into<String>, value: impl Into<String>, expected: impl Into<String>) -> Wrong {
    let (value, expected) = (value.into(), expected.into());
    (at, key.into(), What::Refused { value, expected })
}

/// Columns that a table may have.
#[derive(Clone, Copy)]
pub(crate) struct Known {
    /// Lengths, whose columns name a unit.
    pub lengths: &'static [&'static str],
    /// Others.
    pub others: &'static [&'static str],
}

impl Known {
    fn names(self) -> Vec<String> {
        let lengths = self.lengths.iter();
        let lengths = lengths.flat_map(|name| UNITS.map(|(unit, _)| format!("{name}{unit}")));
        let others = self.others.iter().map(|name| (*name).to_owned());
        others.chain(lengths).collect()
    }

    /// Complaint about the name of a column, if there is any.
    fn complaint(self, name: &str) -> Option<String> {
        let known = self.names();
        if known.iter().any(|known| known == name) {
            return None;
        }
        if self.lengths.contains(&name) {
            return Some(format!("unknown without its unit: must be {name}_m or {name}_mm"));
        }
        let nearest = nearest(name, known.iter().map(String::as_str));
        let nearest = nearest.map_or(String::new(), |nearest| format!(", did you mean \"{nearest}\"?"));
        Some(format!("unknown column{nearest}; known columns: {}", known.join(", ")))
    }
}

/// A column of lengths.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    index: usize,
    per_metre: f64,
}

impl Csv {
    /// Reads `text`, whose first line that is neither empty nor begins with `#` names the columns.
    pub fn read(text: &str, file: u16, files: &Files, known: Known) -> Result<Self, Vec<Wrong>> {
        let line = |line: usize| At::Line(line).moved_to(file);
        // Spreadsheets begin a text in UTF-8 with a mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = text.lines().enumerate().map(|(number, line)| (number + 1, line.trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((header_line, header)) = lines.next() else {
            let expected = "must begin with the names of its columns";
            return Err(vec![wrong(line(1), "table", "empty", expected)]);
        };
        if header.contains([';', '\t']) {
            let expected = "must be separated by commas, with points in decimals: export the table as CSV in an \
                            English locale";
            return Err(vec![wrong(line(header_line), "table", format!("{header:?}"), expected)]);
        }
        let columns = match cells(header) {
            Ok(columns) => columns,
            Err(expected) => return Err(vec![wrong(line(header_line), "table", header, expected)]),
        };
        let mut problems = Vec::new();
        for (index, name) in columns.iter().enumerate() {
            if columns[..index].contains(name) {
                problems.push(wrong(
                    line(header_line),
                    "column",
                    format!("{name:?}"),
                    "must be there once, is there twice",
                ));
            } else if let Some(complaint) = known.complaint(name) {
                problems.push(wrong(line(header_line), "column", format!("{name:?}"), complaint));
            }
        }
        for name in known.lengths {
            let [metres, millimetres] = UNITS.map(|(unit, _)| format!("{name}{unit}"));
            if columns.contains(&metres) && columns.contains(&millimetres) {
                let because = format!("{metres} has it");
                problems.push((line(header_line), millimetres, What::LeaveOut { because }));
            }
        }
        files.name_columns(file, columns.clone());
        let mut rows = Vec::new();
        for (number, row) in lines {
            let row = match cells(row) {
                Ok(row) => row,
                Err(expected) => {
                    problems.push(wrong(line(number), "row", row, expected));
                    continue;
                }
            };
            if row.len() != columns.len() {
                let hint = if row.len() > columns.len() {
                    "; a decimal comma makes two cells of one, write points"
                } else {
                    ""
                };
                let expected = format!("must have {}, one per column{hint}", columns.len());
                problems.push(wrong(line(number), "row", format!("{} cells", row.len()), expected));
            }
            rows.push((number, row));
        }
        let table = Self {
            file,
            header_line,
            columns,
            rows,
        };
        if table.rows.is_empty() {
            problems.push(wrong(
                table.header(),
                "table",
                "without rows",
                "must have rows below its columns",
            ));
        }
        if problems.is_empty() { Ok(table) } else { Err(problems) }
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The column of a length in one of its units.
    pub fn length(&self, quantity: &str) -> Option<Column> {
        UNITS.iter().find_map(|(unit, per_metre)| {
            let index = self.index(&format!("{quantity}{unit}"))?;
            let per_metre = *per_metre;
            Some(Column { index, per_metre })
        })
    }

    /// A column of other values.
    pub fn column(&self, name: &str) -> Option<Column> {
        let index = self.index(name)?;
        let per_metre = 1.0;
        Some(Column { index, per_metre })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Line of the file that a row stands in.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].0
    }

    /// Place of the names of the columns.
    pub fn header(&self) -> At {
        At::Line(self.header_line).moved_to(self.file)
    }

    /// Place of a row.
    pub fn at_row(&self, row: usize) -> At {
        At::Line(self.line(row)).moved_to(self.file)
    }

    /// Place of a cell.
    pub fn at(&self, row: usize, column: Column) -> At {
        At::Other {
            file: self.file,
            line: self.line(row),
            column: u16::try_from(column.index).ok(),
        }
    }

    /// Name of a column.
    pub fn name(&self, column: Column) -> &str {
        &self.columns[column.index]
    }

    /// A cell.
    pub fn cell(&self, row: usize, column: Column) -> &str {
        &self.rows[row].1[column.index]
    }

    /// A problem with a cell.
    pub fn wrong(&self, row: usize, column: Column, expected: impl Into<String>) -> Wrong {
        let (at, name) = (self.at(row, column), self.name(column).to_owned());
        match self.cell(row, column) {
            "" => {
                let expected = format!("{}, in every row", expected.into());
                (at, name, What::Missing { expected })
            }
            cell => wrong(at, name, format!("{cell:?}"), format!("must be {}", expected.into())),
        }
    }

    /// The length in a cell, m.
    pub fn metres(&self, row: usize, column: Column) -> Result<f64, Wrong> {
        let number = self.cell(row, column).parse::<f64>().ok();
        // A quotient is the decimal nearest to what was typed, a product with 0.001 is not.
        let metres = number
            .filter(|number| number.is_finite())
            .map(|number| number / column.per_metre);
        metres.ok_or_else(|| {
            let unit = if column.per_metre == 1.0 { "m" } else { "mm" };
            self.wrong(row, column, format!("a number in {unit}, with a point in decimals"))
        })
    }

    /// A number as an entry of a list, at its cell.
    pub fn node(&self, row: usize, column: Column, number: f64) -> Node {
        Node {
            at: self.at(row, column),
            value: Value::Float(number),
        }
    }

    /// Refuses a cell that says something where there is nothing to say.
    pub fn must_be_empty(&self, row: usize, column: Column, because: &str) -> Option<Wrong> {
        let cell = self.cell(row, column);
        (!cell.is_empty()).then(|| self.wrong(row, column, format!("empty {because}")))
    }
}

/// Cells of a line; one that begins with a quotation mark ends with one, and has two for each inside.
fn cells(line: &str) -> Result<Vec<String>, &'static str> {
    let mut found = Vec::new();
    let mut rest = line;
    loop {
        let (cell, after) = match rest.trim_start().strip_prefix('"') {
            Some(quoted) => {
                let (cell, after) = unquoted(quoted).ok_or("must end each \"…\" with a quotation mark and a comma")?;
                (cell.trim().to_owned(), after)
            }
            None => {
                let end = rest.find(',').unwrap_or(rest.len());
                (rest[..end].trim().to_owned(), &rest[end..])
            }
        };
        found.push(cell);
        match after.strip_prefix(',') {
            Some(next) => rest = next,
            None => return Ok(found),
        }
    }
}

/// A quoted cell without its quotation marks, and what follows: a comma or nothing.
fn unquoted(text: &str) -> Option<(String, &str)> {
    let mut cell = String::new();
    let mut rest = text;
    loop {
        let end = rest.find('"')?;
        cell.push_str(&rest[..end]);
        rest = &rest[end + 1..];
        match rest.strip_prefix('"') {
            Some(after) => {
                cell.push('"');
                rest = after;
            }
            None => {
                let after = rest.trim_start();
                return (after.is_empty() || after.starts_with(',')).then_some((cell, after));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::cells;

    #[test]
    fn cells_are_parted_by_commas_outside_of_quotation_marks() {
        assert_eq!(cells("a, b ,,").unwrap(), ["a", "b", "", ""]);
        assert_eq!(cells("\"a, b\" ,\"say \"\"c\"\"\"").unwrap(), ["a, b", "say \"c\""]);
        for open in ["\"a", "1,\"a\"b,2", "\""] {
            assert!(cells(open).is_err(), "{open}");
        }
    }
}
