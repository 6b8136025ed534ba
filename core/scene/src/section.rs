//! A tension length with the parts that all tension lengths of a line have in common.

use crate::{Catenary, MassOn, PointMass, StitchWires, TensionLength};
use std::ops::Deref;

/// One tension length of a line: where its wires are fastened to each other.
#[derive(Clone, Copy, Debug)]
pub struct Section<'a> {
    /// Number among the tension lengths, from 0.
    pub number: usize,
    /// The line.
    pub line: &'a Catenary,
    /// Spans, heights and lateral positions.
    pub geometry: &'a TensionLength,
}

impl Deref for Section<'_> {
    type Target = TensionLength;

    fn deref(&self) -> &TensionLength {
        self.geometry
    }
}

impl<'a> Section<'a> {
    /// Positions of the droppers in span `span` (from 0), m from its left support.
    #[must_use]
    pub fn droppers_of(&self, span: usize) -> &'a [f64] {
        let own = &self.geometry.dropper_positions;
        let lists = if own.is_empty() {
            &self.line.droppers.positions
        } else {
            own
        };
        &lists[span % lists.len()]
    }

    /// Unstressed lengths of the droppers in span `span` (from 0), m, where they are given.
    #[must_use]
    pub fn dropper_lengths_of(&self, span: usize) -> Option<&'a [f64]> {
        let lengths = self.line.droppers.lengths.as_ref()?;
        Some(&lengths[span % lengths.len()])
    }

    /// x of the droppers, m, span after span.
    pub fn droppers_x(self) -> impl Iterator<Item = f64> + 'a {
        (0..self.spans()).flat_map(move |span| {
            let left = self.support_x(span);
            self.droppers_of(span).iter().map(move |position| left + position)
        })
    }

    /// The stitch wire about support `support` (from 0): about inner supports of a line that has them.
    #[must_use]
    pub fn stitch_wire_at(&self, support: usize) -> Option<&'a StitchWires> {
        let inner = support > 0 && support < self.spans();
        self.line.stitch_wires.as_ref().filter(|_| inner)
    }

    /// Support (from 0) whose stitch wire carries a dropper at `position` (m) in span `span` (from 0).
    #[must_use]
    pub fn stitch_wire_over(&self, span: usize, position: f64) -> Option<usize> {
        let distances = [position, self.span_lengths[span] - position];
        [span, span + 1]
            .into_iter()
            .zip(distances)
            .find_map(|(support, distance)| {
                let stitch = self.stitch_wire_at(support)?;
                (distance < 0.5 * stitch.length).then_some(support)
            })
    }

    /// Point masses on a wire in span `span` (from 0): distance from its left support in m, mass in kg.
    pub fn masses_on(self, wire: MassOn, span: usize) -> impl Iterator<Item = (f64, f64)> + 'a {
        let (left, right) = (self.support_x(span), self.support_x(span + 1));
        let here = move |point: &&PointMass| {
            point.wire == wire && point.tension_length == self.number + 1 && (left..right).contains(&point.x)
        };
        let points = self.line.point_masses.iter().filter(here);
        points.map(move |point| (point.x - left, point.mass))
    }

    /// Distances of droppers and point masses on the contact wire from the left support of span `span` (from 0), m,
    /// ascending.
    #[must_use]
    pub fn contact_attachments(&self, span: usize) -> Vec<f64> {
        let droppers = self.droppers_of(span).to_vec();
        with_masses(
            droppers,
            self.span_lengths[span],
            self.masses_on(MassOn::ContactWire, span),
        )
    }

    /// Distances of droppers, clamps and point masses on the messenger wire from the left support of span `span`
    /// (from 0), m, ascending.
    #[must_use]
    pub fn messenger_attachments(&self, span: usize) -> Vec<f64> {
        let droppers = self.droppers_of(span).iter().copied();
        let own = droppers.filter(|position| self.stitch_wire_over(span, *position).is_none());
        let half = |support: usize| Some(0.5 * self.stitch_wire_at(support)?.length);
        let clamps = [half(span), half(span + 1).map(|half| self.span_lengths[span] - half)];
        let all = own.chain(clamps.into_iter().flatten()).collect();
        with_masses(
            all,
            self.span_lengths[span],
            self.masses_on(MassOn::MessengerWire, span),
        )
    }

    /// Stations of the stitch wire about support `support` (from 0) in m from the support, from clamp to clamp, each
    /// with true for a dropper or a clamp; the support itself is one without. Empty without a stitch wire.
    #[must_use]
    pub fn stitch_stations(&self, support: usize) -> Vec<(f64, bool)> {
        let Some(stitch) = self.stitch_wire_at(support) else {
            return Vec::new();
        };
        let half = 0.5 * stitch.length;
        let before = self.droppers_of(support - 1).iter();
        let before = before.map(|position| position - self.span_lengths[support - 1]);
        let after = self.droppers_of(support).iter().copied();
        let droppers = before.chain(after).filter(|offset| offset.abs() < half);
        let mut all: Vec<(f64, bool)> = droppers.map(|offset| (offset, true)).collect();
        all.extend([(-half, true), (0.0, false), (half, true)]);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// Height of the contact wire at `x` (m), m, straight between its supports; beyond them that of the end.
    #[must_use]
    pub fn chord_height(&self, x: f64) -> f64 {
        self.between_supports(x, |support| self.height_at(support))
    }

    /// Lateral position of the contact wire at rest at `x` (m), m; beyond the supports that of the end.
    #[must_use]
    pub fn lateral(&self, x: f64) -> f64 {
        let (span, xi) = self.span_at(x);
        self.lateral_within((span, xi.clamp(0.0, 1.0)), |support| self.stagger_at(support))
    }

    /// Lateral position at `xi`, 0…1, in span `span` (from 0) of a wire at rest that lies at `at(support)`, m, at the
    /// supports (from 0): straight between them on straight track, and as `y″ = −κ` has it in a curve.
    #[must_use]
    pub fn lateral_within(&self, (span, xi): (usize, f64), at: impl Fn(usize) -> f64) -> f64 {
        let [a, b] = [span, span + 1].map(at);
        let [left, right] = [span, span + 1].map(|support| self.curvature_at(support));
        let bend = 0.5 * left * xi * (1.0 - xi) + (right - left) / 6.0 * xi * (1.0 - xi * xi);
        a + (b - a) * xi + self.span_lengths[span].powi(2) * bend
    }

    /// Angle by which a wire turns to the right at support `support` (from 0), rad, that lies at `lateral(support)`, m,
    /// at the supports: between them it is straight on straight track, and follows a curve. At an end it is the angle
    /// of its only span.
    pub fn turn_at(&self, support: usize, lateral: impl Fn(usize) -> f64) -> f64 {
        let slope = |span: usize| (lateral(span + 1) - lateral(span)) / self.span_lengths[span];
        let before = support.checked_sub(1);
        let after = (support < self.spans()).then_some(support);
        let of_chords = before.map_or(0.0, slope) - after.map_or(0.0, slope);
        // A load that is linear along a span stands on the supports by a third and a sixth of its ends.
        let by_curve = |span: usize| {
            let ends = self.curvature_at(span) + self.curvature_at(span + 1);
            self.span_lengths[span] * (ends + self.curvature_at(support)) / 6.0
        };
        of_chords - before.map_or(0.0, by_curve) - after.map_or(0.0, by_curve)
    }

    /// Value at `x` (m), straight between the values at the supports (from 0) on either side.
    pub fn between_supports(&self, x: f64, at: impl Fn(usize) -> f64) -> f64 {
        let (span, xi) = self.span_at(x);
        at(span) + (at(span + 1) - at(span)) * xi.clamp(0.0, 1.0)
    }
}

/// Distance below which a mass sits at the place of another fastening, m.
const SAME_PLACE: f64 = 0.1;

/// Fastenings of a span of `length` (m) and its masses, ascending; a mass next to a fastening or a support is at its
/// place.
fn with_masses(mut fastenings: Vec<f64>, length: f64, masses: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    for (position, _) in masses {
        let apart = |place: &f64| (place - position).abs() >= SAME_PLACE;
        if (SAME_PLACE..=length - SAME_PLACE).contains(&position) && fastenings.iter().all(apart) {
            fastenings.push(position);
        }
    }
    fastenings.sort_by(f64::total_cmp);
    fastenings
}

impl Catenary {
    /// The tension lengths.
    pub fn sections(&self) -> impl Iterator<Item = Section<'_>> {
        (0..self.tension_lengths.len()).map(|number| self.section(number))
    }

    /// Tension length `number`, from 0.
    #[must_use]
    pub fn section(&self, number: usize) -> Section<'_> {
        Section {
            number,
            line: self,
            geometry: &self.tension_lengths[number],
        }
    }

    /// The first tension length.
    #[must_use]
    pub fn first(&self) -> Section<'_> {
        self.section(0)
    }
}
