//! Every example does what its README says: the commands are run as printed.
#![cfg(unix)]
use integration_tests::documents::{blocks_of, section, text};
use integration_tests::fmus::tree;
use integration_tests::installed::Program;
use integration_tests::python::{environment, run_apart};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

/// A folder like the source tree, with stand-ins for `pip` (all tests share one environment) and `python` (its
/// interpreter).
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::create_dir(folder.join("target")).unwrap();
    for name in ["scenes", "tests", "examples"] {
        symlink(tree().join(name), folder.join(name)).unwrap();
    }
    fs::create_dir(folder.join("stand-ins")).unwrap();
    let requirements = tree().join("tests/importers/requirements.txt");
    let python = environment("importers", &requirements);
    for (name, script) in [
        ("pip", "[ \"$1\" = install ]".to_owned()),
        ("python", format!("exec '{}' \"$@\"", python.display())),
    ] {
        let path = folder.join("stand-ins").join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    place
}

/// Runs the shell blocks of an example's README in `folder`; returns what was printed.
fn run(example: &str, folder: &Path) -> String {
    let readme = text(&format!("examples/{example}/README.md"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", folder.join("stand-ins").display());
    let blocks = blocks_of(&readme, "sh");
    assert!(!blocks.is_empty(), "{example}: no command");
    let mut said = String::new();
    for commands in blocks {
        let mut shell = Command::new("sh");
        shell
            .args(["-e", "-c", &commands])
            .current_dir(folder)
            .env("PATH", &path);
        said += &run_apart(&mut shell, &commands).0;
    }
    said
}

/// Mean and standard deviation (N) of a line `… mean A N, std B N`.
fn statistics(said: &str) -> (f64, f64) {
    let line = said.lines().find(|line| line.contains(" N, std ")).expect(said);
    let number = |after: &str| {
        let (_, rest) = line.split_once(after).expect(line);
        rest.trim().split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    (number("mean "), number("std "))
}

#[test]
fn a_line_a_pantograph_a_controller_and_a_master_of_ones_own_run_as_printed() {
    let program = Program::new();
    let place = place();
    symlink(program.folder(), place.path().join("target/release")).unwrap();
    run("own-line", place.path());
    let said = run("own-pantograph", place.path());
    assert!(
        said.contains("[[pantograph]]"),
        "inspect prints a table to paste: {said}"
    );
    let said = run("own-controller", place.path());
    assert!(
        said.contains("[[controller]]"),
        "inspect prints a table to paste: {said}"
    );
    for name in [
        "own-line",
        "own-line-140",
        "own-line-both",
        "own-pantograph",
        "own-controller",
    ] {
        let report = place.path().join("results").join(name).join("report.html");
        assert!(report.is_file(), "no {}", report.display());
    }
    // The static force of 120 N and the lift of the pantograph of EN 50318: none is added by the scene.
    let (mean, std) = statistics(&run("fmpy", place.path()));
    assert!(
        (mean - 120.0).abs() < 12.0 && (10.0..80.0).contains(&std),
        "{mean} {std}"
    );
}

/// Page on sweeps.
const SWEEPS: &str = "docs/guide/sweeps.md";

#[test]
fn sweeps_run_as_printed_and_the_page_shows_the_file_of_the_example() {
    let page = text(SWEEPS);
    let part = section(&page, "Sweep keys of a scene");
    assert_eq!(blocks_of(part, "toml"), [text("examples/speed-and-force/sweep.toml")]);
    let [commands] = &*blocks_of(part, "sh") else {
        panic!("one block of commands")
    };
    let of_example = blocks_of(&text("examples/speed-and-force/README.md"), "sh");
    assert!(commands.ends_with(&of_example[0]), "{commands}");

    let program = Program::new();
    let place = tempfile::tempdir().unwrap();
    fs::create_dir(place.path().join("target")).unwrap();
    symlink(program.folder(), place.path().join("target/release")).unwrap();
    for name in ["scenes", "examples"] {
        symlink(tree().join(name), place.path().join(name)).unwrap();
    }
    let mut shell = Command::new("sh");
    shell.args(["-e", "-c", commands]).current_dir(place.path());
    let said = run_apart(&mut shell, commands).0;
    assert!(said.contains("6 of 6 cases finished, 6 stable"), "{said}");
    assert!(
        said.contains("8 of 8 cases finished, 1 left out by constraints, 8 stable"),
        "{said}"
    );
    for file in ["sweep.csv", "sweep.parquet", "sweep.html"] {
        assert!(
            place.path().join("results/speed-and-force").join(file).is_file(),
            "{file}"
        );
    }
}

#[test]
fn the_programs_that_use_the_physics_as_a_library_print_the_force() {
    for name in ["library-one-system", "library-two-components"] {
        let readme = text(&format!("examples/{name}/README.md"));
        let command = format!("cargo run --release --example {name}");
        assert!(readme.contains(&command), "{name}: no {command}");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut run = Command::new(cargo);
        run.current_dir(tree()).args(command.split(' ').skip(1));
        let (mean, std) = statistics(&run_apart(&mut run, &command).0);
        assert!(
            (mean - 120.0).abs() < 12.0 && (10.0..80.0).contains(&std),
            "{name}: {mean} {std}"
        );
    }
}

#[test]
fn the_program_that_builds_a_line_in_rust_has_sixty_lines_at_most() {
    let source = text("examples/library-one-system/main.rs");
    assert!(source.lines().count() <= 60 && !source.contains("toml"));
}

#[test]
fn every_example_says_what_its_reader_does() {
    let folders = fs::read_dir(tree().join("examples")).unwrap();
    let names: Vec<String> = folders
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(names.len() >= 5, "{names:?}");
    for name in names {
        let readme = text(&format!("examples/{name}/README.md"));
        assert!(readme.contains("\nIn this example you "), "{name}");
    }
}
