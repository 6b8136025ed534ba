//! Crates from registries: the check holds and names what is wrong, lists of parts are complete, archives are the same
//! wherever they are built.
use integration_tests::fmus::tree;
use integration_tests::installed::Program;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// True where the check holds, and its lines.
fn checked(arguments: &[&Path]) -> (bool, String) {
    let mut command = Command::new("python3");
    command.arg(tree().join(".ci/supply-chain"));
    if let [metadata, index] = arguments {
        command.arg("--metadata").arg(metadata).arg("--index").arg(index);
    }
    let output = command.output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr);
    (output.status.success(), text)
}

#[test]
fn the_supply_chain_holds() {
    let (holds, found) = checked(&[]);
    assert!(holds, "{found}");
}

#[test]
fn regress_35_a_licence_a_source_a_duplicate_and_a_yanked_version_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let registry = "registry+https://github.com/rust-lang/crates.io-index";
    let package = |name: &str, version: &str, license: &str, source: &str| {
        let mut package = json!({ "name": name, "version": version, "license": license });
        package["source"] = source.into();
        package
    };
    let packages = [
        package("free", "1.0.0", "(MIT OR GPL-3.0) AND Unicode-3.0", registry),
        package("bound", "1.0.0", "GPL-3.0 OR (MIT AND GPL-2.0)", registry),
        package("elsewhere", "1.0.0", "MIT", "git+https://example.org/elsewhere"),
        package("twice", "1.0.0", "MIT", registry),
        package("twice", "2.0.0", "MIT/Apache-2.0", registry),
        package("withdrawn", "1.0.1", "MIT", registry),
    ];
    let metadata = folder.path().join("metadata.json");
    fs::write(&metadata, json!({ "packages": packages }).to_string()).unwrap();
    // As cargo keeps what it was told of a crate.
    let kept = folder.path().join("index/crates.io-0/.cache/wi/th/withdrawn");
    fs::create_dir_all(kept.parent().unwrap()).unwrap();
    let entry = |version: &str, yanked: bool| {
        let entry = json!({ "name": "withdrawn", "vers": version, "yanked": yanked });
        format!("\0{version}\0{entry}")
    };
    let entries = format!("\u{3}head{}{}\0", entry("1.0.0", false), entry("1.0.1", true));
    fs::write(kept, entries).unwrap();
    let (holds, found) = checked(&[&metadata, &folder.path().join("index")]);
    assert!(!holds, "{found}");
    for expected in [
        "bound 1.0.0 has the licence GPL-3.0 OR (MIT AND GPL-2.0), which is not in the list",
        "elsewhere 1.0.0 comes from git+https://example.org/elsewhere, must come from crates.io",
        "twice is there in the versions 1.0.0, 2.0.0",
        "withdrawn 1.0.1 was yanked: must be another version",
    ] {
        assert!(found.contains(expected), "{expected:?} is missing in\n{found}");
    }
    assert!(!found.contains("free 1.0.0"), "{found}");
}

#[test]
fn the_list_of_parts_of_the_fmus_names_the_crates_whose_licences_are_with_it() {
    let parts: Value = serde_json::from_str(&fs::read_to_string(tree().join("fmu/sbom.cdx.json")).unwrap()).unwrap();
    assert_eq!([&parts["bomFormat"], &parts["specVersion"]], ["CycloneDX", "1.5"]);
    let parts = parts["components"].as_array().unwrap();
    let foreign = parts.iter().filter(|part| !part["purl"].is_null());
    let named: BTreeSet<String> = foreign
        .map(|part| {
            assert_eq!(part["hashes"][0]["content"].as_str().unwrap().len(), 64, "{part}");
            format!(
                "{} {}",
                part["name"].as_str().unwrap(),
                part["version"].as_str().unwrap()
            )
        })
        .collect();
    let licenses = fs::read_to_string(tree().join("fmu/licenses.txt")).unwrap();
    let (_, list) = licenses.split_once("\n\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    let licensed = list.lines().map(|line| line.split_once(':').unwrap().0.to_owned());
    assert_eq!(named, licensed.collect());
}

/// Another folder of cargo with the same crates in it.
#[cfg(unix)]
fn another_cargo(folder: &Path) -> PathBuf {
    let variable = |name| std::env::var_os(name).map(PathBuf::from);
    let own = variable("CARGO_HOME").or_else(|| Some(variable("HOME")?.join(".cargo")));
    let other = folder.join("crates of somebody else");
    fs::create_dir(&other).unwrap();
    for entry in fs::read_dir(own.unwrap()).unwrap() {
        let path = entry.unwrap().path();
        std::os::unix::fs::symlink(&path, other.join(path.file_name().unwrap())).unwrap();
    }
    other
}

/// Contents of the entries of an archive.
#[cfg(unix)]
fn entries(archive: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(archive)).unwrap();
    let mut found = BTreeMap::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        found.insert(entry.name().unwrap().into_owned(), bytes);
    }
    found
}

#[cfg(unix)]
#[test]
#[ignore = "builds all crates of the FMUs twice"]
fn archives_to_pass_on_hold_no_path_and_are_the_same_wherever_they_are_built() {
    let folder = tempfile::tempdir().unwrap();
    let other = another_cargo(folder.path());
    let names = ["Catenary.fmu", "Pantograph.fmu"];
    let program = Program::new();
    let built = [("here", None), ("there/further/down", Some(&other))].map(|(name, cargo)| {
        // Another place of the same sources.
        let sources = folder.path().join(name);
        let mut git = Command::new("git");
        git.args(["clone", "--quiet"]).arg(tree()).arg(&sources);
        assert!(git.status().unwrap().success());
        let target = sources.join("target/distribution");
        let mut build = Command::new("bash");
        build.arg(sources.join(".ci/distribution")).arg(&target);
        build.args(["fmu-catenary", "fmu-pantograph"]);
        build.envs(cargo.map(|folder| ("CARGO_HOME", folder)));
        assert!(build.status().unwrap().success(), "{name}");
        // A program takes the libraries beside itself.
        fs::copy(program.folder().join("master"), target.join("master")).unwrap();
        let mut package = Command::new(target.join("master"));
        package.args(["package", "scenes/tram-single-wire.toml", "--out", "fmus"]);
        assert!(package.current_dir(&sources).status().unwrap().success(), "{name}");
        names.map(|name| fs::read(sources.join("fmus").join(name)).unwrap())
    });
    let home = PathBuf::from(std::env::var_os("HOME").unwrap());
    let paths = [tree(), &home, folder.path()].map(|path| format!("{}/", path.display()));
    for (place, name) in names.iter().enumerate() {
        assert!(built[0][place] == built[1][place], "{name}: the bytes differ");
        for (entry, bytes) in entries(&built[0][place]) {
            for path in &paths {
                let holds = bytes.windows(path.len()).any(|bytes| bytes == path.as_bytes());
                assert!(!holds, "{name}: {entry} holds {path}");
            }
        }
    }
}
