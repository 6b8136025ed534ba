//! Keys of a scene file: unit, range, default and meaning.

use scene::KeyText;
use serde::Serialize;

use super::bracketed;

/// A key of the scene file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// Path without the numbers of entries.
    pub path: String,
    /// Table of the reference.
    pub table: String,
    /// Unit; empty where there is none.
    pub unit: String,
    /// Values that are taken.
    pub range: String,
    /// Default, `required` or `optional`.
    pub default: String,
    /// One sentence.
    pub meaning: &'static str,
}

impl Key {
    /// As text.
    pub(super) fn text(&self) -> String {
        let default = match self.default.as_str() {
            "required" | "optional" => self.default.clone(),
            value => format!("default {value}"),
        };
        format!(
            "{}{}\n  {}\n  Values: {}; {default}. Table {}. See docs/scenes/reference.md.\n",
            self.path,
            bracketed(&self.unit),
            self.meaning,
            self.range,
            self.table
        )
    }
}

/// The keys of that path or name, or of that table.
#[must_use]
pub fn keys(typed: &str) -> Vec<Key> {
    let path = scene::without_entries(typed);
    let wanted = |key: &KeyText| key.path() == path || key.name == path || key.table.contains(&format!("[{path}]"));
    let found = scene::described_keys().into_iter().filter(wanted).map(|key| Key {
        path: key.path(),
        table: key.table.trim_matches('`').to_owned(),
        unit: key.unit,
        range: key.range,
        default: key.default,
        meaning: key.sentence,
    });
    found.collect()
}
