//! Hashes that tell which runs belong together.

use std::path::Path;

use scene::Scene;

use crate::engine::store::{by_content, digest};

/// Lines of a scene as text that say something, each with the header of its table, which is empty above the first, and
/// its key.
fn entries(text: &str) -> impl Iterator<Item = (&str, &str, &str)> {
    let lines = text.lines().filter(|line| !line.is_empty());
    lines.scan("", |table, line| {
        if line.starts_with('[') {
            *table = line;
        }
        let key = line.split('=').next().unwrap_or("").trim();
        Some((*table, key, line))
    })
}

/// Short hash of some bytes.
fn hash(bytes: &[u8]) -> String {
    digest(&[bytes])[..12].to_owned()
}

/// Hash of a scene without the keys that a run changes or the hash of its settings holds, without its texts, without
/// what only looks at a result, and without what it leaves to be found: start, duration. Files that it names, supplied
/// FMUs and tables, count by their bytes, wherever they are; paths are relative to `base`. Runs of scenes with the same
/// hash can be compared.
#[must_use]
pub fn identity(scene: &Scene, base: &Path) -> String {
    const TABLES: [&str; 7] = [
        "[catenary.mesh]",
        "[coupling]",
        "[solver]",
        "[model]",
        "[measurement]",
        "[assessment]",
        "[[assessment.limit]]",
    ];
    const KEYS: [(&str, &str); 5] = [
        ("", "title"),
        ("", "source"),
        ("[run]", "duration"),
        ("[run]", "output_step"),
        ("[[pantograph]]", "start"),
    ];
    let text = by_content(scene, base).to_toml();
    let kept: Vec<&str> = entries(&text)
        .filter(|&(table, key, _)| !TABLES.contains(&table) && !KEYS.contains(&(table, key)))
        .map(|(_, _, line)| line)
        .collect();
    hash(kept.join("\n").as_bytes())
}

/// Hash of those keys of mesh and solver, and of the coupling where the sides are coupled, that change the result and
/// that no run specification says; of a scene as text with every default written out. Runs of one specification have
/// the same error where this hash is the same.
pub(super) fn settings(text: &str, coupled: bool) -> String {
    let held = |&(table, key, line): &(&str, &str, &str)| match table {
        "[catenary.mesh]" => !["elements_per_interval", "element_length", "corrections"].contains(&key),
        "[solver]" => !["micro_step", "rho_inf", "newton_tolerance"].contains(&key),
        // A step that is controlled is none of a run specification's.
        "[coupling]" if key == "macro_step" => coupled && line.contains('{'),
        "[coupling]" => coupled && !["algorithm", "extrapolation", "parallel"].contains(&key),
        _ => false,
    };
    let kept: Vec<&str> = entries(text).filter(held).map(|(_, _, line)| line).collect();
    hash(kept.join("\n").as_bytes())
}
