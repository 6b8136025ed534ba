//! One file per subcommand.
//!
//! | file | subject |
//! | --- | --- |
//! | `run`, `report` | one scene in one mode; its page again, or several on one page |
//! | `compare`, `study`, `stability`, `reproduce` | experiments: many runs, one table |
//! | `experiment` | outputs of these four: results kept after every run, page and tables at the end |
//! | `sweep`, `sensitivity` | many cases of one scene, one table; effects of numbers that are not certain |
//! | `validate` | reference models against their ranges, as a record |
//! | `check`, `inspect` | a scene before its run; an FMU before its use |
//! | `package`, `export` | FMUs of a scene; the system as an `.ssp` |
//! | `explain` | what a key, a figure, a limit or a note means |
//! | `completions` | scripts for shells |

pub mod check;
pub mod compare;
pub mod completions;
pub mod experiment;
pub mod explain;
pub mod export;
pub mod galloping;
pub mod inspect;
pub mod latency;
pub mod package;
pub mod report;
pub mod reproduce;
pub mod run;
pub mod sensitivity;
pub mod stability;
pub mod study;
pub mod sweep;
pub mod validate;
pub mod wear;

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use scene::{Files, Scene};

use crate::cli::Common;
use cosim::package::PackageError;
use experiments::study::Sweep;
use fmi2::isolation::IsolationError;
use results::ResultsError;
use simulation::SetupError;
use simulation::paths::scene_name;
use suppliers::ssp::{self, SspError};

/// Why a command ended without success.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A file named on the command line.
    #[error("{}: cannot be read", path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// Reason of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// A file that is no scene.
    #[error("{}: {is}; expected a scene (.toml) or a system (.ssp){instead}", path.display())]
    NoScene {
        /// File.
        path: PathBuf,
        /// Kind of the file.
        is: &'static str,
        /// Hint at the right command.
        instead: &'static str,
    },
    /// A file that is neither a sweep nor a scene.
    #[error("{}: {is}; expected a sweep or a scene (.toml){instead}", path.display())]
    NoSweepFile {
        /// File.
        path: PathBuf,
        /// Kind of the file.
        is: &'static str,
        /// Hint at what would do.
        instead: &'static str,
    },
    /// A sweep that cannot begin or go on.
    #[error(transparent)]
    Sweep(Box<::sweep::SweepError>),
    /// Passages that cannot begin or go on.
    #[error("{}", file.display())]
    Passages {
        /// Scene file.
        file: PathBuf,
        /// Reason.
        #[source]
        source: Box<passages::PassagesError>,
    },
    /// A directory without results.
    #[error("{}: holds no {}; expected the output directory of a finished `master \
        run`", path.display(), results::SUMMARY)]
    NoResults {
        /// Path as named.
        path: PathBuf,
    },
    /// A case that does not exist.
    #[error("--cases {name}: there is no such case{nearest}; the cases are {known}")]
    NoCase {
        /// As typed.
        name: String,
        /// `, did you mean …`, or nothing.
        nearest: String,
        /// All names.
        known: String,
    },
    /// A reference model that is none, or a case that cannot be run.
    #[error(transparent)]
    Validation(Box<validation::ValidationError>),
    /// Figures of a reference model outside of their ranges.
    #[error(
        "{standard}: {failed} of the figures lie outside of their ranges or bounds; the record is in {}",
        directory.display()
    )]
    NotValid {
        /// Standard.
        standard: String,
        /// Number of figures.
        failed: usize,
        /// Folder of the record.
        directory: PathBuf,
    },
    /// A word that stands for nothing.
    #[error(
        "{typed}: is no key of a scene, no figure, no standard and no note; expected one, such as {nearest}, or a \
         limit as in \"EN 50367 std\""
    )]
    Unexplained {
        /// As typed.
        typed: String,
        /// Names that are spelt alike.
        nearest: String,
    },
    /// A flag of `master study` that belongs to a sweep which is not made.
    #[error(
        "{flag}: --sweeps {sweeps} leaves out the sweep that it is for: must be left out, or --sweeps {sweeps},{}",
        missing.name()
    )]
    NoSweep {
        /// The flag.
        flag: &'static str,
        /// As typed.
        sweeps: String,
        /// Its sweep.
        missing: Sweep,
    },
    /// `--sweeps spans` without numbers of spans.
    #[error(
        "--sweeps spans: --spans or --window-spans must say how many there are, such as --spans 10,20,40,80 \
         --window-spans 80,400"
    )]
    NoSpans,
    /// A study without a run.
    #[error("{}: nothing to be studied: {why}", file.display())]
    NothingToStudy {
        /// Scene file.
        file: PathBuf,
        /// Why each sweep is empty.
        why: String,
    },
    /// Overrides for a command that reads no scene.
    #[error("--set {first}: {command} reads no scene whose keys could be set")]
    NothingToSet {
        /// The command.
        command: &'static str,
        /// The first override.
        first: String,
    },
    /// A directory for a command that writes no files.
    #[error("--out {}: {command} writes no files, its result is on stdout; leave --out out", out.display())]
    NothingToWrite {
        /// The command.
        command: &'static str,
        /// The directory.
        out: PathBuf,
    },
    /// The run cannot begin.
    #[error(transparent)]
    Setup(Box<SetupError>),
    /// A wish of the scene that cannot be met.
    #[error("{}", file.display())]
    InScene {
        /// Scene file.
        file: PathBuf,
        /// Why.
        #[source]
        source: Box<SetupError>,
    },
    /// An FMU named on the command line.
    #[error(transparent)]
    FmuFile(Box<fmi2::Error>),
    /// A system structure cannot be made or run.
    #[error(transparent)]
    Ssp(Box<SspError>),
    /// An archive cannot be written; the reason names it.
    #[error(transparent)]
    Unwritten(fmi2::archive::ArchiveError),
    /// FMUs cannot be made.
    #[error(transparent)]
    Package(Box<PackageError>),
    /// The directory given for results, or read from.
    #[error(transparent)]
    Directory(ResultsError),
    /// Results cannot be written.
    #[error(transparent)]
    Results(ResultsError),
    /// This process runs an FMU for another one.
    #[error(transparent)]
    Isolation(IsolationError),
    /// A result cannot be turned into JSON.
    #[error("the result is no JSON")]
    Json(#[from] serde_json::Error),
    /// Standard output does not take the result.
    #[error("cannot write to standard output")]
    Output(#[source] std::io::Error),
    /// The run ended early.
    #[error("the run is incomplete, its results are in {}: {reason}", directory.display())]
    Incomplete {
        /// Folder of the results.
        directory: PathBuf,
        /// Why.
        reason: String,
    },
    /// A measurement ended early, and wrote no results.
    #[error("the run is incomplete: {reason}")]
    Unfinished {
        /// Why.
        reason: String,
    },
    /// The run is complete, and limits fail that were asked to hold.
    #[error("--fail-on-limits: {} of the limits fail, the results are in {}: \
        {}", failed.len(), directory.display(), failed.join("; "))]
    LimitsFailed {
        /// Folder of the results.
        directory: PathBuf,
        /// The limits with value and bound.
        failed: Vec<String>,
    },
}

impl CommandError {
    /// 1 where the simulation could not be completed, 2 where usage, scene or FMU are wrong, 3 where limits fail.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Setup(error) | Self::InScene { source: error, .. } if !error.is_input() => 1,
            Self::Incomplete { .. }
            | Self::Unfinished { .. }
            | Self::Results(_)
            | Self::Output(_)
            | Self::Package(_)
            | Self::Json(_) => 1,
            Self::Sweep(error) if !error.is_input() => 1,
            Self::Validation(error) if !error.is_input() => 1,
            Self::Passages { source, .. } if !source.is_input() => 1,
            Self::LimitsFailed { .. } | Self::NotValid { .. } => 3,
            _ => 2,
        }
    }
}

impl CommandError {
    /// Names the scene file where the message does not name a file yet.
    #[must_use]
    pub fn in_scene(self, file: &Path) -> Self {
        match self {
            Self::Setup(source)
                if !matches!(
                    *source,
                    SetupError::Scene(_) | SetupError::FmuFile(_) | SetupError::Package(_)
                ) =>
            {
                let file = file.to_owned();
                Self::InScene { file, source }
            }
            other => other,
        }
    }
}

impl From<SetupError> for CommandError {
    fn from(error: SetupError) -> Self {
        Self::Setup(Box::new(error))
    }
}

impl From<SspError> for CommandError {
    fn from(error: SspError) -> Self {
        Self::Ssp(Box::new(error))
    }
}

impl From<PackageError> for CommandError {
    fn from(error: PackageError) -> Self {
        Self::Package(Box::new(error))
    }
}

/// A scene file as the command line names it.
pub struct SceneFile {
    /// The scene, overrides included.
    pub scene: Scene,
    /// Name: that of the file, or of its directory for the `scene.toml` of results.
    pub name: String,
    /// Folder that paths in it are relative to.
    pub base: PathBuf,
    /// The unpacked archive, where the scene was made of an `.ssp`.
    pub unpacked: Option<fmi2::scratch::Scratch>,
    /// How such an archive was read, and the size of a large line.
    pub notes: Vec<String>,
}

impl SceneFile {
    /// Reads a scene, or makes one of an `.ssp`; one of the source tree is found from anywhere.
    ///
    /// # Errors
    /// [`CommandError::Read`], [`SetupError::Scene`], [`CommandError::Ssp`].
    pub fn read(path: &Path, common: &Common) -> Result<Self, CommandError> {
        let found = found(path);
        if found.exists() && has_extension(&found, "ssp") {
            let imported = ssp::import(&found, &common.overrides)?;
            let mut unpacked = Some(imported.folder);
            simulation::supervise(&imported.scene, &mut unpacked);
            return Ok(Self {
                scene: imported.scene,
                name: scene_name(&found),
                base: imported.base,
                unpacked,
                notes: imported.notes,
            });
        }
        let text = scene_text(&found, path)?;
        let base = found.parent().unwrap_or(Path::new("")).to_owned();
        let files = Files::new(|path| {
            let read = std::fs::read_to_string(base.join(path));
            read.map_err(|error| format!("cannot be read: {error}"))
        });
        let origin = path.display().to_string();
        let scene = system::load_with(&text, &origin, &common.overrides, &files).map_err(SetupError::from)?;
        drop(files);
        simulation::supervise(&scene, &mut None);
        Ok(Self {
            notes: simulation::size::notice(&scene).into_iter().collect(),
            scene,
            name: scene_name(&found),
            base,
            unpacked: None,
        })
    }

    /// Directory for results.
    #[must_use]
    pub fn output(&self, common: &Common) -> PathBuf {
        common
            .out
            .clone()
            .unwrap_or_else(|| Path::new("results").join(&self.name))
    }
}

/// A file as it is named, or that of the source tree where there is none.
fn found(path: &Path) -> PathBuf {
    if path.exists() {
        return path.to_owned();
    }
    let in_tree = cosim::package::source_tree().map(|tree| tree.join(path));
    in_tree.filter(|path| path.exists()).unwrap_or_else(|| path.to_owned())
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    let extension = path.extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Text of the scene file `found`, `path` on the command line.
fn scene_text(found: &Path, path: &Path) -> Result<String, CommandError> {
    let bytes = std::fs::read(found).map_err(|source| CommandError::Read {
        path: path.to_owned(),
        source,
    })?;
    let is_archive = bytes.starts_with(b"PK\x03\x04");
    let (is, instead) = if has_extension(found, "fmu") {
        let instead = "; `master inspect` shows an FMU and the lines that wire it into a scene";
        ("is an FMU", instead)
    } else if is_archive {
        ("is a zip archive", "; a system needs a name that ends in .ssp")
    } else {
        match String::from_utf8(bytes) {
            Ok(text) => return Ok(text),
            Err(_) => ("is no text in UTF-8", ""),
        }
    };
    let path = path.to_owned();
    Err(CommandError::NoScene { path, is, instead })
}

/// Refuses overrides where there is no scene.
///
/// # Errors
/// [`CommandError::NothingToSet`].
pub fn nothing_to_set(command: &'static str, common: &Common) -> Result<(), CommandError> {
    match common.overrides.first().cloned() {
        Some(first) => Err(CommandError::NothingToSet { command, first }),
        None => Ok(()),
    }
}

/// Refuses a directory for results where none are written.
///
/// # Errors
/// [`CommandError::NothingToWrite`].
pub fn nothing_to_write(command: &'static str, common: &Common) -> Result<(), CommandError> {
    match common.out.clone() {
        Some(out) => Err(CommandError::NothingToWrite { command, out }),
        None => Ok(()),
    }
}

/// This program's own stdout, once FMUs have another.
static OUT: OnceLock<File> = OnceLock::new();

/// Keeps stdout to this program: what FMUs print goes to stderr from now on, so that what is read by other programs
/// stays whole.
pub fn keep_stdout() {
    // Where the system refuses, the two are mixed.
    #[cfg(unix)]
    if let Ok(own) = fmi2::import::process::own_stdout() {
        let _ = OUT.set(own);
    }
}

/// Prints `text` on stdout, with control characters of foreign names escaped; a reader that has gone away is no error.
fn print(text: &str) -> Result<(), CommandError> {
    print_as_it_is(&fmi2::visible(text))
}

fn print_as_it_is(text: &str) -> Result<(), CommandError> {
    let written = match OUT.get() {
        Some(mut own) => own.write_all(text.as_bytes()),
        None => {
            let mut out = std::io::stdout().lock();
            out.write_all(text.as_bytes()).and_then(|()| out.flush())
        }
    };
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(CommandError::Output(error)),
        _ => Ok(()),
    }
}

/// Prints `value` as JSON on stdout.
fn print_json(value: &impl serde::Serialize) -> Result<(), CommandError> {
    // JSON has escapes of its own.
    print_as_it_is(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Prints a line on stderr; a terminal that is gone or a disk that is full is no reason to lose results.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", fmi2::visible(text));
}

/// Prints a line on stderr unless quiet was asked for.
fn say(common: &Common) -> impl Fn(&str) {
    let quiet = common.quiet;
    move |text| {
        if !quiet {
            complain(text);
        }
    }
}

/// Time within which a second signal is the same wish: a terminal that closes, and `timeout`, send theirs twice.
const SAME_WISH: Duration = Duration::from_secs(1);

/// Is set by the first Ctrl-C, SIGTERM or SIGHUP, which ask for an end in order; a later one ends the program at once.
fn interrupted(common: &Common) -> &'static AtomicBool {
    static INTERRUPTED: AtomicBool = AtomicBool::new(false);
    static FIRST: OnceLock<Instant> = OnceLock::new();
    let handler = || {
        let first = *FIRST.get_or_init(Instant::now);
        if INTERRUPTED.swap(true, Ordering::Relaxed) && first.elapsed() > SAME_WISH {
            std::process::exit(130);
        }
    };
    #[cfg(unix)]
    let set = fmi2::import::process::with_hangup_as_it_was(|| ctrlc::set_handler(handler));
    #[cfg(not(unix))]
    let set = ctrlc::set_handler(handler);
    if set.is_err() && common.verbose > 0 {
        say(common)("another handler of Ctrl-C is in place");
    }
    &INTERRUPTED
}
