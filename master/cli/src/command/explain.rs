//! `master explain`.

use std::path::Path;

use results::explain::Explanation;
use scene::{Assessment, KeyText};

use super::{CommandError, SceneFile, nothing_to_set, nothing_to_write, print, print_json};
use crate::cli::Common;

/// Most names that a hint lists.
const HINTS: usize = 4;

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
    let found = Explanation::of(&typed, &assessment);
    if found.is_empty() {
        return Err(CommandError::Unexplained {
            nearest: nearest(&typed),
            typed,
        });
    }
    if common.json {
        return print_json(&found);
    }
    print(&found.text())
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
    fn a_note_is_explained_by_its_subject_and_a_word_that_is_not_known_has_neighbours() {
        let note = "note: mesh: the filtered force is wrong by about 0.9 %";
        assert!(
            Explanation::of(note, &Assessment::default())
                .text()
                .contains("Error of the finite elements")
        );
        assert!(nearest("low_pas").starts_with("run.low_pass_hz") || nearest("low_pas").contains("low_pass_hz"));
    }
}
