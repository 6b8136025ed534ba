//! Hashes that tell which runs belong together: of the program, of a scene, of what a scene leaves to a run.

use std::path::Path;
use std::sync::LazyLock;

use scene::Scene;
use sha2::{Digest, Sha256};

/// Hash of some bytes, in hexadecimal.
#[must_use]
pub fn digest(parts: &[&[u8]]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        // The length keeps parts apart.
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Hash of files; one that cannot be read counts as empty.
fn files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> String {
    let bytes: Vec<Vec<u8>> = paths
        .into_iter()
        .map(|path| std::fs::read(path).unwrap_or_default())
        .collect();
    digest(&bytes.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// The program: its version and its own bytes.
static PROGRAM: LazyLock<String> = LazyLock::new(|| {
    let program = fmi2::program::file().unwrap_or_default();
    digest(&[env!("CARGO_PKG_VERSION").as_bytes(), files([&*program]).as_bytes()])
});

/// The libraries that FMUs of this program are made of.
static LIBRARIES: LazyLock<String> = LazyLock::new(|| {
    let libraries = cosim::package::Libraries::find().ok();
    libraries.map_or_else(String::new, |found| files(found.paths()))
});

/// Hash of the libraries that FMUs of this program are made of; empty where there are none.
#[must_use]
pub fn libraries() -> &'static str {
    &LIBRARIES
}

/// Hash of the program: the same hash gives the same results bit for bit.
#[must_use]
pub fn program() -> &'static str {
    &PROGRAM
}

/// The scene with a hash of their bytes in place of the files that it names: supplied FMUs and tables, relative to
/// `base`.
#[must_use]
pub fn by_content(scene: &Scene, base: &Path) -> Scene {
    let mut scene = scene.clone();
    // A file that cannot be read stops the run that it is for, with a message.
    let hashed = |path: &mut String| {
        let bytes = std::fs::read(base.join(&*path)).unwrap_or_default();
        path.clone_from(&digest(&[&bytes])[..12].to_owned());
    };
    scene.supplied_sides_mut().for_each(|side| hashed(&mut side.fmu));
    scene.unread_files_mut().into_iter().for_each(|(_, path)| hashed(path));
    scene
}

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
    const TABLES: [&str; 10] = [
        "[catenary.mesh]",
        "[coupling]",
        "[solver]",
        "[model]",
        "[measurement]",
        "[assessment]",
        "[[assessment.limit]]",
        "[wear]",
        "[wear.wire]",
        "[wear.strip]",
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
#[must_use]
pub fn settings(text: &str, coupled: bool) -> String {
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
