//! Exchanged values at a communication point.

use crate::exchange::{contact, strip};

/// All outputs at one communication point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Time, s.
    pub t: f64,
    /// Start of the step that led here, s; `t` itself at the first point.
    pub from: f64,
    /// Outputs of the line.
    pub line: Vec<f64>,
    /// Outputs of the pantographs, one after the other.
    pub strips: Vec<f64>,
}

impl Point {
    /// A point at `t` s with zeros for `strips` pantographs and `line_outputs` outputs of the line.
    #[must_use]
    pub fn new(t: f64, strips: usize, line_outputs: usize) -> Self {
        Self {
            t,
            from: t,
            line: vec![0.0; line_outputs],
            strips: vec![0.0; strips * strip::OUTPUTS],
        }
    }

    /// Outputs of the line that belong to strip `i`.
    #[inline]
    #[must_use]
    pub fn contact(&self, i: usize) -> &[f64] {
        &self.line[i * contact::COUNT..(i + 1) * contact::COUNT]
    }

    /// Outputs of pantograph `i`.
    #[inline]
    #[must_use]
    pub fn strip(&self, i: usize) -> &[f64] {
        &self.strips[i * strip::OUTPUTS..(i + 1) * strip::OUTPUTS]
    }

    /// Number of strips.
    #[inline]
    #[must_use]
    pub fn strip_count(&self) -> usize {
        self.strips.len() / strip::OUTPUTS
    }

    /// Work of the strips on the line and of the contact on the strips, J.
    #[must_use]
    pub fn work(&self) -> f64 {
        (0..self.strip_count())
            .map(|i| self.contact(i)[contact::WORK] + self.strip(i)[strip::WORK])
            .sum()
    }
}
