//! Matrix, low-rank terms and buffers that statics and time steps share.
use crate::integrate::formulation::rate_weight;
use crate::integrate::newton::name;
use crate::integrate::residual::{Correction, Imbalance, Residual, Since};
use crate::linear::block_tridiagonal::Precision;
use crate::linear::iteration_matrix::{IterationMatrix, MovingRows};
use crate::linear::low_rank::Woodbury;
use crate::linear::part::Thresholds;
use crate::{Counters, Motion, NewtonOptions, Stage, StepError, System, Updates, Weights};
use std::ops::Range;

/// Ranges of unknowns, ascending and apart.
#[derive(Debug, Default)]
struct Ranges(Vec<Range<usize>>);

impl Ranges {
    /// Ranges that are no further apart than this become one.
    const GAP: usize = 64;

    fn push(&mut self, range: Range<usize>) {
        self.0.push(range);
    }

    /// Sorts, and joins ranges that overlap or are close together.
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

/// Residuals below this part of the tolerance stay while others are corrected, and below a tenth of that in each
/// further correction of the step: low-rank terms as stiff as a closing damper amplify the remainder, and the next
/// correction at the same limit would leave the same remainder behind. The remainder is not seen on rows that are known
/// without evaluation: there a step may end above the tolerance by about as much.
const LEFT: f64 = 0.3;

/// Part of the first residual of a step up to which second corrections leave as much as first ones: what is left
/// behind in each step bends a slow line, and does not tell beside what moves a fast one.
const BESIDE_FIRST: f64 = 2e-3;

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
    /// Ranges in which the correction is not zero, and the unknowns whose equations it enters.
    changed: Ranges,
    affected: Ranges,
    /// Corrections, factorisations and solutions since the last reset.
    pub counters: Counters,
}

impl Workspace {
    pub fn new(system: &mut dyn System, motion: &Motion<'_>, precision: Precision) -> Self {
        let matrix = IterationMatrix::analyse(system, motion, MovingRows::Placeholders, precision);
        let coordinates = system.layout().coordinates();
        let size = coordinates + system.layout().constraints();
        // Room for a few dozen ranges in practice: nothing allocates later.
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

    /// Returns `true` if all contributions that evaluate ranges are linear: contact, the droppers of a linear line,
    /// pantographs and vehicles evaluate none.
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

    /// Solves for the correction number `iteration` (from 0) of a step, which removes the last residual where it is
    /// above a part of the tolerances of `options`; afterwards [`Workspace::correction`] holds `Δq` and `Δλ`. Without
    /// options nothing is left out.
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
            if let Some(low_rank) = force.low_rank() {
                low_rank.push_updates(motion, weights, updates);
            }
            owner += 1;
        });
        for value in &mut self.imbalance.sum[self.coordinates..] {
            *value *= -self.scale;
        }
        // A border requires any force, however small, that brings its coordinates onto the constraint.
        let options = options.filter(|_| !self.updates.has_borders());
        let thresholds = options.map_or_else(Thresholds::default, |(options, iteration)| {
            let left = match iteration {
                0 => LEFT,
                _ => self.left_beside_first() * 0.1_f64.powi(iteration as i32 - 1),
            };
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

    /// Part of the tolerance below which residuals stay in a second correction.
    fn left_beside_first(&self) -> f64 {
        (BESIDE_FIRST * self.imbalance.first()).clamp(0.1 * LEFT, LEFT)
    }

    /// The ranges of coordinates in which the last correction is not zero.
    pub fn changed(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let end = self.coordinates;
        let ranges = self.changed.0.iter().map(move |range| range.start..range.end.min(end));
        ranges.filter(|range| !range.is_empty())
    }

    /// Solves for the effect of a change of the inputs from motion `before` to motion `after`, the same state, at
    /// constraints that stay closed.
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

    /// Forgets the history so far, so that a restored state repeats bit for bit.
    pub fn forget(&mut self) {
        self.woodbury.clear();
    }
}
