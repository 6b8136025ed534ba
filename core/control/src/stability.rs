//! Poles and delay margin of the sampled loop.

mod asked;

pub use asked::FEWEST_SAMPLES;

use nalgebra::{Complex, DMatrix, DVector};

use crate::controller::Reading;
use crate::law::{KnownDrive, Law, Memory};
use crate::linear::{Delayed, LinearPantograph, LinearParts};
use crate::riccati::NoGains;

/// Longest delay that is searched, in samples.
const LONGEST: f64 = 50.0;

/// Halvings of the interval that the margin lies in.
const HALVINGS: usize = 50;

/// Linear pantograph on a wire of given stiffness under its controller, without the limits of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledLoop {
    plant: LinearPantograph,
    law: Law,
    sample: f64,
    delay: f64,
}

impl SampledLoop {
    /// Loop of a lumped pantograph with its head on a wire of `wire_stiffness` N/m.
    ///
    /// # Errors
    /// A linear-quadratic regulator without gains.
    pub fn new(control: &scene::Control, lumped: &scene::Lumped, wire_stiffness: f64) -> Result<Self, NoGains> {
        let plant = LinearPantograph::new(lumped, &control.actuator, wire_stiffness);
        Self::with(plant, control, Some(lumped))
    }

    /// Loop of any pantograph, linear about rest, with its head on a wire of `wire_stiffness` N/m.
    ///
    /// # Errors
    /// A linear-quadratic regulator, which needs a chain, and a pantograph with a singular mass.
    pub fn of(control: &scene::Control, parts: &LinearParts, wire_stiffness: f64) -> Result<Self, NoGains> {
        let plant = LinearPantograph::of(parts, &control.actuator, wire_stiffness).ok_or(NoGains)?;
        Self::with(plant, control, None)
    }

    fn with(
        plant: LinearPantograph,
        control: &scene::Control,
        lumped: Option<&scene::Lumped>,
    ) -> Result<Self, NoGains> {
        Ok(Self {
            plant,
            // The deviations from rest are those from a desired force of 0.
            law: Law::new(control, lumped, 0.0, 0.0)?,
            sample: control.sample_time,
            delay: control.delay(),
        })
    }

    /// Poles of the loop from sample to sample, –: stable inside the unit circle.
    #[must_use]
    pub fn poles(&self) -> Vec<Complex<f64>> {
        self.poles_with(self.delay)
    }

    /// Largest amount of a pole, –.
    #[must_use]
    pub fn spectral_radius(&self) -> f64 {
        radius(&self.poles())
    }

    /// Delay of sensors and actuator together beyond which the loop is unstable, s; 0 for a loop that is unstable
    /// without any, infinite for one that is stable with 50 samples.
    #[must_use]
    pub fn delay_margin(&self) -> f64 {
        let stable = |delay: f64| radius(&self.poles_with(delay)) < 1.0;
        if !stable(0.0) {
            return 0.0;
        }
        // Quarters of a sample: a loop may become stable again with more delay.
        let quarters = (1..=(4.0 * LONGEST) as usize).map(|quarter| 0.25 * self.sample * quarter as f64);
        let Some(mut beyond) = quarters.into_iter().find(|&delay| !stable(delay)) else {
            return f64::INFINITY;
        };
        let mut below = beyond - 0.25 * self.sample;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (below + beyond);
            if stable(middle) {
                below = middle;
            } else {
                beyond = middle;
            }
        }
        0.5 * (below + beyond)
    }

    fn poles_with(&self, delay: f64) -> Vec<Complex<f64>> {
        let delayed = Delayed::new(&self.plant, self.sample, delay);
        let size = delayed.size() + self.law.remembers();
        let mut transition = DMatrix::zeros(size, size);
        for column in 0..size {
            let mut state = DVector::zeros(size);
            state[column] = 1.0;
            transition.set_column(column, &self.step(&delayed, &state));
        }
        transition.complex_eigenvalues().iter().copied().collect()
    }

    /// State a sample later: the rule itself makes the command.
    fn step(&self, delayed: &Delayed, state: &DVector<f64>) -> DVector<f64> {
        let (n, masses) = (delayed.size(), self.plant.masses());
        let mut memory = Memory::of(&state.as_slice()[n..]);
        let reading = Reading {
            force: self.plant.wire_stiffness() * self.plant.rise(state),
            driven: self.plant.driven_way(state)[1],
            rises: state.rows(0, masses).iter().copied().collect(),
            velocities: state.rows(masses, masses).iter().copied().collect(),
            ..Reading::default()
        };
        let known = |index: usize| if index < n { state[index] } else { 0.0 };
        let drive = KnownDrive {
            force: self.plant.drive_state().map_or(0.0, known),
            command: known(self.plant.size()),
        };
        let unlimited = (f64::INFINITY, 0.0);
        let command = self.law.command(&mut memory, &reading, 0.0, drive, unlimited);
        let mut next = DVector::zeros(state.len());
        let moved = &delayed.state * state.rows(0, n) + &delayed.input * command;
        next.rows_mut(0, n).copy_from(&moved);
        let remembers = self.law.remembers();
        next.rows_mut(n, remembers)
            .copy_from_slice(&memory.values()[..remembers]);
        next
    }
}

fn radius(poles: &[Complex<f64>]) -> f64 {
    poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Actuator, Control, ControlLaw, Sensors};

    fn control(law: ControlLaw, sample_time: f64) -> Control {
        Control {
            law,
            sample_time,
            force: None,
            actuator: Actuator::default(),
            sensors: Sensors::default(),
        }
    }

    fn pid(kp: f64, ki: f64, kd: f64) -> ControlLaw {
        ControlLaw::Pid {
            kp,
            ki,
            kd,
            derivative_lag: 0.0,
        }
    }

    /// One mass of 10 kg on 4 kN/m, without damper: the wire has 6 kN/m.
    fn one_mass(damping: f64) -> scene::Lumped {
        scene::Lumped::new(1.0, 100.0, &[10.0], &[4000.0], &[damping])
    }

    #[test]
    fn a_proportional_loop_has_the_poles_of_its_characteristic_polynomial() {
        // Without damper, with c = cos ω T and s = sin ω T, a held force u = −kp k_w q moves q by u (1 − c)/k and v by
        // u ω s/k: trace and determinant of the transition follow.
        let (kp, sample, wire, stiffness) = (0.2_f64, 0.004_f64, 6000.0, 10_000.0);
        let omega = (stiffness / 10.0_f64).sqrt();
        let (s, c) = (omega * sample).sin_cos();
        let by = -kp * wire / stiffness;
        let (trace, determinant) = (
            2.0 * c + by * (1.0 - c),
            // (c + by(1−c)) c − (s/ω)(−ω s + by ω s)
            (c + by * (1.0 - c)) * c + s * s - by * s * s,
        );
        let found = SampledLoop::new(&control(pid(kp, 0.0, 0.0), sample), &one_mass(0.0), wire).unwrap();
        let poles = found.poles();
        for expected in [1.0, -1.0].map(|sign| {
            let root = Complex::new(0.25 * trace * trace - determinant, 0.0).sqrt();
            Complex::new(0.5 * trace, 0.0) + root * sign
        }) {
            let nearest = poles.iter().map(|pole| (pole - expected).norm());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-9, "{expected}: {poles:?}");
        }
    }

    #[test]
    fn many_samples_have_the_delay_margin_of_continuous_control() {
        // m q̈ + c q̇ + k q = −kp k_w q(t − τ): at the margin e^{−iωτ} = (m ω² − k − i c ω)/(kp k_w).
        let (kp, wire, damping) = (0.5_f64, 6000.0, 40.0);
        let gain = kp * wire;
        let (m, k) = (10.0_f64, 10_000.0);
        // (m ω² − k)² + (c ω)² = gain², the larger root.
        let b = damping * damping - 2.0 * m * k;
        let w2 = (-b + (b * b - 4.0 * m * m * (k * k - gain * gain)).sqrt()) / (2.0 * m * m);
        let w = w2.sqrt();
        let angle = (damping * w).atan2(m * w2 - k);
        let expected = angle.rem_euclid(std::f64::consts::TAU) / w;
        let sample = 5e-4;
        let found = SampledLoop::new(&control(pid(kp, 0.0, 0.0), sample), &one_mass(damping), wire).unwrap();
        // Holding a command delays it by half a sample.
        let margin = found.delay_margin() + 0.5 * sample;
        assert!((margin / expected - 1.0).abs() < 1e-3, "{margin} {expected}");
    }

    #[test]
    fn a_skyhook_and_a_regulator_are_stable_and_much_integral_is_not() {
        let lumped = scene::Lumped::new(1.0, 100.0, &[8.0, 12.0], &[7000.0, 0.0], &[120.0, 70.0]);
        let radius = |law| {
            let found = SampledLoop::new(&control(law, 0.005), &lumped, 3000.0).unwrap();
            found.spectral_radius()
        };
        let regulator = ControlLaw::Lqr {
            force_weight: 1.0,
            velocity_weight: 0.0,
            effort_weight: 1.0,
            wire_stiffness: 3000.0,
        };
        let none = radius(pid(1e-12, 0.0, 0.0));
        assert!(none < 1.0);
        assert!(radius(ControlLaw::Skyhook { damping: 200.0 }) < 1.0);
        assert!(radius(regulator) < none, "more damping than without");
        assert!(radius(pid(0.0, 100.0, 0.0)) > 1.0);
    }
}
