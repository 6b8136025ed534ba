//! The reference of the scene file, written from the code that reads it.

use std::fmt::Write as _;

use crate::Scene;
use crate::keys::{Default, Described, Section, describe};

const INTRODUCTION: &str = "\
# Reference of the scene file

Every table and key of a scene with unit, range, default and meaning. Values are in SI units; a key in another unit
names it. x runs along the track from the first support, y to the left, z up from the top of rail; entries of lists and
spans are counted from 1. A key without a default and without \"optional\" must be given.

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
    fn every_key_has_one_sentence() {
        for section in describe::<Scene>("Top of the file") {
            for key in &section.keys {
                assert!(!key.sentence.is_empty(), "{}: {} has none", section.title, key.name);
                assert!(key.sentence.ends_with('.'), "{}: {}", section.title, key.sentence);
            }
        }
    }
}
