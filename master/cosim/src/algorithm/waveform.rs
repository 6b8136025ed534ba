//! The course of the line's force over one macro step, by its moments, and loads with the same moments.
//!
//! With `s = (t − t₀)/h` from 0 to 1 over the step:
//!
//! ```text
//! mean = ∫ F ds,   moment = ∫ (1 − s) F ds
//! ```
//!
//! A free mass under `F` ends with the velocity `v₀ + h·mean/m` at the position `z₀ + h v₀ + h²·moment/m`: two loads of
//! equal mean and moment lead a rigid head to the same end.

use component::exchange::{contact, load};

use component::Point;

use super::Polynomial;

/// Part of a force by which the mean of a straight line may be off by rounding, –.
const STRAIGHT: f64 = 1e-12;

/// One force component over a step, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Waveform {
    /// At the start, N.
    pub start: f64,
    /// At the end, N.
    pub end: f64,
    /// Mean, N.
    pub mean: f64,
    /// `∫ (1 − s) F ds`, N.
    pub moment: f64,
}

impl Waveform {
    /// A force that stays the same.
    #[must_use]
    pub fn held(force: f64) -> Self {
        Self {
            start: force,
            end: force,
            mean: force,
            moment: 0.5 * force,
        }
    }

    /// The straight line from start to end, N.
    #[must_use]
    pub fn line(start: f64, end: f64) -> Self {
        Self {
            start,
            end,
            mean: 0.5 * (start + end),
            moment: start / 3.0 + end / 6.0,
        }
    }

    /// The parabola through start and end with this mean, all in N.
    #[must_use]
    pub fn parabola(start: f64, end: f64, mean: f64) -> Self {
        let (rise, excess) = (end - start, mean - start);
        let square = 3.0 * rise - 6.0 * excess;
        Self {
            start,
            end,
            mean,
            moment: start / 2.0 + (rise - square) / 6.0 + square / 12.0,
        }
    }

    /// True for a straight line from start to end as far as moments tell: the line made one internal step.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        let off = self.mean - 0.5 * (self.start + self.end);
        off.abs() <= STRAIGHT * self.start.abs().max(self.end.abs())
    }

    /// Component `component` (0 to 2) of the force on strip `i` over the step from `from` to `to`.
    ///
    /// A line that gives samples of the contact force yields the centroid of the moment from them (Simpson's rule),
    /// else that of [`Waveform::parabola`].
    #[must_use]
    pub fn of(from: &Point, to: &Point, i: usize, component: usize) -> Self {
        let (from, to) = (from.contact(i), to.contact(i));
        let index = contact::FX + component;
        let mut waveform = Self::parabola(from[index], to[index], to[contact::MEAN_FX + component]);
        if let Some(centroid) = centroid(from[contact::FORCE], &to[contact::SAMPLES..][..contact::SAMPLE_COUNT]) {
            waveform.moment = centroid * waveform.mean;
        }
        waveform
    }
}

/// `∫ (1 − s) F ds / ∫ F ds` by Simpson's rule through the start and the samples; `None` where there are none.
fn centroid(start: f64, samples: &[f64]) -> Option<f64> {
    let count = samples.len();
    let (mut impulse, mut moment) = (0.0, 0.0);
    for j in 0..=count {
        let force = if j == 0 { start } else { samples[j - 1] };
        let weight = match j {
            _ if j == 0 || j == count => 1.0,
            _ if j % 2 == 1 => 4.0,
            _ => 2.0,
        };
        impulse += weight * force;
        moment += weight * force * (1.0 - j as f64 / count as f64);
    }
    (samples.iter().any(|force| *force > 0.0) && impulse > 0.0).then(|| moment / impulse)
}

/// True where the contact of strip `i` was closed all over the step between two points.
#[must_use]
pub fn closed(from: &Point, to: &Point, i: usize) -> bool {
    let (from, to) = (from.contact(i), to.contact(i));
    let samples = &to[contact::SAMPLES..][..contact::SAMPLE_COUNT];
    let sampled = samples.iter().any(|force| *force > 0.0);
    from[contact::FORCE] > 0.0 && to[contact::FORCE] > 0.0 && !(sampled && samples.iter().any(|force| *force <= 0.0))
}

/// A load component over a step in shifted Legendre polynomials: `a₀ + a₁ (2s − 1) + a₂ (6s² − 6s + 1)`, N.
///
/// Mean and moment are `a₀` and `a₀/2 − a₁/6`; `a₂` changes neither, so that a slave that follows a lower degree only
/// is given the first terms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape(pub [f64; 3]);

impl Shape {
    /// The parabola with mean and moment of `waveform` and the mean of its ends.
    #[must_use]
    pub fn of(waveform: &Waveform) -> Self {
        let Waveform {
            start,
            end,
            mean,
            moment,
        } = *waveform;
        Self([mean, 6.0 * (0.5 * mean - moment), 0.5 * (start + end) - mean])
    }

    /// The parabola through start, mean and end of a step of `last` s, carried on over the next `h` s with degree
    /// `order` (0: the end, 1: with the slope that end and mean give, 2: the share `curvature` of itself and the rest
    /// as 1).
    #[must_use]
    pub fn carried_on(waveform: &Waveform, last: f64, h: f64, order: usize, curvature: f64) -> Self {
        let Waveform { start, end, mean, .. } = *waveform;
        let ratio = if last > 0.0 { h / last } else { 0.0 };
        // About the end, per step of `h`: end + slope σ + square σ².
        let line = 2.0 * (end - mean);
        let (slope, square) = match order {
            0 => (0.0, 0.0),
            1 => (line * ratio, 0.0),
            _ => {
                let square = 3.0 * (start + end) - 6.0 * mean;
                let slope = line + curvature * (end - start + square - line);
                (slope * ratio, curvature * square * ratio * ratio)
            }
        };
        Self([
            end + slope / 2.0 + square / 3.0,
            slope / 2.0 + square / 2.0,
            square / 6.0,
        ])
    }

    /// The straight line over the next `h` s to the parabola through the last three ends, which are `steps` s apart.
    #[must_use]
    pub fn straight_on([old, start, end]: [f64; 3], steps: [f64; 2], h: f64) -> Self {
        let [slope_before, slope] = [(start - old) / steps[0], (end - start) / steps[1]];
        let square = (slope - slope_before) / (steps[0] + steps[1]);
        let next = end + h * (slope + square * (h + steps[1]));
        Self::of(&Waveform::line(end, next))
    }

    /// The first terms up to `degree`.
    #[must_use]
    pub fn truncated(mut self, degree: usize) -> Self {
        self.0.iter_mut().skip(degree + 1).for_each(|term| *term = 0.0);
        self
    }

    /// Adds another load.
    pub fn add(&mut self, other: &Self) {
        for (term, other) in self.0.iter_mut().zip(other.0) {
            *term += other;
        }
    }

    /// `∫ F ds`, N.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.0[0]
    }

    /// `∫ (1 − s) F ds`, N.
    #[must_use]
    pub fn moment(&self) -> f64 {
        0.5 * self.0[0] - self.0[1] / 6.0
    }

    /// Writes it as component `component` of a load over `h` s.
    pub fn write(&self, component: usize, h: f64, polynomial: &mut Polynomial) {
        let [a, b, c] = self.0;
        polynomial.value[component] = a - b + c;
        polynomial.derivatives[0][component] = (2.0 * b - 6.0 * c) / h;
        polynomial.derivatives[1][component] = 12.0 * c / (h * h);
    }
}

/// Straight line of the contact point's lateral position through the last step, carried on over the next `h` s.
pub(super) fn lateral(from: &Point, to: &Point, i: usize, known: bool, polynomial: &mut Polynomial) {
    let (before, now) = (from.contact(i)[contact::Y], to.contact(i)[contact::Y]);
    let last = to.t - from.t;
    polynomial.value[load::Y] = now;
    polynomial.derivatives[0][load::Y] = if known && last > 0.0 {
        (now - before) / last
    } else {
        0.0
    };
    polynomial.derivatives[1][load::Y] = 0.0;
}
