//! What statics and time integration share: residuals, corrections, and the options of Newton's method.
use crate::matrix::{IterationMatrix, MovingRows, visit_jacobian};
use crate::part::Thresholds;
use crate::woodbury::Woodbury;
use crate::{Formulation, Motion, System, Updates, Weights};
use pulp::{Arch, Simd, WithSimd};
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
    /// Largest residual of a generalised force at convergence, N (N·m for slopes and rotations).
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
    /// Largest ratio of residual to tolerance; converged at ≤ 1; not a number where a residual is none.
    pub ratio: f64,
    /// First unknown of those with the largest ratio: coordinates or constraint equations.
    start: usize,
    /// The largest residual of these, N or m.
    pub value: f64,
}

/// What has changed since the last residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Since {
    /// Anything.
    Anything,
    /// What the last correction has changed.
    Correction,
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

/// Residuals below this part of the tolerance are left as they are while others are corrected.
const LEFT: f64 = 0.1;

/// Matrix, low-rank terms and buffers of one system.
pub(crate) struct Workspace {
    arch: Arch,
    coordinates: usize,
    fixed: Vec<usize>,
    pub matrix: IterationMatrix,
    woodbury: Woodbury,
    updates: Updates,
    scale: f64,
    /// `Q − M v̇` of the contributions that evaluate ranges.
    local_force: Vec<f64>,
    scratch: Vec<f64>,
    /// `Q − M v̇ − g_qᵀ λ` and `g`.
    imbalance: Vec<f64>,
    /// `Δq` and `Δλ`.
    pub correction: Vec<f64>,
    /// Where the correction is not zero, and the unknowns whose equations it enters.
    changed: Ranges,
    affected: Ranges,
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
            arch: Arch::new(),
            coordinates,
            fixed: system.layout().fixed().to_vec(),
            matrix,
            woodbury: Woodbury::default(),
            updates: Updates::default(),
            scale: 1.0,
            local_force: vec![0.0; coordinates],
            scratch: vec![0.0; coordinates],
            imbalance: vec![0.0; size],
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
        let (force, constraint) = self.imbalance.split_at_mut(self.coordinates);
        force.fill(0.0);
        match v_dot {
            None => system.forces(&mut |contribution| contribution.add_force(motion, force)),
            Some(v_dot) => {
                if since == Since::Anything {
                    self.local_force.fill(0.0);
                }
                let local = &mut self.local_force;
                system.forces(&mut |contribution| {
                    if contribution.evaluates_ranges() {
                        if since == Since::Anything {
                            contribution.add_dynamic_force(motion, v_dot, local);
                        }
                    } else if contribution.multiplies_mass() {
                        contribution.add_dynamic_force(motion, v_dot, force);
                    } else {
                        contribution.add_force(motion, force);
                    }
                });
                self.matrix.subtract_inertia(v_dot, force);
            }
        }
        if let (Some(v_dot), Since::Correction) = (v_dot, since) {
            for range in &self.affected.0 {
                let range = range.start..range.end.min(self.coordinates);
                if range.is_empty() {
                    continue;
                }
                self.scratch[range.clone()].fill(0.0);
                let scratch = &mut self.scratch;
                system.forces(&mut |contribution| {
                    if contribution.evaluates_ranges() {
                        contribution.add_dynamic_force_within(range.clone(), motion, v_dot, scratch);
                    }
                });
                self.local_force[range.clone()].copy_from_slice(&self.scratch[range]);
            }
        }
        visit_jacobian(system, motion, &mut |row, columns, values| {
            for (&column, &value) in columns.iter().zip(values) {
                force[column] -= value * lambda[row];
            }
        });
        let mut first = 0;
        system.constraints(&mut |contribution| {
            let next = first + contribution.dimension();
            contribution.residual(motion, &mut constraint[first..next]);
            first = next;
        });
        for &index in &self.fixed {
            (force[index], self.local_force[index]) = (0.0, 0.0);
        }
        let other: &[f64] = if v_dot.is_some() { &self.local_force } else { &[] };
        let of_forces = self.arch.dispatch(Add { target: force, other });
        let of_constraints = self.arch.dispatch(Add {
            target: constraint,
            other: &[],
        });
        let ratios = [
            of_forces / options.tolerance,
            of_constraints / options.constraint_tolerance,
        ];
        let (ratio, start, value) = if ratios[1] > ratios[0] || ratios[1].is_nan() {
            (ratios[1], self.coordinates, of_constraints)
        } else {
            (ratios[0], 0, of_forces)
        };
        Residual { ratio, start, value }
    }

    /// The unknown with the largest residual.
    pub fn worst(&self, residual: &Residual) -> usize {
        let part = if residual.start == 0 {
            &self.imbalance[..self.coordinates]
        } else {
            &self.imbalance[self.coordinates..]
        };
        let size = |value: f64| if value.is_finite() { value.abs() } else { f64::INFINITY };
        let worst = (0..part.len()).max_by(|&i, &j| size(part[i]).total_cmp(&size(part[j])));
        residual.start + worst.unwrap_or(0)
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

    /// Solves for the correction that removes the last residual where it is above a tenth of the tolerances of `options`;
    /// afterwards [`Workspace::correction`] holds `Δq` and `Δλ`. Without options nothing is left out.
    pub fn correct(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        weights: Weights,
        options: Option<&NewtonOptions>,
    ) -> Result<(), StepError> {
        self.updates.clear();
        self.updates.set_borders(self.coordinates, self.scale);
        let mut owner = 0;
        let updates = &mut self.updates;
        system.forces(&mut |force| {
            updates.set_owner(owner);
            force.push_updates(motion, weights, updates);
            owner += 1;
        });
        for value in &mut self.imbalance[self.coordinates..] {
            *value *= -self.scale;
        }
        let mut thresholds = options.map_or_else(Thresholds::default, |options| Thresholds {
            force: LEFT * options.tolerance,
            constraint: LEFT * options.constraint_tolerance * self.scale,
        });
        // The force that brings a border's coordinates onto its constraint is one of those that would be left.
        if self.updates.has_borders() {
            thresholds.force = thresholds.force.min(thresholds.constraint);
        }
        for range in self.changed.0.drain(..) {
            self.correction[range].fill(0.0);
        }
        self.affected.0.clear();
        let before = self.woodbury.solves;
        let (changed, affected) = (&mut self.changed, &mut self.affected);
        let regular = self.woodbury.solve(
            &mut self.matrix,
            &self.updates,
            &self.imbalance,
            thresholds,
            &mut self.correction,
            &mut |inner, outer| {
                changed.push(inner);
                affected.push(outer);
            },
        );
        changed.tidy();
        affected.tidy();
        for value in &mut self.correction[self.coordinates..] {
            *value *= self.scale;
        }
        self.counters.newton_iterations += 1;
        self.counters.solves += self.woodbury.solves - before;
        // 0 · ∞ is not a number.
        let finite = |range: &Range<usize>| self.correction[range.clone()].iter().map(|x| 0.0 * x).sum::<f64>() == 0.0;
        if regular && self.changed.0.iter().all(finite) {
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
        self.imbalance.fill(0.0);
        let force = &mut self.imbalance[..self.coordinates];
        let mut add = |motion: &Motion<'_>| {
            system.forces(&mut |contribution| {
                if !contribution.evaluates_ranges() {
                    contribution.add_force(motion, force);
                }
            });
            force.iter_mut().for_each(|value| *value = -*value);
        };
        add(before);
        add(after);
        force.iter_mut().for_each(|value| *value = -*value);
        for &index in &self.fixed {
            self.imbalance[index] = 0.0;
        }
        self.correct(system, after, weights, None)
    }

    /// Forgets what depends on the course so far, so that a restored state repeats bit for bit.
    pub fn forget(&mut self) {
        self.woodbury.clear();
    }
}

/// `target += other` where there is another, and the largest absolute value of the sum; not a number where one of them is none or
/// infinite.
struct Add<'a> {
    target: &'a mut [f64],
    other: &'a [f64],
}

impl WithSimd for Add<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let zero = simd.splat_f64s(0.0);
        let (mut largest, mut spoilt) = (zero, zero);
        let mut see = |x: S::f64s| {
            largest = simd.max_f64s(largest, simd.abs_f64s(x));
            // 0 · ∞ is not a number either.
            spoilt = simd.mul_add_e_f64s(x, zero, spoilt);
        };
        let (vectors, rest) = S::as_mut_simd_f64s(self.target);
        if self.other.is_empty() {
            vectors.iter().for_each(|&x| see(x));
        } else {
            let (others, other_rest) = S::as_simd_f64s(self.other);
            for (x, &other) in vectors.iter_mut().zip(others) {
                *x = simd.add_f64s(*x, other);
                see(*x);
            }
            rest.iter_mut().zip(other_rest).for_each(|(x, other)| *x += other);
        }
        see(simd.partial_load_f64s(rest));
        simd.reduce_max_f64s(largest) + simd.reduce_sum_f64s(spoilt)
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
