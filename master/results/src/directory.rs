//! The output directory of a run.
//!
//! | file | subject |
//! | --- | --- |
//! | `lock` | one run in a folder at a time |
//! | `exchange` | results in place of those of an earlier run |

mod exchange;
mod lock;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Animation, LineGeometry, Record, ResultsError, RunInfo, Summary, read_timeseries, write_timeseries};

/// Resolved scene.
const SCENE: &str = "scene.toml";
/// Record.
const TIMESERIES: &str = "timeseries.csv";
/// Name of the summary in a directory of results.
pub const SUMMARY: &str = "summary.json";
/// Pictures.
const ANIMATION: &str = "animation.json";
/// Page for reading.
const REPORT: &str = "report.html";

/// Content of the animation file.
#[derive(Serialize, Deserialize)]
struct AnimationFile {
    line: LineGeometry,
    #[serde(flatten)]
    animation: Animation,
}

/// A finished run, from which the report is made.
#[derive(Clone, Debug, PartialEq)]
pub struct RunBundle {
    /// Figures.
    pub summary: Summary,
    /// Series, line geometry and pictures.
    pub record: Record,
    /// The resolved scene as text; empty where it is not known.
    pub scene: String,
}

/// The folder that one run writes to.
#[derive(Clone, Debug)]
pub struct OutputDirectory {
    path: PathBuf,
    animation: bool,
    /// Files that belong to the results: name in the folder, and the file that is copied.
    more: Vec<(PathBuf, PathBuf)>,
    lock: Option<Arc<lock::Lock>>,
}

/// Error of the operating system on `path`, while the program wanted to `action` it.
pub fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> ResultsError {
    let path = path.to_owned();
    move |source| ResultsError::Io { path, action, source }
}

fn json(path: &Path) -> impl FnOnce(serde_json::Error) -> ResultsError {
    let path = path.to_owned();
    move |source| match source.io_error_kind() {
        // A disk that is full says nothing about the file.
        Some(_) => ResultsError::Io {
            path,
            action: "write",
            source: source.into(),
        },
        None => ResultsError::Json { path, source },
    }
}

fn read(path: &Path) -> Result<String, ResultsError> {
    std::fs::read_to_string(path).map_err(io(path, "read"))
}

impl OutputDirectory {
    /// Makes sure that `path` is a folder that can be written to, and creates it where it is
    /// missing; files that are already there stay untouched.
    ///
    /// To be called before a long run, so that a wrong path fails at once.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, ResultsError> {
        let path = path.into();
        std::fs::create_dir_all(&path).map_err(io(&path, "create the folder"))?;
        tempfile::NamedTempFile::new_in(&path).map_err(io(&path, "write in the folder"))?;
        Ok(Self {
            path,
            animation: true,
            more: Vec::new(),
            lock: None,
        })
    }

    /// Takes hold of the folder until this value and its copies are dropped, and clears it of what killed runs have
    /// left; `holder` are the words that another process is refused with. Returns a note on a run that did not come to
    /// its end, for the user.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Busy`] where another one holds the folder.
    pub fn lock(&mut self, holder: &str) -> Result<Option<String>, ResultsError> {
        let lock = Arc::new(lock::Lock::take(&self.path, holder)?);
        let broken_off = lock.broken_off.clone();
        self.lock = Some(lock);
        self.clear()?;
        Ok(broken_off.map(|words| {
            let folder = self.path.display();
            format!("{folder}: an earlier run did not come to its end, and what it had not written is lost: {words}")
        }))
    }

    /// Finishes what a killed run has begun to exchange, and removes what it has left. For the holder of the lock of
    /// this folder or of the one around it.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn clear(&self) -> Result<(), ResultsError> {
        exchange::recover(&self.path)
    }

    /// Adds a copy of the file `from` to the results, under the relative name `name`.
    pub fn add(&mut self, name: PathBuf, from: PathBuf) {
        self.more.push((name, from));
    }

    /// The same folder without pictures: `animation.json` is not written, the page has no player.
    #[must_use]
    pub fn without_animation(mut self) -> Self {
        self.animation = false;
        self
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the resolved `scene` where the folder holds no results of an earlier run; those stay as they are, with
    /// their scene, until the new ones are complete.
    ///
    /// To be called when the input is known to be good.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn begin(&self, scene: &str) -> Result<(), ResultsError> {
        let older = [SCENE, SUMMARY, REPORT, TIMESERIES, ANIMATION];
        if older.iter().any(|name| self.path.join(name).exists()) {
            return Ok(());
        }
        self.replace(SCENE, |out, path| {
            out.write_all(scene.as_bytes()).map_err(io(path, "write"))
        })
    }

    /// Evaluates `record`, writes the data files, complete or not, in place of those of an earlier run, and returns
    /// their content, from which the page is made.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Length`] where the series do not fit together, else what the operating
    /// system reports.
    pub fn finish(&self, info: &RunInfo, mut record: Record, scene: &str) -> Result<RunBundle, ResultsError> {
        record.check()?;
        if !self.animation {
            record.animation.frames.clear();
        }
        let summary = Summary::new(info, &record);
        let bundle = RunBundle {
            summary,
            record,
            scene: scene.to_owned(),
        };
        let written = exchange::beside(&self.path)?;
        self.write(written.path(), &bundle)?;
        exchange::exchange(written, &self.path)?;
        Ok(bundle)
    }

    /// Writes the files of a run into `folder`.
    fn write(&self, folder: &Path, bundle: &RunBundle) -> Result<(), ResultsError> {
        for (name, from) in &self.more {
            let to = folder.join(name);
            let parent = to.parent().unwrap_or(folder);
            std::fs::create_dir_all(parent).map_err(io(parent, "create the folder"))?;
            std::fs::copy(from, &to).map_err(io(&to, "write"))?;
        }
        replace(folder, SCENE, |out, path| {
            out.write_all(bundle.scene.as_bytes()).map_err(io(path, "write"))
        })?;
        replace(folder, TIMESERIES, |out, path| {
            write_timeseries(out, path, &bundle.record)
        })?;
        if self.animation {
            replace(folder, ANIMATION, |out, path| {
                let file = AnimationFile {
                    line: bundle.record.line.clone(),
                    animation: bundle.record.animation.rounded(),
                };
                serde_json::to_writer(out, &file).map_err(json(path))
            })?;
        }
        replace(folder, SUMMARY, |out, path| write_json(out, path, &bundle.summary))
    }

    /// Writes `summary`.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn write_summary(&self, summary: &Summary) -> Result<(), ResultsError> {
        self.write_json(SUMMARY, summary)
    }

    /// Writes the `page` of the report.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn write_report(&self, page: &str) -> Result<(), ResultsError> {
        self.write_page(REPORT, page)
    }

    /// Writes a page.
    pub fn write_page(&self, name: &str, page: &str) -> Result<(), ResultsError> {
        self.replace(name, |out, path| {
            out.write_all(page.as_bytes()).map_err(io(path, "write"))
        })
    }

    /// Writes `value` as indented JSON into the file `name`.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] with the path and the reason.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), ResultsError> {
        self.replace(name, |out, path| write_json(out, path, value))
    }

    /// Removes the file of an earlier run, where there is one, because it would not belong to the new results.
    pub fn remove(&self, name: &str) -> Result<(), ResultsError> {
        exchange::remove(&self.path.join(name))
    }

    /// Writes a file beside its final place and moves it there when it is complete.
    pub fn replace(
        &self,
        name: &str,
        content: impl FnOnce(&mut dyn Write, &Path) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        replace(&self.path, name, content)
    }
}

/// Writes `value` as indented JSON to `out`; `path` is named in errors.
///
/// # Errors
///
/// [`ResultsError`] with the path and the reason.
pub fn write_json(mut out: &mut dyn Write, path: &Path, value: &impl Serialize) -> Result<(), ResultsError> {
    serde_json::to_writer_pretty(&mut out, value).map_err(json(path))?;
    out.write_all(b"\n").map_err(io(path, "write"))
}

/// Writes the file `name` of `folder` under a new name that no other process knows, and moves it to its place when it
/// is complete.
fn replace(
    folder: &Path,
    name: &str,
    content: impl FnOnce(&mut dyn Write, &Path) -> Result<(), ResultsError>,
) -> Result<(), ResultsError> {
    let path = folder.join(name);
    let prefix = format!(".{name}.");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(exchange::PARTIAL);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As any new file: the user's mask takes away what others may not.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(io(&path, "write"))?;
    let mut out = std::io::BufWriter::new(file.as_file_mut());
    content(&mut out, &path)?;
    out.flush().map_err(io(&path, "write"))?;
    drop(out);
    file.persist(&path).map_err(|error| io(&path, "write")(error.error))?;
    Ok(())
}

impl RunBundle {
    /// Reads the output directory `path` of a finished run. Scene and animation may be missing.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        let file = path.join(SUMMARY);
        let summary = serde_json::from_str(&read(&file)?).map_err(json(&file))?;
        let mut record = read_timeseries(&path.join(TIMESERIES))?;
        let file = path.join(ANIMATION);
        if file.exists() {
            let content: AnimationFile = serde_json::from_str(&read(&file)?).map_err(json(&file))?;
            record.line = content.line;
            record.animation = content.animation;
        }
        let file = path.join(SCENE);
        let scene = if file.exists() { read(&file)? } else { String::new() };
        Ok(Self { summary, record, scene })
    }
}
