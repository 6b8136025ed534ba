//! Which spans are modelled, and how, for each position of the window.
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
    /// For each reduced span its modes; empty for those of the window. Spans are counted from the first modelled one.
    pub modes: Vec<Range<usize>>,
    /// For each support that is an end of reduced spans only its first coordinate.
    pub supports: Vec<Option<usize>>,
    /// First coordinate that is not in use.
    pub used: usize,
}

/// Modes that are kept of a reduced span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ModeCounts {
    /// Of a near span behind the window.
    pub behind: usize,
    /// Of a near span ahead of it.
    pub ahead: usize,
    /// Of a span further away.
    pub far: usize,
}

/// The rules for a line.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Spans of the line.
    pub spans: usize,
    /// Spans of the window.
    pub window: usize,
    /// Spans of the window behind that of the last strip.
    pub behind: usize,
    /// The window moves by as many spans at a time.
    pub stride: usize,
    /// Reduced spans on either side, at most.
    pub reach: usize,
    /// Those of them, nearest to the window, that carry all waves of interest.
    pub near: usize,
    /// Modes of reduced spans.
    pub modes: ModeCounts,
    /// Coordinates of a support.
    pub at_support: usize,
    /// First coordinate behind those of the window.
    pub first: usize,
}

impl Plan {
    /// Coordinates of the `distance`-th span behind the window, counted from 1, its outer support included.
    fn behind(&self, distance: usize) -> usize {
        let modes = if distance > self.near { self.modes.far } else { self.modes.behind };
        modes + self.at_support
    }

    /// See [`Plan::behind`].
    fn ahead(&self, distance: usize) -> usize {
        let modes = if distance > self.near { self.modes.far } else { self.modes.ahead };
        modes + self.at_support
    }

    /// Coordinates of all reduced spans at any position.
    pub fn most_coordinates(&self) -> usize {
        let positions = 0..=self.spans - self.window;
        let used = positions.map(|at| {
            let (left, right) = self.reduced(at);
            let behind: usize = (1..=left).map(|distance| self.behind(distance)).sum();
            let ahead: usize = (1..=right).map(|distance| self.ahead(distance)).sum();
            behind + ahead
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

    /// What is where with the window at `at`.
    pub fn arrangement(&self, at: usize) -> Arrangement {
        let (left, right) = self.reduced(at);
        let window = at..at + self.window;
        let modelled = at - left..window.end + right;
        let mut modes = vec![0..0; modelled.len()];
        let mut supports = vec![None; modelled.len() + 1];
        let mut next = self.first;
        let mut take = |count: usize| {
            next += count;
            (next - count..next - self.at_support, Some(next - self.at_support))
        };
        for distance in 1..=left {
            let span = left - distance;
            (modes[span], supports[span]) = take(self.behind(distance));
        }
        for distance in 1..=right {
            let span = left + self.window + distance - 1;
            (modes[span], supports[span + 1]) = take(self.ahead(distance));
        }
        Arrangement {
            at,
            window,
            modelled,
            modes,
            supports,
            used: next,
        }
    }
}

impl Arrangement {
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
                behind: 10,
                ahead: 20,
                far: 5,
            },
            at_support: 8,
            first: 1000,
        }
    }

    #[test]
    fn a_long_line_costs_as_much_as_a_longer_one() {
        assert_eq!(plan(80).most_coordinates(), plan(2000).most_coordinates());
        assert!(plan(10).most_coordinates() < plan(80).most_coordinates());
    }

    #[test]
    fn every_coordinate_is_used_once_and_every_modelled_span_has_its_place() {
        for spans in [3, 4, 10, 80] {
            let plan = plan(spans);
            for at in 0..=spans - 3 {
                let found = plan.arrangement(at);
                let mut taken = vec![0; plan.most_coordinates()];
                for (i, modes) in found.modes.iter().enumerate() {
                    let own = modes
                        .clone()
                        .chain(found.supports[i].iter().flat_map(|&first| first..first + 8));
                    own.for_each(|index| taken[index - 1000] += 1);
                }
                if let Some(first) = found.supports[found.modelled.len()] {
                    (first..first + 8).for_each(|index| taken[index - 1000] += 1);
                }
                assert!(taken[..found.used - 1000].iter().all(|&count| count == 1));
                assert!(taken[found.used - 1000..].iter().all(|&count| count == 0));
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
