//! Scenes as system structures, through the program as a user meets it.

use std::collections::BTreeMap;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A line of three spans on a coarse mesh, for a fraction of a second: what is tested here does not depend on its
/// accuracy.
const SHORT: [&str; 4] = [
    "catenary.spans=3",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.2",
    "run.evaluate={ time = [0.1, 0.2] }",
];

/// Every side follows what it is given and nothing more: the exchange of a plain tool.
const PLAIN: [&str; 4] = [
    "coupling.algorithm=jacobi",
    "coupling.extrapolation=0",
    "coupling.force=end",
    "run.initialise=as_given",
];

fn master(arguments: &[&str], overrides: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command.args(arguments);
    for key in overrides {
        command.args(["--set", key]);
    }
    command.output().unwrap()
}

fn done(arguments: &[&str], overrides: &[&str]) {
    let output = master(arguments, overrides);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {text}");
}

fn scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml")
}

/// The archive of the short scene in `folder`.
fn exported(folder: &Path) -> PathBuf {
    let out = folder.display().to_string();
    done(&["export", scene().to_str().unwrap(), "--out", &out], &SHORT);
    folder.join("en50318-250.ssp")
}

/// Contact force of the first pantograph, N.
fn forces(directory: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(directory.join("timeseries.csv")).unwrap();
    let mut lines = text.lines();
    let column = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "contact[1].force")
        .unwrap();
    lines
        .map(|line| line.split(',').nth(column).unwrap().parse().unwrap())
        .collect()
}

fn furthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The entries of an archive, changed and written to another one.
fn changed(from: &Path, to: &Path, change: impl Fn(&mut BTreeMap<String, Vec<u8>>)) {
    let folder = fmi2::archive::extract(from, "SystemStructure.ssd", &fmi2::archive::Limits::default()).unwrap();
    let mut entries = BTreeMap::new();
    for part in ["", "resources"] {
        for entry in std::fs::read_dir(folder.path().join(part)).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                let name = Path::new(part).join(entry.file_name()).display().to_string();

                let bytes = std::fs::read(entry.path()).unwrap();
                entries.insert(name, bytes);
            }
        }
    }
    change(&mut entries);
    fmi2::archive::write(to, &fmi2::archive::zipped(&entries).unwrap()).unwrap();
}

fn replaced(entries: &mut BTreeMap<String, Vec<u8>>, name: &str, changes: &[(&str, &str)]) {
    let mut text = String::from_utf8(entries[name].clone()).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{name}: {from}");
        text = text.replace(from, to);
    }
    entries.insert(name.to_owned(), text.into_bytes());
}

#[test]
fn an_archive_runs_as_the_scene_it_was_made_of_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = exported(folder.path());
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    done(
        &["run", scene().to_str().unwrap(), "--out", first.to_str().unwrap()],
        &SHORT,
    );
    done(&["run", path.to_str().unwrap(), "--out", second.to_str().unwrap()], &[]);
    for file in ["timeseries.csv", "scene.toml"] {
        let [first, second] = [&first, &second].map(|run| std::fs::read(run.join(file)).unwrap());
        assert!(first == second, "{file} differs");
    }
    let drawn = folder.path().join("drawn");
    done(
        &["check", path.to_str().unwrap(), "--out", drawn.to_str().unwrap()],
        &[],
    );
}

#[test]
fn exporting_twice_gives_the_same_bytes() {
    let [a, b] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let [a, b] = [&a, &b].map(|folder| std::fs::read(exported(folder.path())).unwrap());
    assert!(a == b);
}

#[test]
fn the_same_fmus_in_a_system_made_elsewhere_run_like_our_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = exported(folder.path());
    let foreign = folder.path().join("foreign.ssp");
    changed(&path, &foreign, |entries| {
        entries.remove("resources/scene.toml");
        let annotation = ("<ssc:Annotation type=\"", "<ssc:Annotation type=\"org.example.");
        // Other names, and files elsewhere in the archive.
        let names = [
            ("\"Catenary\"", "\"OHL\""),
            ("\"Pantograph\"", "\"front\""),
            ("resources/Pantograph.fmu", "resources/CX.fmu"),
        ];
        replaced(entries, "SystemStructure.ssd", &[&[annotation], &names[..]].concat());
        let fmu = entries.remove("resources/Pantograph.fmu").unwrap();
        entries.insert("resources/CX.fmu".to_owned(), fmu);
    });
    let (own, other, again) = (
        folder.path().join("own"),
        folder.path().join("other"),
        folder.path().join("again"),
    );
    done(&["run", path.to_str().unwrap(), "--out", own.to_str().unwrap()], &PLAIN);
    done(
        &["run", foreign.to_str().unwrap(), "--out", other.to_str().unwrap()],
        &PLAIN,
    );
    let (own, found) = (forces(&own), forces(&other));
    assert!(own.iter().any(|force| (force - own[0]).abs() > 1.0), "the force moves");
    assert!(furthest(&own, &found) < 1e-6, "N: {}", furthest(&own, &found));
    // The results run again when the archive is gone.
    std::fs::remove_file(&foreign).unwrap();
    done(
        &[
            "run",
            other.join("scene.toml").to_str().unwrap(),
            "--out",
            again.to_str().unwrap(),
        ],
        &[],
    );
    assert_eq!(found, forces(&again));
}

#[test]
fn a_parameter_changed_in_the_archive_is_heard() {
    let folder = tempfile::tempdir().unwrap();
    let path = exported(folder.path());
    let (heavy, same) = (folder.path().join("heavy.ssp"), folder.path().join("same.ssp"));
    changed(&path, &heavy, |entries| {
        let mass = "<ssv:Parameter name=\"masses[1]\">\n      <ssv:Real value=\"";
        replaced(entries, "resources/Pantograph.ssv", &[(mass, &format!("{mass}1"))]);
    });
    changed(&path, &same, |_| {});
    let run = |path: &Path, name: &str| {
        let out = folder.path().join(name);
        let output = master(&["run", path.to_str().unwrap(), "--out", out.to_str().unwrap()], &PLAIN);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (forces(&out), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (own, _) = run(&path, "own");
    let (repacked, said) = run(&same, "same");
    assert_eq!(own, repacked, "packing it again changes nothing");
    assert!(!said.contains("changed since"), "{said}");
    let (heavier, said) = run(&heavy, "heavy");
    assert!(said.contains("changed since `master export`"), "{said}");
    assert!(furthest(&own, &heavier) > 1.0);
}

#[test]
fn an_archive_that_is_refused_ends_with_exit_code_2_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.ssp");
    std::fs::write(&path, "no zip").unwrap();
    let out = folder.path().join("out");
    let output = master(&["run", path.to_str().unwrap(), "--out", out.to_str().unwrap()], &[]);
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("x.ssp: is no intact zip archive"), "{text}");
    assert!(!out.exists());
}
