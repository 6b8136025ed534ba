//! Keys and words that the scene file had under another name: an old one is refused with the new one named.

/// Old and new path of a key, without the numbers of list entries.
const KEYS: [(&str, &str); 1] = [("catenary.mesh.cures", "catenary.mesh.corrections")];

/// Path of a key without the numbers of list entries, old and new word.
const WORDS: [(&str, &str, &str); 2] = [
    ("solver.formulation", "default", "index_3"),
    ("solver.formulation", "augmented_lagrangian", "index_1_baumgarte"),
];

/// The path of a key as the tables above have it: `pantograph[2].strip` is `pantograph.strip`.
fn without_numbers(path: &str) -> String {
    let mut inside = false;
    path.chars()
        .filter(|&c| {
            let kept = !inside && c != '[';
            inside = (inside || c == '[') && c != ']';
            kept
        })
        .collect()
}

/// The new path of a key that was renamed.
pub(crate) fn new_key(path: &str) -> Option<&'static str> {
    let path = without_numbers(path);
    let found = KEYS.iter().find(|(old, _)| *old == path);
    found.map(|(_, new)| *new)
}

/// The new name of a word that was renamed in the key with this path.
pub(crate) fn new_word(path: &str, word: &str) -> Option<&'static str> {
    let path = without_numbers(path);
    let found = WORDS.iter().find(|(key, old, _)| *key == path && *old == word);
    found.map(|(_, _, new)| *new)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_entries_are_no_part_of_a_renamed_path() {
        assert_eq!(without_numbers("pantograph[12].masses[3]"), "pantograph.masses");
        assert_eq!(without_numbers("catenary.mesh"), "catenary.mesh");
    }
}
