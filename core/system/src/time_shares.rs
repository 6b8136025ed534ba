//! Shares of the parts of a run in the wall time of its time loop.
//!
//! | what runs | parts | how they are measured |
//! | --- | --- | --- |
//! | coupled sides | `catenary`, `pantograph[i]` with its vehicle | calls of a side: `cosim::timed::Timed` |
//! | one system | contributions, solver | an [`Profile`]: one step in [`EVERY`], factorisations always |
//!
//! The last share is always [`MASTER`]: what is left of the time loop, coupling and recording above all.

use std::time::{Duration, Instant};

use dynamics::Stage;

use component::Share;

/// Remainder.
pub const MASTER: &str = "master";

/// The pattern, assembly and factors of the iteration matrix.
pub const FACTORIZATION: &str = "factorization";

/// Corrections from the factors.
pub const LINEAR_SOLUTION: &str = "linear_solution";

/// Prediction, sums, applied corrections: what a step does beside its parts.
pub const TIME_INTEGRATION: &str = "time_integration";

/// One step in so many is timed, because reading the clock costs a noticeable part of a short step. Prime, so that the
/// timed steps do not keep pace with communication points and rows of output.
pub const EVERY: u64 = 31;

/// More parts than a scene has: no memory is asked for later.
const PARTS: usize = 32;

/// Shares of `wall` s from the times (s) of parts that exclude one another; what is left is the [`MASTER`]'s. None
/// where nothing was measured.
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

/// Parts on which the steps of one system spend their time.
pub struct Profile {
    /// Steps that have ended.
    steps: u64,
    /// True where the present step is timed.
    looks: bool,
    /// Time of each part in the steps that were looked at.
    parts: Vec<(&'static str, Duration)>,
    /// Part under way, and since when, as far as it is not in `parts` yet.
    present: usize,
    since: Instant,
    /// Since when the matrix is being factored, where it is.
    factoring: Option<Instant>,
    factorization: Duration,
    /// Begin of the present advance, and the time of those that have ended; what is done outside of them is no
    /// step.
    begun: Option<Instant>,
    advancing: Duration,
}

impl Profile {
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
            begun: None,
            advancing: Duration::ZERO,
        }
    }

    /// True where telling the part under way is worth its cost.
    #[must_use]
    pub fn looks(&self) -> bool {
        self.looks && self.begun.is_some() && self.factoring.is_none()
    }

    /// An advance over one or more steps begins.
    pub fn begin(&mut self) {
        self.since = Instant::now();
        self.begun = Some(self.since);
    }

    /// The advance ends, completed or not.
    pub fn end(&mut self) {
        self.enter(Stage::Integration);
        let now = Instant::now();
        self.close(now);
        if let Some(begun) = self.begun.take() {
            self.advancing += now - begun;
        }
    }

    /// From here on `part` is under way.
    pub fn turn_to(&mut self, part: &'static str) {
        let present = self.parts[self.present].0;
        // Most visits are to the part of the one before: of one type, they share the word itself.
        if !self.looks() || std::ptr::eq(present, part) || present == part {
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
        if self.begun.is_none() {
            return;
        }
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

    /// Leaves out the part under way, as if spread over all parts: too rare, and too long, for one step in [`EVERY`] to
    /// stand for others.
    pub fn leave_out(&mut self) {
        self.since = Instant::now();
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
        if self.looks() {
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

impl Default for Profile {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lets a clock of any resolution move on.
    fn pass() {
        let begin = Instant::now();
        while begin.elapsed().is_zero() {}
    }

    /// Steps, the first one included, of an advance in which `step` is done, and the wall time of it all, s.
    fn advance(profile: &mut Profile, steps: u64, mut step: impl FnMut(&mut Profile)) -> f64 {
        let begin = Instant::now();
        profile.begin();
        for _ in 0..steps {
            step(profile);
            profile.step_done();
        }
        profile.end();
        begin.elapsed().as_secs_f64()
    }

    fn sum(shares: &[Share]) -> f64 {
        shares.iter().map(|share| share.share).sum()
    }

    fn of(shares: &[Share], part: &str) -> Option<f64> {
        shares.iter().find(|share| share.part == part).map(|share| share.share)
    }

    #[test]
    fn what_is_left_is_the_masters() {
        let times = [("catenary".to_owned(), 3.0), ("pantograph[1]".to_owned(), 1.0)];
        let shares = shares(5.0, times);
        let found: Vec<(&str, f64)> = shares.iter().map(|share| (&*share.part, share.share)).collect();
        assert_eq!(found[..2], [("catenary", 0.6), ("pantograph[1]", 0.2)]);
        assert_eq!(found[2].0, MASTER);
        assert!((found[2].1 - 0.2).abs() < 1e-15, "rounding of a sum to 1");
        assert!(super::shares(5.0, []).is_empty(), "nothing was measured");
    }

    #[test]
    fn one_step_in_so_many_is_looked_at() {
        let (mut profile, mut looked) = (Profile::new(), Vec::new());
        let mut n = 0;
        advance(&mut profile, 80, |profile| {
            if profile.looks() {
                looked.push(n);
            }
            n += 1;
        });
        assert_eq!(looked, [0, EVERY, 2 * EVERY]);
    }

    #[test]
    fn shares_sum_to_one_and_name_what_took_time() {
        let mut profile = Profile::new();
        let wall = advance(&mut profile, 40, |profile| {
            for part in ["wires", "droppers"] {
                profile.turn_to(part);
                pass();
            }
            profile.enter(Stage::Integration);
            profile.enter(Stage::Solution);
            pass();
            profile.enter(Stage::Integration);
            pass();
            profile.turn_to(MASTER);
            pass();
        });
        let shares = profile.shares(wall);
        let parts: Vec<&str> = shares.iter().map(|share| &*share.part).collect();
        assert_eq!(parts, ["wires", "droppers", LINEAR_SOLUTION, TIME_INTEGRATION, MASTER]);
        assert!(shares.iter().all(|share| share.share > 0.0));
        assert!((sum(&shares) - 1.0).abs() < 1e-12, "rounding of a sum of five");
    }

    #[test]
    fn factorisations_are_booked_in_every_step_and_their_contributions_with_them() {
        let mut profile = Profile::new();
        let wall = advance(&mut profile, 17, |profile| {
            if profile.steps == 7 {
                profile.enter(Stage::Factorization);
                profile.turn_to("wires");
                pass();
                profile.enter(Stage::Integration);
            }
        });
        let shares = profile.shares(wall);
        assert!(of(&shares, FACTORIZATION) > Some(0.0), "step 7 is not looked at");
        assert_eq!(of(&shares, "wires"), None);
        assert!((sum(&shares) - 1.0).abs() < 1e-12, "rounding of a sum of three");
    }

    #[test]
    fn what_comes_seldom_is_not_taken_for_what_every_step_does() {
        let mut profile = Profile::new();
        let wall = advance(&mut profile, EVERY, |profile| {
            profile.turn_to("wires");
            pass();
            if profile.steps == 0 {
                profile.turn_to(TIME_INTEGRATION);
                std::thread::sleep(Duration::from_millis(20));
                profile.leave_out();
            }
        });
        // Of two parts that take a look at the clock each; a millionth, were the pause one of every step's.
        let wires = of(&profile.shares(wall), "wires").expect("looked at");
        assert!(wires > 0.01, "{wires}");
    }

    #[test]
    fn nothing_is_booked_before_the_first_advance() {
        let mut profile = Profile::new();
        profile.turn_to("wires");
        pass();
        profile.enter(Stage::Factorization);
        pass();
        profile.enter(Stage::Integration);
        assert!(profile.shares(1.0).is_empty());
    }

    #[test]
    fn time_between_advances_belongs_to_the_master_alone() {
        let mut profile = Profile::new();
        let begin = Instant::now();
        for _ in 0..2 {
            advance(&mut profile, 1, |profile| {
                profile.turn_to("wires");
                pass();
            });
            // Many times what is done within.
            let inside = profile.advancing;
            let outside = Instant::now();
            while outside.elapsed() < 20 * inside {}
        }
        let shares = profile.shares(begin.elapsed().as_secs_f64());
        // At most 1 part within to 20 outside.
        assert!(of(&shares, MASTER) > Some(0.9), "{shares:?}");
    }
}
