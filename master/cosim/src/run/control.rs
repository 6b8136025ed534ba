//! The macro step follows the error that it makes.
//!
//! The error of a step is estimated without a further pass, as a height δ of the strip that is wrong, times the
//! contact's stiffness k. What is wrong depends on the exchange ([`Estimate`]).
//!
//! With the cubic through both ends of the strip's step given to the line, and with defects of the loads made up for,
//! the error left is the part of the strip's motion that is no cubic. In the mean over the step
//!
//! ```text
//! δ = c h⁴/720 |z⁗|,   z⁗ = (j − j₋)/(h/2 + h₋/2)                                                (derived here)
//! ```
//!
//! with the jerks j and j₋ of the cubics of this step and the last one. It goes with h⁴ for a smooth force, with h³
//! where the contact opens or closes within the step, and takes no more than heights and velocities of the strip. The
//! factor c is for what adds up in an oscillation that lasts.
//!
//! Elsewhere it is the larger of two:
//!
//! ```text
//! δ = max(|z − z_p|, h²/(6 m) |F − F_p|)                                                       (derived here)
//! ```
//!
//! against what the last communication points, extrapolated with the degree of the exchange itself, had promised. The
//! first is what the line sees when it learns where the strip has gone. The second is what a force that grows wrong by
//! F − F_p over the step does to the height of the strip. Where the contact has just opened or closed the deviation is
//! of one sign, and not taken back in the next step: there its impulse counts, `k δ = h √(k/m)/2 |F − F_p|`, which the
//! strip swings with.
//!
//! The mass m is the ratio of the changes of mean force and mean acceleration from step to step, fitted over the run.
//! The force itself is no measure: droppers and the mesh of a line leave vibrations in it that no macro step resolves
//! and that a collector head does not follow.
//!
//! The controller goes by the root mean square of the last errors, not by each of them, for errors that swing through
//! zero would make it swing as well; the mean is carried over to other step lengths by the order of the error. Steps
//! are whole multiples of the micro step, or its halves, quarters, …, so that no slave takes more micro steps than it
//! would in one go.
//!
//! A step is refused for what happens within it only, an opening or a closing most often: once its time has passed in
//! shorter steps, the step is what it was before.
//!
//! Purpose of the controller: a known error, also with a contact that is lost again and again. On a line of even spans
//! error-controlled steps save nothing, because the error of fixed steps is spread evenly along the track.

use crate::algorithm::{Exchange, Polynomial, predicted_strips};
use component::Point;
use component::exchange::{contact, strip};

/// Error in units of the tolerance above which a step is refused: the mean is held at the tolerance, and three times as
/// much is a rare deviation from a mean but a common one after a blow.
const REFUSED: f64 = 4.0;

/// A step is refused this often at most; then it is taken as it is.
const REFUSALS: u32 = 3;

/// Bounds of the ratio of one step to the one before it.
const RATIO: (f64, f64) = (0.2, 2.0);

/// Steps are shortened when they should be by more than this, and lengthened when they could be by more than that (–).
const DEAD_BAND: (f64, f64) = (0.85, 1.25);

/// Share of the newest error in the mean square: when it is larger than the mean, and when it is smaller.
const WEIGHT: (f64, f64) = (0.3, 0.1);

/// Steps between a change and one upwards, at least and at most. It doubles whenever a longer step has to be taken back
/// to a shorter one before it has lasted that long, and halves when it has lasted for four times as long.
const REST: (u32, u32) = (8, 512);

/// Part of the step that is tried after the contact has opened or closed.
const AFTER_EVENT: f64 = 0.25;

/// Factor for errors that come back in the next steps with the same phase: such an error stretches the period of the
/// head on its contact, which rings for some 30 rad after a blow. Half of them count (–).
const ADDED_UP: f64 = 16.0;

/// Part of a step that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// Settings of a controlled macro step.
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
    /// Value in which the exchange leaves an error.
    pub estimate: Estimate,
}

/// Basis of the estimate of a step's error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimate {
    /// Strips and forces against their extrapolation.
    Prediction {
        /// Degree with which the exchange extrapolates, 0 to 2 (–).
        degree: usize,
    },
    /// The strip's course over the step, where the line gets the cubic through it and defects of the load are made up
    /// for.
    Course,
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

/// Outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Step accepted.
    Accepted,
    /// Step to be taken back and repeated with the controller's next step.
    Refused,
}

/// Chooses the steps of a run.
#[derive(Clone, Debug)]
pub struct Controller {
    control: Control,
    grid: Grid,
    /// True where steps can be taken back.
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
    /// True where the last change was upwards.
    grew: bool,
    /// Refusals of the step under way.
    refusals: u32,
    /// After a refusal: end of the step refused, its length, in units, and the mean square that went with it.
    resume: Option<(u64, u64, f64)>,
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
            resume: None,
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
        let (height, event) = match self.control.estimate {
            Estimate::Prediction { degree } => self.off_prediction(exchange, degree, h),
            Estimate::Course => (off_course(exchange, h), false),
        };
        // A slave that cannot go back must not meet the end of a flight with a long step.
        let flies =
            !self.can_refuse && (0..exchange.strip_count()).any(|i| exchange.reached.contact(i)[contact::FORCE] <= 0.0);
        self.judge_error(self.control.stiffness * height / self.control.tolerance, event, flies)
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

    /// By what the strips are off their prediction, m, and whether a contact has opened or closed.
    fn off_prediction(&mut self, exchange: &Exchange, degree: usize, h: f64) -> (f64, bool) {
        predicted_strips(exchange, degree, &mut self.predicted);
        let (mut height, mut event) = (0.0_f64, false);
        for i in 0..exchange.strip_count() {
            let predicted = self.predicted.at(i * strip::MOTION + strip::Z, h);
            height = height.max((exchange.reached.strip(i)[strip::Z] - predicted).abs());
            let (deviation, used) = force_deviation(exchange, i, degree, h);
            let switches = switches(exchange, i);
            event |= switches;
            let blow = switches || used < degree.min(exchange.known() - 1);
            // A blow reaches the strip a step later where the pantograph steps first: it says nothing on its mass.
            if !blow {
                self.mobilities[i].update(exchange, i, h);
            }
            let mobility = self.mobilities[i].value();
            height = height.max(if blow {
                0.5 * h * (mobility / self.control.stiffness).sqrt() * deviation
            } else {
                h * h / 6.0 * mobility * deviation
            });
        }
        (height, event)
    }

    fn judge_error(&mut self, error: f64, event: bool, flies: bool) -> Verdict {
        let order = self.order();
        if error > REFUSED && self.can_refuse && self.step > self.grid.min && self.refusals < REFUSALS {
            self.refusals += 1;
            let ratio = error.powf(-1.0 / order).clamp(RATIO.0, 0.5);
            if self.resume.is_none() {
                self.resume = Some((self.now + self.step, self.step, self.mean_square));
            }
            self.mean_square = self.mean_square.max(error * error);
            let shorter = self.grid.at_most(ratio * self.step as f64);
            self.go_to(shorter);
            return Verdict::Refused;
        }
        self.now += self.step;
        self.rest += 1;
        if let Some((end, step, mean_square)) = self.resume {
            if self.now >= end {
                (self.step, self.mean_square) = (step, mean_square.min(1.0));
                self.resume = None;
            }
            self.refusals = 0;
            return Verdict::Accepted;
        }
        let square = error * error;
        let weight = if square > self.mean_square { WEIGHT.0 } else { WEIGHT.1 };
        self.mean_square += weight * (square - self.mean_square);
        let refused = std::mem::take(&mut self.refusals) > 0;
        if event {
            // What comes after a blow is not what came before it: small steps, and a mean that forgets at once.
            if !refused && !flies {
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
        if ratio < DEAD_BAND.0 || (grows && !refused && !flies) {
            self.go_to(self.grid.at_most(ratio * self.step as f64));
        }
        Verdict::Accepted
    }

    /// Power of the step that its error goes with.
    fn order(&self) -> f64 {
        match self.control.estimate {
            Estimate::Prediction { degree } => (degree + 1) as f64,
            Estimate::Course => 4.0,
        }
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

/// Response of a strip to the contact force: `1/m` as the slope of acceleration against force, least squares over the
/// changes from step to step.
#[derive(Clone, Copy, Debug, Default)]
struct Mobility {
    along: f64,
    square: f64,
}

impl Mobility {
    /// Takes the step just made into profile.
    fn update(&mut self, exchange: &Exchange, i: usize, h: f64) {
        let (reached, now, before) = (&exchange.reached, exchange.point(0), exchange.point(1));
        if exchange.known() > 1 {
            let change = reached.contact(i)[contact::MEAN_FZ] - now.contact(i)[contact::MEAN_FZ];
            let acceleration = (reached.strip(i)[strip::VZ] - now.strip(i)[strip::VZ]) / h;
            let old = (now.strip(i)[strip::VZ] - before.strip(i)[strip::VZ]) / (now.t - before.t);
            self.along += change * (acceleration - old);
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

/// Contact force reached at strip `i` against its extrapolation with `degree` over `h` s, N; it looks back to where the
/// contact was open last. With it the degree that this leaves.
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

/// By what the strips are off the cubic that the line was given, m.
fn off_course(exchange: &Exchange, h: f64) -> f64 {
    if exchange.known() < 2 {
        return 0.0;
    }
    let (before, now) = (exchange.point(1), exchange.point(0));
    let last = now.t - before.t;
    let change = |i| f64::abs(jerk(now, &exchange.reached, i, h) - jerk(before, now, i, last));
    let most = (0..exchange.strip_count()).map(change).fold(0.0, f64::max);
    ADDED_UP * h.powi(4) / 360.0 * most / (h + last)
}

/// Jerk of the cubic of strip `i` between two points `h` s apart, m/s³.
fn jerk(from: &Point, to: &Point, i: usize, h: f64) -> f64 {
    let (from, to) = (from.strip(i), to.strip(i));
    let mean = (to[strip::Z] - from[strip::Z]) / h;
    (from[strip::VZ] + to[strip::VZ] - 2.0 * mean) * 6.0 / (h * h)
}

/// True where the contact of strip `i` opens or closes within the step just made.
fn switches(exchange: &Exchange, i: usize) -> bool {
    let was_closed = exchange.point(0).contact(i)[contact::FORCE] > 0.0;
    (exchange.reached.contact(i)[contact::FORCE] > 0.0) != was_closed
}

#[cfg(test)]
#[path = "control_tests.rs"]
mod tests;
