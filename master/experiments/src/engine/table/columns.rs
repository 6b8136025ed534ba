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

    /// Appends a column.
    #[must_use]
    pub fn column<C: Cell>(self, name: &'static str, cell: impl Fn(&T) -> C) -> Self {
        self.indexed(name, |_, entry| cell(entry))
    }

    /// Appends a column that depends on the place of an entry too.
    #[must_use]
    pub fn indexed<C: Cell>(mut self, name: &'static str, cell: impl Fn(usize, &T) -> C) -> Self {
        let entries = self.entries.iter().enumerate();
        let cells = entries.map(|(index, entry)| cell(index, entry).cell());
        self.columns.push((name, cells.collect()));
        self
    }

    /// All of them.
    #[must_use]
    pub fn finish(self) -> Vec<Column> {
        self.columns
    }
}
