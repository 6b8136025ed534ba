//! The check of the dependency rules: holds for this tree, and fails with the name of any forbidden arrow.
use integration_tests::fmus::tree;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders whose sources the rules read, besides every manifest and `lib.rs`.
const SOURCES: [&str; 4] = [
    "master/cosim/src/",
    "master/results/src/",
    "master/cli/src/",
    "master/simulation/src/",
];

fn script() -> PathBuf {
    tree().join(".ci/dependency-rules")
}

/// Rows `name : names` of a table of the script.
fn table(name: &str) -> BTreeMap<String, Vec<String>> {
    let text = fs::read_to_string(script()).unwrap();
    let (_, rest) = text.split_once(&format!("\n{name}='\n")).unwrap();
    let (rows, _) = rest.split_once("\n'").unwrap();
    let row = |row: &str| {
        let (name, names) = row.split_once(':').unwrap();
        let names = names.split_whitespace().map(str::to_owned).collect();
        (name.trim().to_owned(), names)
    };
    rows.lines().map(row).collect()
}

/// A copy of the files that the rules read, in a repository of its own.
struct Copy {
    folder: tempfile::TempDir,
    /// Manifests by the name of their package.
    manifests: BTreeMap<String, String>,
}

fn git(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new("git")
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "git {arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

impl Copy {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        git(folder.path(), &["init", "--quiet"]);
        let mut manifests = BTreeMap::new();
        for file in git(tree(), &["ls-files"]).lines() {
            let is_manifest = file.ends_with("Cargo.toml");
            let is_read = is_manifest || file.ends_with("src/lib.rs") || SOURCES.iter().any(|of| file.starts_with(of));
            // Deleted, and not yet committed.
            if !is_read || !tree().join(file).exists() {
                continue;
            }
            let to = folder.path().join(file);
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::copy(tree().join(file), to).unwrap();
            if is_manifest && file != "Cargo.toml" {
                let text = fs::read_to_string(tree().join(file)).unwrap();
                let name = text.lines().find_map(|line| line.strip_prefix("name = ")).unwrap();
                manifests.insert(name.trim_matches('"').to_owned(), file.to_owned());
            }
        }
        Self { folder, manifests }
    }

    /// True where the rules hold, and the breaches that the check names.
    fn checked(&self) -> (bool, String) {
        let output = Command::new("bash")
            .arg(script())
            .arg(self.folder.path())
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr);
        (output.status.success(), text)
    }

    /// Changes a file, checks that the rules fail with `message` alone, and changes the file back.
    fn assert_refused(&self, file: &str, change: impl Fn(&str) -> String, message: &str) {
        let path = self.folder.path().join(file);
        let before = fs::read_to_string(&path).unwrap();
        let after = change(&before);
        assert_ne!(before, after, "{file}: nothing to change");
        fs::write(&path, after).unwrap();
        let (holds, found) = self.checked();
        fs::write(&path, before).unwrap();
        assert!(
            !holds && found.contains(message),
            "{file}: expected {message:?}, found: {found}"
        );
        assert_eq!(found.lines().count(), 1, "{file}: {found}");
    }
}

/// A manifest with one more dependency.
fn with_dependency(manifest: &str, name: &str) -> String {
    let header = "[dependencies]\n";
    match manifest.split_once(header) {
        Some((before, behind)) => format!("{before}{header}{name}.workspace = true\n{behind}"),
        None => format!("{manifest}\n{header}{name}.workspace = true\n"),
    }
}

#[test]
fn the_rules_hold_and_name_every_package() {
    let copy = Copy::new();
    let (holds, found) = copy.checked();
    assert!(holds, "{found}");
    let graph = table("graph");
    assert!(graph.keys().eq(copy.manifests.keys()), "{:?}", copy.manifests.keys());
}

#[test]
fn one_forbidden_arrow_from_any_package_fails_the_check() {
    let copy = Copy::new();
    let graph = table("graph");
    for (package, allowed) in &graph {
        let mut others = graph.keys().filter(|name| *name != package && !allowed.contains(name));
        let forbidden = others.next().expect("no package may depend on all others");
        copy.assert_refused(
            &copy.manifests[package],
            |manifest| with_dependency(manifest, forbidden),
            &format!("{package} depends on {forbidden}; allowed:"),
        );
    }
}

#[test]
fn every_forbidden_arrow_is_named() {
    let copy = Copy::new();
    let graph = table("graph");
    let mut expected = Vec::new();
    for (package, allowed) in &graph {
        let path = copy.folder.path().join(&copy.manifests[package]);
        let mut manifest = fs::read_to_string(&path).unwrap();
        for other in graph.keys().filter(|name| *name != package && !allowed.contains(name)) {
            manifest = with_dependency(&manifest, other);
            expected.push(format!("{package} depends on {other}; allowed:"));
        }
        fs::write(path, manifest).unwrap();
    }
    let (holds, found) = copy.checked();
    let missing: Vec<&String> = expected.iter().filter(|breach| !found.contains(*breach)).collect();
    assert!(!holds && missing.is_empty(), "not named: {missing:?}");
    assert_eq!(found.lines().count(), expected.len(), "{found}");
}

#[test]
fn a_library_from_outside_is_refused_where_it_does_not_belong() {
    let copy = Copy::new();
    let graph = table("graph");
    for (library, may) in table("outside") {
        let package = graph.keys().find(|name| !may.contains(name)).unwrap();
        copy.assert_refused(
            &copy.manifests[package],
            |manifest| with_dependency(manifest, &library),
            &format!("{package} depends on {library}, which only these may:"),
        );
    }
}

#[test]
fn dependencies_are_found_in_every_form_of_a_manifest() {
    let copy = Copy::new();
    let scene = &copy.manifests["scene"];
    for section in [
        "[dependencies.vehicle]\nworkspace = true",
        "[target.'cfg(unix)'.dependencies]\nvehicle = { workspace = true }",
    ] {
        copy.assert_refused(
            scene,
            |manifest| format!("{manifest}\n{section}\n"),
            "scene depends on vehicle; allowed:",
        );
    }
    copy.assert_refused(
        scene,
        |manifest| manifest.replacen("name = \"scene\"", "name = \"stage\"", 1),
        "is not in the graph",
    );
}

#[test]
fn sources_that_break_a_rule_are_named() {
    let copy = Copy::new();
    for library in [
        "core/dynamics/src/lib.rs",
        "fmu/src/lib.rs",
        "master/suppliers/src/lib.rs",
    ] {
        copy.assert_refused(
            library,
            |text| text.replacen("#![forbid(unsafe_code)]", "", 1),
            &format!("{library} does not forbid unsafe code"),
        );
    }
    let line = |line: &'static str| move |text: &str| format!("{text}\n{line}\n");
    copy.assert_refused(
        "master/cosim/src/algorithm/jacobi.rs",
        line("use catenary::Subsystem;"),
        "master/cosim/src/algorithm names more than the Slave trait",
    );
    copy.assert_refused(
        "master/results/src/record.rs",
        line("use crate::report::Progress;"),
        "results name the report",
    );
    copy.assert_refused(
        "master/cli/src/main.rs",
        line("use std::process::Command;"),
        "FMUs are made without a compiler",
    );
}
