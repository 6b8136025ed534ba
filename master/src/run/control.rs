//! The macro step follows the error that it makes.
//!
//! The error of a step is estimated without a further pass, from what the step has reached against what the last communication
//! points, extrapolated with the degree of the exchange itself, had promised. It is the larger of two effects on the contact
//! force:
//!
//! ```text
//! e = max(k |z − z_p|, k h²/(6 m) |F − F_p|)  in N                                             (derived here)
//! ```
//!
//! The first is what the line sees when it learns where the strip has gone. The second is what a force that grows wrong by F − F_p
//! over the step does to the height of a strip of mass m; m is the ratio of the changes of force and acceleration from step to
//! step, fitted over the run. Where the contact has just opened or closed the deviation is of one sign, and not taken back in the
//! next step: there its impulse counts, `e = h √(k/m)/2 |F − F_p|`, which the strip swings with. The force itself is no measure: droppers and the mesh of a line leave vibrations in it that no
//! macro step resolves and that a collector head does not follow.
//!
//! The controller goes by the root mean square of the last errors, not by each of them, for errors that swing through zero would
//! make it swing as well; the mean is carried over to other step lengths by the order of the error. Steps are whole multiples of
//! the micro step, or its halves, quarters, …, so that no slave takes more micro steps than it would in one go.

use crate::algorithm::{Exchange, Point, Polynomial, predicted_strips};
use crate::interface::{contact, strip};

/// Error in units of the tolerance above which a step is refused: the mean is held at the tolerance, and three times as much is a
/// rare deviation from a mean but a common one after a blow.
const REFUSED: f64 = 4.0;

/// A step is refused this often at most; then it is taken as it is.
const REFUSALS: u32 = 3;

/// Bounds of the ratio of one step to the one before it.
const RATIO: (f64, f64) = (0.2, 2.0);

/// Steps are shortened when they should be by more than this, and lengthened when they could be by more than that (–).
const DEAD_BAND: (f64, f64) = (0.85, 1.25);

/// Share of the newest error in the mean square: when it is larger than the mean, and when it is smaller.
const WEIGHT: (f64, f64) = (0.3, 0.1);

/// Steps between a change and one upwards, at least and at most. It doubles whenever a longer step has to be taken back to a
/// shorter one before it has lasted that long, and halves when it has lasted for four times as long.
const REST: (u32, u32) = (8, 512);

/// Part of the step that is tried after the contact has opened or closed.
const AFTER_EVENT: f64 = 0.25;

/// Part of a step that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// What a controlled macro step goes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Simulated time, s.
    pub duration: f64,
    /// Root mean square of the steps' errors, N of the contact force.
    pub tolerance: f64,
    /// Shortest step, s; taken whatever its error.
    pub min: f64,
    /// Longest step, s.
    pub max: f64,
    /// First step, s.
    pub first: f64,
    /// Micro step of the slaves, s.
    pub micro_step: f64,
    /// Contact stiffness, N/m.
    pub stiffness: f64,
    /// Degree with which the exchange extrapolates, 0 to 2 (–).
    pub degree: usize,
}

/// Lengths that steps may have, in units of the smallest.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// s.
    unit: f64,
    /// The micro step in units, a power of two.
    micro: u64,
    min: u64,
    max: u64,
}

impl Grid {
    fn new(control: &Control) -> Self {
        let halvings = (control.micro_step / control.min * (1.0 - ROUNDING)).log2().ceil();
        let micro = 1_u64 << halvings.clamp(0.0, 40.0) as u32;
        let unit = control.micro_step / micro as f64;
        let whole = |step: f64| step / unit;
        let mut grid = Self {
            unit,
            micro,
            min: 1,
            max: u64::MAX,
        };
        // The shortest step is never shorter than asked for; the longest never longer, but for a shortest one above it.
        let min = ((whole(control.min) * (1.0 - ROUNDING)).ceil() as u64).max(1);
        grid.min = if min > micro {
            min.div_ceil(micro) * micro
        } else {
            min.next_power_of_two()
        };
        grid.max = grid.at_most(whole(control.max) * (1.0 + ROUNDING)).max(grid.min);
        grid
    }

    /// The longest allowed step that is not above `units`.
    fn at_most(&self, units: f64) -> u64 {
        let units = (units * (1.0 + ROUNDING)).clamp(self.min as f64, self.max as f64) as u64;
        if units >= self.micro {
            units / self.micro * self.micro
        } else {
            let power = 1_u64 << units.max(1).ilog2();
            power.max(self.min)
        }
    }
}

/// What became of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It stands.
    Accepted,
    /// It is to be taken back and repeated with the controller's next step.
    Refused,
}

/// Chooses the steps of a run.
#[derive(Clone, Debug)]
pub struct Controller {
    control: Control,
    grid: Grid,
    /// Whether steps can be taken back.
    can_refuse: bool,
    predicted: Polynomial,
    mobilities: Vec<Mobility>,
    /// Present time and next step, in units.
    now: u64,
    step: u64,
    /// Mean square of the errors in units of the tolerance, as if made with the next step.
    mean_square: f64,
    /// Steps since the last change.
    rest: u32,
    /// Steps after a change before the step may grow.
    patience: u32,
    /// Whether the last change was upwards.
    grew: bool,
    /// Refusals of the step under way.
    refusals: u32,
}

impl Controller {
    /// For `strips` pantographs; with `can_refuse` where all slaves can go back.
    #[must_use]
    pub fn new(control: Control, strips: usize, can_refuse: bool) -> Self {
        let grid = Grid::new(&control);
        Self {
            control,
            grid,
            can_refuse,
            predicted: Polynomial::zeros(strips * strip::MOTION),
            mobilities: vec![Mobility::default(); strips],
            now: 0,
            step: grid.at_most(control.first / grid.unit),
            mean_square: 1.0,
            rest: 0,
            patience: REST.0,
            grew: false,
            refusals: 0,
        }
    }

    /// End and length of the next step, s; `None` when the duration is reached.
    #[must_use]
    pub fn next(&self) -> Option<(f64, f64)> {
        let start = self.now as f64 * self.grid.unit;
        if start >= self.control.duration - ROUNDING * self.grid.unit {
            return None;
        }
        let end = (self.now + self.step) as f64 * self.grid.unit;
        if end >= self.control.duration - ROUNDING * self.grid.unit {
            return Some((self.control.duration, self.control.duration - start));
        }
        Some((end, end - start))
    }

    /// Judges the step of `h` s that has just reached [`Exchange::reached`], and chooses the next one.
    pub fn judge(&mut self, exchange: &Exchange, h: f64) -> Verdict {
        let error = self.error(exchange, h) / self.control.tolerance;
        let event = (0..exchange.strip_count()).any(|i| switches(exchange, i));
        self.judge_error(error, event)
    }

    /// A step that could not be completed: whether it is to be repeated with a shorter one.
    pub fn shorten(&mut self) -> bool {
        if self.step == self.grid.min {
            return false;
        }
        self.go_to(self.grid.at_most(0.5 * self.step as f64).max(self.grid.min));
        true
    }

    /// Counts a step that was completed in parts, without a judgement.
    pub fn skip(&mut self) {
        self.now += self.step;
        self.refusals = 0;
    }

    /// Estimated error of the contact force, N.
    fn error(&mut self, exchange: &Exchange, h: f64) -> f64 {
        let Control { degree, stiffness, .. } = self.control;
        predicted_strips(exchange, degree, &mut self.predicted);
        let mut error = 0.0_f64;
        for i in 0..exchange.strip_count() {
            let predicted = self.predicted.at(i * strip::MOTION + strip::Z, h);
            error = error.max((exchange.reached.strip(i)[strip::Z] - predicted).abs());
            let (deviation, used) = force_deviation(exchange, i, degree, h);
            let blow = switches(exchange, i) || used < degree.min(exchange.known() - 1);
            // A blow reaches the strip a step later where the pantograph steps first: it says nothing on its mass.
            if !blow {
                self.mobilities[i].update(exchange, i, h);
            }
            let mobility = self.mobilities[i].value();
            error = error.max(if blow {
                0.5 * h * (mobility / stiffness).sqrt() * deviation
            } else {
                h * h / 6.0 * mobility * deviation
            });
        }
        stiffness * error
    }

    fn judge_error(&mut self, error: f64, event: bool) -> Verdict {
        let order = self.order();
        if error > REFUSED && self.can_refuse && self.step > self.grid.min && self.refusals < REFUSALS {
            self.refusals += 1;
            let ratio = error.powf(-1.0 / order).clamp(RATIO.0, 0.5);
            self.mean_square = self.mean_square.max(error * error);
            let shorter = self.grid.at_most(ratio * self.step as f64);
            self.go_to(shorter);
            return Verdict::Refused;
        }
        self.now += self.step;
        self.rest += 1;
        let square = error * error;
        let weight = if square > self.mean_square { WEIGHT.0 } else { WEIGHT.1 };
        self.mean_square += weight * (square - self.mean_square);
        let refused = std::mem::take(&mut self.refusals) > 0;
        if event {
            // What comes after a blow is not what came before it: small steps, and a mean that forgets at once.
            if !refused {
                self.go_to(self.grid.at_most(AFTER_EVENT * self.step as f64));
            }
            self.mean_square = self.mean_square.min(1.0);
            (self.patience, self.grew) = (REST.0, false);
            return Verdict::Accepted;
        }
        // A mean of zero asks for the longest ratio.
        let ratio = self.mean_square.max(1e-30).powf(-0.5 / order).clamp(RATIO.0, RATIO.1);
        let longer = self.grid.at_most(ratio * self.step as f64);
        let grows = ratio > DEAD_BAND.1 && longer > self.step && self.rest >= self.patience;
        if ratio < DEAD_BAND.0 || (grows && !refused) {
            self.go_to(self.grid.at_most(ratio * self.step as f64));
        }
        Verdict::Accepted
    }

    /// Power of the step that its error goes with.
    fn order(&self) -> f64 {
        (self.control.degree + 1) as f64
    }

    fn go_to(&mut self, step: u64) {
        if step != self.step {
            let grows = step > self.step;
            if self.grew && !grows && self.rest < self.patience {
                self.patience = (2 * self.patience).min(REST.1);
            } else if self.rest > 4 * self.patience {
                self.patience = (self.patience / 2).max(REST.0);
            }
            self.grew = grows;
            self.mean_square *= (step as f64 / self.step as f64).powf(2.0 * self.order());
            self.step = step;
            self.rest = 0;
        }
    }
}

/// How a strip answers to the contact force: `1/m` as the slope of acceleration against force, least squares over the changes from
/// step to step.
#[derive(Clone, Copy, Debug, Default)]
struct Mobility {
    along: f64,
    square: f64,
}

impl Mobility {
    /// Takes the step just made into account.
    fn update(&mut self, exchange: &Exchange, i: usize, h: f64) {
        let (reached, now, before) = (&exchange.reached, exchange.point(0), exchange.point(1));
        let force = |a: &Point, b: &Point| 0.5 * (a.contact(i)[contact::FORCE] + b.contact(i)[contact::FORCE]);
        let velocity = |point: &Point| point.strip(i)[strip::VZ];
        if exchange.known() > 1 {
            let change = force(now, reached) - force(before, now);
            let acceleration = (velocity(reached) - velocity(now)) / h;
            let old = (velocity(now) - velocity(before)) / (now.t - before.t);
            self.along -= change * (acceleration - old);
            self.square += change * change;
        }
    }

    /// 1/kg; zero before two steps are known.
    fn value(&self) -> f64 {
        if self.square > 0.0 {
            (self.along / self.square).max(0.0)
        } else {
            0.0
        }
    }
}

/// Contact force reached at strip `i` against its extrapolation with `degree` over `h` s, N; it looks back to where the contact
/// was open last. With it the degree that this leaves.
fn force_deviation(exchange: &Exchange, i: usize, degree: usize, h: f64) -> (f64, usize) {
    let now = exchange.point(0).t;
    let force = |back: usize| exchange.point(back).contact(i)[contact::FORCE];
    let time = |back: usize| exchange.point(back).t - now;
    let closed = (0..exchange.known()).take_while(|&back| force(back) > 0.0).count();
    let degree = degree.min(closed.saturating_sub(1));
    let mut predicted = force(0);
    if degree >= 1 {
        let first = (force(0) - force(1)) / (time(0) - time(1));
        predicted += first * h;
        if degree >= 2 {
            let second = (first - (force(1) - force(2)) / (time(1) - time(2))) / (time(0) - time(2));
            predicted += second * h * (h - time(1));
        }
    }
    ((exchange.reached.contact(i)[contact::FORCE] - predicted).abs(), degree)
}

/// Whether the contact of strip `i` opens or closes within the step just made.
fn switches(exchange: &Exchange, i: usize) -> bool {
    let was_closed = exchange.point(0).contact(i)[contact::FORCE] > 0.0;
    (exchange.reached.contact(i)[contact::FORCE] > 0.0) != was_closed
}

#[cfg(test)]
#[path = "control_tests.rs"]
mod tests;
