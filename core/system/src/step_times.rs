//! Wall times of the macro steps of a run, and their pace in real time.

use std::time::{Duration, Instant};

use component::Percentiles;
use hdrhistogram::Histogram;

/// Longest step that is told apart, ns.
const LONGEST: u64 = 1_000_000_000_000;
/// Digits of a time that are kept.
const DIGITS: u8 = 3;

/// Wall times of macro steps, in constant memory.
#[derive(Clone, Debug)]
pub struct StepTimes {
    /// Times of steps, ns.
    steps: Histogram<u64>,
    /// Times by which paced steps began late, ns; what the machine disturbs where steps are short.
    late: Histogram<u64>,
    /// Start of real time; none where steps follow each other at once.
    start: Option<Instant>,
    paced: bool,
    begun: Instant,
    missed: u64,
}

impl StepTimes {
    /// No step yet; `paced` steps begin when real time has reached them.
    ///
    /// # Panics
    /// Never: the bounds of the histograms are possible ones.
    #[must_use]
    pub fn new(paced: bool) -> Self {
        let histogram = || Histogram::new_with_bounds(1, LONGEST, DIGITS).expect("bounds are possible");
        Self {
            steps: histogram(),
            late: histogram(),
            start: None,
            paced,
            begun: Instant::now(),
            missed: 0,
        }
    }

    /// Begins the step from `t` s after the start, when real time has come there.
    pub fn begin(&mut self, t: f64) {
        if self.paced {
            let due = *self.start.get_or_insert_with(Instant::now) + Duration::from_secs_f64(t);
            // Awake, as on a core that is kept for the simulation: threads that sleep wake late, with cold caches.
            while Instant::now() < due {
                std::hint::spin_loop();
            }
            self.late.saturating_record(nanoseconds(due.elapsed()));
        }
        self.begun = Instant::now();
    }

    /// Ends the step that is due at `t` s after the start.
    pub fn end(&mut self, t: f64) {
        let now = Instant::now();
        self.steps.saturating_record(nanoseconds(now - self.begun));
        if let Some(start) = self.start {
            self.missed += u64::from(now > start + Duration::from_secs_f64(t));
        }
    }

    /// Steps counted.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.steps.len()
    }

    /// Paced steps that ended after they were due.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Times of steps.
    #[must_use]
    pub fn steps(&self) -> Percentiles {
        percentiles(&self.steps)
    }

    /// Times by which paced steps began late.
    #[must_use]
    pub fn late(&self) -> Percentiles {
        percentiles(&self.late)
    }

    /// Adds the steps of another run.
    ///
    /// # Panics
    /// Never: all histograms have the same bounds.
    pub fn add(&mut self, other: &Self) {
        self.steps.add(&other.steps).expect("bounds are the same");
        self.late.add(&other.late).expect("bounds are the same");
        self.missed += other.missed;
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX).max(1)
}

fn percentiles(times: &Histogram<u64>) -> Percentiles {
    let at = |percent: f64| 1e-9 * times.value_at_percentile(percent) as f64;
    Percentiles {
        p50_s: at(50.0),
        p99_s: at(99.0),
        p99_9_s: at(99.9),
        p99_99_s: at(99.99),
        longest_s: 1e-9 * times.max() as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paced_steps_begin_when_they_are_due_and_late_ones_are_missed() {
        let begin = Instant::now();
        let mut times = StepTimes::new(true);
        for n in 0..10 {
            let t = 2e-3 * f64::from(n);
            times.begin(t);
            if n == 4 {
                std::thread::sleep(Duration::from_millis(3));
            }
            times.end(t + 2e-3);
        }
        assert!(begin.elapsed() >= Duration::from_millis(18));
        assert!(times.count() == 10 && times.missed() >= 1);
        let steps = times.steps();
        assert!(
            steps.longest_s >= 3e-3 && steps.p50_s <= steps.p99_s && steps.p99_s <= steps.longest_s,
            "{steps:?}"
        );
    }

    #[test]
    fn percentiles_are_those_of_the_times() {
        let mut times = StepTimes::new(false);
        (1..=1000).for_each(|time| times.steps.saturating_record(1000 * time));
        let steps = times.steps();
        for (found, expected) in [(steps.p50_s, 500e-6), (steps.p99_s, 990e-6), (steps.longest_s, 1000e-6)] {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
        let mut both = times.clone();
        both.add(&times);
        assert!(both.count() == 2000 && both.steps() == steps && both.missed() == 0);
    }
}
