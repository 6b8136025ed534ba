//! Modelled spans and their reduction for each position of the window.
use std::ops::Range;

/// Spans of the line at one position of the window; spans and supports are numbered from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Arrangement {
    /// First span of the window.
    pub at: usize,
    /// Spans of the window.
    pub window: Range<usize>,
    /// All spans modelled.
    pub modelled: Range<usize>,
    /// For each reduced span, its modes; empty for spans of the window. Spans are counted from the first modelled one.
    pub modes: Vec<Range<usize>>,
    /// For each reduced span, the elongations of its droppers that are coordinates; counted as `modes`.
    pub elongations: Vec<Range<usize>>,
    /// Coordinates of each support between reduced spans; none for other supports.
    pub supports: Vec<Option<Range<usize>>>,
}

/// Numbers of modes kept of a reduced span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ModeCounts {
    /// Modes of a near span.
    pub near: usize,
    /// Modes of a span further away.
    pub far: usize,
    /// Lowest modes among which those that are kept are found.
    pub searched: usize,
}

/// Rules for the arrangements of a line.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Spans of the line.
    pub spans: usize,
    /// Spans of the window.
    pub window: usize,
    /// Spans of the window behind that of the last strip.
    pub behind: usize,
    /// Spans by which the window moves at a time.
    pub stride: usize,
    /// Reduced spans on either side, at most.
    pub reach: usize,
    /// Reduced spans nearest to the window that carry all waves of interest.
    pub near: usize,
    /// Modes of reduced spans of one tension length.
    pub modes: ModeCounts,
    /// Tension lengths in each span; none given, one each.
    pub beside: Vec<usize>,
    /// Coordinates of a support, at most.
    pub at_support: usize,
    /// Elongations of droppers that are coordinates of a reduced span, at most.
    pub elongations: usize,
    /// Coordinates of the window, at most.
    pub inner: usize,
    /// First coordinate of the line.
    pub first: usize,
}

impl Plan {
    /// Tension lengths in a span.
    pub fn beside(&self, span: usize) -> usize {
        self.beside.get(span).copied().unwrap_or(1)
    }

    /// Modes of a span, the `distance`-th from the window, counted from 1.
    fn mode_count(&self, span: usize, distance: usize) -> usize {
        let of_one = if distance > self.near {
            self.modes.far
        } else {
            self.modes.near
        };
        self.beside(span) * of_one
    }

    /// Reduced spans on one side, at most.
    fn most(&self) -> usize {
        self.reach.min(self.spans - self.window)
    }

    /// Number of coordinates of a reduced span and one of its supports, without the modes.
    fn interface(&self) -> usize {
        self.at_support + self.elongations
    }

    /// First coordinate of the window. All interfaces and the window follow one another along the track, so that only
    /// neighbours are coupled; modes come last.
    pub fn window_first(&self) -> usize {
        self.first + self.most() * self.interface()
    }

    fn modes_first(&self) -> usize {
        self.window_first() + self.inner + self.most() * self.interface()
    }

    /// Number of coordinates at any position.
    pub fn coordinates(&self) -> usize {
        self.modes_first() - self.first + self.most_modes()
    }

    fn most_modes(&self) -> usize {
        let positions = 0..=self.spans - self.window;
        let used = positions.map(|at| {
            let (left, right) = self.reduced(at);
            let of_left = (1..=left).map(|distance| self.mode_count(at - distance, distance));
            let of_right = (1..=right).map(|distance| self.mode_count(at + self.window + distance - 1, distance));
            of_left.chain(of_right).sum()
        });
        used.max().unwrap_or(0)
    }

    fn reduced(&self, at: usize) -> (usize, usize) {
        (at.min(self.reach), (self.spans - self.window - at).min(self.reach))
    }

    /// The position for a last strip in span `span`.
    pub fn position(&self, span: usize) -> usize {
        let at = span.saturating_sub(self.behind) / self.stride * self.stride;
        at.min(self.spans - self.window)
    }

    /// Arrangement with the window at `at`.
    pub fn arrangement(&self, at: usize) -> Arrangement {
        let (left, right) = self.reduced(at);
        let window = at..at + self.window;
        let modelled = at - left..window.end + right;
        let (mut modes, mut elongations) = (vec![0..0; modelled.len()], vec![0..0; modelled.len()]);
        let mut supports = vec![None; modelled.len() + 1];
        let mut next = self.modes_first();
        let mut take = |count: usize| {
            next += count;
            next - count..next
        };
        for distance in 1..=left {
            let span = left - distance;
            modes[span] = take(self.mode_count(at - distance, distance));
            let support = self.window_first() - distance * self.interface();
            supports[span] = Some(support..support + self.at_support);
            elongations[span] = support + self.at_support..support + self.interface();
        }
        for distance in 1..=right {
            let span = left + self.window + distance - 1;
            modes[span] = take(self.mode_count(window.end + distance - 1, distance));
            let support = self.window_first() + self.inner + distance * self.interface() - self.at_support;
            supports[span + 1] = Some(support..support + self.at_support);
            elongations[span] = support - self.elongations..support;
        }
        Arrangement {
            at,
            window,
            modelled,
            modes,
            elongations,
            supports,
        }
    }
}

impl Arrangement {
    /// Coordinates of all reduced spans.
    pub fn reduced(&self) -> impl Iterator<Item = usize> + '_ {
        let supports = self.supports.iter().flatten();
        let spans = self.modes.iter().chain(&self.elongations);
        spans.chain(supports).cloned().flatten()
    }

    /// Leaves those coordinates unused that a support or a span, both of the line, has fewer of than the largest one.
    pub fn trim(&mut self, at_support: impl Fn(usize) -> usize, elongations: impl Fn(usize) -> usize) {
        let first = self.modelled.start;
        for (number, support) in self.supports.iter_mut().enumerate() {
            if let Some(places) = support {
                places.end = places.start + at_support(first + number);
            }
        }
        for (number, places) in self.elongations.iter_mut().enumerate() {
            if !self.window.contains(&(first + number)) {
                places.end = places.start + elongations(first + number);
            }
        }
    }

    /// Elongations and modes of a span; none for a span that is not modelled, empty in the window.
    pub fn own(&self, span: usize) -> Option<(Range<usize>, Range<usize>)> {
        let place = span.checked_sub(self.modelled.start)?;
        Some((self.elongations.get(place)?.clone(), self.modes[place].clone()))
    }

    /// Distance of a modelled span from the window, from 1; 0 in the window.
    pub fn distance(&self, span: usize) -> usize {
        if span < self.window.start {
            self.window.start - span
        } else {
            (span + 1).saturating_sub(self.window.end)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(spans: usize) -> Plan {
        Plan {
            spans,
            window: 3,
            behind: 1,
            stride: 1,
            reach: 8,
            near: 4,
            modes: ModeCounts {
                near: 20,
                far: 5,
                searched: 30,
            },
            beside: Vec::new(),
            at_support: 8,
            elongations: 3,
            inner: 100,
            first: 1000,
        }
    }

    #[test]
    fn a_long_line_costs_as_much_as_a_longer_one() {
        assert_eq!(plan(80).coordinates(), plan(2000).coordinates());
        assert!(plan(10).coordinates() < plan(80).coordinates());
    }

    #[test]
    fn every_coordinate_is_used_once_and_every_modelled_span_has_its_place() {
        for spans in [3, 4, 10, 80] {
            let plan = plan(spans);
            for at in 0..=spans - 3 {
                let found = plan.arrangement(at);
                let mut taken = vec![false; plan.coordinates()];
                for index in found.reduced().chain(plan.window_first()..plan.window_first() + 100) {
                    assert!(!std::mem::replace(&mut taken[index - 1000], true));
                }
                assert!(found.modelled.start == at.saturating_sub(8) && found.modelled.end == (at + 11).min(spans));
            }
        }
    }

    #[test]
    fn the_window_follows_the_last_strip_and_stays_on_the_line() {
        let plan = plan(10);
        let positions: Vec<usize> = (0..10).map(|span| plan.position(span)).collect();
        assert_eq!(positions, [0, 0, 1, 2, 3, 4, 5, 6, 7, 7]);
    }
}
