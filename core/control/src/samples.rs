//! Times of samples.

/// Part of a sample time within which two times are one.
const SAME_TIME: f64 = 1e-7;

/// Samples at even distances, number `k` at `t = k T`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples {
    /// `T`, s.
    distance: f64,
}

impl Samples {
    /// Samples every `distance` s.
    #[must_use]
    pub fn every(distance: f64) -> Self {
        Self { distance }
    }

    /// Time of sample `number`, s.
    #[must_use]
    pub fn time(&self, number: i64) -> f64 {
        number as f64 * self.distance
    }

    /// Number of the first sample at `t` s or later.
    #[must_use]
    pub fn first_from(&self, t: f64) -> i64 {
        (t / self.distance - SAME_TIME).ceil() as i64
    }

    /// Number of the first sample later than `t` s.
    #[must_use]
    pub fn first_after(&self, t: f64) -> i64 {
        ((t / self.distance + SAME_TIME).floor() as i64).saturating_add(1)
    }

    /// True where `event` (s) is not later than `t` s.
    #[must_use]
    pub fn is_due(&self, event: f64, t: f64) -> bool {
        event <= t + SAME_TIME * self.distance
    }
}
