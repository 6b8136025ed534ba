//! Words, prose and width of the sources, and the sizes of the crates.
use integration_tests::documents::text;
use integration_tests::fmus::tree;
use std::path::Path;
use std::process::Command;

/// Tracked files with these endings.
fn sources(endings: &[&str]) -> Vec<String> {
    let listing = Command::new("git")
        .current_dir(tree())
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .output();
    let files = match listing {
        Ok(listing) if listing.status.success() => String::from_utf8(listing.stdout).unwrap(),
        // A source archive without git.
        _ => walk(tree()),
    };
    let ends = |file: &&str| endings.iter().any(|ending| file.ends_with(ending)) && tree().join(file).is_file();
    files.lines().filter(ends).map(str::to_owned).collect()
}

fn walk(folder: &Path) -> String {
    let mut files = String::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !name.starts_with('.') && name != "target" && name != "results" {
            files += &walk(&path);
        } else if path.is_file() {
            files += &format!("{}\n", path.strip_prefix(tree()).unwrap().display());
        }
    }
    files
}

/// Lines of Rust outside of tests: without test files, test folders and modules under `#[cfg(test)]`.
fn product_lines(folder: &str) -> usize {
    let files = sources(&[".rs"]);
    let of_tests = |file: &str| {
        let name = file.rsplit('/').next().unwrap();
        file.contains("/tests/") || file.contains("/benches/") || name == "tests.rs" || name.ends_with("_tests.rs")
    };
    let product = files.iter().filter(|file| file.starts_with(folder) && !of_tests(file));
    product
        .map(|file| {
            let text = text(file);
            let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
            text[..end].lines().count()
        })
        .sum()
}

#[test]
fn no_crate_outgrows_its_room() {
    let rooms = sources(&["Cargo.toml"]);
    for manifest in rooms.iter().filter(|manifest| manifest.contains('/')) {
        let folder = manifest.trim_end_matches("Cargo.toml");
        if folder != "tests/" {
            let lines = product_lines(&format!("{folder}src/"));
            assert!(lines <= 16_000, "{folder}: {lines} lines outside of tests");
        }
    }
    let program = product_lines("master/cli/src/");
    assert!(
        program <= 2_500,
        "the program has {program} lines: it holds arguments and tables only"
    );
    let experiments = product_lines("master/experiments/src/");
    assert!(
        experiments <= 9_000,
        "{experiments} lines of experiments: a new one is a plan and a judge"
    );
}

#[test]
fn no_line_is_wider_than_120_columns() {
    for file in sources(&[".rs"]) {
        for (number, line) in text(&file).lines().enumerate() {
            assert!(line.chars().count() <= 120, "{file}:{}: {line}", number + 1);
        }
    }
}

#[test]
fn comments_begin_with_a_noun_or_an_imperative_verb() {
    for file in sources(&[".rs"]) {
        let mut before = "";
        for (number, line) in text(&file).lines().enumerate() {
            let line = line.trim_start();
            let doc = ["/// ", "//! "].iter().find_map(|mark| line.strip_prefix(mark));
            // Inside a paragraph a line may begin with any word.
            let begins = before.len() <= 3 || !before.starts_with(line.get(..3).unwrap_or(line));
            for word in ["What", "Whether", "Where", "Of"] {
                let wrong = doc.is_some_and(|doc| doc.split([' ', ',']).next() == Some(word));
                assert!(!(wrong && begins), "{file}:{}: {line}", number + 1);
            }
            before = line;
        }
    }
}

/// Words that the field does not use, with what is said in place of each.
const WORDS: [(&str, &str); 14] = [
    ("cure", "correction"),
    ("cures", "corrections"),
    ("foresight", "convergence_estimate"),
    ("OneWayStep", "UnilateralStep"),
    ("at_start", "unilateral"),
    ("hardship", "disturbance"),
    ("rehearse", "disturbance"),
    ("endure", "disturbance"),
    ("pluck", "disturbance"),
    ("third_party", "suppliers"),
    ("augmented_lagrangian", "index_1_baumgarte"),
    ("suspects", "statics_hints"),
    ("beside_strip", "strip_overrun"),
    ("standstill", "settling"),
];

/// Files that may name an old word, each with its reason.
const EXCEPTIONS: [(&str, &str); 5] = [
    ("tests/prose.rs", "the list itself"),
    (
        "core/scene/src/renames.rs",
        "old keys and words are refused with the new ones named",
    ),
    ("core/scene/tests/refused.rs", "the refusals of the old keys"),
    ("CHANGELOG.md", "says what was renamed"),
    ("docs/scenes/reference.md", "lists the renamed keys"),
];

#[test]
fn the_words_are_those_of_the_field() {
    for file in sources(&[".rs", ".toml", ".md", ".py"]) {
        if EXCEPTIONS.iter().any(|(exception, _)| *exception == file) {
            continue;
        }
        for (number, line) in text(&file).lines().enumerate() {
            let mut words = line.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
            let found = words.find_map(|word| WORDS.iter().find(|(old, _)| *old == word));
            assert!(found.is_none(), "{file}:{}: {found:?} in {line}", number + 1);
        }
    }
}
