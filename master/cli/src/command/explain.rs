//! `master explain`.

use std::path::Path;

use results::explain::Explanation;
use scene::{Assessment, KeyText};
use serde::Serialize;

use super::{CommandError, SceneFile, nothing_to_set, nothing_to_write, print, print_json};
use crate::cli::Common;

/// Most names that a hint lists.
const HINTS: usize = 4;

/// Keys, figures, limits and notes of one word.
#[derive(Serialize)]
struct Found {
    keys: Vec<Key>,
    #[serde(flatten)]
    results: Explanation,
}

/// A key of the scene file.
#[derive(Serialize)]
struct Key {
    path: String,
    table: String,
    unit: String,
    range: String,
    default: String,
    meaning: &'static str,
}

impl Key {
    fn text(&self) -> String {
        let unit = match self.unit.as_str() {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        let default = match self.default.as_str() {
            "required" | "optional" => self.default.clone(),
            value => format!("default {value}"),
        };
        format!(
            "{}{unit}\n  {}\n  Values: {}; {default}. Table {}. See docs/scenes/reference.md.\n",
            self.path, self.meaning, self.range, self.table
        )
    }
}

/// Prints the explanation of a key of the scene, a figure, a limit or a note.
///
/// # Errors
/// See [`CommandError`].
pub fn explain(words: &[String], scene: Option<&Path>, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master explain", common)?;
    nothing_to_write("master explain", common)?;
    let assessment = match scene {
        Some(path) => SceneFile::read(path, common)?.scene.assessment,
        None => Assessment::default(),
    };
    let typed = words.join(" ");
    let found = found(&typed, &assessment);
    if found.keys.is_empty() && found.results.is_empty() {
        return Err(CommandError::Unexplained {
            nearest: nearest(&typed),
            typed,
        });
    }
    if common.json {
        return print_json(&found);
    }
    let keys: Vec<String> = found.keys.iter().map(Key::text).collect();
    let results = found.results.text();
    let parts = keys.into_iter().chain([results]).filter(|text| !text.is_empty());
    print(&parts.collect::<Vec<_>>().join("\n"))
}

/// Path of a key without the numbers of entries.
fn plain(path: &str) -> String {
    let parts = path.split('.').map(|part| part.split('[').next().unwrap_or(part));
    parts.collect::<Vec<_>>().join(".")
}

fn found(typed: &str, assessment: &Assessment) -> Found {
    // A note begins with its subject.
    let typed = typed.trim().trim_start_matches("note: ");
    let subject = typed.split(": ").next().unwrap_or(typed);
    let path = plain(subject);
    let wanted = |key: &KeyText| key.path() == path || key.name == path || key.table.contains(&format!("[{path}]"));
    let keys = scene::described_keys().into_iter().filter(wanted).map(|key| Key {
        path: key.path(),
        table: key.table.trim_matches('`').to_owned(),
        unit: key.unit,
        range: key.range,
        default: key.default,
        meaning: key.sentence,
    });
    Found {
        keys: keys.collect(),
        results: Explanation::of(subject, assessment),
    }
}

/// Names that are spelt like what was typed, as a hint.
fn nearest(typed: &str) -> String {
    let mut names: Vec<String> = scene::described_keys().iter().map(KeyText::path).collect();
    names.extend(Explanation::names());
    let near = |name: &String| {
        let last = name.rsplit('.').next().unwrap_or(name);
        strsim::jaro_winkler(typed, name).max(strsim::jaro_winkler(typed, last))
    };
    names.sort_by(|a, b| near(b).total_cmp(&near(a)).then(a.cmp(b)));
    names.dedup();
    names.truncate(HINTS);
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_by_path_by_name_with_numbers_and_by_its_table() {
        for typed in [
            "run.low_pass_hz",
            "low_pass_hz",
            "pantograph[2].static_force",
            "catenary.contact_wire",
        ] {
            assert!(!found(typed, &Assessment::default()).keys.is_empty(), "{typed}");
        }
        let key = &found("run.speed_kmh", &Assessment::default()).keys[0];
        assert!(
            key.text().contains("run.speed_kmh [km/h]\n  Speed of the train."),
            "{}",
            key.text()
        );
        assert!(found("catenary.contact_wire", &Assessment::default()).keys.len() > 3);
    }

    #[test]
    fn a_note_is_explained_by_its_subject_and_a_word_that_is_not_known_has_neighbours() {
        let note = "note: mesh: the filtered force is wrong by about 0.9 %";
        assert!(
            found(note, &Assessment::default())
                .results
                .text()
                .contains("Error of the finite elements")
        );
        assert!(nearest("low_pas").starts_with("run.low_pass_hz") || nearest("low_pas").contains("low_pass_hz"));
    }
}
