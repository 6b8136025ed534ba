//! Runs of the cases in every mode, and what they show.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use component::Progress;
use results::Machine;
use results::report::verdict_word;
use results::statistics::rms_difference;
use results::{ErrorShare, Record as Series, Summary};
use scene::Files;
use serde::Serialize;
use simulation::identity::{by_content, digest, program};
use simulation::{FmuSource, Mode, StaticLines, prepare_on};
use system::run::Watch;

use crate::measured::Measured;
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
    /// True where every figure that has a range lies in it in every mode, and every measured one within its bound;
    /// absent where none has.
    pub pass: Option<bool>,
    /// Figures that no range is known for.
    pub without_range: usize,
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
    /// A measurement beside the run as one system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<Measured>,
}

/// A figure with its range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The figure.
    pub figure: Figure,
    /// Unit.
    pub unit: &'static str,
    /// Least value; absent where no range is known.
    pub low: Option<f64>,
    /// Largest value, likewise.
    pub high: Option<f64>,
    /// Value in each mode.
    pub values: Vec<ModeFigures>,
    /// True where all lie in the range; absent without one.
    pub pass: Option<bool>,
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
        pass: pass(&cases),
        without_range: cases
            .iter()
            .flat_map(|run| &run.figures)
            .filter(|found| found.pass.is_none())
            .count(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        program: program().to_owned(),
        model: digest(&[text.as_bytes()]),
        machine: Machine::this(),
        date: around.date.clone(),
        cases,
    })
}

/// Verdict on all cases; nothing where nothing is decided.
fn pass(cases: &[Run]) -> Option<bool> {
    let verdicts = cases.iter().flat_map(Run::verdicts);
    verdicts.flatten().reduce(|all, one| all && one)
}

/// Runs a case in every mode.
fn run(case: &Case, around: &Surroundings<'_>) -> Result<Run, ValidationError> {
    let origin = case.scene.display().to_string();
    let path = around.folder.join(&case.scene);
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = simulation::paths::scene_name(&path);
    let failed = |mode: Mode, source: Box<dyn std::error::Error + Send + Sync>| ValidationError::Run {
        case: case.name.clone(),
        mode: mode.name(),
        source,
    };
    let first = |source| failed(MODES[0], source);
    let text = std::fs::read_to_string(&path).map_err(|source| first(format!("{origin}: {source}").into()))?;
    let files = Files::new(|path| std::fs::read_to_string(folder.join(path)).map_err(|error| error.to_string()));
    let scene = system::load_with(&text, &origin, &[], &files).map_err(|error| first(error.into()))?;
    let heads = scene.pantographs.len();
    if case.pantograph > heads {
        return Err(ValidationError::Case {
            case: case.name.clone(),
            what: format!(
                "pantograph = {}: must be at most {heads}, as many as {origin} has",
                case.pantograph
            ),
        });
    }
    // All modes run on one static state.
    let lines = StaticLines::keeping(1);
    let mut made: Vec<(Mode, Summary, Series)> = Vec::new();
    for mode in MODES {
        let prepared = prepare_on(&lines, scene.clone(), &name, folder, false);
        let mut prepared = prepared.map_err(|error| failed(mode, error.into()))?;
        prepared.pictures = false;
        let source = FmuSource {
            folder: around.fmus.join(&name),
            logging: false,
        };
        let watch = Watch::new(around.interrupted, around.progress);
        let finished = prepared.run(mode, &source, &watch, |_| Ok::<(), simulation::SetupError>(()));
        let finished = finished.map_err(|error| failed(mode, error.into()))?;
        if let Some(failure) = finished.failure {
            let (case, reason) = (case.name.clone(), failure.to_string());
            return Err(ValidationError::Ended { case, reason });
        }
        made.push((
            mode,
            Summary::without_detail(&finished.info, &finished.record),
            finished.record,
        ));
    }
    let (_, summary, series) = &made[0];
    let measured = case.measured.as_ref().map(|files| {
        let beside = files.beside(around.folder, (summary, series), case.pantograph.saturating_sub(1));
        beside.map_err(|what| ValidationError::Case {
            case: case.name.clone(),
            what,
        })
    });
    let ranges = case.ranges.iter().map(|(figure, range)| (*figure, Some(*range)));
    let figures = ranges.chain(case.figures.iter().map(|figure| (*figure, None)));
    let figures = figures.map(|(figure, range)| found(figure, range, case.pantograph, &made));
    Ok(Run {
        name: case.name.clone(),
        scene: origin.clone(),
        scene_hash: digest(&[by_content(&scene, folder).to_toml().as_bytes()]),
        figures: figures.collect(),
        expected_error_percent: summary.accuracy.expected_percent,
        error_shares: summary.accuracy.shares.clone(),
        coupling: made[1..]
            .iter()
            .map(|(mode, summary, series)| Differences {
                mode: mode.name(),
                filtered_percent: difference((&made[0].1, &made[0].2), (summary, series), case.pantograph),
            })
            .collect(),
        measured: measured.transpose()?,
    })
}

fn found(figure: Figure, range: Option<(f64, f64)>, pantograph: usize, made: &[(Mode, Summary, Series)]) -> Found {
    let values: Vec<ModeFigures> = made
        .iter()
        .map(|(mode, summary, _)| ModeFigures {
            mode: mode.name(),
            value: figure.of(summary, pantograph),
        })
        .collect();
    let inside = |(low, high): (f64, f64)| {
        let inside = |value: &ModeFigures| value.value.is_some_and(|value| (low..=high).contains(&value));
        values.iter().all(inside)
    };
    Found {
        figure,
        unit: figure.unit(),
        low: range.map(|(low, _)| low),
        high: range.map(|(_, high)| high),
        pass: range.map(inside),
        values,
    }
}

/// Root mean square of the difference of two filtered forces over the evaluation range, % of the standard deviation of
/// the first.
fn difference(first: (&Summary, &Series), other: (&Summary, &Series), pantograph: usize) -> Option<f64> {
    let index = pantograph.checked_sub(1)?;
    let filtered = |(summary, series): (&Summary, &Series)| {
        let force = &series.pantographs.get(index)?.force;
        summary.evaluation.evaluated(&series.time, index, force)
    };
    let (first_force, other_force) = (filtered(first)?, filtered(other)?);
    let std = Figure::Std.of(first.0, pantograph).filter(|std| *std > 0.0)?;
    Some(100.0 * rms_difference(&first_force, &other_force)? / std)
}

impl Run {
    /// Verdicts on figures and measured figures.
    fn verdicts(&self) -> impl Iterator<Item = Option<bool>> + '_ {
        let measured = self.measured.iter().flat_map(|measured| &measured.figures);
        let figures = self.figures.iter().map(|found| found.pass);
        figures.chain(measured.map(|compared| compared.pass))
    }

    /// Figures outside of their ranges, and measured ones beyond their bounds.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.verdicts().filter(|pass| *pass == Some(false)).count()
    }
}

impl Record {
    /// The verdict in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let said = match self.pass {
            Some(false) => "figures lie outside of their ranges or bounds",
            Some(true) => "every figure that has a range or a bound lies within it",
            None => "nothing is decided",
        };
        match self.without_range {
            0 => said.to_owned(),
            1 => format!("{said}; no range is known for one figure"),
            count => format!("{said}; no range is known for {count} figures"),
        }
    }

    /// The result in words, for the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.standard, self.verdict());
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
                    "  {:<24} {:<52} {} {}  {}\n",
                    found.figure.name(),
                    values.collect::<Vec<_>>().join(", "),
                    found
                        .low
                        .zip(found.high)
                        .map_or_else(|| "–".to_owned(), |(low, high)| format!("{low} to {high}")),
                    found.unit,
                    verdict_word(found.pass)
                ));
            }
            for compared in case.measured.iter().flat_map(|measured| &measured.figures) {
                text.push_str(&format!(
                    "  {:<24} measured {:.2}, computed {:.2} {}, {} %{}  {}\n",
                    compared.quantity.name(),
                    compared.measured,
                    compared.computed,
                    compared.unit,
                    (compared.difference_percent).map_or_else(|| "–".to_owned(), |percent| format!("{percent:+.1}")),
                    compared
                        .bound_percent
                        .map_or_else(String::new, |bound| format!(" of ± {bound} %")),
                    verdict_word(compared.pass)
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
