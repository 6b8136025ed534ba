//! Results of an earlier run outlive whatever ends a later one.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn command(out: &Path, more: &[&str]) -> Command {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command
        .arg("run")
        .arg(scene)
        .args(["--mode", "inprocess", "-q", "--no-animation", "--out"]);
    command.arg(out).args(more).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// A run of a fraction of a second on a short line.
fn short(out: &Path) -> Output {
    let keys = [
        "catenary.spans=3",
        "catenary.mesh.elements_per_interval=1",
        "run.duration=0.2",
        "run.evaluate={ time = [0.1, 0.2] }",
    ];
    command(out, &keys.map(|key| ["--set", key]).concat()).output().unwrap()
}

/// Waits until a run of many seconds has begun.
fn begun(mut command: Command, out: &Path) -> Child {
    let child = command.spawn().unwrap();
    let begin = Instant::now();
    while !out.join(".pantoline.lock").exists() {
        // Many times the setup of this scene on a slow machine.
        assert!(begin.elapsed() < Duration::from_secs(60), "the folder is never held");
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(100));
    child
}

fn signal(child: &Child, name: &str) {
    let mut kill = Command::new("kill");
    let sent = kill.args([&format!("-{name}"), &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
}

fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    paths.map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

#[test]
fn a_killed_run_leaves_the_results_of_the_one_before_and_the_next_one_clears_up() {
    let folder = tempfile::tempdir().unwrap();
    assert!(short(folder.path()).status.success());
    let before = content(folder.path());
    let mut child = begun(command(folder.path(), &[]), folder.path());
    signal(&child, "KILL");
    child.wait().unwrap();
    let mut after = content(folder.path());
    after.remove(&folder.path().join(".pantoline.lock"));
    assert_eq!(after, before);
    assert!(short(folder.path()).status.success());
    let names = |content: &BTreeMap<PathBuf, Vec<u8>>| content.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&content(folder.path())), names(&before));
}

#[test]
fn a_second_run_into_the_same_folder_is_refused_and_names_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let first = begun(command(folder.path(), &[]), folder.path());
    let second = short(folder.path());
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{said}");
    let process = format!("process {}", first.id());
    for part in ["`master run` of", "en50318-250.toml", &process] {
        assert!(said.contains(part), "nothing about {part}: {said}");
    }
    signal(&first, "INT");
    assert_eq!(first.wait_with_output().unwrap().status.code(), Some(1));
    assert!(folder.path().join("summary.json").exists());
}

#[test]
fn a_run_that_was_told_to_outlive_its_terminal_does() {
    let folder = tempfile::tempdir().unwrap();
    let run = command(
        folder.path(),
        &["--set", "run.duration=3", "--set", "run.evaluate={ time = [0.5, 3.0] }"],
    );
    let mut shell = Command::new("sh");
    shell
        .args(["-c", "trap '' HUP; exec \"$@\"", "sh"])
        .arg(run.get_program())
        .args(run.get_args());
    shell.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = begun(shell, folder.path());
    signal(&child, "HUP");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
