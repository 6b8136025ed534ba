//! Long lines of equal spans, solved as short ones.
use super::{ElasticityReport, StaticAnswer, StaticLine, StaticsError, StaticsReport};
use crate::LineOptions;
use crate::line::window::{SAME, Source};
use scene::Catenary;

/// Spans at either end of a line that may differ from its periodic middle.
const MARGIN: usize = 2;
/// Longest period that is tried, spans.
const LONGEST_PERIOD: usize = 8;
/// Spans of the short line, at least.
const KNOWN: usize = 16;

/// Map of the spans of a line to the solved ones that stand for them: the middle of a long line repeats itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Repeat {
    /// Spans of the line.
    pub spans: usize,
    /// Spans that were solved.
    pub known: usize,
    /// Period of the middle, spans; none without repetition.
    pub period: Option<usize>,
}

impl Repeat {
    /// Map of a line with all spans solved.
    pub fn of_solved(source: &Source<'_>) -> Self {
        let spans = source.catenary.spans();
        let middle = MARGIN..if source.topology.has_common_nodes() {
            spans.saturating_sub(MARGIN)
        } else {
            0
        };
        let period = (1..=LONGEST_PERIOD)
            .filter(|period| middle.len() >= 2 * period)
            .find(|&period| {
                let mut pairs = middle.start..middle.end - period;
                pairs.all(|span| source.difference(span, span + period) <= SAME)
            });
        Self {
            spans,
            known: spans,
            period,
        }
    }

    /// The solved spans that stand for `count` spans of the line from `from` on; the first of them.
    pub fn source_of(&self, from: usize, count: usize) -> usize {
        match self.period {
            Some(_) if from + count + MARGIN >= self.spans && from > MARGIN => self.known - (self.spans - from),
            Some(period) if from > MARGIN => {
                // Spans about the middle of the solved ones, in step with the period.
                let middle = MARGIN + (self.known / 2).saturating_sub(MARGIN + count / 2) / period * period;
                let last = self.known.saturating_sub(MARGIN + count + period - 1);
                let middle = middle.min(MARGIN + last.saturating_sub(MARGIN) / period * period);
                middle + (from - MARGIN) % period
            }
            _ => from,
        }
    }
}

impl StaticLine {
    /// Solves the static state of a line of which at most `together` consecutive spans are used at a time.
    ///
    /// In place of a long line with equal spans a line of a few dozen spans is solved, provided that its middle repeats
    /// itself to `SAME` with the period of the stagger: the long line then repeats itself likewise, because its end
    /// effects end within the same spans. Memory and time do not grow with the number of spans.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn solve_long(catenary: &Catenary, options: LineOptions, together: usize) -> Result<Self, StaticsError> {
        let (spans, cycle) = (catenary.spans(), catenary.first().stagger.len());
        // A stop depends on the length of the whole line.
        let stops = catenary.tensioning.is_some_and(|device| device.travel.is_some());
        let uniform = catenary.is_uniform() && !stops;
        let mut known = KNOWN.max(2 * MARGIN + 2 * cycle + together);
        // The last support keeps its phase of the stagger.
        known += spans.saturating_sub(known) % cycle;
        while uniform && cycle <= LONGEST_PERIOD && 2 * known <= spans {
            let short = catenary.part(0, known);
            let mut line = Self::solve(&short, options)?;
            let repeat = Repeat::of_solved(&line.source());
            if repeat.period.is_some_and(|period| cycle % period == 0) {
                line.repeat = Repeat { spans, ..repeat };
                line.whole = catenary.clone();
                line.report = line.repeated(&line.report);
                return Ok(line);
            }
            known = 2 * known + spans.saturating_sub(2 * known) % cycle;
        }
        Self::solve(catenary, options)
    }

    /// Number of spans.
    #[must_use]
    pub fn spans(&self) -> usize {
        self.repeat.spans
    }

    /// For each span of a long line solved as a short one, the solved span (from 0) that stands for it, and the way
    /// from there along the track, m; none of a line with all spans solved.
    pub fn spans_of_short_line(&self) -> Option<impl Iterator<Item = (usize, f64)> + '_> {
        (self.repeat.spans > self.repeat.known).then(|| {
            (0..self.repeat.spans).map(|span| {
                let solved = self.repeat.source_of(span, 1);
                (solved, self.whole.support_x(span) - self.catenary.support_x(solved))
            })
        })
    }

    /// Elements of both wires together.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.topology.elements() / self.repeat.known * self.repeat.spans
    }

    /// Place among the solved spans that stands for `x` (m).
    fn solved_place(&self, x: f64) -> f64 {
        if self.repeat.spans == self.repeat.known {
            return x;
        }
        let length = self.whole.span_lengths()[0];
        let span = ((x / length).max(0.0) as usize).min(self.repeat.spans - 1);
        x - self.whole.support_x(span) + self.catenary.support_x(self.repeat.source_of(span, 1))
    }

    /// Static state with an upward force (N) on the contact wire at `x` (m).
    ///
    /// The force is held at the place along the track, not on a point of the wire. The residual compliance of the
    /// contact wire, if any, is that of the moving strips, with which a run begins: height and force are those of a
    /// strip at the start. A long line solved as a short one returns the coordinates of the short one.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn wire_height_under(&self, x: f64, force: f64) -> Result<StaticAnswer, StaticsError> {
        let length = self.whole.length();
        if !(0.0..=length).contains(&x) {
            return Err(StaticsError::BesideTheLine { x, length });
        }
        self.solved_height_under(self.solved_place(x), force)
    }

    /// Height of the contact wire at `x` (m) under an upward force in N, m; the last few are kept.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn wire_height(&self, x: f64, force: f64) -> Result<f64, StaticsError> {
        self.heights.or_made((x, force), || {
            self.wire_height_under(x, force).map(|answer| answer.height)
        })
    }

    /// Elasticity of the contact wire at each `x` (m): its rise under an upward force of 100 N at rest, per newton,
    /// residual compliance included. Slack droppers are followed.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn elasticity(&self, x: &[f64]) -> Result<Vec<ElasticityReport>, StaticsError> {
        let mut sorted = x.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let length = self.whole.length();
        if let Some(&x) = sorted.iter().find(|x| !(0.0..=length).contains(*x)) {
            return Err(StaticsError::BesideTheLine { x, length });
        }
        let solved: Vec<f64> = sorted.iter().map(|&x| self.solved_place(x)).collect();
        let reports = self.solved_elasticity(&solved)?;
        let reports = sorted
            .iter()
            .zip(reports)
            .map(|(&x, report)| ElasticityReport { x, ..report });
        Ok(reports.collect())
    }

    /// Report on all spans from that on a short line.
    fn repeated(&self, found: &StaticsReport) -> StaticsReport {
        let repeat = &self.repeat;
        let per_span = self.catenary.droppers.positions[0].len();
        let longer = self.whole.length() / self.catenary.length();
        let ends = found.ends.iter().map(|end| super::EndReport {
            x: if end.x > 0.0 { self.whole.length() } else { end.x },
            travel: end.travel * longer,
            weights: end.weights * longer,
            ..end.clone()
        });
        let mut report = StaticsReport {
            ends: ends.collect(),
            droppers: Vec::new(),
            supports: Vec::new(),
            ..found.clone()
        };
        for (span, (source, shift)) in self.spans_of_short_line().into_iter().flatten().enumerate() {
            for dropper in &found.droppers[source * per_span..(source + 1) * per_span] {
                report.droppers.push(super::DropperReport {
                    span: span + 1,
                    x: dropper.x + shift,
                    ..*dropper
                });
            }
            for support in &found.supports[source..source + 1 + usize::from(span + 1 == repeat.spans)] {
                report.supports.push(super::SupportReport {
                    x: support.x + shift,
                    ..*support
                });
            }
        }
        report
    }
}
