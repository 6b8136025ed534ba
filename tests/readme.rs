//! The commands of README.md, run as printed, in their order and in a folder that looks like the source tree.
#![cfg(unix)]
use integration_tests::documents::{block, blocks_of, section, text};
use integration_tests::fmus::tree;
use integration_tests::installed::Program;
use integration_tests::python::{environment, run_apart};
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

/// Stand-ins for commands that a test cannot make: `cargo run` (the program is built already), `cargo test` (the
/// caller of this file) and `pip` (all tests share one environment).
fn stand_ins(folder: &Path) {
    let requirements = tree().join("tests/importers/requirements.txt");
    let fmpy = fs::read_to_string(&requirements).unwrap();
    let fmpy = fmpy.lines().find(|line| line.starts_with("fmpy==")).unwrap();
    let python = environment("importers", &requirements);
    let scripts = [
        (
            "cargo",
            "[ \"$1 $2\" = \"test --release\" ] && exit 0\n[ \"$1 $2\" = \"run --release\" ] || exit 9\nshift 2\n\
             exec target/release/master \"$@\""
                .to_owned(),
        ),
        ("pip", format!("[ \"$1 $2\" = \"install {fmpy}\" ] || exit 9")),
        ("python", format!("exec '{}' \"$@\"", python.display())),
    ];
    fs::create_dir(folder).unwrap();
    for (name, script) in scripts {
        let path = folder.join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
}

/// Words of a line that are the same in every run: no figures, no verdict.
fn words(line: &str) -> BTreeSet<String> {
    let words = line
        .split(|letter: char| !letter.is_alphabetic())
        .map(str::to_lowercase);
    words
        .filter(|word| !word.is_empty() && !["pass", "fail", "holds", "fails"].contains(&word.as_str()))
        .collect()
}

#[test]
fn every_command_of_the_readme_runs_as_printed() {
    let readme = text("README.md");
    let program = Program::new();
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    fs::create_dir(place.join("target")).unwrap();
    symlink(program.folder(), place.join("target/release")).unwrap();
    for folder in ["scenes", "tests", "examples"] {
        symlink(tree().join(folder), place.join(folder)).unwrap();
    }
    stand_ins(&place.join("stand-ins"));
    fs::write(place.join("my-line.toml"), block("README.md", "Your own line", "toml")).unwrap();

    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", place.join("stand-ins").display());
    let mut said = String::new();
    let commands = blocks_of(&readme, "sh");
    assert!(commands.len() >= 4, "{commands:?}");
    for commands in commands {
        let mut shell = Command::new("sh");
        shell
            .args(["-e", "-c", &commands])
            .current_dir(place)
            .env("PATH", &path);
        said += &run_apart(&mut shell, &commands).0;
    }
    for written in [
        "results/thesis/report.html",
        "results/my-line/report.html",
        "results/slower/report.html",
        "results/two-mass/summary.json",
        "results/both/report.html",
        "fmus/Catenary.fmu",
        "fmus/Pantograph.fmu",
    ] {
        assert!(place.join(written).is_file(), "no {written}:\n{said}");
    }

    let shown = block("README.md", "Install and first run", "text");
    let printed: Vec<_> = said.lines().map(words).collect();
    for line in shown.lines() {
        let shown = words(line);
        assert!(
            printed.iter().any(|printed| shown.is_subset(printed)),
            "the program prints no line like\n{line}\nbut\n{said}"
        );
    }
}

#[test]
fn the_readme_has_two_screens_and_its_two_commands() {
    let readme = text("README.md");
    let lines = readme.lines().count();
    assert!(lines <= 120, "{lines} lines");
    for line in readme.lines() {
        assert!(line.chars().count() <= 160, "{line}");
    }
    let first = section(&readme, "Install and first run");
    for command in ["cargo run --release ", "cargo test --release "] {
        assert!(first.contains(command), "no {command}");
    }
}
