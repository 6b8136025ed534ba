//! Limits of standards, held against the figures of one run.
//!
//! Every limit says where it is written, whether it applies to this run and why, and how sure its figure is: the texts
//! of the standards are not public, so each figure carries a [`Certainty`]. One that is only remembered is a band of
//! plausibility, not the standard.
//!
//! | standard | file | what it limits here |
//! | --- | --- | --- |
//! | EN 50367, TSI ENE | `en50367` | mean force by system and speed, σ, maximum, uplift, amplitude, arcing |
//! | EN 50119 | `en50119` | extremes of the force by system and speed, space for the uplift, speed against waves |
//! | EN 50317 | `en50317` | how the force is measured: band, sampling, section |
//! | any | `own` | limits that the user enters, `[assessment]`, in place of those above |
//!
//! Sources:
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois
//!   at Chicago, 2016; its section 4.2.3 quotes EN 50367:2006.
//! - `[EN 50367]` CENELEC, Railway applications – Current collection systems – Technical criteria for the interaction
//!   between pantograph and overhead line, 2012.
//! - `[EN 50119]` CENELEC, Railway applications – Fixed installations – Electric traction overhead contact lines, 2009.
//! - `[EN 50317]` CENELEC, Railway applications – Current collection systems – Requirements for and validation of
//!   measurements of the dynamic interaction between pantograph and overhead contact line, 2012.
//! - `[TSI ENE]` Commission Regulation (EU) No 1301/2014 on the energy subsystem: 4.2.9.2 lateral deviation, 4.2.11
//!   mean contact force, 4.2.12 dynamic behaviour and quality of current collection.
//! - `[Bane NOR]` Teknisk regelverk, book 540, chapter 6 (trv.banenor.no): TRV:00599 quotes EN 50119:2009, 5.2.4.
//! - `[OCS]` github.com/showhoo/ocs-calculators, `src/force/meta.ts`: quotes EN 50367, Table 6, and the curves of the
//!   TSI for DC.

mod en50119;
mod en50317;
mod en50367;
mod own;
#[cfg(test)]
mod own_tests;
#[cfg(test)]
mod tests;

pub use en50119::gradient_limit;
#[cfg(test)]
pub(crate) use own_tests::typed;
use scene::{Assessment, Electrification};
use serde::{Deserialize, Serialize};

use crate::statistics::{Filter, ForceStatistics};

/// One quantity held against its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Name of the standard.
    pub standard: String,
    /// Edition, by its year.
    #[serde(default)]
    pub edition: String,
    /// Edition, clause or table of it.
    #[serde(default)]
    pub clause: String,
    /// Limited quantity: `mean`, `mean_lower`, `std`, `max`, `min`, `uplift`, `free_uplift`, `vertical_amplitude`,
    /// `arcing`, `speed_ratio`, `band`, `sampling_rate`, `control_section`.
    pub quantity: String,
    /// Pantograph, numbered from 1; absent where the quantity belongs to the line or to the evaluation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pantograph: Option<usize>,
    /// Value of the run in `unit`; `null` where it is not known.
    pub value: Option<f64>,
    /// How `value` has to stand to `limit`.
    #[serde(default)]
    pub bound: Bound,
    /// The limit, in `unit`; `null` where it depends on an unknown value or does not apply.
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`.
    pub unit: String,
    /// True where the limit holds; `null` where this was not decided.
    pub pass: Option<bool>,
    /// True where the limit applies to this run.
    #[serde(default = "yes")]
    pub applicable: bool,
    /// Why it applies, or why it does not and what to set.
    #[serde(default)]
    pub reason: String,
    /// How sure the figure is.
    #[serde(default)]
    pub certainty: Certainty,
    /// Source of a limit that the user has entered; absent for those that the program knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Numerical uncertainty of `value`, in `unit`; absent where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Formula, and what the value is.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub remark: String,
    /// Formula that the limit comes from; empty for a number. For explanations, not in the file.
    #[serde(skip)]
    pub formula: String,
}

/// How a value has to stand to its limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// ≤
    #[default]
    AtMost,
    /// <
    Below,
    /// ≥
    AtLeast,
    /// >
    Above,
    /// =
    Equal,
}

impl Bound {
    /// Its sign.
    #[must_use]
    pub const fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "≤",
            Self::Below => "<",
            Self::AtLeast => "≥",
            Self::Above => ">",
            Self::Equal => "=",
        }
    }

    fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::AtMost => value <= limit,
            Self::Below => value < limit,
            Self::AtLeast => value >= limit,
            Self::Above => value > limit,
            Self::Equal => value == limit,
        }
    }
}

/// How sure the figure of a limit is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Certainty {
    /// Read in a text that quotes the standard.
    #[default]
    #[serde(rename = "C")]
    Cited,
    /// Remembered, not verified.
    #[serde(rename = "R")]
    Remembered,
    /// Read in the standard itself by the one who entered it.
    #[serde(rename = "S")]
    Standard,
    /// Chosen, in no standard.
    #[serde(rename = "H")]
    Chosen,
}

impl Certainty {
    /// Its mark.
    #[must_use]
    pub const fn mark(self) -> &'static str {
        match self {
            Self::Cited => "[C]",
            Self::Remembered => "[R]",
            Self::Standard => "[S]",
            Self::Chosen => "[H]",
        }
    }

    /// Meaning of the mark.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Cited => "figure read in a text that quotes the standard",
            Self::Remembered => "remembered and not verified",
            Self::Standard => "read in the standard by the one who entered it",
            Self::Chosen => "chosen, in no standard",
        }
    }
}

/// Properties of the line that decide which limits apply, beside speed and evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// `run.electrification`.
    pub electrification: Option<Electrification>,
    /// Transverse wave speed of the contact wire, m/s; `None` for a line that this program does not model.
    pub wave_speed: Option<f64>,
    /// `catenary.registration_arms.free_uplift`, m.
    pub free_uplift: Option<f64>,
    /// `catenary.registration_arms.uplift_stop`.
    pub uplift_stop: bool,
}

/// How a run was made and evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The line.
    pub line: Line,
    /// Running speed, m/s.
    pub speed: f64,
    /// Cut-off frequency of the filter of the contact force, Hz.
    pub low_pass_hz: f64,
    /// The filter.
    pub filter: Filter,
    /// Time between two samples, s.
    pub output_step: f64,
    /// Largest rise of the contact wire at the supports of the evaluated spans, m.
    pub uplift: Option<f64>,
}

impl Conditions {
    /// Running speed, km/h, without the rounding of its conversion: limits change at whole numbers.
    fn speed_kmh(&self) -> f64 {
        kmh(self.speed)
    }
}

/// Speed of m/s in km/h, without the rounding of its conversion.
fn kmh(speed: f64) -> f64 {
    (3.6e6 * speed).round() / 1e6
}

/// Figures of one pantograph over its evaluation range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Low-pass filtered contact force, N; `None` where the run has none.
    pub force: Option<ForceStatistics>,
    /// Vertical amplitude of the strip, m.
    pub vertical_amplitude: Option<f64>,
    /// Share of the time without contact, %.
    pub loss_of_contact: Option<f64>,
    /// Share of the time in losses of contact that last [`SHORTEST_ARC`] or longer, %.
    pub arcing: Option<f64>,
    /// Length of track that was evaluated, m.
    pub section: f64,
    /// Length of the longest span that it touches, m; `None` where the line is not known.
    pub longest_span: Option<f64>,
}

/// Duration from which an arc counts, s. `[TSI ENE, Table 4.2.12]`, remembered
pub const SHORTEST_ARC: f64 = 5e-3;

/// Every limit that is known here, in a fixed order: those of each pantograph, then those of the line and of the
/// evaluation; with the user's own in their places.
#[must_use]
pub fn limits(conditions: &Conditions, pantographs: &[Figures], assessment: &Assessment) -> Vec<Limit> {
    let mut all = Vec::new();
    for (i, figures) in pantographs.iter().enumerate() {
        let first = all.len();
        all.extend(en50367::of_pantograph(conditions, figures));
        all.extend(en50119::of_pantograph(conditions, figures));
        all.push(en50317::control_section(figures));
        for limit in &mut all[first..] {
            limit.pantograph = Some(i + 1);
        }
    }
    all.push(en50367::uplift(conditions));
    all.extend(en50119::of_line(conditions));
    all.extend(en50317::of_evaluation(conditions));
    own::assessed(
        all,
        assessment,
        (
            conditions.line.electrification,
            conditions.speed_kmh(),
            pantographs.len(),
        ),
    )
}

/// Limits of a line at rest: running speed in m/s, largest gradient of the contact wire and largest change of
/// it, – and –; `pantographs` is their number. With wind on the wires also the largest lateral position of the contact
/// wire in the mean wind and the width of the narrowest strip where it is known, m.
#[must_use]
pub fn limits_at_rest(
    line: &Line,
    (speed, pantographs): (f64, usize),
    (gradient, change): (Option<f64>, Option<f64>),
    lateral_deviation: Option<(f64, Option<f64>)>,
    assessment: &Assessment,
) -> Vec<Limit> {
    let mut all = en50119::at_rest(line, speed, gradient, change).to_vec();
    all.extend(lateral_deviation.map(|(largest, width)| en50367::lateral_deviation(largest, width)));
    own::assessed(all, assessment, (line.electrification, kmh(speed), pantographs))
}

impl Limit {
    /// A limit of a standard, its edition and a clause of it.
    fn new((standard, edition, clause): (&str, &str, &str), quantity: &str, value: Option<f64>, unit: &str) -> Self {
        Self {
            standard: standard.to_owned(),
            edition: edition.to_owned(),
            clause: format!("{edition}, {clause}"),
            quantity: quantity.to_owned(),
            pantograph: None,
            value,
            bound: Bound::AtMost,
            limit: None,
            unit: unit.to_owned(),
            pass: None,
            applicable: true,
            reason: String::new(),
            certainty: Certainty::Cited,
            source: None,
            tolerance: None,
            remark: String::new(),
            formula: String::new(),
        }
    }

    fn bounded(mut self, bound: Bound, limit: impl Into<Option<f64>>) -> Self {
        self.bound = bound;
        self.limit = limit.into();
        self
    }

    fn remembered(mut self) -> Self {
        self.certainty = Certainty::Remembered;
        self
    }

    fn chosen(mut self) -> Self {
        self.certainty = Certainty::Chosen;
        self
    }

    fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = reason.into();
        self
    }

    fn not_applicable(mut self, reason: impl Into<String>) -> Self {
        self.applicable = false;
        self.reason = reason.into();
        self
    }

    /// The formula, which is the remark too.
    fn formula(mut self, formula: impl Into<String>) -> Self {
        self.formula = formula.into();
        self.remark = self.formula.clone();
        self
    }

    fn remark(mut self, remark: impl Into<String>) -> Self {
        self.remark = remark.into();
        self
    }

    /// Standard with its edition, as `assessment.editions` names it.
    #[must_use]
    pub fn edition_name(&self) -> String {
        format!("{}:{}", self.standard, self.edition)
    }

    /// Factor and unit of value and limit for reading: short lengths are told in mm.
    #[must_use]
    pub fn scale(&self) -> (f64, &str) {
        match self.unit.as_str() {
            "m" if self.quantity != "control_section" => (1e3, "mm"),
            unit => (1.0, unit),
        }
    }

    /// Distance of the value from the limit, in `unit`: positive where the limit holds, negative where it fails.
    #[must_use]
    pub fn room(&self) -> Option<f64> {
        let (value, limit) = self.value.zip(self.limit)?;
        match self.bound {
            Bound::AtMost | Bound::Below => Some(limit - value),
            Bound::AtLeast | Bound::Above => Some(value - limit),
            Bound::Equal => (value != limit).then(|| -(value - limit).abs()),
        }
    }

    /// True for a decided limit that is closer to the value than the computation is certain.
    #[must_use]
    pub fn is_close(&self) -> bool {
        let close = self
            .room()
            .zip(self.tolerance)
            .is_some_and(|(room, tolerance)| room.abs() < tolerance);
        self.pass.is_some() && close
    }

    /// Remedy that practice tries first where the limit fails; nothing where there is none.
    #[must_use]
    pub fn remedy(&self) -> Option<&'static str> {
        let remedy = match self.quantity.as_str() {
            "mean" => "less static force or less aerodynamic lift",
            "mean_lower" => "more static force or more aerodynamic lift",
            "std" | "arcing" => {
                "a lower speed, more tension in the wires, more space between pantographs, or a lighter strip; more \
                 static force lowers arcing alone"
            }
            "max" | "min" => "as for the standard deviation, and a look at the span where the extreme stands (By span)",
            "uplift" => "less static force, a lower speed, or more space between pantographs",
            "free_uplift" => "more space at the steady arm, or a stop",
            "vertical_amplitude" => "less presag, or stiffness that varies less along the span",
            "speed_ratio" => "more tension in the contact wire, or a lower speed",
            "band" => "run.low_pass_hz = 20",
            "sampling_rate" => "a shorter run.output_step",
            "lateral_deviation" => "shorter spans, less stagger, or more tension",
            "gradient" | "gradient_change" => "heights of the supports in smaller steps",
            _ => return None,
        };
        Some(remedy)
    }

    fn decide(&mut self) {
        self.pass = match (self.applicable, self.value, self.limit) {
            (true, Some(value), Some(limit)) => Some(self.bound.holds(value, limit)),
            _ => None,
        };
    }
}

/// Why a limit by voltage cannot be applied to a scene without one.
fn system_unknown() -> String {
    let words: Vec<String> = Electrification::ALL
        .iter()
        .map(|system| format!("\"{system}\""))
        .collect();
    format!(
        "differs from system to system: set run.electrification to one of {}",
        words.join(", ")
    )
}

fn yes() -> bool {
    true
}
