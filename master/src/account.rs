//! Where the wall time of a run goes: shares of its time loop.
//!
//! | what runs | parts | how they are measured |
//! | --- | --- | --- |
//! | coupled sides | `catenary`, `pantograph[i]` with its vehicle | every call of a side, see [`Timed`](crate::timed::Timed) |
//! | one system | contributions, solver | an [`Account`]: one step in [`EVERY`], factorisations always |
//!
//! The last share is always [`MASTER`]: what is left of the time loop, coupling and recording above all.

use std::time::{Duration, Instant};

use dynamics::Stage;

use crate::results::Share;

/// What is left.
pub const MASTER: &str = "master";

/// The pattern, assembly and factors of the iteration matrix.
pub const FACTORIZATION: &str = "factorization";

/// Corrections from the factors.
pub const LINEAR_SOLUTION: &str = "linear_solution";

/// Prediction, sums, applied corrections: what a step does beside its parts.
pub const TIME_INTEGRATION: &str = "time_integration";

/// One step in so many is looked at: some hundred looks at a clock, 30 ns each, cost a step of 50 µs 6 % and so a run 0.4 %. Prime, so
/// that it does not keep pace with communication points and rows of output.
pub const EVERY: u64 = 17;

/// More parts than a scene has: no memory is asked for later.
const PARTS: usize = 32;

/// Shares of `wall` s from the times (s) of parts that exclude one another; what is left is the [`MASTER`]'s. None where nothing was
/// measured.
#[must_use]
pub fn shares(wall: f64, times: impl IntoIterator<Item = (String, f64)>) -> Vec<Share> {
    let mut shares: Vec<Share> = times
        .into_iter()
        .filter(|(_, time)| *time > 0.0)
        .map(|(part, time)| Share {
            part,
            share: time / wall,
        })
        .collect();
    if !shares.is_empty() {
        // Times within the loop are no longer than it, but for rounding.
        let left = 1.0 - shares.iter().map(|share| share.share).sum::<f64>();
        shares.push(Share {
            part: MASTER.to_owned(),
            share: left.max(0.0),
        });
    }
    shares
}

/// What the steps of one system are spent on.
pub struct Account {
    /// Steps that have ended.
    steps: u64,
    /// Whether the present step is looked at.
    looks: bool,
    /// Time of each part in the steps that were looked at.
    parts: Vec<(&'static str, Duration)>,
    /// Which part is under way, and since when, as far as it is not in `parts` yet.
    present: usize,
    since: Instant,
    /// Since when the matrix is being factored, where it is.
    factoring: Option<Instant>,
    factorization: Duration,
    /// When the present advance has begun, and the time of those that have ended.
    begun: Instant,
    advancing: Duration,
}

impl Account {
    /// An empty one.
    #[must_use]
    pub fn new() -> Self {
        let now = Instant::now();
        let mut parts = Vec::with_capacity(PARTS);
        parts.push((TIME_INTEGRATION, Duration::ZERO));
        Self {
            steps: 0,
            looks: true,
            parts,
            present: 0,
            since: now,
            factoring: None,
            factorization: Duration::ZERO,
            begun: now,
            advancing: Duration::ZERO,
        }
    }

    /// Whether it is worth telling what part is under way.
    #[must_use]
    pub fn looks(&self) -> bool {
        self.looks && self.factoring.is_none()
    }

    /// An advance over one or more steps begins.
    pub fn begin(&mut self) {
        self.begun = Instant::now();
        self.since = self.begun;
    }

    /// The advance ends, completed or not.
    pub fn end(&mut self) {
        self.enter(Stage::Integration);
        let now = Instant::now();
        self.close(now);
        self.advancing += now - self.begun;
    }

    /// From here on `part` is under way.
    pub fn turn_to(&mut self, part: &'static str) {
        if !self.looks() || self.parts[self.present].0 == part {
            return;
        }
        self.close(Instant::now());
        let known = self.parts.iter().position(|(name, _)| *name == part);
        self.present = known.unwrap_or_else(|| {
            self.parts.push((part, Duration::ZERO));
            self.parts.len() - 1
        });
    }

    /// The solver turns to something else.
    pub fn enter(&mut self, stage: Stage) {
        if stage == Stage::Factorization {
            let now = Instant::now();
            self.close(now);
            self.factoring = Some(now);
            return;
        }
        if let Some(begun) = self.factoring.take() {
            self.since = Instant::now();
            self.factorization += self.since - begun;
        }
        self.turn_to(match stage {
            Stage::Solution => LINEAR_SOLUTION,
            _ => TIME_INTEGRATION,
        });
    }

    /// A step has ended, with whatever is done after it.
    pub fn step_done(&mut self) {
        self.steps += 1;
        self.turn_to(TIME_INTEGRATION);
        let looks = self.steps.is_multiple_of(EVERY);
        if looks != self.looks {
            let now = Instant::now();
            self.close(now);
            self.looks = looks;
        }
    }

    /// Books the time up to `now`.
    fn close(&mut self, now: Instant) {
        if self.looks && self.factoring.is_none() {
            self.parts[self.present].1 += now - self.since;
        }
        self.since = now;
    }

    /// Shares of a time loop of `wall` s.
    #[must_use]
    pub fn shares(&self, wall: f64) -> Vec<Share> {
        let seen: Duration = self.parts.iter().map(|(_, time)| *time).sum();
        let steps = (self.advancing.saturating_sub(self.factorization)).as_secs_f64();
        let scale = steps / seen.as_secs_f64().max(f64::MIN_POSITIVE);
        let sampled = |wanted: &'static str| {
            let parts = self.parts.iter().filter(move |(part, _)| *part == wanted);
            parts.map(move |(part, time)| ((*part).to_owned(), scale * time.as_secs_f64()))
        };
        // Contributions in the order in which they are visited, then what the solver does.
        let others = [MASTER, LINEAR_SOLUTION, TIME_INTEGRATION];
        let contributions = self.parts.iter().map(|(part, _)| *part);
        let contributions = contributions.filter(|part| !others.contains(part)).flat_map(sampled);
        let factorization = (FACTORIZATION.to_owned(), self.factorization.as_secs_f64());
        let times = contributions.chain([factorization]);
        shares(
            wall,
            times.chain(sampled(LINEAR_SOLUTION)).chain(sampled(TIME_INTEGRATION)),
        )
    }
}

impl Default for Account {
    fn default() -> Self {
        Self::new()
    }
}
