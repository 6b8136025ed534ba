//! `[catenary.stitch_wires]`, and which wire each dropper hangs from.

use crate::keys::{Entry, Keys, Number, Sentences};
use crate::{Catenary, Wire};

/// `[catenary.stitch_wires]`: a wire below the messenger wire about every inner support, clamped to it at both ends,
/// from which the droppers between its clamps hang.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StitchWires {
    /// Distance between the clamps along the track, m; half of it on either side of the support.
    pub length: f64,
    /// Section, tension and strength.
    pub wire: Wire,
}

impl Catenary {
    /// The stitch wire about support `support` (from 0): about inner supports of a line that has them.
    #[must_use]
    pub fn stitch_wire_at(&self, support: usize) -> Option<&StitchWires> {
        let inner = support > 0 && support < self.spans();
        self.stitch_wires.as_ref().filter(|_| inner)
    }

    /// Support (from 0) whose stitch wire carries a dropper at `position` (m) in span `span` (from 0).
    #[must_use]
    pub fn stitch_wire_over(&self, span: usize, position: f64) -> Option<usize> {
        let distances = [position, self.span_lengths()[span] - position];
        [span, span + 1]
            .into_iter()
            .zip(distances)
            .find_map(|(support, distance)| {
                let stitch = self.stitch_wire_at(support)?;
                (distance < 0.5 * stitch.length).then_some(support)
            })
    }

    /// Distances of the clamps of stitch wires from the left support of span `span` (from 0), m, ascending.
    fn clamps(&self, span: usize) -> impl Iterator<Item = f64> + '_ {
        let half = |support: usize| Some(0.5 * self.stitch_wire_at(support)?.length);
        let left = half(span);
        let right = half(span + 1).map(|half| self.span_lengths()[span] - half);
        left.into_iter().chain(right)
    }

    /// Distances of droppers and clamps on the messenger wire from the left support of span `span` (from 0), m,
    /// ascending.
    #[must_use]
    pub fn messenger_attachments(&self, span: usize) -> Vec<f64> {
        let droppers = self.droppers.of_span(span).iter().copied();
        let own = droppers.filter(|position| self.stitch_wire_over(span, *position).is_none());
        let mut all: Vec<f64> = own.chain(self.clamps(span)).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Stations of the stitch wire about support `support` (from 0) in m from the support, from clamp to clamp, each
    /// with true for a dropper or a clamp; the support itself is one without. Empty without a stitch wire.
    #[must_use]
    pub fn stitch_stations(&self, support: usize) -> Vec<(f64, bool)> {
        let Some(stitch) = self.stitch_wire_at(support) else {
            return Vec::new();
        };
        let half = 0.5 * stitch.length;
        let before = self.droppers.of_span(support - 1).iter();
        let before = before.map(|position| position - self.span_lengths()[support - 1]);
        let after = self.droppers.of_span(support).iter().copied();
        let droppers = before.chain(after).filter(|offset| offset.abs() < half);
        let mut all: Vec<(f64, bool)> = droppers.map(|offset| (offset, true)).collect();
        all.extend([(-half, true), (0.0, false), (half, true)]);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }
}

impl Entry for StitchWires {
    const SENTENCES: Sentences = &[(
        "length",
        "Distance between the clamps of a stitch wire along the track, half of it on either side of the support; the \
         droppers between them hang from the stitch wire.",
    )];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            length: keys.number("length", was.map(|stitch| stitch.length), Number::positive("m")),
            wire: keys.part(was.map(|stitch| &stitch.wire)),
        }
    }
}
