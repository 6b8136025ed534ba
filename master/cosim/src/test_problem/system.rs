//! The coupling test problem as one system of ordinary differential equations, and its solution.

use std::f64::consts::TAU;

/// Heights and velocities of head and frame, m and m/s: z₁, v₁, z₂, v₂.
pub type PantographState = [f64; 4];

/// Height and velocity of the wire, m and m/s.
pub type WireState = [f64; 2];

/// Step of the solution taken for the truth, s.
const TRUTH_STEP: f64 = 1e-5;

/// Parameters of the test problem.
///
/// The pantograph is that of EN 50318 (two masses), the wire one mode whose stiffness changes as under a pantograph
/// that travels from span to span, `k(t) = k₀ (1 + a sin 2π f t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Masses of head and frame, kg.
    pub masses: [f64; 2],
    /// Stiffnesses between head and frame and between frame and base, N/m.
    pub stiffnesses: [f64; 2],
    /// Dampings of the same, N s/m.
    pub dampings: [f64; 2],
    /// Contact force at rest, N.
    pub static_force: f64,
    /// Mass of the wire, kg.
    pub wire_mass: f64,
    /// Damping of the wire, N s/m.
    pub wire_damping: f64,
    /// Mean stiffness of the wire, N/m.
    pub wire_stiffness: f64,
    /// Relative amplitude of the wire's stiffness (–).
    pub amplitude: f64,
    /// Frequency of the wire's stiffness, Hz.
    pub frequency: f64,
    /// Stiffness of the contact, N/m.
    pub contact_stiffness: f64,
}

impl Parameters {
    /// Contact is never lost: force 110 N, standard deviation 18.6 N.
    pub const CLOSED: Self = Self {
        masses: [7.2, 15.0],
        stiffnesses: [4200.0, 50.0],
        dampings: [10.0, 90.0],
        static_force: 110.0,
        wire_mass: 10.0,
        wire_damping: 100.0,
        wire_stiffness: 2500.0,
        amplitude: 0.3,
        frequency: 1.1667,
        contact_stiffness: 5e4,
    };

    /// Contact is lost for a sixth of the time.
    pub const LOSING: Self = Self {
        amplitude: 1.5,
        frequency: 2.0,
        ..Self::CLOSED
    };

    /// Contact ten times as stiff under a head of 1 kg.
    pub const STIFF: Self = Self {
        masses: [1.0, 15.0],
        contact_stiffness: 5e5,
        ..Self::CLOSED
    };

    /// Circular frequency of the contact, rad/s: head and wire on the contact's spring.
    #[must_use]
    pub fn contact_frequency(&self) -> f64 {
        (self.contact_stiffness * (1.0 / self.masses[0] + 1.0 / self.wire_mass)).sqrt()
    }

    /// State of rest: the wire lifted by the static force, the head as deep in it as the contact needs.
    #[must_use]
    pub fn start(&self) -> (PantographState, WireState) {
        let wire = self.static_force / self.wire_stiffness;
        let head = wire + self.static_force / self.contact_stiffness;
        // The frame's height counts from its own rest.
        ([head, 0.0, 0.0, 0.0], [wire, 0.0])
    }

    /// Contact force at this penetration, N.
    #[must_use]
    pub fn force(&self, penetration: f64) -> f64 {
        (self.contact_stiffness * penetration).max(0.0)
    }

    /// Rate of the pantograph's state under the contact force, N.
    #[must_use]
    pub fn pantograph_rate(&self, state: &PantographState, force: f64) -> PantographState {
        let [z1, v1, z2, v2] = *state;
        let above = z1 - self.start().0[0];
        let suspension = self.stiffnesses[0] * (above - z2) + self.dampings[0] * (v1 - v2);
        let base = self.stiffnesses[1] * z2 + self.dampings[1] * v2;
        [
            v1,
            (self.static_force - force - suspension) / self.masses[0],
            v2,
            (suspension - base) / self.masses[1],
        ]
    }

    /// Rate of the wire's state at `t` s under the contact force, N.
    #[must_use]
    pub fn wire_rate(&self, t: f64, state: &WireState, force: f64) -> WireState {
        let stiffness = self.wire_stiffness * (1.0 + self.amplitude * (TAU * self.frequency * t).sin());
        [
            state[1],
            (force - self.wire_damping * state[1] - stiffness * state[0]) / self.wire_mass,
        ]
    }
}

/// One step of the classical Runge-Kutta method.
pub(super) fn rk4<const N: usize>(y: [f64; N], t: f64, h: f64, f: &impl Fn(f64, &[f64; N]) -> [f64; N]) -> [f64; N] {
    let along = |k: &[f64; N], part: f64| std::array::from_fn(|i| y[i] + part * h * k[i]);
    let k1 = f(t, &y);
    let k2 = f(t + 0.5 * h, &along(&k1, 0.5));
    let k3 = f(t + 0.5 * h, &along(&k2, 0.5));
    let k4 = f(t + h, &along(&k3, 1.0));
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// Contact force of the one system, on a fine grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    forces: Vec<f64>,
}

impl Truth {
    /// Solves the one system up to `duration` s.
    #[must_use]
    pub fn solve(parameters: &Parameters, duration: f64) -> Self {
        let steps = (duration / TRUTH_STEP).round() as usize;
        let (pantograph, wire) = parameters.start();
        let mut y = [0.0; 6];
        y[..4].copy_from_slice(&pantograph);
        y[4..].copy_from_slice(&wire);
        let mut forces = Vec::with_capacity(steps + 1);
        for n in 0..=steps {
            forces.push(parameters.force(y[0] - y[4]));
            y = rk4(y, n as f64 * TRUTH_STEP, TRUTH_STEP, &|t, y: &[f64; 6]| {
                let force = parameters.force(y[0] - y[4]);
                let [a, b, c, d] = parameters.pantograph_rate(&[y[0], y[1], y[2], y[3]], force);
                let [e, f] = parameters.wire_rate(t, &[y[4], y[5]], force);
                [a, b, c, d, e, f]
            });
        }
        Self { forces }
    }

    /// Contact force at `t` s, N.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        let position = (t / TRUTH_STEP).clamp(0.0, (self.forces.len() - 1) as f64);
        let before = (position.floor() as usize).min(self.forces.len() - 2);
        let part = position - before as f64;
        self.forces[before] + part * (self.forces[before + 1] - self.forces[before])
    }

    /// Duration, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        (self.forces.len() - 1) as f64 * TRUTH_STEP
    }

    /// Contact forces every 10 µs, N.
    #[must_use]
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }
}
