//! Licences of the crates that are linked into the FMUs: the list that goes into the archives is complete.
use integration_tests::fmus::tree;
use integration_tests::python::run_apart;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A crate from a registry.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Crate {
    name: String,
    version: String,
    license: String,
    source: String,
}

fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    run_apart(Command::new(cargo).current_dir(tree()).args(arguments), "cargo").0
}

/// Crates linked into the two libraries; macros run at compile time only.
fn linked() -> BTreeSet<Crate> {
    let listing = cargo(&[
        "tree",
        "--locked",
        "--package=fmu-catenary",
        "--package=fmu-pantograph",
        "--edges=normal,no-proc-macro",
        "--prefix=none",
        "--no-dedupe",
        "--format={p}|{l}|{r}",
    ]);
    let foreign = listing.lines().filter_map(|line| {
        let [package, license, source] = line.split('|').collect::<Vec<_>>().try_into().ok()?;
        let (name, version) = package.split_once(" v")?;
        // A package of this workspace has its path behind the version.
        (!version.contains(' ')).then(|| Crate {
            name: name.into(),
            version: version.into(),
            license: license.into(),
            source: source.into(),
        })
    });
    foreign.collect()
}

/// Folder and authors of each package.
fn packages() -> BTreeMap<(String, String), (PathBuf, String)> {
    let metadata: Value = serde_json::from_str(&cargo(&["metadata", "--locked", "--format-version=1"])).unwrap();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let entries = metadata["packages"].as_array().unwrap().iter().map(|package| {
        let name_of = |author: &Value| text(author).split(" <").next().unwrap_or_default().to_owned();
        let authors: Vec<String> = package["authors"].as_array().unwrap().iter().map(name_of).collect();
        let folder = Path::new(&text(&package["manifest_path"])).parent().unwrap().to_owned();
        (
            (text(&package["name"]), text(&package["version"])),
            (folder, authors.join(", ")),
        )
    });
    entries.collect()
}

/// Licence files of a crate; of several licences on offer the MIT licence is taken.
fn texts(folder: &Path) -> Vec<String> {
    let named = |file: &PathBuf| {
        let name = file.file_name().unwrap().to_string_lossy().to_uppercase();
        name.starts_with("LICEN")
            || name.starts_with("COPYING")
            || name.starts_with("UNLICEN")
            || name.starts_with("NOTICE")
    };
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files.filter(|file| file.is_file() && named(file)).collect();
    files.sort();
    let name = |file: &PathBuf| file.file_name().unwrap().to_string_lossy().to_uppercase();
    if files.iter().any(|file| name(file).starts_with("LICENSE-MIT")) {
        files.retain(|file| name(file).starts_with("LICENSE-MIT") || name(file).starts_with("NOTICE"));
    }
    let read = |file: PathBuf| {
        std::fs::read_to_string(file)
            .unwrap()
            .replace("\r\n", "\n")
            .trim()
            .to_owned()
    };
    files.into_iter().map(read).collect()
}

/// The file that goes into the archives.
fn collected() -> String {
    let (crates, packages) = (linked(), packages());
    let mut text = String::from(
        "The binaries in this archive contain the standard library of Rust (MIT or Apache-2.0, The Rust Project \
         Contributors,\n\
         https://github.com/rust-lang/rust) and the crates below. Their licences follow; where a crate leaves the \
         choice, the MIT\n\
         licence is taken. Sources: https://crates.io/crates/<name>/<version>.\n\n",
    );
    let mut licenses: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for each in &crates {
        let (folder, authors) = &packages[&(each.name.clone(), each.version.clone())];
        let authors = if authors.is_empty() {
            "its contributors"
        } else {
            authors
        };
        text.push_str(&format!(
            "{} {}: {}, {}, {}\n",
            each.name, each.version, each.license, authors, each.source
        ));
        for license in texts(folder) {
            licenses
                .entry(license)
                .or_default()
                .push(format!("{} {}", each.name, each.version));
        }
    }
    for (license, of) in licenses {
        text.push_str(&format!("\n{}\n{}\n\n{license}\n", "-".repeat(80), of.join(", ")));
    }
    text
}

#[test]
fn the_licences_in_the_archives_are_those_of_the_crates_linked_in() {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return; // other systems link other crates
    }
    let path = tree().join("fmu/licenses.txt");
    let expected = collected();
    if std::env::var_os("UPDATE_LICENSES").is_some() {
        std::fs::write(&path, &expected).unwrap();
    }
    let present = std::fs::read_to_string(&path).unwrap_or_default();
    let update = "`UPDATE_LICENSES=1 cargo test --release -p integration-tests --test all licenses` writes it anew";
    for (line, (new, old)) in expected.lines().zip(present.lines()).enumerate() {
        assert_eq!(old, new, "{}, line {}: {update}", path.display(), line + 1);
    }
    assert!(present == expected, "{}: {update}", path.display());
}

#[test]
fn every_crate_has_a_licence_that_lets_us_pass_it_on() {
    let known = [
        "MIT",
        "Apache-2.0",
        "ISC",
        "Zlib",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "Unlicense",
        "MPL-2.0",
        "0BSD",
        "BSL-1.0",
    ];
    let crates = linked();
    assert!(crates.iter().any(|each| each.name == "faer") && crates.len() > 20);
    for each in crates {
        let choices: Vec<&str> = each.license.split(" OR ").flat_map(|part| part.split('/')).collect();
        let fits = choices.iter().any(|choice| {
            let parts = choice.trim_matches(['(', ')', ' ']).split(" AND ");
            parts.into_iter().all(|part| known.contains(&part))
        });
        assert!(fits, "{each:?}");
    }
}
