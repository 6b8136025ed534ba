//! Exchange between strips and line over a communication step.
use crate::{ContactPair, Model, OnWire};
use dynamics::Motion;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Number of force samples within a communication step.
pub const SAMPLES: usize = 10;

/// Action of a strip on the line over the last communication step and since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Exchange {
    /// Mean contact force, N.
    pub mean_force: f64,
    /// Mean force on the strip, N.
    pub mean_on_strip: Vector3<f64>,
    /// Contact force at j/10 of the step, N.
    pub samples: [f64; SAMPLES],
    /// Work of the strip on the line since the start, J.
    pub work: f64,
}

/// Force, force on the strip and power of the strip on the line at one instant.
#[derive(Clone, Copy, Debug, Default)]
struct Rates {
    force: f64,
    on_strip: Vector3<f64>,
    power: f64,
}

impl Rates {
    /// Sums over the contacts of a strip.
    fn of(pairs: &[ContactPair], motion: &Motion<'_>) -> Self {
        let rates = pairs.iter().map(|pair| Self::of_pair(pair, motion));
        let sum = rates.reduce(|a, b| Self {
            force: a.force + b.force,
            on_strip: a.on_strip + b.on_strip,
            power: a.power + b.power,
        });
        sum.unwrap_or_default()
    }

    fn of_pair(pair: &ContactPair, motion: &Motion<'_>) -> Self {
        let Some(contact) = pair.state(motion) else {
            return Self::default();
        };
        let strip = pair.strip(motion);
        let lever = contact.geometry.lever();
        let on_strip = contact.force_on_strip();
        Self {
            force: contact.force,
            on_strip,
            power: -on_strip.dot(&(strip.velocity + strip.angular_velocity.cross(&lever))),
        }
    }
}

/// Integrals of force and power of each strip over the internal steps, by the trapezoidal rule.
#[derive(Debug, Default)]
pub(crate) struct ContactIntegrals {
    last: Vec<Rates>,
    integral: Vec<Rates>,
    /// Contact force after each internal step as (τ in s, N), one list per strip.
    history: Vec<Vec<(f64, f64)>>,
    tau: f64,
}

impl ContactIntegrals {
    pub fn new(strips: usize) -> Self {
        Self {
            last: vec![Rates::default(); strips],
            integral: vec![Rates::default(); strips],
            history: vec![Vec::with_capacity(64); strips],
            tau: 0.0,
        }
    }

    /// Starts a communication step.
    pub fn begin(&mut self, model: &Model, motion: &Motion<'_>) {
        self.tau = 0.0;
        for i in 0..self.last.len() {
            self.last[i] = Rates::of(model.contacts_of(i), motion);
            self.integral[i] = Rates::default();
            self.history[i].clear();
            self.history[i].push((0.0, self.last[i].force));
        }
    }

    /// Adds an internal step of `dt` s that has just ended.
    pub fn add(&mut self, model: &Model, motion: &Motion<'_>, dt: f64) {
        self.tau += dt;
        for i in 0..self.last.len() {
            let (last, now) = (self.last[i], Rates::of(model.contacts_of(i), motion));
            let integral = &mut self.integral[i];
            integral.force += 0.5 * dt * (last.force + now.force);
            integral.on_strip += 0.5 * dt * (last.on_strip + now.on_strip);
            integral.power += 0.5 * dt * (last.power + now.power);
            self.last[i] = now;
            self.history[i].push((self.tau, now.force));
        }
    }

    /// Ends the communication step.
    pub fn finish(&self, exchanges: &mut [Exchange]) {
        let h = self.tau;
        for ((exchange, integral), history) in exchanges.iter_mut().zip(&self.integral).zip(&self.history) {
            exchange.mean_force = integral.force / h;
            exchange.mean_on_strip = integral.on_strip / h;
            exchange.work += integral.power;
            for (j, sample) in exchange.samples.iter_mut().enumerate() {
                *sample = interpolate(history, h * (j + 1) as f64 / SAMPLES as f64);
            }
            exchange.samples[SAMPLES - 1] = history[history.len() - 1].1;
        }
    }
}

/// Interpolates linearly in a history that starts at τ = 0.
fn interpolate(history: &[(f64, f64)], tau: f64) -> f64 {
    let next = history.partition_point(|&(at, _)| at < tau).clamp(1, history.len() - 1);
    let ((a, from), (b, to)) = (history[next - 1], history[next]);
    from + (to - from) * ((tau - a) / (b - a)).clamp(0.0, 1.0)
}
