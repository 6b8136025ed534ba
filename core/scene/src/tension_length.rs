//! Geometry of a tension length: spans, heights and lateral positions of its wires.

use crate::check::LONGEST_SPAN;
use crate::keys::{Entry, Keys, Length, Number, Sentences};
use crate::plausible::HIGHEST_WIRE;

/// Contact wire and messenger wire between two anchors: spans, heights and lateral positions.
///
/// A list per support or per span repeats itself where it is shorter; one entry holds everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionLength {
    /// x of the first support, m.
    pub start_x: f64,
    /// Length of each span, m; `spans` and `span_length` in the file.
    pub span_lengths: Vec<f64>,
    /// Height of the contact wire above the top of rail, m, per support.
    pub contact_wire_height: Vec<f64>,
    /// Height of the messenger wire above the contact wire, m, per support.
    pub encumbrance: Vec<f64>,
    /// Lowering of the contact wire at mid-span against the chord of its supports, m, per span.
    pub presag: Vec<f64>,
    /// Lateral position y of the contact wire, m, per support; any number of entries is repeated cyclically.
    pub stagger: Vec<f64>,
    /// Lateral position y of the messenger wire, m, likewise; empty is that of the contact wire.
    pub messenger_stagger: Vec<f64>,
    /// Radius of the curve in which the track lies at each support, m, positive with the middle to the left, infinite
    /// where it is straight; between supports the curvature is linear. Empty on straight track.
    pub curve_radius: Vec<f64>,
    /// Positions of the droppers as [`crate::Droppers::positions`], where this tension length has its own; else empty.
    pub dropper_positions: Vec<Vec<f64>>,
}

/// Entry `index` of a list that repeats itself.
fn repeated(list: &[f64], index: usize) -> f64 {
    list[index % list.len()]
}

/// List that repeats itself, from entry `start` on.
pub(crate) fn from<T: Clone>(list: &[T], start: usize) -> Vec<T> {
    let mut rotated = list.to_vec();
    if !rotated.is_empty() {
        rotated.rotate_left(start % list.len());
    }
    rotated
}

impl TensionLength {
    /// Level wires without stagger over spans of these lengths (m), the contact wire at `height`, the messenger wire
    /// `encumbrance` above (m).
    #[must_use]
    pub fn new(span_lengths: Vec<f64>, height: f64, encumbrance: f64) -> Self {
        Self {
            start_x: 0.0,
            span_lengths,
            contact_wire_height: vec![height],
            encumbrance: vec![encumbrance],
            presag: vec![0.0],
            stagger: vec![0.0],
            messenger_stagger: Vec::new(),
            curve_radius: Vec::new(),
            dropper_positions: Vec::new(),
        }
    }

    /// Number of spans.
    #[must_use]
    pub fn spans(&self) -> usize {
        self.span_lengths.len()
    }

    /// x of support `index`, m; counted from 0, at most [`TensionLength::spans`].
    ///
    /// A product and not a sum for spans of one length, so that nothing accumulates.
    #[must_use]
    pub fn support_x(&self, index: usize) -> f64 {
        let first = self.span_lengths[0];
        let along = if self.span_lengths.iter().all(|length| *length == first) {
            index as f64 * first
        } else {
            self.span_lengths[..index].iter().sum()
        };
        self.start_x + along
    }

    /// x of the last support, m.
    #[must_use]
    pub fn end_x(&self) -> f64 {
        self.support_x(self.spans())
    }

    /// x of all supports, m.
    pub fn supports_x(&self) -> impl Iterator<Item = f64> + '_ {
        (0..=self.spans()).map(|index| self.support_x(index))
    }

    /// Span (from 0) at `x` (m) and the position within it, 0…1; of the first or last span beyond its end.
    #[must_use]
    pub fn span_at(&self, x: f64) -> (usize, f64) {
        let span = (1..self.spans())
            .take_while(|&support| self.support_x(support) <= x)
            .count();
        let (left, right) = (self.support_x(span), self.support_x(span + 1));
        (span, (x - left) / (right - left))
    }

    /// Height of the contact wire at support `index` (from 0), m.
    #[must_use]
    pub fn height_at(&self, index: usize) -> f64 {
        repeated(&self.contact_wire_height, index)
    }

    /// Height of the messenger wire above the contact wire at support `index` (from 0), m.
    #[must_use]
    pub fn encumbrance_at(&self, index: usize) -> f64 {
        repeated(&self.encumbrance, index)
    }

    /// Lowering of the contact wire in the middle of span `index` (from 0), m.
    #[must_use]
    pub fn presag_of(&self, index: usize) -> f64 {
        repeated(&self.presag, index)
    }

    /// Lateral position of the contact wire at support `index` (from 0), m.
    #[must_use]
    pub fn stagger_at(&self, index: usize) -> f64 {
        repeated(&self.stagger, index)
    }

    /// Curvature of the track at support `index` (from 0), 1/m, positive with the middle to the left.
    #[must_use]
    pub fn curvature_at(&self, index: usize) -> f64 {
        1.0 / self.radius_at(index)
    }

    /// Radius of the track at support `index` (from 0), m, positive with the middle to the left; infinite where it is
    /// straight.
    #[must_use]
    pub fn radius_at(&self, index: usize) -> f64 {
        if self.curve_radius.is_empty() {
            f64::INFINITY
        } else {
            repeated(&self.curve_radius, index)
        }
    }

    /// True where the track is curved somewhere.
    #[must_use]
    pub fn is_curved(&self) -> bool {
        self.curve_radius.iter().any(|radius| radius.is_finite())
    }

    /// Lateral position of the messenger wire at support `index` (from 0), m.
    #[must_use]
    pub fn messenger_stagger_at(&self, index: usize) -> f64 {
        if self.messenger_stagger.is_empty() {
            self.stagger_at(index)
        } else {
            repeated(&self.messenger_stagger, index)
        }
    }

    /// True where all spans and supports are alike but for the stagger of both wires together.
    pub(crate) fn is_uniform(&self) -> bool {
        let alike = |list: &[f64]| list.iter().all(|value| *value == list[0]);
        let lists = [
            &self.span_lengths,
            &self.contact_wire_height,
            &self.encumbrance,
            &self.presag,
        ];
        let own = [&self.messenger_stagger, &self.curve_radius];
        lists.into_iter().all(|list| alike(list)) && own.into_iter().all(Vec::is_empty)
    }

    /// Lateral positions of both wires at the supports, m.
    pub(crate) fn laterals(&self) -> impl Iterator<Item = f64> + '_ {
        self.stagger.iter().chain(&self.messenger_stagger).copied()
    }

    /// Spans from `start` up to and without `end` (from 0), the first support at x = 0.
    #[must_use]
    pub fn part(&self, start: usize, end: usize) -> Self {
        Self {
            start_x: 0.0,
            span_lengths: self.span_lengths[start..end].to_vec(),
            contact_wire_height: from(&self.contact_wire_height, start),
            encumbrance: from(&self.encumbrance, start),
            presag: from(&self.presag, start),
            stagger: from(&self.stagger, start),
            messenger_stagger: from(&self.messenger_stagger, start),
            curve_radius: from(&self.curve_radius, start),
            dropper_positions: from(&self.dropper_positions, start),
        }
    }
}

/// More spans than any tension length has, and few enough to be numbered and stored.
pub const MAX_SPANS: usize = 5000;

impl Entry for TensionLength {
    const SENTENCES: Sentences = &[
        ("spans", "Number of spans, counted from 1 in the other keys."),
        ("span_length", "Length of every span, or of each span in turn."),
        (
            "contact_wire_height",
            "Height of the contact wire at the supports above the top of rail: one for all, or one for each support \
             in turn, with a straight slope of the chord between them.",
        ),
        (
            "encumbrance",
            "Height of the messenger wire above the contact wire at the supports: one for all, or one for each \
             support in turn; left out with a single wire.",
        ),
        (
            "presag",
            "Lowering of the contact wire at mid-span against the chord of its supports: one for all, or one for each \
             span in turn.",
        ),
        (
            "presag_ratio",
            "Presag of each span as a share of its length, in place of `presag`.",
        ),
        (
            "stagger",
            "Lateral position of the contact wire at the supports in turn, positive to the left; repeated \
             cyclically.",
        ),
        (
            "messenger_stagger",
            "Lateral position of the messenger wire at the supports in turn; repeated cyclically. Left out, it hangs \
             above the contact wire.",
        ),
        (
            "curve_radius",
            "Radius of the curve of the track at the supports, positive with the middle to the left, `inf` where it is \
             straight: one for all, or one for each support in turn; the curvature is linear between them. Left out, \
             the track is straight.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let spans = keys.count("spans", was.map(Self::spans), 1..=MAX_SPANS, None);
        keys.written_out("presag_ratio", "", "any number, within ±0.02");
        let list = |of: fn(&Self) -> &Vec<f64>| was.map(|line| of(line).as_slice());
        Self {
            start_x: 0.0,
            span_lengths: keys.number_or_numbers(
                "span_length",
                list(|line| &line.span_lengths),
                Number::positive("m").at_most(LONGEST_SPAN),
                spans,
            ),
            contact_wire_height: keys.one_or_each(
                "contact_wire_height",
                list(|line| &line.contact_wire_height),
                Number::positive("m").at_most(HIGHEST_WIRE),
                spans + 1,
            ),
            encumbrance: keys.optional_one_or_each(
                "encumbrance",
                list(|line| &line.encumbrance),
                Number::positive("m"),
                spans + 1,
            ),
            presag: keys.one_or_each("presag", list(|line| &line.presag), Number::any("m"), spans),
            stagger: keys.numbers(
                "stagger",
                list(|line| &line.stagger),
                Number::any("m"),
                Length::NotEmpty,
            ),
            messenger_stagger: keys.optional_numbers(
                "messenger_stagger",
                list(|line| &line.messenger_stagger),
                Number::any("m"),
            ),
            curve_radius: keys.optional_one_or_each(
                "curve_radius",
                list(|line| &line.curve_radius),
                Number::radius(),
                spans + 1,
            ),
            dropper_positions: Vec::new(),
        }
    }
}

/// An entry of `[[catenary.tension_length]]`: a tension length with a place of its own.
pub(crate) struct Placed(pub TensionLength);

impl Entry for Placed {
    const SENTENCES: Sentences = &[
        (
            "start_x",
            "Place of the first support along the track; 0 for the tension length that the line begins with.",
        ),
        (
            "dropper_positions",
            "Positions of the droppers, as `catenary.droppers.positions`, where this tension length has its own.",
        ),
        (
            "dropper_pattern",
            "The same by names of `catenary.droppers.patterns`, in place of `dropper_positions`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let was = was.map(|placed| &placed.0);
        let own = was.is_some_and(|line| !line.dropper_positions.is_empty());
        let start = Number::not_negative("m").default(0.0);
        let start_x = keys.number("start_x", was.map(|line| line.start_x), start);
        let dropper_positions = if keys.has("dropper_positions", own) {
            let positions = was.map(|line| line.dropper_positions.as_slice());
            keys.list_or_lists("dropper_positions", positions, Number::any("m"))
        } else {
            Vec::new()
        };
        keys.written_out("dropper_pattern", "", "text, or a list of texts");
        Self(TensionLength {
            start_x,
            dropper_positions,
            ..keys.part(was)
        })
    }
}
