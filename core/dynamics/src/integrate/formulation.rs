//! Constraints within a time step: index 3, or index 1 with Baumgarte's stabilisation.
//!
//! The thesis calls its equations augmented: `v̇` and `λ` are unknowns of one system. The augmented Lagrangian of the
//! literature is another method, the penalty and multiplier iteration of Bayo [Bayo, García de Jalón & Serna, Comput.
//! Methods Appl. Mech. Engrg. 71 (1988) 183], which is not used here.
use crate::{Constraint, Force, JacobianRows, Layout, Motion, System, Weights};

/// Equations of constraints in a time step; constraints that [`Constraint::moves`] have their own, see
/// [`crate::GeneralizedAlpha`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    /// Index 3 (default): `g(q) = 0` at the end of the step, to rounding.
    #[default]
    Index3,
    /// Index 1: accelerations and multipliers solve one linear system at the end of the step.
    ///
    /// ```text
    /// [ M    g_qᵀ ] [ v̇ ]   [ Q                      ]
    /// [ g_q  0    ] [ λ ] = [ Q_c − 2 ω ġ − ω² g ]        [Thesis, Eq. (19)]
    /// ```
    ///
    /// with `Q_c = −(g_q)˙ v`: the index-1 form of the equations of motion with Baumgarte's stabilisation. The thesis
    /// states no treatment of the drift of `g̈ = 0`; here it decays with `ω` = 50 1/s [Baumgarte 1972], a rate that
    /// does not go with the step, so that positions, velocities and multipliers stay of second order: the drift is of
    /// the order of `h²`.
    Index1Baumgarte,
}

/// `ω`, 1/s: a drift has decayed after a tenth of a second, and the rate is far below those that steps of a millisecond
/// resolve.
const DRIFT_RATE: f64 = 50.0;

/// Weight of the rate of a constraint that moves in a time step, s; zero in statics, which have no rates.
///
/// Such a constraint requires `(ġ + ω g) / (γ' + ω) = 0`, a length as `g` is, with the derivative `g_q + ∂ġ/∂q / (γ' +
/// ω)` if velocities change by `γ'` per change of the coordinates.
pub(crate) fn rate_weight(weights: Weights) -> f64 {
    if weights.v > 0.0 {
        1.0 / (weights.v + DRIFT_RATE)
    } else {
        0.0
    }
}

/// A system whose constraints are those that a time step solves.
pub(crate) struct Stepped<'a> {
    system: &'a mut dyn System,
    formulation: Formulation,
    v_dot: &'a [f64],
    of_accelerations: f64,
    of_rates: f64,
}

impl<'a> Stepped<'a> {
    /// The constraints of `system` at the accelerations `v_dot`, where a change of the coordinates by 1 changes
    /// accelerations by `mass_rate` (1/s²) and velocities by `weights.v` (1/s).
    ///
    /// Residuals of accelerations are divided by `∂(v̇ + 2 ω v + ω² q)/∂q`, so that their derivative is `g_q` but for
    /// terms of the order of the step: the iteration matrix and the tolerance are those of the positions.
    pub fn new(
        system: &'a mut dyn System,
        formulation: Formulation,
        v_dot: &'a [f64],
        (mass_rate, weights): (f64, Weights),
    ) -> Self {
        Self {
            system,
            formulation,
            v_dot,
            of_accelerations: 1.0 / (mass_rate + DRIFT_RATE * (2.0 * weights.v + DRIFT_RATE)),
            of_rates: rate_weight(weights),
        }
    }
}

impl System for Stepped<'_> {
    fn layout(&self) -> &Layout {
        self.system.layout()
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.system.forces(visit);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        let (v_dot, formulation) = (self.v_dot, self.formulation);
        let (of_accelerations, of_rates) = (self.of_accelerations, self.of_rates);
        self.system.constraints(&mut |constraint| {
            if constraint.moves() {
                visit(&mut OfRates {
                    constraint,
                    scale: of_rates,
                });
            } else if formulation == Formulation::Index1Baumgarte {
                visit(&mut OfAccelerations {
                    constraint,
                    v_dot,
                    scale: of_accelerations,
                });
            } else {
                visit(constraint);
            }
        });
    }
}

/// `ġ + ω g`, scaled.
struct OfRates<'a> {
    constraint: &'a mut dyn Constraint,
    scale: f64,
}

impl Constraint for OfRates<'_> {
    fn dimension(&self) -> usize {
        self.constraint.dimension()
    }

    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        self.constraint.residual(motion, g);
        g.iter_mut().for_each(|g| *g *= DRIFT_RATE);
        self.constraint.add_rate(motion, g);
        g.iter_mut().for_each(|g| *g *= self.scale);
    }

    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        self.constraint.jacobian(motion, rows);
    }

    fn moves(&self) -> bool {
        true
    }
}

/// `g_q v̇ + (g_q)˙ v + 2 ω ġ + ω² g`, scaled; `g` itself where the constraint does not know its second derivative.
struct OfAccelerations<'a> {
    constraint: &'a mut dyn Constraint,
    v_dot: &'a [f64],
    scale: f64,
}

impl Constraint for OfAccelerations<'_> {
    fn dimension(&self) -> usize {
        self.constraint.dimension()
    }

    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        self.constraint.residual(motion, g);
        for g in g.iter_mut() {
            *g *= DRIFT_RATE * DRIFT_RATE;
        }
        if !self.constraint.add_velocity_terms(motion, g) {
            self.constraint.residual(motion, g);
            return;
        }
        let mut add = |row: usize, columns: &[usize], values: &[f64]| {
            for (&column, value) in columns.iter().zip(values) {
                g[row] += value * (self.v_dot[column] + 2.0 * DRIFT_RATE * motion.v[column]);
            }
        };
        self.constraint.jacobian(motion, &mut JacobianRows::new(&mut add));
        for g in g.iter_mut() {
            *g *= self.scale;
        }
    }

    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        self.constraint.jacobian(motion, rows);
    }
}
