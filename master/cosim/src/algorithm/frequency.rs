//! Circular frequency of the contact, from what both sides put out anyway.

use component::exchange::{contact, load, strip};

use super::{Exchange, waveform};

/// Steps in which the force changes by less say nothing, N.
const SMALLEST_CHANGE: f64 = 0.05;

/// Weight of a step against the next one: some fifty steps count.
const KEPT: f64 = 0.98;

/// Time that puts heights and velocities on the scale of accelerations, s.
const SCALE: f64 = 1e-2;

/// A pivot below this part of its diagonal element has no digits left (–).
const SMALLEST_PIVOT: f64 = 1e-9;

/// A mass whose standard error is a larger part of it is not known (–).
const LARGEST_ERROR: f64 = 0.03;

/// Share of the frequency found at which the strip must be seen to oscillate, where mass and stiffness cannot be told
/// apart (–).
const OWN: f64 = 0.7;

/// Unknowns of a strip's regression: effective mass, damping and stiffness of what carries it.
const UNKNOWNS: usize = 3;

/// `ω = √(k/m)` of each strip, rad/s: the contact's spring under the mass that the strip feels like.
///
/// Stiffness and mass come from differences over closed steps, by least squares with fading weights:
///
/// ```text
/// k = Σ ΔF Δδ / Σ Δδ²             δ penetration: the line's gap, or the height of the strip of a line without gap
/// Δ²F̄ = m Δ²a + d Δ²v + c Δ²z     F̄ mean force, a, v, z mean acceleration, velocity and height of a step
/// ```
///
/// (derived here; `d` and `c` take in what the suspension of the head does, which is not mass; the second difference
/// leaves fast motions only). A mass counts as known while its standard error is small: where nothing oscillates fast
/// there is nothing to be seen, and nothing that could become unstable. Computed values only: a run made again finds
/// the same.
#[derive(Clone, Debug)]
pub struct Frequency {
    strips: Vec<Sums>,
    /// Last point looked at, s.
    seen: f64,
    /// Given from outside, rad/s.
    given: Option<f64>,
}

#[derive(Clone, Debug, Default)]
struct Sums {
    force_penetration: f64,
    penetration: f64,
    /// Normal equations: matrix and right side.
    matrix: [[f64; UNKNOWNS]; UNKNOWNS],
    right: [f64; UNKNOWNS],
    /// Sum of squares of the right side, and of the weights.
    square: f64,
    weight: f64,
    /// First differences of the step before, and its end.
    last: Option<(f64, f64, [f64; UNKNOWNS])>,
    /// Mean that the strip was given in the last step, N, the defect of its momentum at its end, N s, and that end, s.
    given: (f64, f64, f64),
    /// Steps that were used.
    used: usize,
    found: Option<f64>,
}

impl Frequency {
    /// Nothing is known yet of `strips` strips.
    #[must_use]
    pub fn new(strips: usize) -> Self {
        Self {
            strips: vec![Sums::default(); strips],
            seen: f64::NEG_INFINITY,
            given: None,
        }
    }

    /// Frequency found by a sounding of strip `i`, rad/s: valid until a better estimate.
    pub fn sounded(&mut self, i: usize, frequency: f64) {
        self.strips[i].found.get_or_insert(frequency);
    }

    /// Takes `frequency`, rad/s, for granted.
    pub fn know(&mut self, frequency: f64) {
        self.given = Some(frequency);
    }

    /// That of strip `i`, rad/s, where it is known.
    #[must_use]
    pub fn of(&self, i: usize) -> Option<f64> {
        self.given.or(self.strips[i].found)
    }

    /// The largest of all strips, rad/s.
    #[must_use]
    pub fn largest(&self) -> Option<f64> {
        (0..self.strips.len()).filter_map(|i| self.of(i)).reduce(f64::max)
    }

    /// Takes in the last two steps, once.
    pub fn observe(&mut self, exchange: &Exchange) {
        let [now, before, old] = [0, 1, 2].map(|back| exchange.point(back));
        if self.given.is_some() || exchange.known() < 3 || now.t <= self.seen {
            return;
        }
        self.seen = now.t;
        let (h, last) = (now.t - before.t, before.t - old.t);
        for (i, sums) in self.strips.iter_mut().enumerate() {
            let [line, line_before] = [now.contact(i), before.contact(i)];
            // What the line has answered with, less what the defect of the momentum has grown by.
            let momentum = exchange.defect(i, load::FZ).momentum;
            let (given_before, momentum_before, at) = sums.given;
            let given = line[contact::MEAN_FZ] - (momentum - momentum_before) / h;
            sums.given = (given, momentum, now.t);
            if at != before.t || !(waveform::closed(old, before, i) && waveform::closed(before, now, i)) {
                continue;
            }
            let [to, mid, from] = [now.strip(i), before.strip(i), old.strip(i)];
            let force = line[contact::FZ] - line_before[contact::FZ];
            let mean = given - given_before;
            let gap = line[contact::GAP] - line_before[contact::GAP];
            // The force on the strip falls as it rises.
            let penetration = if gap == 0.0 { to[strip::Z] - mid[strip::Z] } else { -gap };
            let acceleration = (to[strip::VZ] - mid[strip::VZ]) / h - (mid[strip::VZ] - from[strip::VZ]) / last;
            let velocity = (to[strip::Z] - mid[strip::Z]) / h - (mid[strip::Z] - from[strip::Z]) / last;
            let height = 0.5 * (to[strip::Z] - from[strip::Z]);
            let row = [acceleration, velocity / SCALE, height / (SCALE * SCALE)];
            let (row_before, mean_before) = match sums.last.replace((now.t, mean, row)) {
                Some((t, mean, row)) if t == before.t => (row, mean),
                _ => continue,
            };
            let mean = mean - mean_before;
            if force.abs() < SMALLEST_CHANGE || mean.abs() < SMALLEST_CHANGE {
                continue;
            }
            let row = std::array::from_fn(|k| row[k] - row_before[k]);
            sums.add(-force, penetration, mean, row);
        }
    }
}

impl Sums {
    fn add(&mut self, force: f64, penetration: f64, mean: f64, row: [f64; UNKNOWNS]) {
        self.force_penetration = KEPT * self.force_penetration + force * penetration;
        self.penetration = KEPT * self.penetration + penetration * penetration;
        for (i, own) in row.into_iter().enumerate() {
            self.right[i] = KEPT * self.right[i] + own * mean;
            for (entry, other) in self.matrix[i].iter_mut().zip(row) {
                *entry = KEPT * *entry + own * other;
            }
        }
        self.square = KEPT * self.square + mean * mean;
        self.weight = KEPT * self.weight + 1.0;
        self.used += 1;
        let stiffness = self.force_penetration / self.penetration;
        if self.used <= 4 * UNKNOWNS || stiffness.is_nan() || stiffness <= 0.0 {
            return;
        }
        let found = |mass: f64| (stiffness / mass).sqrt();
        if let Some(mass) = self.mass(UNKNOWNS) {
            self.found = Some(found(mass));
        } else if let Some(mass) = self.mass(UNKNOWNS - 1) {
            // One oscillation alone cannot tell mass from stiffness; where it is the contact's own, the suspension is
            // small.
            let [heights, accelerations] = [UNKNOWNS - 1, 0].map(|k| self.matrix[k][k]);
            let seen = (accelerations / heights).powf(0.25) / SCALE;
            if seen > OWN * found(mass) {
                self.found = Some(found(mass));
            }
        }
    }

    /// The first unknown with the first `unknowns` of them, by elimination from the last one on; `None` where it is not
    /// known well enough.
    fn mass(&self, unknowns: usize) -> Option<f64> {
        let (mut matrix, mut right, mut square) = (self.matrix, self.right, self.square);
        for k in (1..unknowns).rev() {
            // What cannot be told from the others counts as none.
            if matrix[k][k] <= SMALLEST_PIVOT * self.matrix[k][k] {
                continue;
            }
            let pivot = matrix[k];
            for i in 0..k {
                let factor = matrix[i][k] / pivot[k];
                for (entry, pivot) in matrix[i].iter_mut().zip(pivot) {
                    *entry -= factor * pivot;
                }
                right[i] -= factor * right[k];
            }
            square -= right[k] * right[k] / matrix[k][k];
        }
        let pivot = matrix[0][0];
        let mass = right[0] / pivot;
        let left = (square - right[0] * mass).max(0.0);
        let error = (left / ((self.weight - unknowns as f64).max(1.0) * pivot)).sqrt();
        (pivot > SMALLEST_PIVOT * self.matrix[0][0] && mass > 0.0 && error < LARGEST_ERROR * mass).then_some(mass)
    }
}
