//! Columns that only one table has.

use super::row::Cell;

/// A name, and one cell per row.
pub type Column = (&'static str, Vec<String>);

/// Columns over the entries of one table, each by a function of an entry.
#[derive(Debug)]
pub struct Columns<'a, T> {
    entries: &'a [T],
    columns: Vec<Column>,
}

impl<'a, T> Columns<'a, T> {
    /// No columns yet.
    #[must_use]
    pub fn of(entries: &'a [T]) -> Self {
        let columns = Vec::new();
        Self { entries, columns }
    }

    /// Appends a column of text.
    #[must_use]
    pub fn text(self, name: &'static str, cell: impl Fn(&T) -> String) -> Self {
        self.indexed(name, |_, entry| cell(entry))
    }

    /// Appends a column of values, empty where there is none.
    #[must_use]
    pub fn value(self, name: &'static str, value: impl Fn(&T) -> Option<f64>) -> Self {
        self.text(name, |entry| value(entry).cell())
    }

    /// Appends a column of counts, empty where there is none.
    #[must_use]
    pub fn count(self, name: &'static str, count: impl Fn(&T) -> Option<u64>) -> Self {
        self.text(name, |entry| count(entry).cell())
    }

    /// Appends a column of text that depends on the place of an entry too.
    #[must_use]
    pub fn indexed(mut self, name: &'static str, cell: impl Fn(usize, &T) -> String) -> Self {
        let cells = self.entries.iter().enumerate().map(|(index, entry)| cell(index, entry));
        self.columns.push((name, cells.collect()));
        self
    }

    /// All of them.
    #[must_use]
    pub fn finish(self) -> Vec<Column> {
        self.columns
    }
}
