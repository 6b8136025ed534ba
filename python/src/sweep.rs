//! Many cases of one scene, whole or in batches.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use ::sweep::journal::Journal;
use ::sweep::plan::PlanWishes;
use ::sweep::sensitivity::{self, Parameter, Sensitivity};
use ::sweep::{Made, Options, Sweep, Wishes, file};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use results::OutputDirectory;
use results::report::{Progress, Show};
use tempfile::TempDir;

use crate::error::{RunError, SweepError, of_results, of_sweep};
use crate::interruption::interruptible;
use crate::scene::{SceneSource, mode, parameters};

/// A sweep that can begin.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct CaseSweep {
    name: String,
    sweep: Sweep,
    files: BTreeMap<String, String>,
    /// Numbers that are varied one at a time, and the hash of their scene.
    one_at_a_time: Option<(Vec<Parameter>, String)>,
    mode: &'static str,
    /// Journal of a sweep whose batches are made elsewhere, and its folder.
    journal: Mutex<Option<(Journal, PathBuf)>>,
    /// Packages of FMUs.
    _packages: TempDir,
}

fn json(error: &serde_json::Error) -> PyErr {
    RunError::new_err(error.to_string())
}

#[pymethods]
impl CaseSweep {
    /// Reads the scene, makes the plan and tries its values; wishes are those of the command line. `files` are texts of
    /// files beside the scene, where the sweep is made in a place that has none.
    ///
    /// In place of wishes: `rows` are the values of each key in one case after the other; `ranges` are numbers that are
    /// varied one at a time, with those of the scene, or those of `keys` alone.
    #[new]
    #[pyo3(signature = (
        scene, *, vary, derive, where_, sample, count, seed, series, mode, jobs, files,
        rows=None, ranges=None, keys=None
    ))]
    #[allow(clippy::too_many_arguments, reason = "each is an option of the program")]
    fn new(
        py: Python<'_>,
        scene: &SceneSource,
        vary: Vec<String>,
        derive: Vec<String>,
        where_: Vec<String>,
        sample: Option<&str>,
        count: Option<u64>,
        seed: Option<u64>,
        series: bool,
        mode: &str,
        jobs: usize,
        files: BTreeMap<String, String>,
        rows: Option<&Bound<'_, PyDict>>,
        ranges: Option<Vec<String>>,
        keys: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let mut wishes = Wishes::default();
        let refused = |error: ::sweep::SweepError| of_sweep(&error);
        vary.iter().try_for_each(|text| wishes.vary(text)).map_err(refused)?;
        derive
            .iter()
            .try_for_each(|text| wishes.derive(text))
            .map_err(refused)?;
        where_.iter().for_each(|text| wishes.constrain(text));
        let method = sample.map(|word| {
            let refused = |what| SweepError::new_err(format!("sample = \"{word}\": {what}"));
            file::method(word).map_err(refused)
        });
        wishes.method = method.transpose()?;
        (wishes.count, wishes.seed, wishes.series) = (count, seed, series);
        let packages = tempfile::tempdir()?;
        let mode = self::mode(mode)?;
        let options = Options {
            mode,
            jobs,
            series,
            logging: false,
            fmus: packages.path().to_owned(),
        };
        let base = scene.base().with_files(files);
        let one_at_a_time = match &ranges {
            Some(ranges) => {
                let parameters = parameters(&base, ranges, keys.as_deref()).map_err(refused)?;
                Some((parameters, sensitivity::identity(&base).map_err(refused)?))
            }
            None => None,
        };
        let plan = match (&one_at_a_time, rows) {
            (Some((parameters, _)), _) => sensitivity::wishes(parameters),
            (None, Some(rows)) => {
                // A dictionary of Python keeps the order of its keys.
                let column = |(key, values): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
                    Ok::<_, PyErr>((key.extract::<String>()?, values.extract::<Vec<f64>>()?))
                };
                PlanWishes::rows(rows.iter().map(column).collect::<PyResult<_>>()?)
            }
            (None, None) => wishes.plan().map_err(refused)?,
        };
        let sweep = py.detach(|| Sweep::new(base, plan, options)).map_err(refused)?;
        Ok(Self {
            name: scene.name.clone(),
            files: sweep.files(),
            sweep,
            one_at_a_time,
            mode: mode.name(),
            journal: Mutex::default(),
            _packages: packages,
        })
    }

    /// Number of cases.
    fn cases(&self) -> u64 {
        self.sweep.cases()
    }

    /// Texts of the files beside the scene.
    fn files(&self) -> BTreeMap<String, String> {
        self.files.clone()
    }

    /// Text that is the same for the same cases, bit for bit.
    fn identity(&self) -> PyResult<String> {
        serde_json::to_string(self.sweep.identity()).map_err(|error| json(&error))
    }

    /// Makes all cases; returns the summary as JSON.
    fn run(&self, py: Python<'_>, folder: PathBuf, progress: bool) -> PyResult<String> {
        OutputDirectory::open(&folder).map_err(|error| of_results(&error))?;
        let show = if progress { Show::OnTerminal } else { Show::Never };
        let summary = interruptible(py, |stop| {
            let bar = Progress::share(&self.name, show);
            self.sweep.run(&folder, stop, &bar)
        })?;
        let summary = summary.map_err(|error| of_sweep(&error))?;
        serde_json::to_string(&summary).map_err(|error| json(&error))
    }

    /// Figures of the finished cases in `folder`, and the reasons of those without, as JSON.
    fn figures(&self, py: Python<'_>, folder: PathBuf) -> PyResult<String> {
        let records = py
            .detach(|| self.sweep.records(&folder))
            .map_err(|error| of_sweep(&error))?;
        let reasons: Vec<&str> = records.iter().map(|record| &*record.reason).collect();
        let found = serde_json::json!({ "figures": sensitivity::figures(&records), "reasons": reasons });
        Ok(found.to_string())
    }

    /// Effects of the numbers that were varied one at a time in `folder`, as JSON; writes the files of
    /// `master sensitivity`.
    fn effects(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Option<String>> {
        let Some((parameters, identity)) = &self.one_at_a_time else {
            return Ok(None);
        };
        let records = py
            .detach(|| self.sweep.records(&folder))
            .map_err(|error| of_sweep(&error))?;
        let found = Sensitivity::of((&self.name, self.mode, identity.clone()), parameters, &records);
        let written = OutputDirectory::open(&folder).and_then(|output| found.write(&output));
        written.map_err(|error| of_results(&error))?;
        serde_json::to_string(&found).map(Some).map_err(|error| json(&error))
    }

    /// Makes some cases, for a sweep that is kept elsewhere; returns them as JSON.
    fn make(&self, py: Python<'_>, cases: Vec<u64>) -> PyResult<String> {
        let cases = cases.into_iter().collect();
        let made = interruptible(py, |stop| self.sweep.make_batch(&cases, stop))?;
        let made = made.map_err(|error| of_sweep(&error))?;
        serde_json::to_string(&made).map_err(|error| json(&error))
    }

    /// Opens or begins the sweep in a folder; returns the cases that it does not hold yet.
    fn open(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<u64>> {
        OutputDirectory::open(&folder).map_err(|error| of_results(&error))?;
        let journal = py
            .detach(|| self.sweep.journal(&folder))
            .map_err(|error| of_sweep(&error))?;
        let open = (1..=self.sweep.cases()).filter(|&case| !journal.has(case)).collect();
        *self.journal.lock().unwrap_or_else(PoisonError::into_inner) = Some((journal, folder));
        Ok(open)
    }

    /// Keeps a batch of cases, and writes its rows to `part`; a case that is held already is left out.
    fn keep(&self, py: Python<'_>, made: &str, part: PathBuf) -> PyResult<()> {
        let mut batch: Vec<Made> = serde_json::from_str(made).map_err(|error| json(&error))?;
        let kept = py.detach(|| {
            let mut journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
            let Some((journal, _)) = journal.as_mut() else {
                return Ok(());
            };
            batch.retain(|made| !journal.has(made.record.case));
            self.sweep.write_batch(&part, &batch)?;
            for made in batch {
                journal.add(made.record, &made.series)?;
            }
            journal.sync()
        });
        kept.map_err(|error| of_sweep(&error))
    }

    /// Writes the tables of all cases that are held, and closes the sweep; returns the summary as JSON.
    fn close(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let written = py.detach(|| {
            let mut journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
            let Some((mut journal, folder)) = journal.take() else {
                return Ok(None);
            };
            self.sweep.write(&mut journal, &folder).map(Some)
        });
        let summary = written.map_err(|error| of_sweep(&error))?;
        let text = summary.map(|summary| serde_json::to_string(&summary)).transpose();
        text.map_err(|error| json(&error))
    }
}
