//! What statics and time integration share: residuals, corrections, and the options of Newton's method.
use crate::augmented::rate_weight;
use crate::matrix::{IterationMatrix, MovingRows};
use crate::part::Thresholds;
use crate::residual::{Correction, Imbalance, Residual, Since};
use crate::woodbury::Woodbury;
use crate::{Formulation, Motion, Stage, System, Updates, Weights};
use serde::{Deserialize, Serialize};
use std::ops::Range;

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
    /// Largest residual of a generalised force at convergence, N (N·m for slopes and rotations), evaluated or foreseen from how
    /// corrections contracted in the steps before.
    pub tolerance: f64,
    /// Largest residual of a constraint at convergence, m (–).
    pub constraint_tolerance: f64,
    /// Iterations before the step is given up.
    pub max_iterations: usize,
    /// See [`Jacobian`].
    pub jacobian: Jacobian,
    /// See [`Formulation`]; statics have no accelerations and take positions.
    pub formulation: Formulation,
}

impl Default for NewtonOptions {
    /// 1e-6 N is 1e-8 of a contact force; 1e-12 m is rounding at the size of a pantograph.
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            constraint_tolerance: 1e-12,
            max_iterations: 30,
            jacobian: Jacobian::Modified,
            formulation: Formulation::Positions,
        }
    }
}

impl NewtonOptions {
    /// The tolerance that the residual of an unknown is held to; the first ones are `coordinates`, then come constraints.
    pub(crate) fn tolerance_of(&self, unknown: usize, coordinates: usize) -> f64 {
        if unknown < coordinates {
            self.tolerance
        } else {
            self.constraint_tolerance
        }
    }
}

/// Why an equilibrium could not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Newton's method used all its iterations; a smaller `h` may help.
    #[error(
        "no equilibrium at t = {t} s (h = {h} s): residual {residual:.3e} {unit} after {iterations} iterations, tolerance \
         {tolerance:.1e} {unit}, largest at {coordinate}",
        unit = unit(coordinate)
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
    /// Time steps whose last residual was foreseen and not evaluated.
    #[serde(default)]
    pub foreseen: u64,
}

/// Ranges of unknowns, ascending and apart.
#[derive(Debug, Default)]
struct Ranges(Vec<Range<usize>>);

impl Ranges {
    /// Ranges that are no further apart than this become one.
    const GAP: usize = 64;

    fn push(&mut self, range: Range<usize>) {
        self.0.push(range);
    }

    /// Sorts, and joins what overlaps or is close together.
    fn tidy(&mut self) {
        self.0.sort_unstable_by_key(|range| range.start);
        self.0.dedup_by(|next, kept| {
            let joined = next.start <= kept.end + Self::GAP;
            if joined {
                kept.end = kept.end.max(next.end);
            }
            joined
        });
    }
}

/// Residuals below this part of the tolerance are left as they are while others are corrected, and below a tenth of that in each
/// further correction of the step: what is left behind passes through low-rank terms as stiff as a closing damper's, which make more
/// of it than there was, and at the same limit the next correction would leave the same behind. On rows that are known without
/// evaluation what is left is not seen: there a step may end above the tolerance by about as much.
const LEFT: f64 = 0.3;

/// Matrix, low-rank terms and buffers of one system.
pub(crate) struct Workspace {
    coordinates: usize,
    pub matrix: IterationMatrix,
    woodbury: Woodbury,
    updates: Updates,
    scale: f64,
    imbalance: Imbalance,
    /// `Δq` and `Δλ`.
    pub correction: Vec<f64>,
    /// Where the correction is not zero, and the unknowns whose equations it enters.
    changed: Ranges,
    affected: Ranges,
    /// Corrections, factorisations and solutions since they were last taken from here.
    pub counters: Counters,
}

impl Workspace {
    pub fn new(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        let matrix = IterationMatrix::analyse(system, motion, MovingRows::Placeholders);
        let coordinates = system.layout().coordinates();
        let size = coordinates + system.layout().constraints();
        // Nothing allocates later: there are at most as many ranges as unknowns, and a few dozen in practice.
        let ranges = || Ranges(Vec::with_capacity(256));
        Self {
            coordinates,
            matrix,
            woodbury: Woodbury::default(),
            updates: Updates::default(),
            scale: 1.0,
            imbalance: Imbalance::new(system, motion),
            correction: vec![0.0; size],
            changed: ranges(),
            affected: ranges(),
            counters: Counters::default(),
        }
    }

    /// Evaluates `Q − M v̇ − g_qᵀ λ` and `g`; without `v_dot` the inertia is left out.
    pub fn residual(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        v_dot: Option<&[f64]>,
        lambda: &[f64],
        (options, since): (&NewtonOptions, Since),
    ) -> Residual {
        self.updates.set_multipliers(lambda);
        match v_dot {
            None => self.imbalance.at_rest(system, motion),
            Some(v_dot) => {
                let last = Correction {
                    change: &self.correction,
                    updates: &self.updates,
                    forces: self.woodbury.forces(),
                    affected: &self.affected.0,
                };
                self.imbalance
                    .in_motion(system, motion, v_dot, &self.matrix, (since, &last));
            }
        }
        self.imbalance.sum_up(system, motion, lambda, options)
    }

    /// Whether nothing is nonlinear but what evaluates no ranges: contact, the droppers of a linear line, pantographs, vehicles.
    pub fn is_linear(&self) -> bool {
        self.imbalance.is_linear()
    }

    /// The equations of constraints that move, ascending.
    pub fn moving(&self) -> &[usize] {
        &self.matrix.moving
    }

    /// The unknown with the largest residual.
    pub fn worst(&self, residual: &Residual) -> usize {
        self.imbalance.worst(residual)
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
        self.imbalance.linearise(system, motion, mass_weight, weights);
        self.matrix
            .factor(system, motion, mass_weight, weights, self.scale)
            .map_err(|singular| StepError::Singular {
                t: motion.t,
                coordinate: name(system, singular.unknown),
            })
    }

    /// Solves for the correction number `iteration` (from 0) of a step, which removes the last residual where it is above a part of
    /// the tolerances of `options`; afterwards [`Workspace::correction`] holds `Δq` and `Δλ`. Without options nothing is left out.
    pub fn correct(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        weights: Weights,
        options: Option<(&NewtonOptions, usize)>,
    ) -> Result<(), StepError> {
        self.updates.clear();
        self.updates
            .set_borders(self.coordinates, self.scale, rate_weight(weights));
        let mut owner = 0;
        let updates = &mut self.updates;
        system.forces(&mut |force| {
            updates.set_owner(owner);
            force.push_updates(motion, weights, updates);
            owner += 1;
        });
        for value in &mut self.imbalance.sum[self.coordinates..] {
            *value *= -self.scale;
        }
        // A border asks of its coordinates whatever force brings them onto the constraint, however small beside others.
        let options = options.filter(|_| !self.updates.has_borders());
        let thresholds = options.map_or_else(Thresholds::default, |(options, iteration)| {
            let left = LEFT * 0.1_f64.powi(iteration as i32);
            Thresholds {
                force: left * options.tolerance,
                constraint: left * options.constraint_tolerance * self.scale,
            }
        });
        self.changed.0.clear();
        self.affected.0.clear();
        let before = self.woodbury.solves;
        let (changed, affected) = (&mut self.changed, &mut self.affected);
        system.enter(Stage::Solution);
        let regular = self.woodbury.solve(
            &mut self.matrix,
            &self.updates,
            &self.imbalance.sum,
            thresholds,
            &mut self.correction,
            &mut |inner, outer| {
                changed.push(inner);
                affected.push(outer);
            },
        );
        system.enter(Stage::Integration);
        changed.tidy();
        affected.tidy();
        for value in &mut self.correction[self.coordinates..] {
            *value *= self.scale;
        }
        self.counters.newton_iterations += 1;
        self.counters.solves += self.woodbury.solves - before;
        if regular {
            return Ok(());
        }
        let place = self.correction.iter().position(|value| !value.is_finite());
        Err(StepError::Singular {
            t: motion.t,
            coordinate: name(system, place.unwrap_or(0)),
        })
    }

    /// The ranges of coordinates in which the last correction is not zero.
    pub fn changed(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let end = self.coordinates;
        let ranges = self.changed.0.iter().map(move |range| range.start..range.end.min(end));
        ranges.filter(|range| !range.is_empty())
    }

    /// Solves for what the change of the inputs from motion `before` to motion `after`, the same state, does at constraints that
    /// stay closed.
    pub fn jump(
        &mut self,
        system: &mut dyn System,
        before: &Motion<'_>,
        after: &Motion<'_>,
        weights: Weights,
    ) -> Result<(), StepError> {
        self.imbalance.jump(system, before, after);
        self.correct(system, after, weights, None)
    }

    /// Forgets what depends on the course so far, so that a restored state repeats bit for bit.
    pub fn forget(&mut self) {
        self.woodbury.clear();
    }
}

/// What constraint equations are called in messages.
const EQUATION: &str = "constraint equation";

/// Name of a coordinate or multiplier for messages.
pub(crate) fn name(system: &dyn System, unknown: usize) -> String {
    let coordinates = system.layout().coordinates();
    if unknown < coordinates {
        system.layout().name(unknown)
    } else {
        format!("{EQUATION} {}", unknown - coordinates + 1)
    }
}

/// Unit of the residual of what [`name`] has named.
fn unit(name: &str) -> &'static str {
    if name.starts_with(EQUATION) { "m" } else { "N" }
}
