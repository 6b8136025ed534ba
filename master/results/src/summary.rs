//! The summary of a run: what `summary.json` holds.

use component::{Percentiles, Share};
use scene::Assessment;
use serde::{Deserialize, Serialize};

use super::{Detail, Instrument, Measured, Record, SupportRecord, Wearing};
use crate::standards::{self, Conditions, Figures, Limit, SHORTEST_ARC};
use crate::statistics::{
    Filter, FilterError, ForceStatistics, long_loss_of_contact_percent, loss_of_contact_percent, peak_to_peak,
    sample_range,
};

/// Facts of a run besides its record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunInfo {
    /// Name of the scene.
    pub scene: String,
    /// Title of the scene.
    pub title: String,
    /// Source of the scene.
    pub source: String,
    /// `cosimulation`, `monolithic` or `inprocess`.
    pub mode: String,
    /// True where the run reached its end.
    pub complete: bool,
    /// Why it did not; empty for a complete run.
    pub incomplete_reason: String,
    /// Evaluation of the record.
    pub evaluation: Evaluation,
    /// Properties of the line that decide which limits apply.
    pub line: standards::Line,
    /// Editions and limits of the user's own.
    pub assessment: Assessment,
    /// Instruments of the heads; nothing is measured without them.
    pub instrument: Option<Instrument>,
    /// Current and wear; no current flows without.
    pub wear: Option<Wearing>,
    /// How the two sides were coupled.
    pub coupling: Coupling,
    /// The model.
    pub model: Model,
    /// Expected error.
    pub accuracy: Accuracy,
    /// Uncertainty by numbers of the scene that are not known for certain; empty where it is not known.
    pub uncertainty: Vec<Uncertainty>,
    /// Cost of the run.
    pub cost: Cost,
    /// Free remarks.
    pub notes: Vec<String>,
}

/// Range and filter of the evaluation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// First and last time of the evaluation range of each pantograph, s.
    #[serde(rename = "time_s")]
    pub time: Vec<(f64, f64)>,
    /// Cut-off frequency of the low-pass filter, Hz.
    pub low_pass_hz: f64,
    /// The filter.
    #[serde(default)]
    pub filter: Filter,
    /// Bands that the spread of the force is given for, Hz.
    #[serde(default)]
    pub bands_hz: Vec<[f64; 2]>,
    /// Time between two samples, s.
    #[serde(rename = "output_step_s")]
    pub output_step: f64,
    /// Running speed, m/s.
    #[serde(rename = "speed_m_per_s")]
    pub speed: f64,
}

/// How the two sides were coupled.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// Name of the algorithm; `none` where the run is one system.
    pub algorithm: String,
    /// Why this one.
    pub reason: String,
    /// Energy that the coupling added, J.
    #[serde(rename = "energy_residual_J")]
    pub energy_residual: Option<f64>,
    /// The same as a share of the work that crossed the contact, –; not in the file, notes say it where it matters.
    #[serde(skip)]
    pub energy_share: f64,
}

/// The model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Number of generalised coordinates.
    pub coordinates: usize,
    /// Number of constraint equations.
    pub constraints: usize,
    /// Number of finite elements.
    pub elements: usize,
    /// Reductions in use.
    pub reductions: Vec<String>,
    /// Parts, modelled or not.
    pub parts: Vec<Part>,
}

/// One part of the system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// `catenary`, `pantograph`, `vehicle`, `wheel_rail`, `track`, `wind_pantograph`, `wind_wires`.
    pub part: String,
    /// True where the part is modelled.
    pub modelled: bool,
    /// Why, or how.
    pub reason: String,
}

/// Expected error of the filtered contact force, in percent of its standard deviation, cause by cause.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// `run.accuracy_percent`, where it is given.
    pub asked_percent: Option<f64>,
    /// Sum of the shares; none where no rule is known.
    pub expected_percent: Option<f64>,
    /// Shares by cause.
    pub shares: Vec<ErrorShare>,
    /// Why no rule is known; empty where one is.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub without_rule: String,
    /// Cost of the nonlinear whole line beside that of the line as it is reduced, on the same mesh and step, –.
    pub cost_of_whole_line: Option<f64>,
}

/// Uncertainty of a figure by numbers of the scene that are not known for certain, from a sensitivity analysis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// Pantograph, from 1.
    pub pantograph: usize,
    /// `std`, `mean`, `max`, `min`, `loss` or `uplift`.
    pub figure: String,
    /// Unit.
    pub unit: String,
    /// Change downward that all numbers make together.
    pub below: f64,
    /// Change upward.
    pub above: f64,
    /// Keys with the largest effects.
    pub largest: Vec<String>,
}

/// One share of an expected error.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorShare {
    /// `mesh`, `step`, a reduction, `newton_tolerance` or `coupling`.
    pub cause: String,
    /// %.
    pub percent: f64,
}

/// Cost of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Wall time of the time loop, s.
    pub wall_s: f64,
    /// Wall time of statics and loading, s.
    pub setup_s: f64,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// `wall_s / simulated_s`, –; below 1 is faster than real time.
    pub real_time_factor: Option<f64>,
    /// Macro steps.
    pub macro_steps: u64,
    /// Micro steps.
    pub micro_steps: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Factorisations of an iteration matrix.
    pub factorizations: u64,
    /// Steps that were taken back.
    pub rollbacks: u64,
    /// Macro steps that were refused for their error, and repeated shorter.
    #[serde(default)]
    pub refused_steps: u64,
    /// Shortest, longest and mean macro step, s; the last one, which ends at the duration, is not among the shortest.
    #[serde(default)]
    pub smallest_macro_step_s: Option<f64>,
    /// See above.
    #[serde(default)]
    pub largest_macro_step_s: Option<f64>,
    /// See above.
    #[serde(default)]
    pub mean_macro_step_s: Option<f64>,
    /// Wall times of macro steps.
    #[serde(default)]
    pub step_times: Percentiles,
    /// Shares of `wall_s`; empty where they were not measured.
    #[serde(default)]
    pub shares: Vec<Share>,
}

/// The summary of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Title of the scene.
    #[serde(default)]
    pub title: String,
    /// Source of the scene.
    #[serde(default)]
    pub source: String,
    /// `cosimulation`, `monolithic` or `inprocess`.
    pub mode: String,
    /// True where the run reached its end.
    pub complete: bool,
    /// Why it did not.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub incomplete_reason: String,
    /// Evaluation of the record.
    pub evaluation: Evaluation,
    /// Figures of each pantograph.
    pub pantographs: Vec<PantographSummary>,
    /// Uplift of the line.
    pub uplift: Uplift,
    /// How the two sides were coupled.
    pub coupling: Coupling,
    /// Limits of standards.
    pub limits: Vec<Limit>,
    /// The model.
    pub model: Model,
    /// Expected error.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Uncertainty by numbers of the scene that are not known for certain.
    #[serde(default)]
    pub uncertainty: Vec<Uncertainty>,
    /// Cost of the run.
    pub cost: Cost,
    /// Instruments of the heads; absent where nothing is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instrument: Option<Instrument>,
    /// Current, arcs and wear of the passage; absent where no current is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wear: Option<wear::Train>,
    /// Free remarks.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// Figures of one pantograph.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PantographSummary {
    /// Contact force over the evaluation range, the sum over the strips of a head.
    pub contact_force: ContactForceSummary,
    /// Motion of the collector strip; of a head with several, of the mean of their heights.
    pub strip: StripSummary,
    /// Contact force of each strip of a head with several; empty for one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub strips: Vec<ContactForceSummary>,
    /// The same force in detail.
    #[serde(default)]
    pub detail: Detail,
    /// The force as instruments measure it; absent where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Measured>,
}

/// Contact force over the evaluation range; `null` where the run ended before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactForceSummary {
    /// After the low-pass filter, N.
    pub filtered: Option<ForceStatistics>,
    /// As recorded, N.
    pub raw: Option<ForceStatistics>,
    /// Share of the evaluation time with zero raw force, %.
    pub loss_of_contact_percent: Option<f64>,
}

/// Motion of the collector strip over the evaluation range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StripSummary {
    /// Largest minus smallest height, m.
    #[serde(rename = "vertical_amplitude_m")]
    pub vertical_amplitude: Option<f64>,
}

/// Uplift of the line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Uplift {
    /// Largest rise at the supports that bound the evaluated spans, whole run, m.
    #[serde(rename = "max_at_support_m")]
    pub max_at_support: Option<f64>,
    /// Largest rise at each of these supports.
    #[serde(default)]
    pub supports: Vec<SupportUplift>,
}

/// Uplift at one support, whole run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SupportUplift {
    /// Number of the support, from 1.
    pub number: usize,
    /// Place along the track, m; absent where the line is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Largest rise, m; absent where it is not a number.
    pub max_m: Option<f64>,
    /// Time of it, s.
    pub time_s: Option<f64>,
}

impl Summary {
    /// Evaluates `record`.
    ///
    /// A quantity that cannot be given is `None`, and a note says why: the run ended before the
    /// evaluation range, or a sample is not a number. Limits are decided for complete runs only.
    #[must_use]
    pub fn new(info: &RunInfo, record: &Record) -> Self {
        let detail = |index: usize, filtered: &[f64]| {
            let (evaluation, time) = (&info.evaluation, &record.time);
            let strip = &record.pantographs[index];
            let range = evaluation.samples(time, index);
            let measured = (info.instrument.as_ref())
                .and_then(|instrument| instrument.figures((index, strip), filtered, evaluation, time));
            let detail = Detail::of((strip, filtered), &range, evaluation, (time, &record.line));
            (detail, measured)
        };
        Self::with(info, record, detail)
    }

    /// As [`Summary::new`] without [`Detail`] and [`Measured`], which take several filters: for one of many runs, of
    /// which nobody opens a page.
    #[must_use]
    pub fn without_detail(info: &RunInfo, record: &Record) -> Self {
        Self::with(info, record, |_, _| (Detail::default(), None))
    }

    /// The summary with the detail and the measured force of each pantograph (from 0) by its filtered force.
    fn with(info: &RunInfo, record: &Record, in_detail: impl Fn(usize, &[f64]) -> (Detail, Option<Measured>)) -> Self {
        let mut notes = info.notes.clone();
        let mut figures = Vec::new();
        let mut pantographs = Vec::new();
        for (i, strip) in record.pantographs.iter().enumerate() {
            let range = info.evaluation.samples(&record.time, i);
            let raw = strip.force.get(range.clone()).unwrap_or_default();
            let force = info.evaluation.filtered(&strip.force).unwrap_or_else(|error| {
                notes.push(format!("pantograph {}: no filtered force: {error}", i + 1));
                Vec::new()
            });
            let filtered = force.get(range.clone()).and_then(ForceStatistics::of);
            if range.is_empty() {
                notes.push(format!("pantograph {}: the evaluation range holds no sample", i + 1));
            } else if strip.force.iter().any(|f| !f.is_finite()) {
                // The filter runs over the whole record and carries the defect everywhere.
                notes.push(format!("pantograph {}: the contact force is not finite", i + 1));
            }
            let (detail, measured) = in_detail(i, &force);
            let summary = PantographSummary {
                contact_force: ContactForceSummary {
                    filtered,
                    raw: ForceStatistics::of(raw),
                    loss_of_contact_percent: loss_of_contact_percent(raw),
                },
                strip: StripSummary {
                    vertical_amplitude: strip.strip_z.get(range.clone()).and_then(peak_to_peak),
                },
                strips: (strip.strips.iter())
                    .map(|strip| {
                        let raw = strip.force.get(range.clone()).unwrap_or_default();
                        let filtered = info.evaluation.filtered(&strip.force).ok();
                        ContactForceSummary {
                            filtered: filtered.and_then(|force| force.get(range.clone()).and_then(ForceStatistics::of)),
                            raw: ForceStatistics::of(raw),
                            loss_of_contact_percent: loss_of_contact_percent(raw),
                        }
                    })
                    .collect(),
                detail,
                measured,
            };
            let (from, to) = info.evaluation.time.get(i).copied().unwrap_or_default();
            figures.push(Figures {
                force: filtered,
                vertical_amplitude: summary.strip.vertical_amplitude,
                loss_of_contact: summary.contact_force.loss_of_contact_percent,
                arcing: long_loss_of_contact_percent(
                    &strip.force,
                    range.clone(),
                    info.evaluation.output_step,
                    SHORTEST_ARC,
                ),
                section: info.evaluation.speed * (to - from),
                longest_span: strip.contact_x.get(range).and_then(|x| record.line.longest_span(x)),
            });
            pantographs.push(summary);
        }
        let samples = || record.supports.iter().flat_map(|s| &s.uplift).copied();
        let max_at_support = if samples().any(|u| !u.is_finite()) {
            notes.push("the uplift at a support is not finite".to_owned());
            None
        } else {
            samples().reduce(f64::max)
        };
        let conditions = Conditions {
            line: info.line,
            speed: info.evaluation.speed,
            low_pass_hz: info.evaluation.low_pass_hz,
            filter: info.evaluation.filter,
            output_step: info.evaluation.output_step,
            uplift: max_at_support,
        };
        let mut limits = standards::limits(&conditions, &figures, &info.assessment);
        set_tolerances(&mut limits, &info.accuracy, &pantographs);
        if !info.complete {
            for limit in &mut limits {
                limit.pass = None;
            }
        }
        notes.extend(crate::undecided::take_back(&mut limits, &info.evaluation, record));
        Self {
            scene: info.scene.clone(),
            title: info.title.clone(),
            source: info.source.clone(),
            mode: info.mode.clone(),
            complete: info.complete,
            incomplete_reason: info.incomplete_reason.clone(),
            evaluation: info.evaluation.clone(),
            pantographs,
            uplift: Uplift {
                max_at_support,
                supports: record
                    .supports
                    .iter()
                    .map(|support| SupportUplift::of(support, record))
                    .collect(),
            },
            coupling: info.coupling.clone(),
            limits,
            model: info.model.clone(),
            accuracy: info.accuracy.clone(),
            uncertainty: info.uncertainty.clone(),
            cost: info.cost.clone(),
            instrument: info.instrument.clone(),
            wear: info.wear.as_ref().map(|wear| wear.train(&info.evaluation, record)),
            notes,
        }
    }

    /// Uncertainty of a figure of a pantograph (from 1), where it is known.
    #[must_use]
    pub fn uncertainty_of(&self, pantograph: usize, figure: &str) -> Option<&Uncertainty> {
        let of = |known: &&Uncertainty| known.pantograph == pantograph && known.figure == figure;
        self.uncertainty.iter().find(of)
    }

    /// Name of the run in legends: scene and mode.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{} ({})", self.scene, self.mode)
    }
}

/// Errors of extremes by the rms error: that of a normal error which one sample in some hundred exceeds, –.
const EXTREMES: f64 = 3.0;

/// Gives limits of the force the numerical uncertainty of their values: the expected error is the rms of the
/// difference in percent of σ, which neither the mean nor σ can differ by more than.
fn set_tolerances(limits: &mut [Limit], accuracy: &Accuracy, pantographs: &[PantographSummary]) {
    let Some(percent) = accuracy.expected_percent else {
        return;
    };
    for limit in limits {
        let of = limit.pantograph.and_then(|number| pantographs.get(number - 1));
        let std = of
            .and_then(|pantograph| pantograph.contact_force.filtered)
            .map(|force| force.std);
        let times = match limit.quantity.as_str() {
            "mean" | "mean_lower" | "std" => 1.0,
            "max" | "min" => EXTREMES,
            _ => continue,
        };
        limit.tolerance = std.map(|std| times * percent / 100.0 * std);
    }
}

impl Evaluation {
    /// Indices of the samples of `time` (s) inside the evaluation range of pantograph `i` (from 0).
    #[must_use]
    pub fn samples(&self, time: &[f64], i: usize) -> std::ops::Range<usize> {
        self.time
            .get(i)
            .map_or(0..0, |(from, to)| sample_range(time, *from, *to))
    }

    /// Low-pass filtered `force`, N, whole record.
    ///
    /// # Errors
    ///
    /// [`FilterError`] where the record is too short or the cut-off frequency not possible.
    pub fn filtered(&self, force: &[f64]) -> Result<Vec<f64>, FilterError> {
        self.filtered_by(self.filter, force)
    }

    /// Low-pass filtered `force` of pantograph `i` (from 0) inside its evaluation range, N; `None` where it cannot be
    /// filtered, or the range reaches beyond it.
    #[must_use]
    pub fn evaluated(&self, time: &[f64], i: usize, force: &[f64]) -> Option<Vec<f64>> {
        let filtered = self.filtered(force).ok()?;
        filtered.get(self.samples(time, i)).map(<[f64]>::to_vec)
    }

    /// [`Evaluation::filtered`] by another filter.
    pub(super) fn filtered_by(&self, filter: Filter, force: &[f64]) -> Result<Vec<f64>, FilterError> {
        filter.design(self.low_pass_hz, self.output_step)?.filter(force)
    }
}

impl SupportUplift {
    fn of(support: &SupportRecord, record: &Record) -> Self {
        let samples = support.uplift.iter().zip(&record.time);
        let finite = support.uplift.iter().all(|uplift| uplift.is_finite());
        let highest = samples.max_by(|a, b| a.0.total_cmp(b.0)).filter(|_| finite);
        Self {
            number: support.number,
            x_m: record.line.support_x.get(support.number.wrapping_sub(1)).copied(),
            max_m: highest.map(|(uplift, _)| *uplift),
            time_s: highest.map(|(_, time)| *time),
        }
    }
}
