//! The Python package: its extension, program and FMUs staged as a wheel has them, and its own tests run on that.
#![cfg(unix)]
use integration_tests::fmus::{Packaged, tree};
use integration_tests::installed::{Program, artifacts};
use integration_tests::python::{environment, run};
use integration_tests::runs::EN_300;
use integration_tests::vendor::{Pantograph, under_the_line};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Puts a file to another place, without a copy where the system can.
fn put(file: &Path, place: &Path) {
    if fs::hard_link(file, place).is_err() {
        fs::copy(file, place).unwrap();
    }
}

/// Puts the package into `folder` as an installation does.
fn stage(folder: &Path) {
    let package = folder.join("pantoline");
    fs::create_dir_all(package.join("bin")).unwrap();
    fs::create_dir(package.join("fmus")).unwrap();
    for entry in fs::read_dir(tree().join("python/pantoline")).unwrap() {
        let path = entry.unwrap().path();
        let source = [".py", ".pyi", ".typed"];
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if source.iter().any(|ending| name.ends_with(ending)) {
            fs::copy(&path, package.join(name)).unwrap();
        }
    }
    // Libraries of the whole workspace, for which they are built anyway.
    let built = artifacts(&["--workspace", "--lib"], "cdylib");
    let extension = built.iter().find(|file| file.to_string_lossy().contains("_pantoline"));
    put(
        extension.expect("the extension is built"),
        &package.join("_pantoline.abi3.so"),
    );
    let program = Program::new();
    for entry in fs::read_dir(program.folder()).unwrap() {
        let path = entry.unwrap().path();
        put(&path, &package.join("bin").join(path.file_name().unwrap()));
    }
    let fmus = Packaged::new(EN_300, &[]);
    for identifier in ["Catenary", "Pantograph"] {
        put(&fmus.path(identifier), &package.join(format!("fmus/{identifier}.fmu")));
    }
}

/// An FMU that ends the process which makes an instance of it: with the interpreter, all that a user has computed.
#[test]
fn regress_35_an_fmu_that_ends_what_loads_it_is_met_in_the_trial_and_not_in_the_interpreter() {
    let interpreter = environment("package", &tree().join("python/tests/requirements.txt"));
    let place = tempfile::tempdir().unwrap();
    stage(place.path());
    let script = "import pantoline\n\
                  try:\n    pantoline.Scene.load('scene.toml').run(mode='cosimulation')\n\
                  except pantoline.RunError as error:\n    print('refused:', error)\n";
    for (fault, words) in [
        ("ABORT", "crashed with SIGABRT"),
        ("EXIT", "ended its process by exit("),
    ] {
        let fault = format!("FAULT={fault}");
        let fmu = Pantograph::new().built_with(&[&fault, "FAULT_IN=INSTANTIATE"]);
        let fmu = fmu.write(place.path(), "head");
        fs::write(place.path().join("scene.toml"), under_the_line(&fmu, "")).unwrap();
        let mut command = Command::new(&interpreter);
        command.current_dir(place.path()).args(["-c", script]);
        command
            .env("PYTHONPATH", place.path())
            .env("PYTHONDONTWRITEBYTECODE", "1");
        let said = run(&mut command, &fault);
        assert!(said.starts_with("refused: ") && said.contains(words), "{fault}: {said}");
    }
}

#[test]
fn the_package_passes_its_own_tests() {
    let interpreter = environment("package", &tree().join("python/tests/requirements.txt"));
    let place = tempfile::tempdir().unwrap();
    stage(place.path());
    let text = run(
        Command::new(interpreter)
            .current_dir(place.path())
            .env("PYTHONPATH", place.path())
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=8"])
            .arg(tree().join("python/tests")),
        "python/tests",
    );
    print!("{text}");
    assert!(text.contains(" passed") && !text.contains("skipped"), "{text}");
}
