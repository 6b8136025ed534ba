//! Static equilibrium by Newton's method.
use crate::capability::visit_histories;
use crate::integrate::newton::name;
use crate::integrate::residual::Since;
use crate::integrate::workspace::Workspace;
use crate::linear::block_tridiagonal::Precision;
use crate::{Jacobian, Motion, NewtonOptions, State, StepError, System, Weights};
use nalgebra::{UnitQuaternion, Vector3};

/// Contraction of the residual up to which the next correction keeps the factors, by the last correction or in the mean
/// of the last two: a factorisation takes as long as dozens of corrections. What bends a wire stretches it, so that
/// corrections contract by turns.
const KEPT: f64 = 0.3;

/// Options of the static solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticOptions {
    /// Tolerances and iteration limit.
    pub newton: NewtonOptions,
    /// `μ M` is added to the stiffness matrix, 1/s²: it holds coordinates without stiffness (bars that may spin about
    /// their own axis) and costs iterations if it is not small against the squares of the eigenfrequencies.
    pub mass_shift: f64,
    /// Largest change of a coordinate in one correction, m or rad; a longer correction is shortened as a whole.
    pub largest_change: f64,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            newton: NewtonOptions {
                max_iterations: 200,
                jacobian: Jacobian::Full,
                ..NewtonOptions::default()
            },
            mass_shift: 0.0,
            largest_change: 0.5,
        }
    }
}

impl StaticOptions {
    /// Factors that are kept while corrections contract the residual, for tangents that change little.
    #[must_use]
    pub fn modified() -> Self {
        let mut options = Self::default();
        options.newton.jacobian = Jacobian::Modified;
        options
    }
}

/// Work and result of a static solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Remaining largest residual, N.
    pub residual: f64,
}

/// Moves `state` to the static equilibrium with inputs `u`: velocities and accelerations become zero, multipliers
/// follow.
///
/// The exact tangent is factored in every iteration, unless the options keep factors.
///
/// # Errors
/// See [`StepError`]; `state` is then unchanged.
pub fn solve_static(
    system: &mut dyn System,
    state: &mut State,
    u: &[f64],
    options: &StaticOptions,
) -> Result<StaticReport, StepError> {
    StaticSolver::new(system, &state.motion(u)).solve(system, state, u, options)
}

/// Static solutions one after the other of systems whose contributions have the same entries: their pattern is analysed
/// once.
pub struct StaticSolver {
    workspace: Workspace,
    /// True if there are factors of an earlier solution.
    factored: bool,
}

impl StaticSolver {
    /// A solver for a system, and for others with its coordinates and entries.
    pub fn new(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        Self {
            workspace: Workspace::new(system, motion, Precision::Double),
            factored: false,
        }
    }

    /// Moves `state` to the static equilibrium, see [`solve_static`]. Where factors are kept, those of the solution
    /// before are tried first, and exact tangents where kept ones lead nowhere.
    ///
    /// # Errors
    /// See [`StepError`]; `state` is then unchanged.
    pub fn solve(
        &mut self,
        system: &mut dyn System,
        state: &mut State,
        u: &[f64],
        options: &StaticOptions,
    ) -> Result<StaticReport, StepError> {
        let start = state.clone();
        let mut result = solve((&mut self.workspace, &mut self.factored), system, state, u, options);
        if result.is_err() && options.newton.jacobian == Jacobian::Modified {
            let mut options = *options;
            options.newton.jacobian = Jacobian::Full;
            state.copy_from(&start);
            result = solve((&mut self.workspace, &mut self.factored), system, state, u, &options);
        }
        if result.is_err() {
            self.factored = false;
            *state = start;
        }
        result
    }
}

fn solve(
    (workspace, factored): (&mut Workspace, &mut bool),
    system: &mut dyn System,
    state: &mut State,
    u: &[f64],
    options: &StaticOptions,
) -> Result<StaticReport, StepError> {
    for vector in [&mut state.v, &mut state.v_dot, &mut state.a] {
        vector.fill(0.0);
    }
    let weights = Weights { q: 1.0, v: 0.0 };
    let newton = &options.newton;
    visit_histories(system, &mut |kept| kept.begin_step(&state.motion(u), 0.0));
    let mut best = f64::INFINITY;
    let mut stagnant = 0;
    // Residuals before the last two corrections with these factors.
    let mut before = [0.0_f64; 2];
    for iteration in 0..=newton.max_iterations {
        let motion = state.motion(u);
        let residual = workspace.residual(system, &motion, None, &state.lambda, (newton, Since::Anything));
        if !residual.ratio.is_finite() {
            return Err(StepError::NotFinite {
                t: state.t,
                coordinate: name(system, workspace.worst(&residual)),
            });
        }
        if residual.ratio <= 1.0 {
            visit_histories(system, &mut |kept| kept.end_step(&motion));
            return Ok(StaticReport {
                iterations: iteration,
                residual: residual.value,
            });
        }
        if iteration == newton.max_iterations {
            let worst = workspace.worst(&residual);
            return Err(StepError::NotConverged {
                t: state.t,
                h: 0.0,
                iterations: iteration,
                residual: residual.value,
                tolerance: newton.tolerance_of(worst, state.q.len()),
                coordinate: name(system, worst),
            });
        }
        stagnant = if residual.ratio < 0.9 * best { 0 } else { stagnant + 1 };
        best = best.min(residual.ratio);
        let serve = match iteration {
            0 => *factored,
            _ => residual.ratio <= KEPT * before[0].max(KEPT * before[1]),
        };
        if newton.jacobian == Jacobian::Full || !serve {
            workspace.factor(system, &motion, options.mass_shift, weights)?;
            *factored = true;
            before[0] = 0.0;
        }
        before = [residual.ratio, before[0]];
        workspace.correct(system, &motion, weights, None)?;
        let n = state.q.len();
        let largest = workspace.correction[..n]
            .iter()
            .fold(0.0_f64, |max, x| max.max(x.abs()));
        // Droppers that switch to and fro make full corrections cycle; shorter ones end the cycle.
        let patience = if stagnant > 5 { 0.5 } else { 1.0 };
        let damping = patience * (options.largest_change / largest).min(1.0);
        if damping < 1.0 {
            before = [0.0; 2];
        }
        for (q, change) in state.q.iter_mut().zip(&workspace.correction) {
            *q += damping * change;
        }
        for (lambda, change) in state.lambda.iter_mut().zip(&workspace.correction[n..]) {
            *lambda += damping * change;
        }
        for (k, &first) in system.layout().rotations().iter().enumerate() {
            let turn = Vector3::new(state.q[first], state.q[first + 1], state.q[first + 2]);
            state.q[first..first + 3].fill(0.0);
            state.rotation[k] *= UnitQuaternion::from_scaled_axis(turn);
        }
    }
    unreachable!("the last pass returns")
}
