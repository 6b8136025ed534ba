//! Tables of experiments as files: one exporter per format.
//!
//! | part | format |
//! | --- | --- |
//! | [`Csv`] | one row per run, for programs |
//! | [`Json`] | the whole table, for programs |
//! | [`Html`] | sections with plots, one file that needs no network |
//! | [`Text`] | the terminal |
//!
//! Curves of the pages' plots are in `plot`.

mod csv;
mod html;
mod json;
pub(crate) mod plot;
mod text;

use serde::Serialize;

use super::table::{Column, RunRow};
use results::report::Page;
use results::{OutputDirectory, ResultsError};

pub use self::csv::Csv;
pub use html::Html;
pub(crate) use html::{
    incomplete, over_steps, reasons, run_lines, scene_lead, scene_page, status_counts, status_rule, status_span,
    status_word,
};
pub use json::Json;
pub use text::Text;
pub(crate) use text::scene_head;

/// Values under equal keys, in the order in which the keys come first.
pub(crate) fn grouped<K: PartialEq, V>(pairs: impl IntoIterator<Item = (K, V)>) -> Vec<(K, Vec<V>)> {
    let mut groups: Vec<(K, Vec<V>)> = Vec::new();
    for (key, value) in pairs {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, values)) => values.push(value),
            None => groups.push((key, vec![value])),
        }
    }
    groups
}

/// Rows of a table and the columns of its own before and behind the common ones.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Columns before the common ones.
    pub leading: Vec<Column>,
    /// Rows.
    pub rows: Vec<RunRow>,
    /// Columns behind the common ones.
    pub trailing: Vec<Column>,
}

/// The table of an experiment, complete or not.
pub trait Table: Serialize {
    /// Rows and columns of the CSV file.
    fn sheet(&self) -> Sheet;

    /// `true` where every run was made.
    fn is_complete(&self) -> bool {
        let (made, all) = self.made();
        made == all
    }

    /// Number of runs that were made, and of all.
    fn made(&self) -> (usize, usize) {
        let rows = self.sheet().rows;
        (rows.iter().filter(|row| row.status.is_some()).count(), rows.len())
    }

    /// The table for the terminal, at most 120 columns wide.
    fn text(&self) -> String;

    /// The page: title, lead and sections.
    fn sections(&self) -> Page;
}

/// One format of a table.
pub trait Exporter {
    /// The table as a string.
    ///
    /// # Errors
    /// A value that the format does not take.
    fn string(&self, table: &impl Table) -> Result<String, ResultsError>;

    /// Replaces the file `name` of a directory by the table.
    ///
    /// # Errors
    /// Reports of the operating system.
    fn replace(&self, table: &impl Table, output: &OutputDirectory, name: &str) -> Result<(), ResultsError> {
        let text = self.string(table)?;
        output.replace(name, |out, path| {
            out.write_all(text.as_bytes()).map_err(results::io(path, "write"))
        })
    }
}
