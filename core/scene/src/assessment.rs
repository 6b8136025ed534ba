//! `[assessment]`: editions of standards, and limits of the user's own, that a run is held against.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences, placeholder};
use crate::{Electrification, Mark, Scene};

/// `[assessment]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Editions whose limits count, such as `EN 50367:2012`; empty: all that are known.
    pub editions: Vec<String>,
    /// Source of the limits below.
    pub source: Option<String>,
    /// Limits that stand in place of those that the program knows for the same standard and quantity.
    pub limits: Vec<LimitRow>,
}

/// `[[assessment.limit]]`: one row of a table of limits.
///
/// ```text
/// limit = value + speed_squared v² + factor · reference          v in km/h
/// ```
///
/// The reference is the mean force for `std`, and the largest uplift at the supports for `free_uplift`.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitRow {
    /// Standard and edition, `EN 50367:2020`.
    pub standard: String,
    /// Clause or table.
    pub clause: String,
    /// Limited quantity.
    pub quantity: LimitedQuantity,
    /// Relation of the quantity to the limit; that of the quantity where it is left out.
    pub bound: Option<LimitBound>,
    /// Power supplies that it holds for; all where it is left out.
    pub system: Option<SystemGroup>,
    /// Speed above which it holds, km/h.
    pub above_kmh: f64,
    /// Speed up to which it holds, km/h; infinite where it is left out.
    pub up_to_kmh: Option<f64>,
    /// Fewest and most pantographs that it holds for.
    pub pantographs: Option<[usize; 2]>,
    /// Constant part, in the unit of the quantity.
    pub value: Option<f64>,
    /// Part that goes with the square of the speed, in the unit of the quantity by (km/h)².
    pub speed_squared: f64,
    /// Part that goes with the reference of the quantity, –.
    pub factor: Option<f64>,
    /// Its origin.
    pub mark: Mark,
    /// The requirement in words.
    pub text: Option<String>,
}

choice! {
    /// `assessment.limit.quantity`.
    pub enum LimitedQuantity {
        /// Largest mean force, N.
        Mean = "mean",
        /// Smallest mean force, N.
        MeanLower = "mean_lower",
        /// Standard deviation of the filtered force, N.
        Std = "std",
        /// Largest filtered force, N.
        Max = "max",
        /// Smallest filtered force, N.
        Min = "min",
        /// Largest uplift at a support, m.
        Uplift = "uplift",
        /// Space for the uplift at a steady arm, m.
        FreeUplift = "free_uplift",
        /// Highest less lowest place of the strip, m.
        VerticalAmplitude = "vertical_amplitude",
        /// Share of the time in losses of contact of 5 ms and longer, %.
        Arcing = "arcing",
        /// Speed by speed of waves, –.
        SpeedRatio = "speed_ratio",
        /// Cut-off frequency of the filter, Hz.
        Band = "band",
        /// Samples per second, Hz.
        SamplingRate = "sampling_rate",
        /// Evaluated length of track, m.
        ControlSection = "control_section",
        /// Gradient of the contact wire, ‰.
        Gradient = "gradient",
        /// Change of it at a support, ‰.
        GradientChange = "gradient_change",
        /// Lateral position of the contact wire in the wind, m.
        LateralDeviation = "lateral_deviation",
    }
    unavailable: []
}

choice! {
    /// `assessment.limit.bound`.
    pub enum LimitBound {
        /// ≤
        AtMost = "at_most",
        /// <
        Below = "below",
        /// ≥
        AtLeast = "at_least",
        /// >
        Above = "above",
        /// =
        Equal = "equal",
    }
    unavailable: []
}

choice! {
    /// `assessment.limit.system`: power supplies, one or those of a kind.
    pub enum SystemGroup {
        /// Alternating current.
        Ac = "ac",
        /// Direct current.
        Dc = "dc",
        /// 25 kV, 50 Hz.
        Ac25Kv = "ac_25kv",
        /// 15 kV, 16.7 Hz.
        Ac15Kv = "ac_15kv",
        /// 3 kV direct current.
        Dc3Kv = "dc_3kv",
        /// 1.5 kV direct current.
        Dc1_5Kv = "dc_1_5kv",
    }
    unavailable: []
}

/// Editions whose limits the program knows.
pub const EDITIONS: [&str; 5] = [
    "EN 50367:2006",
    "EN 50367:2012",
    "EN 50119:2009",
    "EN 50317:2012",
    "TSI ENE:2014",
];

impl SystemGroup {
    /// True where a power supply is one of these.
    #[must_use]
    pub fn holds(self, system: Electrification) -> bool {
        use Electrification::{Ac15Kv, Ac25Kv, Dc1_5Kv, Dc3Kv};
        match self {
            Self::Ac => system.is_alternating(),
            Self::Dc => !system.is_alternating(),
            Self::Ac25Kv => system == Ac25Kv,
            Self::Ac15Kv => system == Ac15Kv,
            Self::Dc3Kv => system == Dc3Kv,
            Self::Dc1_5Kv => system == Dc1_5Kv,
        }
    }
}

impl LimitedQuantity {
    /// Unit of the limit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Mean | Self::MeanLower | Self::Std | Self::Max | Self::Min => "N",
            Self::Uplift
            | Self::FreeUplift
            | Self::VerticalAmplitude
            | Self::ControlSection
            | Self::LateralDeviation => "m",
            Self::Arcing => "%",
            Self::SpeedRatio => "–",
            Self::Band | Self::SamplingRate => "Hz",
            Self::Gradient | Self::GradientChange => "‰",
        }
    }

    /// Quantity that `factor` multiplies; nothing for most.
    #[must_use]
    pub fn reference(self) -> Option<&'static str> {
        match self {
            Self::Std => Some("the mean force of the run"),
            Self::FreeUplift => Some("the largest uplift of the run"),
            _ => None,
        }
    }

    /// Relation to the limit where the row does not say it.
    #[must_use]
    pub fn bound(self) -> LimitBound {
        match self {
            Self::MeanLower | Self::FreeUplift | Self::SamplingRate | Self::ControlSection => LimitBound::AtLeast,
            Self::Min => LimitBound::Above,
            Self::Band => LimitBound::Equal,
            _ => LimitBound::AtMost,
        }
    }
}

impl Default for Assessment {
    /// An empty table.
    fn default() -> Self {
        placeholder()
    }
}

impl LimitRow {
    /// Name of the standard, without its edition.
    #[must_use]
    pub fn name(&self) -> &str {
        self.standard.rsplit_once(':').map_or(&self.standard, |(name, _)| name)
    }
}

impl Entry for Assessment {
    const SENTENCES: Sentences = &[
        (
            "from",
            "Path of a file with the keys of this table, relative to the scene; keys that stand here win, and rows \
             stand before those of the file.",
        ),
        (
            "editions",
            "Editions whose limits count: those that the program knows, and those of `assessment.limit`; all where it \
             is left out.",
        ),
        ("source", "One line that says where the limits come from."),
        (
            "limit",
            "Limits that stand in place of those that the program knows for the same standard and quantity.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        keys.written_out("from", "", "path of a file");
        let editions = keys.optional_texts(
            "editions",
            was.map(|all| all.editions.as_slice()),
            "a list of standards with their editions, such as [\"EN 50367:2012\"]",
        );
        let source = keys.optional_text(
            "source",
            was.map(|all| all.source.as_deref()),
            "one line that says where the limits come from",
        );
        let limits = keys.any_tables("limit", was.map(|all| all.limits.as_slice()));
        Self {
            editions,
            source,
            limits,
        }
    }
}

impl Entry for LimitRow {
    const SENTENCES: Sentences = &[
        ("standard", "Standard and edition, as in `EN 50367:2020`."),
        ("clause", "Clause or table."),
        (
            "quantity",
            "Limited quantity, as in `summary.json`; `mean_lower` is the smallest mean force. Forces are in N, lengths \
             in m, `arcing` in %, gradients in ‰.",
        ),
        (
            "bound",
            "Relation of the quantity to the limit; that which fits the quantity where it is left out.",
        ),
        (
            "system",
            "Power supply that the row holds for; every one where it is left out.",
        ),
        ("above_kmh", "Speed above which the row holds."),
        (
            "up_to_kmh",
            "Speed up to which the row holds; every higher one where it is left out.",
        ),
        ("pantographs", "Fewest and most pantographs that the row holds for."),
        ("value", "Limit, or its constant part, in the unit of the quantity."),
        (
            "speed_squared",
            "Part of the limit that goes with the square of the speed in km/h, in the unit of the quantity.",
        ),
        (
            "factor",
            "Share of the mean force (`std`), or multiple of the largest uplift at the supports (`free_uplift`).",
        ),
        ("mark", "Origin of the figures."),
        ("text", "The requirement in words."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let row = Self {
            standard: keys.text(
                "standard",
                was.map(|row| row.standard.as_str()),
                "a standard with its edition, such as \"EN 50367:2020\"",
            ),
            clause: keys.text("clause", was.map(|row| row.clause.as_str()), "a clause or table"),
            quantity: keys.word("quantity", was.map(|row| row.quantity), None),
            bound: keys.optional_word("bound", was.map(|row| row.bound)),
            system: keys.optional_word("system", was.map(|row| row.system)),
            above_kmh: keys.number(
                "above_kmh",
                was.map(|row| row.above_kmh),
                Number::not_negative("km/h").default(0.0),
            ),
            up_to_kmh: keys.optional_number("up_to_kmh", was.map(|row| row.up_to_kmh), Number::positive("km/h")),
            pantographs: keys
                .has("pantographs", was.is_some_and(|row| row.pantographs.is_some()))
                .then(|| keys.pair_of_counts("pantographs", was.and_then(|row| row.pantographs), 1..=100)),
            value: keys.optional_number("value", was.map(|row| row.value), Number::any("")),
            speed_squared: keys.number(
                "speed_squared",
                was.map(|row| row.speed_squared),
                Number::any("").default(0.0),
            ),
            factor: keys.optional_number("factor", was.map(|row| row.factor), Number::positive("")),
            mark: keys.word("mark", was.map(|row| row.mark), Some(Mark::Standard)),
            text: keys.optional_text("text", was.map(|row| row.text.as_deref()), "the requirement in words"),
        };
        if was.is_none() && !keys.describes() {
            row.refuse_within(keys);
        }
        row
    }
}

impl LimitRow {
    /// Refuses a row whose keys contradict each other.
    fn refuse_within(&self, keys: &mut Keys) {
        let (name, edition) = self.standard.rsplit_once(':').unwrap_or((&self.standard, ""));
        if !self.standard.is_empty() && (name.trim().is_empty() || edition.trim().is_empty()) {
            keys.refuse(
                "standard",
                "must name the edition behind a colon, such as \"EN 50367:2020\"",
            );
        }
        if self.pantographs.is_some_and(|[fewest, most]| fewest > most) {
            keys.refuse("pantographs", "must be the fewest and the most of them, such as [2, 4]");
        }
        if self.up_to_kmh.is_some_and(|most| most <= self.above_kmh) {
            keys.refuse(
                "up_to_kmh",
                format!("must be more than above_kmh = {} km/h", self.above_kmh),
            );
        }
        let quantity = self.quantity;
        match (self.factor, quantity.reference()) {
            (Some(_), None) => {
                let because = format!("quantity = \"{quantity}\" is held against a number, which value says");
                keys.report("factor", What::LeaveOut { because });
            }
            (None, _) if self.value.is_none() => {
                let other = quantity
                    .reference()
                    .map_or_else(String::new, |of| format!(", or factor times {of}"));
                let expected = format!("the limit of \"{quantity}\" in {}{other}", quantity.unit());
                keys.report("value", What::Missing { expected });
            }
            _ => {}
        }
    }
}

impl Scene {
    /// Checks that editions are known.
    pub(crate) fn check_assessment(&self, found: &mut Found) {
        let own: Vec<&str> = self.assessment.limits.iter().map(|row| row.standard.as_str()).collect();
        for edition in &self.assessment.editions {
            if !EDITIONS.contains(&edition.as_str()) && !own.contains(&edition.as_str()) {
                let mut known = EDITIONS.to_vec();
                known.extend(own.iter().filter(|name| !EDITIONS.contains(name)));
                known.dedup();
                let expected = format!(
                    "must be among {}; limits of another edition are entered under [[assessment.limit]]",
                    known.join(", ")
                );
                refuse(found, "assessment.editions", format!("{edition:?}"), expected);
            }
        }
    }
}
