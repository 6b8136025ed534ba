//! Python for tests with independent importers: an interpreter, virtual environments, programs.
use crate::fmus::tree;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The interpreter on the path that can make virtual environments.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn python() -> String {
    let tried = ["python3", "python"];
    let works = |name: &&str| {
        let check = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))";
        Command::new(name)
            .args(["-c", check])
            .output()
            .is_ok_and(|output| output.status.success())
    };
    let found = tried.into_iter().find(works);
    found
        .unwrap_or_else(|| {
            panic!(
                "the FMUs are tested with other importers, which needs Python 3.10 or later with the modules venv and \
                 ensurepip: none of {tried:?} is that. Install it (Debian, Ubuntu: apt-get install \
                 python3 python3-venv) and run the tests again"
            )
        })
        .to_owned()
}

/// Runs a program to its end; returns its standard output and its standard error.
///
/// # Panics
/// When the program cannot be started, or fails.
pub fn run_apart(command: &mut Command, what: &str) -> (String, String) {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{what}: {command:?}: {error}"));
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(
        output.status.success(),
        "{what} failed ({}):\n{out}{err}",
        output.status
    );
    (out, err)
}

/// Runs a program to its end; returns all its output.
///
/// # Panics
/// See [`run_apart`].
pub fn run(command: &mut Command, what: &str) -> String {
    let (out, err) = run_apart(command, what);
    out + &err
}

/// The interpreter of the virtual environment `target/<name>-venv`, made anew where it does not fit the pinned
/// requirements.
///
/// # Panics
/// When it cannot be made.
#[must_use]
pub fn environment(name: &str, requirements: &Path) -> PathBuf {
    let folder = tree().join(format!("target/{name}-venv"));
    let interpreter = folder.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    });
    fs::create_dir_all(folder.parent().unwrap()).unwrap();
    let lock = File::create(tree().join(format!("target/{name}-venv.lock"))).unwrap();
    lock.lock().unwrap();
    let wanted = fs::read(requirements).unwrap();
    let stamp = folder.join("installed.txt");
    if !fs::read(&stamp).is_ok_and(|installed| installed == wanted) || !interpreter.exists() {
        let _ = fs::remove_dir_all(&folder);
        run(
            Command::new(python()).args(["-m", "venv"]).arg(&folder),
            "making a Python virtual environment",
        );
        // Without dependencies: the lists are complete for what is used here, FMPy's own would pull in far more.
        let install = [
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--no-deps",
            "--requirement",
        ];
        run(
            Command::new(&interpreter).args(install).arg(requirements),
            &format!("installing {} (network access is needed once)", requirements.display()),
        );
        fs::write(&stamp, &wanted).unwrap();
    }
    interpreter
}

/// The shared library of the interpreter, which FMUs from PythonFMU expect to be loaded already.
///
/// # Panics
/// When the interpreter has none.
#[must_use]
pub fn library(interpreter: &Path) -> String {
    let ask =
        "import sysconfig as s, os; print(os.path.join(s.get_config_var('LIBDIR'), s.get_config_var('INSTSONAME')))";
    let path = run(
        Command::new(interpreter).args(["-c", ask]),
        "asking Python for its shared library",
    );
    let path = path.trim();
    assert!(
        path.contains(".so") && Path::new(path).exists(),
        "FMUs from PythonFMU need a Python with a shared library, and {} has none ({path}): install one (Debian, \
         Ubuntu: apt-get install libpython3-dev; pyenv: PYTHON_CONFIGURE_OPTS=--enable-shared)",
        interpreter.display()
    );
    path.to_owned()
}
