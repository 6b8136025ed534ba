//! The reference of the scene file, written from the code that reads it.

use std::fmt::Write as _;

use crate::Scene;
use crate::keys::{Default, Described, Section, describe};

const INTRODUCTION: &str = "\
# Reference of the scene file

Every table and key of a scene with unit, range, default and meaning. Values are in SI units; a key in another unit
names it. x runs along the track from the first support, y to the left, z up from the top of rail; entries of lists and
spans are counted from 1. A key without a default and without \"optional\" must be given. A number may stand with its
range, `{ value = 5.0e4, low = 4.0e4, high = 6.0e4, mark = \"standard\" }`, or have it under `[ranges]` by the path of
its key: see [uncertainty](../guide/report.md#uncertainty).

This file is generated from the code that reads scenes; after a change of a key it is written anew by

```text
cargo run --release -p scene --example reference > docs/scenes/reference.md
```
";

/// Every table and key of the scene file in Markdown, a table for each section.
#[must_use]
pub fn reference() -> String {
    let mut text = INTRODUCTION.to_owned();
    for section in describe::<Scene>("Top of the file") {
        write_section(&mut text, &section);
    }
    text
}

/// A key of the scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyText {
    /// Table that holds it, as typed.
    pub table: String,
    /// Name.
    pub name: String,
    /// Unit; empty where there is none.
    pub unit: String,
    /// Values that it may have.
    pub range: String,
    /// Value where it is left out: a value, `required`, or `optional`.
    pub default: String,
    /// Meaning.
    pub sentence: &'static str,
}

impl KeyText {
    /// Path of the key, such as `run.evaluate.spans`: the table without its brackets, and the name.
    #[must_use]
    pub fn path(&self) -> String {
        let table = self.table.trim_start_matches(['`', '[']);
        let end = table.find([']', '`', ' ']).unwrap_or(table.len());
        match (table.starts_with("Top of"), &table[..end]) {
            (true, _) => self.name.clone(),
            (false, table) => format!("{table}.{}", self.name),
        }
    }
}

/// Every key of the scene file.
#[must_use]
pub fn keys() -> Vec<KeyText> {
    let text = |table: &str, key: Described| KeyText {
        table: table.to_owned(),
        name: key.name,
        unit: key.unit,
        range: key.range,
        default: match key.default {
            Default::Required => "required".to_owned(),
            Default::None => "optional".to_owned(),
            Default::Value(value) => value,
        },
        sentence: key.sentence,
    };
    let sections = describe::<Scene>("Top of the file").into_iter();
    sections
        .flat_map(|section| section.keys.into_iter().map(move |key| text(&section.title, key)))
        .collect()
}

fn write_section(text: &mut String, section: &Section) {
    // Writing to a text cannot fail.
    let _ = write!(
        text,
        "\n## {}\n\n| key | unit | range | default | meaning |\n| --- | --- | --- | --- | --- |\n",
        section.title
    );
    for key in &section.keys {
        let _ = writeln!(text, "{}", row(key));
    }
}

fn row(key: &Described) -> String {
    let default = match &key.default {
        Default::Required => String::new(),
        Default::None => "optional".to_owned(),
        Default::Value(value) => format!("`{value}`"),
    };
    let cell = |text: &str| text.replace('|', "\\|");
    let unit = if key.unit.is_empty() { "–" } else { &key.unit };
    format!(
        "| `{}` | {unit} | {} | {default} | {} |",
        key.name,
        cell(&key.range),
        cell(key.sentence)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_has_the_path_that_overrides_take() {
        let paths: Vec<String> = keys().iter().map(KeyText::path).collect();
        for path in [
            "title",
            "run.low_pass_hz",
            "run.evaluate.spans",
            "catenary.contact_wire.tension",
        ] {
            assert!(paths.iter().any(|known| known == path), "{path}: {paths:?}");
        }
        assert!(paths.iter().any(|path| path == "pantograph.static_force"));
    }

    #[test]
    fn every_key_has_one_sentence() {
        for section in describe::<Scene>("Top of the file") {
            for key in &section.keys {
                assert!(!key.sentence.is_empty(), "{}: {} has none", section.title, key.name);
                assert!(key.sentence.ends_with('.'), "{}: {}", section.title, key.sentence);
            }
        }
    }
}
