//! The output directory of a run.

use std::io::Write;
use std::path::{Path, PathBuf};

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
}

/// Error of the operating system on `path`, while the program wanted to `action` it.
pub fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> ResultsError {
    let path = path.to_owned();
    move |source| ResultsError::Io { path, action, source }
}

fn json(path: &Path) -> impl FnOnce(serde_json::Error) -> ResultsError {
    let path = path.to_owned();
    move |source| ResultsError::Json { path, source }
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
        Ok(Self { path, animation: true })
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

    /// Writes the resolved `scene` and removes the result files of an earlier run, so that the
    /// folder never holds a mixture of two runs.
    ///
    /// To be called when the input is known to be good.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn begin(&self, scene: &str) -> Result<(), ResultsError> {
        for name in [SUMMARY, REPORT, TIMESERIES, ANIMATION] {
            let path = self.path.join(name);
            match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(ResultsError::Io {
                        path,
                        action: "remove",
                        source,
                    });
                }
                _ => {}
            }
        }
        self.replace(SCENE, |out, path| {
            out.write_all(scene.as_bytes()).map_err(io(path, "write"))
        })
    }

    /// Evaluates `record`, writes the data files, complete or not, and returns their content, from which the page is
    /// made.
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
        self.replace(SCENE, |out, path| {
            out.write_all(scene.as_bytes()).map_err(io(path, "write"))
        })?;
        self.replace(TIMESERIES, |out, path| write_timeseries(out, path, &bundle.record))?;
        if self.animation {
            self.replace(ANIMATION, |out, path| {
                let file = AnimationFile {
                    line: bundle.record.line.clone(),
                    animation: bundle.record.animation.rounded(),
                };
                serde_json::to_writer(out, &file).map_err(json(path))
            })?;
        }
        self.write_summary(&bundle.summary)?;
        Ok(bundle)
    }

    /// Writes `summary`.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Io`] with the path and the reason.
    pub fn write_summary(&self, summary: &Summary) -> Result<(), ResultsError> {
        self.replace(SUMMARY, |out, path| {
            serde_json::to_writer_pretty(&mut *out, summary).map_err(json(path))?;
            out.write_all(b"\n").map_err(io(path, "write"))
        })
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

    /// Removes the file of an earlier run, where there is one, because it would not belong to the new results.
    pub fn remove(&self, name: &str) -> Result<(), ResultsError> {
        let path = self.path.join(name);
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(io(&path, "remove")(source)),
            _ => Ok(()),
        }
    }

    /// Writes a file beside its final place and moves it there when it is complete.
    pub fn replace(
        &self,
        name: &str,
        content: impl FnOnce(&mut dyn Write, &Path) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        let path = self.path.join(name);
        let partial = self.path.join(format!(".{name}.partial"));
        let file = std::fs::File::create(&partial).map_err(io(&partial, "write"))?;
        let mut out = std::io::BufWriter::new(file);
        content(&mut out, &path)?;
        out.flush().map_err(io(&path, "write"))?;
        std::fs::rename(&partial, &path).map_err(io(&path, "write"))
    }
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
