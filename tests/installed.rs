//! The program as it is installed: beside its libraries, outside of the source tree.
use crate::fmus::tree;
use serde_json::Value;
use std::fmt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// After this wall time a call counts as hanging: many times what any call in these tests takes on a slow machine.
const PATIENCE: Duration = Duration::from_secs(180);

/// Artifacts of one kind that cargo has built, `bin` or `cdylib`.
///
/// # Panics
/// When they cannot be built.
#[must_use]
pub fn artifacts(arguments: &[&str], kind: &str) -> Vec<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .current_dir(tree())
        .args(["build", "--release", "--message-format=json-render-diagnostics"]);
    let output = command.args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let messages = String::from_utf8_lossy(&output.stdout);
    let messages = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let wanted =
        messages.filter(|message| message["reason"] == "compiler-artifact" && message["target"]["kind"][0] == kind);
    wanted
        .filter_map(|message| Some(PathBuf::from(message["filenames"][0].as_str()?)))
        .collect()
}

/// Paths of the program and its libraries; with the selections of packages for which they are built anyway.
fn built() -> &'static [PathBuf] {
    static BUILT: OnceLock<Vec<PathBuf>> = OnceLock::new();
    BUILT.get_or_init(|| {
        let mut files = artifacts(&["--workspace", "--bin", "master"], "bin");
        files.extend(artifacts(&["-p", "fmu-catenary", "-p", "fmu-pantograph"], "cdylib"));
        assert_eq!(files.len(), 3, "{files:?}");
        files
    })
}

/// The program in a folder of its own, which is removed in the end.
pub struct Program {
    folder: TempDir,
}

/// Outcome of a call of the program.
pub struct Ended {
    /// Exit status; `None` after a signal.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// Folder of the results, which need not exist.
    pub results: PathBuf,
}

impl Default for Program {
    fn default() -> Self {
        Self::new()
    }
}

impl Program {
    /// Installs the program.
    ///
    /// # Panics
    /// When the program cannot be built.
    #[must_use]
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for file in built() {
            let here = folder.path().join(file.file_name().unwrap());
            if fs::hard_link(file, &here).is_err() {
                fs::copy(file, &here).unwrap();
            }
        }
        Self { folder }
    }

    /// Folder of the program, the current directory of every call.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a scene beside the program.
    ///
    /// # Panics
    /// When that is not possible.
    #[must_use]
    pub fn scene(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder().join(format!("{name}.toml"));
        fs::write(&path, text).unwrap();
        path
    }

    /// Calls the program, with a limit of wall time.
    ///
    /// # Panics
    /// When the call does not end.
    #[must_use]
    pub fn call(&self, arguments: &[&str]) -> Ended {
        let name = |stream: &str| self.folder().join(format!("{stream}.txt"));
        let file = |stream: &str| Stdio::from(File::create(name(stream)).unwrap());
        let mut child = Command::new(self.folder().join(format!("master{}", std::env::consts::EXE_SUFFIX)))
            .current_dir(self.folder())
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(file("stdout"))
            .stderr(file("stderr"))
            .spawn()
            .unwrap();
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            if begin.elapsed() > PATIENCE {
                child.kill().unwrap();
                child.wait().unwrap();
                panic!("`master {}` hangs", arguments.join(" "));
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        let text = |stream: &str| String::from_utf8_lossy(&fs::read(name(stream)).unwrap()).into_owned();
        Ended {
            code: status.code(),
            stdout: text("stdout"),
            stderr: text("stderr"),
            results: PathBuf::new(),
        }
    }

    /// Runs a scene, with the results beside the program.
    ///
    /// # Panics
    /// When the run does not end.
    #[must_use]
    pub fn run(&self, scene: &Path, more: &[&str]) -> Ended {
        let results = scene.with_extension("results");
        let mut arguments = vec!["run", scene.to_str().unwrap(), "--out", results.to_str().unwrap(), "-q"];
        arguments.extend(more);
        let mut ended = self.call(&arguments);
        ended.results = results;
        ended
    }
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "exit status {:?}\n{}{}", self.code, self.stdout, self.stderr)
    }
}

impl Ended {
    /// The outcome itself, if successful.
    ///
    /// # Panics
    /// When the call failed.
    #[must_use]
    pub fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self}");
        self
    }

    /// The outcome itself, if the call failed in order: with this exit status and a message that contains all of these.
    ///
    /// # Panics
    /// When the call did not fail so.
    #[must_use]
    pub fn refused(self, code: i32, said: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self}");
        for said in said {
            assert!(self.stderr.contains(said), "nothing about {said:?}:\n{self}");
        }
        assert!(!self.stderr.contains("panicked"), "{self}");
        self
    }

    /// The outcome itself, if the call failed in order, in the run or before, with a message that contains all of
    /// these.
    ///
    /// # Panics
    /// When the call did not fail so.
    #[must_use]
    pub fn failed(self, said: &[&str]) -> Self {
        let code = self.code.filter(|code| (1..=2).contains(code));
        let code = code.unwrap_or_else(|| panic!("{self}"));
        self.refused(code, said)
    }

    /// `summary.json` of a run.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn summary(&self) -> Value {
        let path = self.results.join("summary.json");
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}\n{self}", path.display()));
        serde_json::from_str(&text).unwrap()
    }

    /// A column of `timeseries.csv`.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn series(&self, column: &str) -> Vec<f64> {
        let path = self.results.join("timeseries.csv");
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}\n{self}", path.display()));
        let mut lines = text.lines();
        let place = lines
            .next()
            .unwrap()
            .split(',')
            .position(|name| name == column)
            .unwrap();
        lines
            .map(|line| line.split(',').nth(place).unwrap().parse().unwrap())
            .collect()
    }

    /// Contact force of the first pantograph, N.
    #[must_use]
    pub fn force(&self) -> Vec<f64> {
        self.series("contact[1].force")
    }
}
