//! Energy of a system in time: stored, brought in, turned into heat, and the residual.
use crate::linear::iteration_matrix::{mass_matrix, visit_jacobian};
use crate::{Motion, SparseMatrix, State, System};

/// Follows the energy of a system from step to step.
///
/// ```text
/// T + U − (T + U)₀ = ∫ P dt − ∫ D dt + residual
/// ```
///
/// `P` is the power of prescribed motion, `D` that of dampers and friction. The part of a contribution that ends with
/// the velocities, `Q(q, v) − Q(q, 0)`, derives from no potential, unless the contribution gives its own
/// [`crate::Force::power`]. Work over a step is that of the mean force on the mean velocity, which is exact for the
/// trapezoid: with `rho_inf` = 1 the residual is the error of the time step in nonlinear forces, with a smaller one
/// numerical damping shows as a loss.
#[derive(Debug)]
pub struct EnergyBalance {
    mass: SparseMatrix,
    start: f64,
    now: f64,
    /// Velocities at the end of the last step.
    v: Vec<f64>,
    losses: Vec<f64>,
    driven_power: f64,
    dissipated_power: f64,
    driven: f64,
    dissipated: f64,
    exchanged: f64,
    worst: f64,
    drift: [f64; 2],
    buffers: [Vec<f64>; 3],
}

impl EnergyBalance {
    /// Begins at a state with the inputs `u`.
    pub fn start(system: &mut dyn System, state: &State, u: &[f64]) -> Self {
        let zeros = vec![0.0; state.v.len()];
        let mut balance = Self {
            mass: mass_matrix(system),
            start: 0.0,
            now: 0.0,
            v: zeros.clone(),
            losses: zeros.clone(),
            driven_power: 0.0,
            dissipated_power: 0.0,
            driven: 0.0,
            dissipated: 0.0,
            exchanged: 0.0,
            worst: 0.0,
            drift: [0.0; 2],
            buffers: [zeros.clone(), zeros.clone(), zeros],
        };
        balance.read(system, state, u);
        balance.start = balance.now;
        balance
    }

    /// Takes in a step of `h` s that has ended at `state`.
    pub fn step(&mut self, system: &mut dyn System, state: &State, u: &[f64], h: f64) {
        let before = (self.driven_power, self.dissipated_power);
        let mut v = std::mem::take(&mut self.buffers[2]);
        let mut losses = std::mem::take(&mut self.losses);
        v.copy_from_slice(&self.v);
        self.losses = std::mem::take(&mut self.buffers[0]);
        self.read(system, state, u);
        let means = v.iter().zip(&self.v).map(|(a, b)| 0.5 * (a + b));
        let forces = losses.iter().zip(&self.losses).map(|(a, b)| 0.5 * (a + b));
        let by_velocity: f64 = means.zip(forces).map(|(v, force)| v * force).sum();
        let driven = 0.5 * h * (before.0 + self.driven_power);
        let dissipated = 0.5 * h * (before.1 + self.dissipated_power) - h * by_velocity;
        self.driven += driven;
        self.dissipated += dissipated;
        self.exchanged += driven.abs() + dissipated.abs();
        self.worst = self.worst.max(self.residual().abs());
        std::mem::swap(&mut losses, &mut self.buffers[0]);
        self.buffers[2] = v;
    }

    /// Kinetic and potential energy, J; its zero is that of the contributions.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.now
    }

    /// Kinetic and potential energy more than at the start, J.
    #[must_use]
    pub fn gained(&self) -> f64 {
        self.now - self.start
    }

    /// Work of prescribed motion, J.
    #[must_use]
    pub fn driven(&self) -> f64 {
        self.driven
    }

    /// Heat, J.
    #[must_use]
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// Sum of the amounts of work and heat, step by step, J: the scale of a residual.
    #[must_use]
    pub fn exchanged(&self) -> f64 {
        self.exchanged
    }

    /// Energy that neither work nor heat explains, J: positive if the integration has created energy.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.gained() - self.driven + self.dissipated
    }

    /// Largest amount of [`EnergyBalance::residual`] so far, J.
    #[must_use]
    pub fn worst_residual(&self) -> f64 {
        self.worst
    }

    /// Largest violation of a constraint so far, m (–), and of its rate, m/s (1/s).
    #[must_use]
    pub fn drift(&self) -> [f64; 2] {
        self.drift
    }

    /// Energies, powers and forces without a potential at `state`.
    fn read(&mut self, system: &mut dyn System, state: &State, u: &[f64]) {
        let motion = state.motion(u);
        self.v.copy_from_slice(motion.v);
        let mut rest = std::mem::take(&mut self.buffers[1]);
        rest.fill(0.0);
        let held = rest.clone();
        let at_rest = Motion { v: &held, ..motion };
        self.losses.fill(0.0);
        let (mut driven, mut dissipated, mut potential) = (0.0, 0.0, 0.0);
        let losses = &mut self.losses;
        system.forces(&mut |force| {
            potential += force.energy(&motion);
            match force.power(&motion) {
                Some(power) => {
                    driven += power.driven;
                    dissipated += power.dissipated;
                }
                None => {
                    force.add_force(&at_rest, &mut rest);
                    force.add_force(&motion, losses);
                }
            }
        });
        for (force, rest) in losses.iter_mut().zip(&rest) {
            *force -= rest;
        }
        for &index in system.layout().fixed() {
            losses[index] = 0.0;
        }
        self.buffers[1] = rest;
        // Constraints whose ends are driven do work: −λ · g_q v.
        let mut rates = vec![0.0; state.lambda.len()];
        visit_jacobian(system, &motion, &mut |row, columns, values| {
            rates[row] += columns
                .iter()
                .zip(values)
                .map(|(&i, value)| value * motion.v[i])
                .sum::<f64>();
        });
        driven -= state
            .lambda
            .iter()
            .zip(&rates)
            .map(|(lambda, rate)| lambda * rate)
            .sum::<f64>();
        self.look_at_constraints(system, &motion, &mut rates);
        self.driven_power = driven;
        self.dissipated_power = dissipated;
        self.now = 0.5 * self.mass.quadratic_form(motion.v) + potential;
    }

    fn look_at_constraints(&mut self, system: &mut dyn System, motion: &Motion<'_>, rates: &mut [f64]) {
        let mut residuals = vec![0.0; rates.len()];
        let mut first = 0;
        system.constraints(&mut |constraint| {
            let next = first + constraint.dimension();
            constraint.residual(motion, &mut residuals[first..next]);
            if constraint.moves() {
                rates[first..next].fill(0.0);
                constraint.add_rate(motion, &mut rates[first..next]);
            }
            first = next;
        });
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        self.drift[0] = self.drift[0].max(largest(&residuals));
        self.drift[1] = self.drift[1].max(largest(rates));
    }
}
