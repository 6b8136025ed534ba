//! Tables on the terminal.

use super::{Exporter, Table};
use results::ResultsError;

/// The table for the terminal.
#[derive(Clone, Copy, Debug)]
pub struct Text;

impl Exporter for Text {
    fn string(&self, table: &impl Table) -> Result<String, ResultsError> {
        Ok(table.text())
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
