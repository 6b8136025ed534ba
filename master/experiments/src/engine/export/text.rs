//! Tables on the terminal.

use std::io::Write;
use std::path::Path;

use super::{Exporter, Table};
use results::ResultsError;

/// The table for the terminal.
#[derive(Clone, Copy, Debug)]
pub struct Text;

impl Exporter for Text {
    fn export(&self, table: &impl Table, out: &mut dyn Write, path: &Path) -> Result<(), ResultsError> {
        out.write_all(table.text().as_bytes())
            .map_err(results::io(path, "write"))
    }
}

/// Column of a table of text: lines of its heading, cell of an entry.
pub(crate) type TextColumn<T, const N: usize> = ([&'static str; N], fn(&T) -> String);

/// Lines of the headings of columns.
pub(crate) fn heading<T, const N: usize>(columns: &[TextColumn<T, N>]) -> Vec<Vec<String>> {
    let line = |n: usize| columns.iter().map(|(lines, _)| lines[n].to_owned()).collect();
    (0..N).map(line).collect()
}

/// Cells of an entry.
pub(crate) fn text_cells<T, const N: usize>(columns: &[TextColumn<T, N>], entry: &T) -> Vec<String> {
    columns.iter().map(|(_, cell)| cell(entry)).collect()
}

/// A table of text, head and rows.
pub(crate) fn text_table<'a, T: 'a, const N: usize>(
    columns: &[TextColumn<T, N>],
    entries: impl IntoIterator<Item = &'a T>,
) -> Vec<Vec<String>> {
    let rows = entries.into_iter().map(|entry| text_cells(columns, entry));
    heading(columns).into_iter().chain(rows).collect()
}

/// First lines of the tables of one scene: its name and title, and whether runs are missing.
pub(crate) fn scene_head(scene: &str, title: &str, table: &impl Table) -> String {
    let mut text = scene.to_owned();
    if !title.is_empty() {
        text.push_str(&format!(": {title}"));
    }
    text.push('\n');
    if !table.is_complete() {
        let (made, all) = table.made();
        text.push_str(&format!("INCOMPLETE: {made} of {all} runs\n"));
    }
    text
}

/// A remark in lines of at most 116 characters, indented.
pub(crate) fn wrapped(remark: &str) -> String {
    let (mut text, mut line) = (String::new(), String::from(" "));
    for word in remark.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 116 {
            text.push_str(&line);
            text.push('\n');
            line = String::from("   ");
        }
        line.push(' ');
        line.push_str(word);
    }
    text.push_str(&line);
    text.push('\n');
    text
}
