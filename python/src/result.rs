//! A run that has ended.

use std::path::PathBuf;

use ::scene::Scene;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use results::report::{render, table};
use results::{OutputDirectory, Record, RunBundle, RunInfo, Summary};
use simulation::Finished;
use simulation::paths::relative_to;

use crate::error::{RunError, of_name, of_results};
use crate::value::bytes;

/// Record and figures of a run; never changed.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct RunResult {
    scene: Scene,
    info: RunInfo,
    record: Record,
    summary: Summary,
    droppers: String,
}

impl RunResult {
    /// A finished run of a resolved scene; `droppers` are those of the line at rest, as JSON.
    pub fn new(scene: Scene, finished: Finished, droppers: String) -> Self {
        let Finished { info, record, .. } = finished;
        Self {
            scene,
            summary: Summary::new(&info, &record),
            info,
            record,
            droppers,
        }
    }

    fn bundle(&self) -> RunBundle {
        RunBundle {
            summary: self.summary.clone(),
            record: self.record.clone(),
            scene: self.scene.to_toml(),
        }
    }
}

#[pymethods]
impl RunResult {
    /// Content of `summary.json`.
    fn summary(&self) -> PyResult<String> {
        serde_json::to_string(&self.summary).map_err(|error| RunError::new_err(error.to_string()))
    }

    /// Droppers of the line at rest, JSON.
    fn droppers(&self) -> &str {
        &self.droppers
    }

    /// The resolved scene.
    fn scene(&self) -> String {
        self.scene.to_toml()
    }

    /// The table that the program prints.
    fn table(&self) -> String {
        table(&self.summary)
    }

    /// Reason why the run is not complete; empty for a complete one.
    fn incomplete_reason(&self) -> &str {
        &self.info.incomplete_reason
    }

    /// Times, s, floats of 64 bits.
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyByteArray> {
        PyByteArray::new(py, &bytes(&self.record.time))
    }

    /// Names, units and descriptions of the series.
    fn names(&self) -> Vec<(String, &'static str, String)> {
        let series = self.record.series().into_iter();
        series
            .map(|series| (series.name, series.unit, series.description))
            .collect()
    }

    /// A series by its name.
    fn series<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyByteArray>> {
        let all = self.record.series();
        let series = all.iter().find(|series| series.name == name);
        let series = series.ok_or_else(|| of_name(name, all.iter().map(|series| &*series.name)))?;
        Ok(PyByteArray::new(py, &bytes(series.values)))
    }

    /// Filtered contact force of a pantograph (from 1) over the whole record, N.
    fn filtered<'py>(&self, py: Python<'py>, pantograph: i64) -> PyResult<Bound<'py, PyByteArray>> {
        let index = usize::try_from(pantograph)
            .ok()
            .and_then(|number| number.checked_sub(1));
        let strip = index
            .and_then(|index| self.record.pantographs.get(index))
            .ok_or_else(|| {
                let count = self.record.pantographs.len();
                PyIndexError::new_err(format!("pantograph {pantograph}: must be a number from 1 to {count}"))
            })?;
        let force = self.info.evaluation.filtered(&strip.force);
        let force = force.map_err(|error| RunError::new_err(error.to_string()))?;
        Ok(PyByteArray::new(py, &bytes(&force)))
    }

    /// Writes the files that `master run` writes.
    fn save(&self, py: Python<'_>, folder: PathBuf, report: bool, animation: bool) -> PyResult<()> {
        let saved = py.detach(|| {
            let mut output = OutputDirectory::open(&folder)?;
            if !animation {
                output = output.without_animation();
            }
            output.lock("a result that is saved from Python")?;
            let text = relative_to(&self.scene, &folder).to_toml();
            output.begin(&text)?;
            let bundle = output.finish(&self.info, self.record.clone(), &text)?;
            if report {
                output.write_report(&render(std::slice::from_ref(&bundle)))?;
            }
            Ok(())
        });
        saved.map_err(|error| of_results(&error))
    }

    /// The page `report.html`.
    fn report(&self, py: Python<'_>) -> String {
        py.detach(|| render(&[self.bundle()]))
    }
}
