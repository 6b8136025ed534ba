//! What statics and time integration share: residuals, corrections, and the options of Newton's method.
use crate::matrix::{IterationMatrix, visit_jacobian};
use crate::woodbury::Woodbury;
use crate::{Motion, System, Updates, Weights};
use serde::{Deserialize, Serialize};

/// When the iteration matrix is made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Jacobian {
    /// One factorisation is kept until it converges too slowly (default).
    Modified,
    /// Factored in every iteration, exact contact tangent included: quadratic convergence.
    Full,
}

/// Options of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest residual of a generalised force at convergence, N (N·m for slopes and rotations).
    pub tolerance: f64,
    /// Largest residual of a constraint at convergence, m (–).
    pub constraint_tolerance: f64,
    /// Iterations before the step is given up.
    pub max_iterations: usize,
    /// See [`Jacobian`].
    pub jacobian: Jacobian,
}

impl Default for NewtonOptions {
    /// 1e-6 N is 1e-8 of a contact force; 1e-12 m is rounding at the size of a pantograph.
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            constraint_tolerance: 1e-12,
            max_iterations: 30,
            jacobian: Jacobian::Modified,
        }
    }
}

/// Why an equilibrium could not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Newton's method used all its iterations; a smaller `h` may help.
    #[error(
        "no equilibrium at t = {t} s (h = {h} s): residual {residual:.3e} N after {iterations} iterations, tolerance \
         {tolerance:.1e} N, largest at {coordinate}"
    )]
    NotConverged {
        /// Time aimed at, s.
        t: f64,
        /// Step, s; 0 for statics.
        h: f64,
        /// Iterations used.
        iterations: usize,
        /// Largest residual left, N or m.
        residual: f64,
        /// What was asked for.
        tolerance: f64,
        /// Name of the coordinate with the largest residual.
        coordinate: String,
    },
    /// The iteration matrix is singular: the model is under-constrained, no `h` will help.
    #[error("iteration matrix is singular at t = {t} s, near {coordinate}")]
    Singular {
        /// Time aimed at, s.
        t: f64,
        /// Name of a coordinate that nothing holds.
        coordinate: String,
    },
    /// A force or coordinate is not a finite number.
    #[error("{coordinate} has no finite residual at t = {t} s")]
    NotFinite {
        /// Time aimed at, s.
        t: f64,
        /// Name of the coordinate.
        coordinate: String,
    },
}

impl StepError {
    /// Whether a master may roll back and try again with a smaller step (`fmi2Discard`): a residual that is no number may be
    /// the overshoot of a step that was too long.
    #[must_use]
    pub fn is_retryable(&self) -> bool {
        matches!(self, Self::NotConverged { .. } | Self::NotFinite { .. })
    }
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Time steps.
    pub micro_steps: u64,
    /// Newton corrections.
    pub newton_iterations: u64,
    /// Numeric factorisations.
    pub factorizations: u64,
    /// Solutions with the factors.
    pub solves: u64,
    /// Most Newton corrections of one time step.
    #[serde(default)]
    pub most_iterations: u64,
}

/// Size of the residual in units of its tolerance, and where it is largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    /// Largest ratio of residual to tolerance; converged at ≤ 1.
    pub ratio: f64,
    /// Unknown with the largest ratio.
    pub worst: usize,
    /// Its residual, N or m.
    pub value: f64,
}

/// Matrix, low-rank terms and buffers of one system.
pub(crate) struct Workspace {
    coordinates: usize,
    fixed: Vec<usize>,
    pub matrix: IterationMatrix,
    woodbury: Woodbury,
    updates: Updates,
    scale: f64,
    residual: Vec<f64>,
    pub correction: Vec<f64>,
    pub counters: Counters,
}

impl Workspace {
    pub fn new(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        let matrix = IterationMatrix::analyse(system, motion);
        let coordinates = system.layout().coordinates();
        let size = coordinates + system.layout().constraints();
        Self {
            coordinates,
            fixed: system.layout().fixed().to_vec(),
            matrix,
            woodbury: Woodbury::default(),
            updates: Updates::default(),
            scale: 1.0,
            residual: vec![0.0; size],
            correction: vec![0.0; size],
            counters: Counters::default(),
        }
    }

    /// Evaluates `M v̇ − Q + g_qᵀ λ` and `g`.
    pub fn residual(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        v_dot: Option<&[f64]>,
        lambda: &[f64],
        options: &NewtonOptions,
    ) -> Residual {
        let (force, constraint) = self.residual.split_at_mut(self.coordinates);
        force.fill(0.0);
        system.forces(&mut |contribution| match v_dot {
            Some(v_dot) if contribution.multiplies_mass() => contribution.add_dynamic_force(motion, v_dot, force),
            _ => contribution.add_force(motion, force),
        });
        for value in force.iter_mut() {
            *value = -*value;
        }
        if let Some(v_dot) = v_dot {
            self.matrix.multiplied_mass.multiply_add(v_dot, force);
        }
        visit_jacobian(system, motion, &mut |row, columns, values| {
            for (&column, &value) in columns.iter().zip(values) {
                force[column] += value * lambda[row];
            }
        });
        let mut first = 0;
        system.constraints(&mut |contribution| {
            let next = first + contribution.dimension();
            contribution.residual(motion, &mut constraint[first..next]);
            first = next;
        });
        for &index in &self.fixed {
            self.residual[index] = 0.0;
        }
        let (mut worst, mut ratio, mut value) = (0, 0.0, 0.0);
        for (i, &entry) in self.residual.iter().enumerate() {
            let tolerance = if i < self.coordinates {
                options.tolerance
            } else {
                options.constraint_tolerance
            };
            let here = entry.abs() / tolerance;
            if here > ratio || here.is_nan() {
                (worst, ratio, value) = (i, here, entry.abs());
                if here.is_nan() {
                    break;
                }
            }
        }
        Residual { ratio, worst, value }
    }

    /// Assembles and factors.
    pub fn factor(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        mass_weight: f64,
        weights: Weights,
    ) -> Result<(), StepError> {
        self.scale = if mass_weight > 0.0 {
            mass_weight * self.matrix.mean_mass()
        } else {
            1.0
        };
        self.counters.factorizations += 1;
        self.woodbury.clear();
        self.matrix
            .factor(system, motion, mass_weight, weights, self.scale)
            .map_err(|singular| StepError::Singular {
                t: motion.t,
                coordinate: name(system, singular.unknown),
            })
    }

    /// Solves for the correction that removes the last residual; afterwards [`Workspace::correction`] holds `Δq` and `Δλ`.
    pub fn correct(&mut self, system: &mut dyn System, motion: &Motion<'_>, weights: Weights) -> Result<(), StepError> {
        self.updates.clear();
        let mut owner = 0;
        let updates = &mut self.updates;
        system.forces(&mut |force| {
            updates.set_owner(owner);
            force.push_updates(motion, weights, updates);
            owner += 1;
        });
        for (i, value) in self.residual.iter_mut().enumerate() {
            *value *= if i < self.coordinates { -1.0 } else { -self.scale };
        }
        let before = self.woodbury.solves;
        let regular = self
            .woodbury
            .solve(&mut self.matrix, &self.updates, &self.residual, &mut self.correction);
        for value in &mut self.correction[self.coordinates..] {
            *value *= self.scale;
        }
        self.counters.newton_iterations += 1;
        self.counters.solves += self.woodbury.solves - before;
        match self.correction.iter().position(|value| !value.is_finite()) {
            None if regular => Ok(()),
            place => Err(StepError::Singular {
                t: motion.t,
                coordinate: name(system, place.unwrap_or(0)),
            }),
        }
    }

    /// Solves for what the change of the forces from motion `before` to motion `after` does at constraints that stay closed.
    pub fn jump(
        &mut self,
        system: &mut dyn System,
        before: &Motion<'_>,
        after: &Motion<'_>,
        weights: Weights,
    ) -> Result<(), StepError> {
        self.residual.fill(0.0);
        let force = &mut self.residual[..self.coordinates];
        system.forces(&mut |contribution| contribution.add_force(after, force));
        for value in force.iter_mut() {
            *value = -*value;
        }
        system.forces(&mut |contribution| contribution.add_force(before, force));
        for &index in &self.fixed {
            self.residual[index] = 0.0;
        }
        self.correct(system, after, weights)
    }

    /// Forgets what depends on the course so far, so that a restored state repeats bit for bit.
    pub fn forget(&mut self) {
        self.woodbury.clear();
    }
}

/// Name of a coordinate or multiplier for messages.
pub(crate) fn name(system: &dyn System, unknown: usize) -> String {
    let coordinates = system.layout().coordinates();
    if unknown < coordinates {
        system.layout().name(unknown)
    } else {
        format!("constraint equation {}", unknown - coordinates + 1)
    }
}
