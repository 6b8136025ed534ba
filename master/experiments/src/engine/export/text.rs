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
