//! `[run]`: what is driven, for how long, and what is evaluated.

use crate::MAX_SPANS;
use crate::accuracy::Accuracy;
use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences, placeholder};

/// `[run]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Speed of the train, m/s; `speed_kmh` in the file.
    pub speed: f64,
    /// Simulated time, s; the run starts at t = 0.
    pub duration: f64,
    /// x of a strip with `offset_x` = 0 at t = 0, m.
    pub start_x: f64,
    /// Range that statistics are taken over.
    pub evaluate: Evaluate,
    /// Cut-off frequency of the low-pass filter of the contact force, Hz; 20 Hz by default, as in EN 50317.
    pub low_pass_hz: f64,
    /// Filter of the contact force.
    pub filter: ForceFilter,
    /// Frequency bands that the spread of the contact force is given for, from and to in Hz.
    pub bands_hz: Vec<[f64; 2]>,
    /// Time between two rows of the time series, s; 1 ms by default, which resolves 20 Hz fifty-fold.
    pub output_step: f64,
    /// State at t = 0.
    pub initialise: Initialise,
    /// True accepts a speed above the contact wire's transverse wave speed.
    pub allow_supercritical: bool,
    /// Power supply of the line: no part of the motion, only of the limits of standards that a run is held against;
    /// without it those that depend on it are not applied.
    pub electrification: Option<Electrification>,
    /// Error of the filtered force that mesh, steps, tolerance and reductions are chosen for; `accuracy_percent` in the
    /// file.
    pub accuracy: Option<Accuracy>,
}

/// `run.evaluate`: the range that statistics are taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evaluate {
    /// `{ spans = [first, last] }`: both included, numbered from 1; for each pantograph the time that its own
    /// strip spends there.
    Spans {
        /// First span, from 1.
        first: usize,
        /// Last span, from 1, at least `first`.
        last: usize,
    },
    /// `{ time = [from, to] }`, the same for every pantograph.
    Time {
        /// s.
        from: f64,
        /// s.
        to: f64,
    },
}

choice! {
    /// `run.initialise`: the state at t = 0.
    pub enum Initialise {
        /// Both sides at rest in static balance under the contact force.
        Equilibrium = "equilibrium",
        /// Each side in the state that its own tables describe.
        AsGiven = "as_given",
    }
    unavailable: []
}

choice! {
    /// `run.electrification`: the traction power supply system. [EN 50163]
    pub enum Electrification {
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

impl Electrification {
    /// True for alternating current.
    #[must_use]
    pub const fn is_alternating(self) -> bool {
        matches!(self, Self::Ac25Kv | Self::Ac15Kv)
    }
}

choice! {
    /// `run.filter`: the low-pass filter of the contact force.
    pub enum ForceFilter {
        /// Butterworth of order 4, forward and backward: no delay.
        ZeroPhase = "zero_phase",
        /// Butterworth of order 6, forward only, as a measuring train filters. [EN 50317]
        Causal = "causal",
    }
    unavailable: []
}

/// `run.bands_hz` where it is left out, Hz: one span passing and its harmonics, spans, droppers.
pub(crate) const BANDS: [[f64; 2]; 3] = [[0.0, 2.0], [0.0, 5.0], [5.0, 20.0]];

impl Run {
    /// A run at `speed` m/s for `duration` s, from `start_x` m on, of which `evaluate` is evaluated; all else as where
    /// it is left out in a file.
    #[must_use]
    pub fn new(speed: f64, duration: f64, start_x: f64, evaluate: Evaluate) -> Self {
        Self {
            speed,
            duration,
            start_x,
            evaluate,
            ..placeholder()
        }
    }
}

impl Entry for Run {
    const SENTENCES: Sentences = &[
        ("speed_kmh", "Speed of the train."),
        ("duration", "Simulated time from t = 0."),
        (
            "start_x",
            "Place of a strip with `offset_x = 0` at t = 0, from the first support.",
        ),
        ("evaluate", "Range that statistics are taken over."),
        (
            "low_pass_hz",
            "Cut-off frequency of the low-pass filter of the contact force [EN 50317].",
        ),
        (
            "filter",
            "Butterworth filter of the contact force: of order 4 forward and backward, without delay, or of order 6 \
             forward only [EN 50317].",
        ),
        (
            "bands_hz",
            "Bands that the standard deviation of the contact force is given for.",
        ),
        ("output_step", "Time between two rows of the time series."),
        (
            "initialise",
            "State at t = 0: static balance of both sides under the contact force, or as the tables describe each \
             side.",
        ),
        (
            "allow_supercritical",
            "True accepts a speed above the wave speed of the contact wire.",
        ),
        (
            "electrification",
            "Power supply [EN 50163] that limits of standards depend on; without it such limits are not applied.",
        ),
        (
            "accuracy_percent",
            "Largest sum of expected errors of the filtered force, in percent of its standard deviation: mesh, steps, \
             tolerance and reductions that are left out are chosen for it together.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            speed: keys.number("speed_kmh", was.map(|run| kmh(run.speed)), Number::positive("km/h")) / KMH,
            duration: keys.number("duration", was.map(|run| run.duration), Number::positive("s")),
            start_x: keys.number("start_x", was.map(|run| run.start_x), Number::any("m")),
            evaluate: keys.inline_table("evaluate", was.map(|run| &run.evaluate)),
            low_pass_hz: keys.number(
                "low_pass_hz",
                was.map(|run| run.low_pass_hz),
                Number::positive("Hz").default(20.0),
            ),
            filter: keys.word("filter", was.map(|run| run.filter), Some(ForceFilter::ZeroPhase)),
            bands_hz: bands(keys, was.map(|run| run.bands_hz.as_slice())),
            output_step: keys.number(
                "output_step",
                was.map(|run| run.output_step),
                Number::positive("s").default(1e-3),
            ),
            initialise: keys.word(
                "initialise",
                was.map(|run| run.initialise),
                Some(Initialise::Equilibrium),
            ),
            allow_supercritical: keys.flag("allow_supercritical", was.map(|run| run.allow_supercritical), false),
            electrification: keys.optional_word("electrification", was.map(|run| run.electrification)),
            accuracy: accuracy(keys, was.map(|run| run.accuracy)),
        }
    }
}

/// Reads or writes `bands_hz`.
fn bands(keys: &mut Keys, was: Option<&[[f64; 2]]>) -> Vec<[f64; 2]> {
    const KEY: &str = "bands_hz";
    if keys.describes() || keys.has(KEY, was.is_some()) {
        let bands = keys.points::<2>(KEY, was, Number::not_negative("Hz"));
        for [from, to] in &bands {
            if from >= to {
                keys.refuse(
                    KEY,
                    "each band must be [from, to] in Hz, with from below to, such as [5, 20]",
                );
            }
        }
        bands
    } else {
        BANDS.to_vec()
    }
}

/// Least `accuracy_percent`: below, the error of the coupling is not known well enough.
const LEAST_ERROR: f64 = 0.3;
/// Largest `accuracy_percent`: beyond, rules of errors are far off.
const MOST_ERROR: f64 = 10.0;
/// `accuracy_percent`.
const ACCURACY: Number = Number::between_in("%", LEAST_ERROR, MOST_ERROR);

/// Reads or writes `accuracy_percent`; what it leaves open is told by other keys.
fn accuracy(keys: &mut Keys, was: Option<Option<Accuracy>>) -> Option<Accuracy> {
    let typed = was.map(|wish| wish.map(|wish| wish.percent));
    let percent = keys.optional_number("accuracy_percent", typed, ACCURACY)?;
    let open = was.flatten().map(|wish| wish.open).unwrap_or_default();
    Some(Accuracy { percent, open })
}

/// km/h in one m/s.
const KMH: f64 = 3.6;

/// The value of `speed_kmh` that is read as exactly `speed` in m/s: of the candidates within rounding, the first
/// one that is, with a short decimal number tried before all others.
#[must_use]
pub fn kmh(speed: f64) -> f64 {
    let near = speed * KMH;
    let short = (near * 1e6).round() / 1e6;
    [
        short,
        near,
        near.next_up(),
        near.next_down(),
        near.next_up().next_up(),
        near.next_down().next_down(),
    ]
    .into_iter()
    .find(|candidate| candidate / KMH == speed)
    .unwrap_or(near)
}

impl Entry for Evaluate {
    const SENTENCES: Sentences = &[
        (
            "spans",
            "First and last span, both included; for each pantograph the time of its own strip there.",
        ),
        (
            "time",
            "First and last time, the same for every pantograph; in place of `spans`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let spans = was.and_then(|evaluate| match evaluate {
            Self::Spans { first, last } => Some([*first, *last]),
            Self::Time { .. } => None,
        });
        let time = was.and_then(|evaluate| match evaluate {
            Self::Spans { .. } => None,
            Self::Time { from, to } => Some([*from, *to]),
        });
        let (by_spans, by_time) = (keys.has("spans", spans.is_some()), keys.has("time", time.is_some()));
        if by_spans && by_time {
            keys.refuse("spans", "must stand alone: evaluate either spans or time, not both");
        } else if !by_spans && !by_time {
            let expected = "a list of the first and the last span, such as [5, 6], or else time = [from, to] in s";
            keys.report(
                "spans",
                What::Missing {
                    expected: expected.to_string(),
                },
            );
        }
        if keys.describes() {
            keys.pair_of_counts("spans", None, 1..=MAX_SPANS);
        }
        if by_time {
            let [from, to] = keys.pair("time", time, Number::not_negative("s"));
            Self::Time { from, to }
        } else {
            let [first, last] = if by_spans {
                keys.pair_of_counts("spans", spans, 1..=MAX_SPANS)
            } else {
                [1, 1]
            };
            Self::Spans { first, last }
        }
    }
}
