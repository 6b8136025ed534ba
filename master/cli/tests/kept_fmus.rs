//! FMUs that are kept from run to run are those that would be packed now.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use cosim::package::{self, Libraries};
use fmi2::archive::{write, zipped};
use fmi2::import::Fmu;
use scene::Scene;
use system::equilibrium;

const SHORT: [&str; 4] = [
    "catenary.spans=3",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.1",
    "run.evaluate={ time = [0.0, 0.1] }",
];

fn scene_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml")
}

fn resolved() -> Scene {
    let text = std::fs::read_to_string(scene_file()).unwrap();
    let mut scene = system::load(&text, "en50318-250.toml", &SHORT.map(str::to_owned)).unwrap();
    let statics = catenary::static_line(&scene).unwrap();
    equilibrium::resolve(&mut scene, &statics).unwrap();
    scene
}

/// All files of an unpacked FMU.
fn entries(folder: &Path, below: &str, entries: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{below}{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            self::entries(&entry.path(), &format!("{name}/"), entries);
        } else {
            entries.insert(name, std::fs::read(entry.path()).unwrap());
        }
    }
}

/// Writes the FMU at `path` again with another content of the file `name`, under the same GUID.
fn alter(path: &Path, name: &str, change: impl Fn(Vec<u8>) -> Vec<u8>) {
    let mut found = BTreeMap::new();
    entries(Fmu::open(path).unwrap().folder(), "", &mut found);
    let content = found.get_mut(name).unwrap();
    *content = change(std::mem::take(content));
    write(path, &zipped(&found).unwrap()).unwrap();
}

#[test]
fn a_kept_fmu_with_another_scene_or_library_under_the_same_guid_is_packed_anew() {
    let (scene, libraries) = (resolved(), Libraries::find().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let ensure = || package::ensure(&scene, &libraries, folder.path()).unwrap();
    let path = folder.path().join("Catenary.fmu");
    let guid = ensure()[0].1.description().guid.clone();
    let whole = std::fs::read(&path).unwrap();
    let written = || std::fs::metadata(&path).unwrap().modified().unwrap();
    let first = written();
    assert_eq!(ensure()[0].1.path(), path);
    assert_eq!(written(), first, "an FMU that is the one to be packed stays");

    let inner = |scene: Vec<u8>| {
        String::from_utf8(scene)
            .unwrap()
            .replace("spans = ", "spans = 1")
            .into_bytes()
    };
    let library = fmi2::archive::binary_entry("Catenary");
    for (name, change) in [
        ("resources/scene.toml", &inner as &dyn Fn(Vec<u8>) -> Vec<u8>),
        (&library, &|_| b"planted".to_vec()),
    ] {
        alter(&path, name, change);
        assert_eq!(Fmu::open(&path).unwrap().description().guid, guid);
        assert_ne!(std::fs::read(&path).unwrap(), whole, "{name}");
        let fmus = ensure();
        let mut found = BTreeMap::new();
        entries(fmus[0].1.folder(), "", &mut found);
        assert_ne!(found[name], b"planted");
        assert_eq!(std::fs::read(&path).unwrap(), whole, "{name}");
    }
}

#[test]
fn fmus_in_the_current_directory_are_neither_read_nor_written_by_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let program = Path::new(env!("CARGO_BIN_EXE_master"));
    let libraries = Libraries::find().unwrap();
    for file in libraries.paths().into_iter().chain([program]) {
        let here = at(file.file_name().unwrap().to_str().unwrap());
        std::fs::copy(file, here).unwrap();
    }
    let kept = |cache: &Path| cache.join("fmu/en50318-250/Catenary.fmu");
    for (name, variable) in [
        ("own", "PANTOLINE_CACHE"),
        ("user", "XDG_CACHE_HOME"),
        ("relative", "XDG_CACHE_HOME"),
    ] {
        let mut command = Command::new(at(program.file_name().unwrap().to_str().unwrap()));
        command.current_dir(folder.path()).env_remove("PANTOLINE_CACHE");
        command.env("HOME", at("home"));
        let cache = if name == "relative" {
            PathBuf::from("target")
        } else {
            at(name)
        };
        command
            .env(variable, cache)
            .arg("run")
            .arg(scene_file())
            .args(["-q", "--no-report", "--out", "out"]);
        for key in SHORT {
            command.args(["--set", key]);
        }
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(!at("target").exists(), "{name}: nothing of a run is in ./target");
    }
    assert!(kept(&at("own")).exists());
    assert!(kept(&at("user/pantoline")).exists());
    assert!(
        kept(&at("home/.cache/pantoline")).exists(),
        "a relative XDG_CACHE_HOME is passed over"
    );
}

/// Libraries that are beside the program are used as they are.
#[test]
fn regress_35_a_co_simulation_needs_no_cargo_and_nothing_else_from_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_master"));
    command
        .arg("run")
        .arg(scene_file())
        .args(["--out", "out", "-q", "--no-report"]);
    for key in [
        "catenary.spans=3",
        "catenary.mesh.elements_per_interval=1",
        "run.duration=0.1",
        "run.evaluate={ time = [0.0, 0.1] }",
    ] {
        command.args(["--set", key]);
    }
    command
        .current_dir(folder.path())
        .env_clear()
        .env("TMPDIR", folder.path());
    command.env("HOME", folder.path()).env("PATH", "");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary = std::fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
    assert!(summary.contains("\"mode\": \"cosimulation\""), "{summary}");
}
