//! How many elements lie between neighbouring droppers or supports.

use crate::check::{Found, refuse};
use crate::error::What;
use crate::keys::{Keys, Number};
use crate::write::shown_number;
use crate::{Catenary, Section, Wire, WireKind};

/// Equal elements between neighbouring droppers or supports: how many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Division {
    /// `elements_per_interval`: as many in each interval, at least 1.
    PerInterval(usize),
    /// `element_length`: as few as are no longer than this, m.
    UpTo(f64),
}

/// Most elements of an interval.
const MOST: usize = Division::MOST;

/// Part of an element that rounding may leave of a length that the limit divides, –.
const ROUNDING: f64 = 1e-9;

impl Division {
    /// Most elements of an interval: far beyond any converged mesh.
    pub const MOST: usize = 200;

    /// Elements of an interval of this length, m.
    #[must_use]
    pub fn elements(self, length: f64) -> usize {
        match self {
            Self::PerInterval(count) => count,
            Self::UpTo(limit) => ((length / limit - ROUNDING).ceil() as usize).max(1),
        }
    }

    /// The key that says it, of which a mesh has one.
    pub(crate) fn entry(keys: &mut Keys, was: Option<Self>) -> Self {
        let (count, limit) = match was {
            Some(Self::PerInterval(count)) => (Some(count), None),
            Some(Self::UpTo(limit)) => (None, Some(limit)),
            None => (None, None),
        };
        let (name, other) = ("elements_per_interval", "element_length");
        let has_count = keys.has(name, count.is_some());
        if keys.describes() {
            keys.count(name, None, 1..=MOST, None);
        }
        if keys.has(other, limit.is_some()) {
            if has_count {
                let because = format!("catenary.mesh.{name} divides the intervals; one of the two");
                keys.report(other, What::LeaveOut { because });
            }
            return Self::UpTo(keys.number(other, limit, Number::positive("m")));
        }
        if !has_count {
            let expected = format!("a whole number from 1 to {MOST}, or {other} in m or error_percent in its place");
            keys.report(name, What::Missing { expected });
            return Self::PerInterval(1);
        }
        Self::PerInterval(keys.count(name, count, 1..=MOST, None))
    }
}

/// Lengths between neighbouring places of a span of `length` (m), its ends included.
fn between<I: Iterator<Item = f64> + Clone>(places: I, length: f64) -> impl Iterator<Item = f64> + use<I> {
    let ends = places.clone().chain([length]);
    std::iter::once(0.0)
        .chain(places)
        .zip(ends)
        .map(|(start, end)| end - start)
}

impl<'a> Section<'a> {
    /// Lengths between neighbouring droppers and supports of a span (counted from 0) along the track, m.
    pub fn intervals_of(self, span: usize) -> impl Iterator<Item = f64> + use<'a> {
        between(self.droppers_of(span).iter().copied(), self.geometry.span_lengths[span])
    }

    /// Lengths between neighbouring fastenings of each kind of wire along the track, m; of equal spans those of one.
    fn intervals(self) -> impl Iterator<Item = ((WireKind, &'a Wire), f64)> {
        let line = self.line;
        let spans = if line.is_uniform() { 1 } else { self.spans() };
        let of_span = move |span: usize| {
            let places = self.contact_attachments(span);
            let contact: Vec<f64> = between(places.iter().copied(), self.span_lengths[span]).collect();
            let contact = contact.into_iter();
            let contact = contact.map(|length| ((WireKind::Contact, &line.contact_wire), length));
            let messenger = line.messenger_wire.as_ref().map(|wire| {
                let places = self.messenger_attachments(span);
                let lengths: Vec<f64> = between(places.iter().copied(), self.span_lengths[span]).collect();
                lengths
                    .into_iter()
                    .map(move |length| ((WireKind::Messenger, wire), length))
            });
            contact.chain(messenger.into_iter().flatten())
        };
        let of_stitch_wire = move |support: usize| {
            let wire = self.stitch_wire_at(support).map(|stitch| &stitch.wire);
            let stations = self.stitch_stations(support);
            let lengths: Vec<f64> = stations.windows(2).map(|ends| ends[1].0 - ends[0].0).collect();
            wire.into_iter().flat_map(move |wire| {
                lengths
                    .clone()
                    .into_iter()
                    .map(move |length| ((WireKind::Stitch, wire), length))
            })
        };
        (0..spans)
            .flat_map(of_span)
            .chain((0..=self.spans()).flat_map(of_stitch_wire))
    }
}

impl Catenary {
    /// Lengths between neighbouring fastenings of each kind of wire along the track, m; of equal spans those of one.
    pub fn intervals(&self) -> impl Iterator<Item = ((WireKind, &Wire), f64)> {
        self.sections().flat_map(Section::intervals)
    }

    /// Number of intervals of the contact wire in one span; where spans differ, in the one that has most.
    #[must_use]
    pub fn intervals_per_span(&self) -> usize {
        let sections = self.sections();
        let most = sections.flat_map(|section| (0..section.spans()).map(move |span| section.droppers_of(span).len()));
        most.max().unwrap_or(0) + 1
    }

    /// Length of the longest interval, m.
    #[must_use]
    pub fn longest_interval(&self) -> f64 {
        self.intervals().map(|(_, length)| length).fold(0.0, f64::max)
    }

    /// Elements that a division makes of the contact wire in a span; where spans differ, in the one that has most.
    #[must_use]
    pub fn elements_per_span(&self, division: Division) -> usize {
        let of_section = |section: Section<'_>| {
            let counts = (0..section.spans()).map(|span| elements_of(section, span, division).sum());
            counts.max().unwrap_or(0)
        };
        self.sections().map(of_section).max().unwrap_or(0)
    }

    /// Reason for which a window cannot follow the strips along the line.
    pub(crate) fn without_window(&self) -> Option<&'static str> {
        if !self.has_common_masts() {
            return Some(
                "it is cut at masts, and one of the tension lengths has no support at a mast that it passes, or two of \
                 them follow each other without an overlap",
            );
        }
        (self.surface.is_some())
            .then_some("it is made for wires of even running surface, and the line has catenary.surface")
    }

    /// Length of the elements of each interval along the track, m, and their number, with the kind of wire.
    pub fn elements(&self) -> impl Iterator<Item = ((WireKind, &Wire), f64, usize)> {
        self.intervals().map(|(wire, length)| {
            let count = self.mesh.division.elements(length);
            (wire, length / count as f64, count)
        })
    }

    /// Length of the shortest element of the wires of a kind along the track, m; infinite without such wires.
    #[must_use]
    pub fn shortest_element(&self, kind: WireKind) -> f64 {
        let own = self.elements().filter(|((of, _), ..)| *of == kind);
        own.map(|(_, length, _)| length).fold(f64::INFINITY, f64::min)
    }

    /// Length of the longest element along the track, m.
    #[must_use]
    pub fn longest_element(&self) -> f64 {
        self.elements().map(|(_, length, _)| length).fold(0.0, f64::max)
    }

    /// No interval has more elements than it may.
    pub(crate) fn check_division(&self, found: &mut Found) {
        let Division::UpTo(limit) = self.mesh.division else {
            return;
        };
        let longest = self.longest_interval();
        if self.mesh.division.elements(longest) > MOST {
            let expected = format!(
                "must be at least {} m: an interval between droppers, here up to {longest} m, has at most {MOST} \
                 elements",
                longest / MOST as f64
            );
            refuse(
                found,
                "catenary.mesh.element_length",
                shown_number(limit, "m"),
                expected,
            );
        }
    }
}

/// Elements that a division makes of each interval of the contact wire in a span.
fn elements_of(section: Section<'_>, span: usize, division: Division) -> impl Iterator<Item = usize> {
    section.intervals_of(span).map(move |length| division.elements(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_that_divides_a_length_leaves_no_element_of_rounding() {
        for length in [5.0, 5.5, 6.5, 60.0 - 53.5, 0.1 + 0.2, 1e-3, 1e3] {
            for count in 1..=MOST {
                let limit = Division::UpTo(length / count as f64);
                assert_eq!(limit.elements(length), count, "{length} m");
            }
        }
        assert_eq!(Division::UpTo(0.8125).elements(6.5), 8);
        assert_eq!(Division::UpTo(0.8124).elements(6.5), 9);
        assert_eq!(Division::UpTo(1e3).elements(6.5), 1);
        assert_eq!(Division::PerInterval(8).elements(6.5), 8);
    }
}
