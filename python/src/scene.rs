//! A scene with the keys set in it.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use ::scene::{KeyText, Mark, Place, Problem, Scene, What, described_keys, key_steps};
use pyo3::prelude::*;
use simulation::check::Report;
use simulation::paths::scene_name;
use simulation::{FmuSource, Mode, Prepared, SetupError, prepare};
use sweep::Base;
use sweep::sensitivity::Parameter;
use system::run::Watch;

use crate::error::{RunError, SceneError, meant, of_scene, of_setup, of_sweep};
use crate::interruption::interruptible;
use crate::result::RunResult;
use crate::value::{Found, find, to_python};

/// Text of a scene with overrides, from which a run is made as by the program; never changed.
#[pyclass(frozen, module = "pantoline._pantoline")]
pub struct SceneSource {
    pub(crate) name: String,
    pub(crate) origin: String,
    pub(crate) folder: PathBuf,
    pub(crate) text: String,
    pub(crate) overrides: Vec<String>,
}

/// A mode by its word.
///
/// # Errors
/// Words that there are.
pub fn mode(word: &str) -> PyResult<Mode> {
    let modes = [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation];
    let found = modes.into_iter().find(|mode| mode.name() == word);
    found.ok_or_else(|| {
        let text = format!("mode = \"{word}\": must be one of monolithic, inprocess, cosimulation");
        SceneError::new_err(text)
    })
}

/// Key, value, least, most, distribution and origin of a number.
type ParameterRow = (String, f64, f64, f64, Option<String>, Option<&'static str>);

/// Numbers of a scene that have ranges, and those of `ranges`; those of `keys` alone, where there are any.
///
/// # Errors
/// See [`Parameter::of`] and [`Parameter::chosen`].
pub fn parameters(
    base: &Base,
    ranges: &[String],
    keys: Option<&[String]>,
) -> Result<Vec<Parameter>, ::sweep::SweepError> {
    let all = Parameter::of(base, ranges)?;
    match keys {
        Some(keys) => Parameter::chosen(all, keys),
        None => Ok(all),
    }
}

impl SceneSource {
    /// The scene for the cases of a sweep.
    pub fn base(&self) -> Base {
        let (name, origin) = (&self.name, &self.origin);
        Base::new(name, origin, &self.folder, self.text.clone(), self.overrides.clone())
    }

    fn resolve(&self) -> PyResult<Scene> {
        self.base().scene(&[]).map_err(|error| of_scene(&error))
    }

    /// The scene with its statics solved.
    pub fn prepared(&self, scene: Scene) -> Result<Prepared, SetupError> {
        prepare(scene, &self.name, &self.folder, false)
    }

    /// The resolved scene as a table; values that contradict each other leave it as it is read, with their refusal.
    fn table(&self) -> PyResult<(toml::Value, PyResult<()>)> {
        let (scene, resolved) = match self.resolve() {
            Ok(scene) => (scene, Ok(())),
            Err(refused) => (self.base().read(&[]).map_err(|error| of_scene(&error))?, Err(refused)),
        };
        let table = scene.to_toml().parse().unwrap_or_default();
        Ok((toml::Value::Table(table), resolved))
    }

    /// Refusal of a text that is no path of a key.
    fn no_path(&self, key: &str) -> PyErr {
        let known: Vec<String> = described_keys().iter().map(KeyText::path).collect();
        let meant = meant(key, known.iter().map(String::as_str));
        let form = "must be a path such as run.speed_kmh or pantograph[1].static_force";
        SceneError::new_err(format!("{}: \"{key}\": is no key{meant}; {form}", self.origin))
    }

    /// Refusal of a key that the resolved scene does not have; nothing for a key that is known and left out.
    fn refusal(&self, key: &str, no_entry: bool) -> Option<PyErr> {
        let refused = self.base().read(&[format!("{key}=0")]).err()?;
        let own = |problem: &&Problem| {
            let unknown = matches!(
                problem.what,
                What::UnknownKey { .. } | What::Renamed { .. } | What::Syntax { .. }
            );
            matches!(problem.place, Place::Override(..)) && (unknown || no_entry)
        };
        let problem = refused.problems.iter().find(own)?;
        let place = Place::File(self.origin.clone());
        let problem = Problem {
            place,
            ..problem.clone()
        };
        Some(SceneError::new_err(problem.to_string()))
    }
}

#[pymethods]
impl SceneSource {
    /// A scene from its text; `file` is its name in messages, and names of files in it are relative to its folder.
    #[new]
    fn new(text: String, file: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let source = Self {
            name: scene_name(&file),
            origin: file.display().to_string(),
            folder: file.parent().unwrap_or(Path::new("")).to_owned(),
            text,
            overrides,
        };
        source.base().read(&[]).map_err(|error| of_scene(&error))?;
        Ok(source)
    }

    /// Name in results.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The file in messages.
    #[getter]
    fn origin(&self) -> &str {
        &self.origin
    }

    /// Text as read.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Keys set, `key=value`.
    #[getter]
    fn overrides(&self) -> Vec<String> {
        self.overrides.clone()
    }

    /// The scene with keys set, each checked as `--set` checks them.
    fn with_keys(&self, keys: Vec<(String, String)>) -> PyResult<Self> {
        let mut overrides = self.overrides.clone();
        for (key, value) in keys {
            if key_steps(&key).is_none() {
                return Err(self.no_path(&key));
            }
            let begin = format!("{}=", key.trim());
            overrides.retain(|set| !set.starts_with(&begin));
            overrides.push(format!("{begin}{value}"));
        }
        Self::new(self.text.clone(), PathBuf::from(&self.origin), overrides)
    }

    /// Value of a key in the resolved scene; `None` for a known key that is left out.
    fn value<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let (table, resolved) = self.table()?;
        let found = find(&table, key);
        // A key that there is not is refused before values that contradict each other.
        let refused = match found {
            Found::Value(_) => None,
            Found::NoPath => Some(self.no_path(key)),
            Found::NoKey => self.refusal(key, false),
            Found::NoEntry => Some(
                self.refusal(key, true)
                    .unwrap_or_else(|| SceneError::new_err(format!("{}: {key}: has no such entry", self.origin))),
            ),
        };
        if let Some(refused) = refused {
            return Err(refused);
        }
        resolved?;
        match found {
            Found::Value(value) => to_python(py, value),
            _ => Ok(py.None().into_bound(py)),
        }
    }

    /// `true` for a key that has a value in the resolved scene; where values contradict each other, in the scene as
    /// read.
    fn has(&self, key: &str) -> PyResult<bool> {
        Ok(matches!(find(&self.table()?.0, key), Found::Value(_)))
    }

    /// Numbers with the ranges that they may have: key, value, least, most, distribution, origin; `ranges` as behind
    /// `--range`. Those of `keys` alone, where there are any.
    fn parameters(&self, ranges: Vec<String>, keys: Option<Vec<String>>) -> PyResult<Vec<ParameterRow>> {
        let found = parameters(&self.base(), &ranges, keys.as_deref()).map_err(|error| of_sweep(&error))?;
        let row = |parameter: Parameter| {
            let mark = parameter.mark.map(Mark::name);
            let distribution = parameter.distribution.map(|distribution| distribution.to_string());
            (
                parameter.key,
                parameter.value,
                parameter.low,
                parameter.high,
                distribution,
                mark,
            )
        };
        Ok(found.into_iter().map(row).collect())
    }

    /// The resolved scene as TOML.
    fn to_toml(&self) -> PyResult<String> {
        Ok(self.resolve()?.to_toml())
    }

    /// Statics, model and waves of the scene, as `master check --json` prints them.
    fn check(&self, py: Python<'_>) -> PyResult<String> {
        let scene = self.resolve()?;
        let report = interruptible(py, |_| self.prepared(scene).and_then(|prepared| Report::of(&prepared)))?;
        let report = report.map_err(|error| of_setup(&error, &self.origin))?;
        serde_json::to_string(&report).map_err(|error| RunError::new_err(error.to_string()))
    }

    /// Runs the scene.
    fn run(&self, py: Python<'_>, mode: &str, pictures: bool) -> PyResult<RunResult> {
        let (scene, mode) = (self.resolve()?, self::mode(mode)?);
        let made = interruptible(py, |stop| self.made(scene, mode, pictures, stop))?;
        made.map_err(|error| of_setup(&error, &self.origin))
    }
}

impl SceneSource {
    fn made(&self, scene: Scene, mode: Mode, pictures: bool, stop: &AtomicBool) -> Result<RunResult, SetupError> {
        let mut prepared = self.prepared(scene)?;
        prepared.pictures = pictures;
        let droppers = prepared.statics.as_ref().map(|line| line.report().droppers.clone());
        let packages = tempfile::tempdir().unwrap_or_else(|error| panic!("no folder for temporary files: {error}"));
        let source = FmuSource {
            folder: packages.path().to_owned(),
            logging: false,
        };
        let mut resolved = None;
        let finished = prepared.run(mode, &source, &Watch::new(stop, &()), |scene| {
            resolved = Some(scene.clone());
            Ok::<(), SetupError>(())
        })?;
        let scene = resolved.expect("a run that ended has begun");
        let droppers = serde_json::to_string(&droppers.unwrap_or_default()).unwrap_or_default();
        Ok(RunResult::new(scene, finished, droppers))
    }
}
