//! Runs of the cases in every mode, and what they show.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use component::Progress;
use experiments::engine::Machine;
use experiments::engine::store::{by_content, digest, program};
use results::{ErrorShare, Record as Series, Summary};
use scene::Files;
use serde::Serialize;
use simulation::{FmuSource, Mode, prepare};
use system::run::Watch;

use crate::model::{Case, Figure, ReferenceModel, ValidationError};

/// Modes of the runs; the first one is what the others are compared with.
const MODES: [Mode; 3] = [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation];

/// A validation that can be kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// Standard and edition.
    pub standard: String,
    /// Source of the ranges.
    pub source: String,
    /// True where every figure lies in its range in every mode.
    pub pass: bool,
    /// Version of the program.
    pub version: String,
    /// Hash of the program, SHA-256.
    pub program: String,
    /// Hash of the file of the model, SHA-256.
    pub model: String,
    /// Machine.
    pub machine: Machine,
    /// Date, UTC.
    pub date: String,
    /// Cases.
    pub cases: Vec<Run>,
}

/// Runs of a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// Name of the case.
    pub name: String,
    /// Scene file as the model names it.
    pub scene: String,
    /// Hash of the resolved scene, SHA-256.
    pub scene_hash: String,
    /// Figures with their ranges.
    pub figures: Vec<Found>,
    /// Expected numerical error of the filtered force, % of its standard deviation; absent where no rule is known.
    pub expected_error_percent: Option<f64>,
    /// Its causes.
    pub error_shares: Vec<ErrorShare>,
    /// Differences of coupled runs from that as one system.
    pub coupling: Vec<Differences>,
}

/// A figure with its range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The figure.
    pub figure: Figure,
    /// Unit.
    pub unit: &'static str,
    /// Least value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Value in each mode.
    pub values: Vec<ModeFigures>,
    /// True where all lie in the range.
    pub pass: bool,
}

/// Value in a mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeFigures {
    /// Mode.
    pub mode: &'static str,
    /// Value; absent where the run has none.
    pub value: Option<f64>,
}

/// Difference of a coupled run from that as one system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differences {
    /// Mode.
    pub mode: &'static str,
    /// Root mean square of the difference of the filtered forces, % of the standard deviation.
    pub filtered_percent: Option<f64>,
}

/// Surroundings of a validation.
pub struct Surroundings<'a> {
    /// Folder that scenes of the model are relative to.
    pub folder: &'a Path,
    /// Folder for packages of FMUs.
    pub fmus: PathBuf,
    /// Set where the user wants an end.
    pub interrupted: &'a AtomicBool,
    /// Bar.
    pub progress: &'a dyn Progress,
    /// Date, UTC.
    pub date: String,
}

/// Runs every case of `model`, whose file has this `text`, in every mode.
///
/// # Errors
/// [`ValidationError`].
pub fn record(model: &ReferenceModel, text: &str, around: &Surroundings<'_>) -> Result<Record, ValidationError> {
    let cases = model
        .cases
        .iter()
        .map(|case| run(case, around))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(Record {
        standard: model.standard.clone(),
        source: model.source.clone(),
        pass: cases.iter().flat_map(|run| &run.figures).all(|found| found.pass),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        program: program().to_owned(),
        model: digest(&[text.as_bytes()]),
        machine: Machine::this(),
        date: around.date.clone(),
        cases,
    })
}

/// Runs a case in every mode.
fn run(case: &Case, around: &Surroundings<'_>) -> Result<Run, ValidationError> {
    let mut hash = String::new();
    let mut made: Vec<(Mode, Summary, Series)> = Vec::new();
    for mode in MODES {
        let failed = |source: Box<dyn std::error::Error + Send + Sync>| ValidationError::Run {
            case: case.name.clone(),
            mode: mode.name(),
            source,
        };
        let path = around.folder.join(&case.scene);
        let origin = case.scene.display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|source| failed(format!("{origin}: {source}").into()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let files = Files::new(|path| std::fs::read_to_string(folder.join(path)).map_err(|error| error.to_string()));
        let scene = system::load_with(&text, &origin, &[], &files).map_err(|error| failed(error.into()))?;
        hash = digest(&[by_content(&scene, folder).to_toml().as_bytes()]);
        let name = simulation::paths::scene_name(&path);
        let mut prepared = prepare(scene, &name, folder, false).map_err(|error| failed(error.into()))?;
        prepared.pictures = false;
        let source = FmuSource {
            folder: around.fmus.join(&name),
            logging: false,
        };
        let watch = Watch::new(around.interrupted, around.progress);
        let finished = prepared.run(mode, &source, &watch, |_| Ok::<(), simulation::SetupError>(()));
        let finished = finished.map_err(|error| failed(error.into()))?;
        if let Some(failure) = finished.failure {
            let (case, reason) = (case.name.clone(), failure.to_string());
            return Err(ValidationError::Ended { case, reason });
        }
        made.push((mode, Summary::new(&finished.info, &finished.record), finished.record));
    }
    let figures = case
        .ranges
        .iter()
        .map(|(figure, range)| found(*figure, *range, case.pantograph, &made));
    let (_, first, _) = &made[0];
    Ok(Run {
        name: case.name.clone(),
        scene: case.scene.display().to_string(),
        scene_hash: hash,
        figures: figures.collect(),
        expected_error_percent: first.accuracy.expected_percent,
        error_shares: first.accuracy.shares.clone(),
        coupling: made[1..]
            .iter()
            .map(|(mode, summary, series)| Differences {
                mode: mode.name(),
                filtered_percent: difference((&made[0].1, &made[0].2), (summary, series), case.pantograph),
            })
            .collect(),
    })
}

fn found(figure: Figure, (low, high): (f64, f64), pantograph: usize, made: &[(Mode, Summary, Series)]) -> Found {
    let values: Vec<ModeFigures> = made
        .iter()
        .map(|(mode, summary, _)| ModeFigures {
            mode: mode.name(),
            value: figure.of(summary, pantograph),
        })
        .collect();
    let inside = |value: &ModeFigures| value.value.is_some_and(|value| (low..=high).contains(&value));
    Found {
        figure,
        unit: figure.unit(),
        low,
        high,
        pass: values.iter().all(inside),
        values,
    }
}

/// Root mean square of the difference of two filtered forces over the evaluation range, % of the standard deviation of
/// the first.
fn difference(first: (&Summary, &Series), other: (&Summary, &Series), pantograph: usize) -> Option<f64> {
    let index = pantograph.checked_sub(1)?;
    let filtered = |(summary, series): (&Summary, &Series)| {
        let force = &series.pantographs.get(index)?.force;
        let range = summary.evaluation.samples(&series.time, index);
        let filtered = summary.evaluation.filtered(force).ok()?;
        Some(filtered.get(range)?.to_vec())
    };
    let (first_force, other_force) = (filtered(first)?, filtered(other)?);
    let std = Figure::Std.of(first.0, pantograph).filter(|std| *std > 0.0)?;
    if first_force.len() != other_force.len() || first_force.is_empty() {
        return None;
    }
    let squares: f64 = first_force.iter().zip(&other_force).map(|(a, b)| (a - b).powi(2)).sum();
    Some(100.0 * (squares / first_force.len() as f64).sqrt() / std)
}

impl Record {
    /// The result in words, for the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let verdict = if self.pass {
            "every figure lies in its range"
        } else {
            "figures lie outside of their ranges"
        };
        let mut text = format!("{}: {verdict}\n", self.standard);
        for case in &self.cases {
            text.push_str(&format!("\n{}, {}\n", case.name, case.scene));
            for found in &case.figures {
                let values = found.values.iter().map(|value| {
                    value.value.map_or_else(
                        || format!("{} –", value.mode),
                        |number| format!("{} {number:.2}", value.mode),
                    )
                });
                text.push_str(&format!(
                    "  {:<24} {:<52} {} to {} {}  {}\n",
                    found.figure.name(),
                    values.collect::<Vec<_>>().join(", "),
                    found.low,
                    found.high,
                    found.unit,
                    if found.pass { "pass" } else { "FAIL" }
                ));
            }
            if let Some(percent) = case.expected_error_percent {
                text.push_str(&format!(
                    "  expected numerical error {percent:.2} % of the standard deviation\n"
                ));
            }
            for other in &case.coupling {
                if let Some(percent) = other.filtered_percent {
                    text.push_str(&format!("  {} against one system: {percent:.4} %\n", other.mode));
                }
            }
        }
        text
    }
}
