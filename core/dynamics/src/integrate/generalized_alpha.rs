//! Generalized-α time integration of constrained systems.
use crate::capability::visit_histories;
use crate::integrate::convergence_estimate::ConvergenceEstimate;
use crate::integrate::formulation::{Formulation, Stepped};
use crate::integrate::memory::{Linearisation, Memory, restore_after_step};
use crate::integrate::newton::name;
use crate::integrate::passes::{Apply, Predict};
use crate::integrate::residual::Since;
use crate::integrate::scheme::Scheme;
use crate::integrate::workspace::Workspace;
use crate::linear::block_tridiagonal::Precision;
use crate::{Counters, Jacobian, Motion, NewtonOptions, Stage, State, StepError, System, Weights};
use nalgebra::{UnitQuaternion, Vector3};
use pulp::Arch;
use std::sync::Arc;

/// Generalized-α for constrained systems on vector spaces and rotations [Arnold & Brüls 2007; Brüls, Cardona & Arnold
/// 2012], here with constraints of positions; see [`Formulation`] for the other form:
///
/// ```text
/// M v̇ₙ₊₁ = Q(tₙ₊₁, qₙ₊₁, vₙ₊₁) − g_qᵀ λₙ₊₁,   g(qₙ₊₁) = 0
/// qₙ₊₁ = qₙ ∘ exp(h vₙ + h² (½ − β) aₙ + h² β aₙ₊₁)
/// vₙ₊₁ = vₙ + h (1 − γ) aₙ + h γ aₙ₊₁
/// (1 − α_m) aₙ₊₁ + α_m aₙ = (1 − α_f) v̇ₙ₊₁ + α_f v̇ₙ
/// ```
///
/// A constraint that [`crate::Constraint::moves`] along the coordinates, as a strip along a wire, has
///
/// ```text
/// ġ(qₙ₊₁, vₙ₊₁) + ω g(qₙ₊₁) = 0,    ω = 50 1/s
/// ```
///
/// in place of `g = 0`, whatever the formulation. The multiplier of a constraint of positions repeats an error with the
/// double root `−rho_inf` of index 3 [Cardona & Géradin, Computers & Structures 33 (1989) 801, for the trapezoid], and
/// the turn of `g_q` from step to step feeds the error, so that it grows. The root of a constraint of rates is single
/// (index 2), and the turn can only take from the error: with `Y_ab = g_q(a) A⁻¹ g_q(b)ᵀ` of the iteration matrix `A`,
/// the trapezoid (`rho_inf` = 1) makes `−Y_(n+1)(n) / Y_(n+1)(n+1)` of an error at step `n`, and `Y_ab² ≤ Y_aa Y_bb`
/// leaves no more than `√(Y_00/Y_NN)` of it after `N` steps (derived here). The motion feels the loss, of the order of
/// `h`, and the reported multipliers come from the impulses of the steps, see [`State::lambda`]. The distance that
/// rates leave, of the order of `h²`, decays with `ω` [Baumgarte 1972] as under [`Formulation::Index1Baumgarte`].
///
/// The iteration matrix `β' M + γ' D + K` treats the derivative of the exponential map as the identity: its error is of
/// the order of the rotation within one step and costs at most iterations.
pub struct GeneralizedAlpha {
    scheme: Scheme,
    options: NewtonOptions,
    pub(super) workspace: Option<Workspace>,
    pub(super) memory: Memory,
    /// Rotation vectors of the present step, one per rotation.
    increments: Vec<Vector3<f64>>,
    start: State,
    start_history: Vec<f64>,
    counters: Counters,
    residuals: Vec<f64>,
}

/// Tolerance below which solutions have double precision, N. Single precision leaves some 1e-5 N of the forces of a
/// line: the next residual shows them, but not on rows that are known without evaluation.
const ROUNDED: f64 = 1e-4;

/// Contraction of the residual per iteration beyond which a kept factorisation is replaced.
const SLOW: f64 = 0.3;

/// Ratio of two steps above which the second one takes nothing over from the first.
const LONGEST_STRETCH: f64 = 1e3;

impl GeneralizedAlpha {
    /// An integrator for one system.
    #[must_use]
    pub fn new(rho_inf: f64, options: NewtonOptions) -> Self {
        Self {
            scheme: Scheme::new(rho_inf),
            options,
            workspace: None,
            memory: Memory::default(),
            increments: Vec::new(),
            start: State::default(),
            start_history: Vec::new(),
            counters: Counters::default(),
            residuals: Vec::with_capacity(options.max_iterations + 1),
        }
    }

    /// Keeps periods of oscillations to the fourth order of the step, see [`Scheme::fox_goodwin`]; to be called before
    /// the first step.
    pub(super) fn keep_periods(&mut self) {
        self.scheme = self.scheme.fox_goodwin();
    }

    /// Largest residual before each Newton iteration of the last step, N or m; the last one is the remaining residual,
    /// evaluated or estimated.
    #[must_use]
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// Work done so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Advances `state` by `h` s; `u` are the inputs at the end of the step.
    ///
    /// # Errors
    /// See [`StepError`]; the state and the contributions are then as before the step.
    pub fn step(
        &mut self,
        system: &mut dyn System,
        state: &mut State,
        u: &[f64],
        t_end: f64,
        h: f64,
    ) -> Result<(), StepError> {
        self.start_history.clear();
        visit_histories(system, &mut |kept| kept.save_for_step(&mut self.start_history));
        let result = self.attempt(system, state, u, t_end, h);
        match &result {
            Ok(()) => self.memory.last_h = Some(h),
            Err(_) => restore_after_step(system, &self.start_history),
        }
        result
    }

    pub(super) fn take_workspace(&mut self, system: &mut dyn System, motion: &Motion<'_>) -> Workspace {
        match self.workspace.take() {
            Some(workspace) => workspace,
            None => {
                system.enter(Stage::Factorization);
                let precision = if self.options.tolerance < ROUNDED {
                    Precision::Double
                } else {
                    Precision::Mixed
                };
                let workspace = Workspace::new(system, motion, precision);
                system.enter(Stage::Integration);
                workspace
            }
        }
    }

    fn attempt(
        &mut self,
        system: &mut dyn System,
        state: &mut State,
        u: &[f64],
        t_end: f64,
        h: f64,
    ) -> Result<(), StepError> {
        let mut workspace = self.take_workspace(system, &state.motion(u));
        let result = self.ensure_factor(&mut workspace, system, state, u, h).and_then(|()| {
            let result = self.iterate(&mut workspace, system, state, u, t_end, h);
            if result.is_err() {
                std::mem::swap(state, &mut self.start);
            }
            result
        });
        self.counters.micro_steps += 1;
        let iterations = workspace.counters.newton_iterations;
        self.counters.newton_iterations += iterations;
        self.counters.most_iterations = self.counters.most_iterations.max(iterations);
        self.keep(workspace);
        result
    }

    /// Keeps the workspace, and counts its factorisations and solutions since it was taken.
    pub(super) fn keep(&mut self, mut workspace: Workspace) {
        let work = std::mem::take(&mut workspace.counters);
        self.counters.factorizations += work.factorizations;
        self.counters.solves += work.solves;
        self.workspace = Some(workspace);
    }

    fn iterate(
        &mut self,
        workspace: &mut Workspace,
        system: &mut dyn System,
        state: &mut State,
        u: &[f64],
        t_end: f64,
        h: f64,
    ) -> Result<(), StepError> {
        let (mass_rate, velocity_rate) = self.scheme.rates(h);
        let weights = Weights {
            q: 1.0,
            v: velocity_rate,
        };
        let stretch = self.stretch(h);
        self.predict(system, state, t_end, h);
        let moving = &mut self.memory.moving;
        moving.begin(workspace.moving(), &self.scheme, stretch, &mut state.lambda);
        visit_histories(system, &mut |kept| kept.begin_step(&state.motion(u), h));
        let n = state.q.len();
        let options = self.options;
        let mut last_ratio = f64::INFINITY;
        let mut fresh = 0;
        let mut damping = 1.0;
        let mut contracts = false;
        self.residuals.clear();
        for iteration in 0..=options.passes.unwrap_or(options.max_iterations) {
            let motion = state.motion(u);
            let since = match iteration {
                0 => Since::Anything,
                _ if damping < 1.0 => Since::PartOfCorrection,
                _ => Since::Correction,
            };
            let mut stepped;
            let at: &mut dyn System = match options.formulation {
                Formulation::Index3 if workspace.moving().is_empty() => &mut *system,
                formulation => {
                    stepped = Stepped::new(system, formulation, &state.v_dot, (mass_rate, weights));
                    &mut stepped
                }
            };
            let residual = workspace.residual(at, &motion, Some(&state.v_dot), &state.lambda, (&options, since));
            self.residuals.push(residual.value);
            if !residual.ratio.is_finite() {
                return Err(StepError::NotFinite {
                    t: t_end,
                    coordinate: name(system, workspace.worst(&residual)),
                });
            }
            if contracts {
                self.memory
                    .convergence_estimate
                    .observe(iteration - 1, last_ratio, residual.ratio);
            }
            let ends = match options.passes {
                None => residual.ratio <= options.served_after(iteration),
                Some(passes) => iteration == passes,
            };
            if ends {
                self.counters.above_tolerance += u64::from(residual.ratio > 1.0);
                self.memory.convergence_estimate.end_step(false);
                visit_histories(system, &mut |kept| kept.end_step(&motion));
                let moving = &mut self.memory.moving;
                moving.end(workspace.moving(), &self.scheme, (h, stretch), &mut state.lambda);
                return Ok(());
            }
            let estimated = if options.passes.is_none() && damping == 1.0 && workspace.moving().is_empty() {
                let convergence_estimate = &self.memory.convergence_estimate;
                (convergence_estimate.last_residual(iteration, residual.ratio, last_ratio))
                    .filter(|left| *left <= options.served_after(iteration + 1))
            } else {
                None
            };
            if iteration == options.max_iterations {
                let worst = workspace.worst(&residual);
                return Err(StepError::NotConverged {
                    t: t_end,
                    h,
                    iterations: iteration,
                    residual: residual.value,
                    tolerance: options.tolerance_of(worst, n),
                    coordinate: name(system, worst),
                });
            }
            let slow = iteration >= 6 && residual.ratio > SLOW * last_ratio && residual.ratio > 10.0;
            if options.jacobian == Jacobian::Full || (options.passes.is_none() && slow && fresh < 2) {
                self.linearise(workspace, system, &motion, h)?;
                fresh += 1;
            }
            // A term that switches to and fro makes full corrections cycle: corrections become shorter with every
            // growth of the residual and recover while the residual falls.
            if iteration >= 3 {
                let growth = residual.ratio > last_ratio;
                damping = if growth {
                    0.5 * damping
                } else {
                    (1.5_f64 * damping).min(1.0)
                };
            }
            last_ratio = residual.ratio;
            workspace.correct(system, &motion, weights, Some((&options, iteration)))?;
            self.apply(workspace, damping, (mass_rate, velocity_rate), system, state);
            // The contraction of a first correction predicts that of the next step only if no law changes its branch.
            let tells = iteration == 0 && workspace.is_linear();
            let continues = (estimated.is_some() || tells) && continues_to(system, &state.motion(u));
            if let Some(left) = estimated
                && continues
            {
                self.counters.estimated += 1;
                self.memory.convergence_estimate.end_step(true);
                visit_histories(system, &mut |kept| kept.end_step(&state.motion(u)));
                self.residuals.push(residual.value * left / residual.ratio);
                return Ok(());
            }
            contracts = damping == 1.0 && (iteration > 0 || continues);
        }
        unreachable!("the last pass returns")
    }

    /// Factors for steps of `h` s ahead of the first one, where steps have fixed [`NewtonOptions::passes`].
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub(crate) fn prepare(
        &mut self,
        system: &mut dyn System,
        state: &State,
        u: &[f64],
        h: f64,
    ) -> Result<(), StepError> {
        if self.options.passes.is_none() {
            return Ok(());
        }
        let mut workspace = self.take_workspace(system, &state.motion(u));
        let result = self.ensure_factor(&mut workspace, system, state, u, h);
        self.keep(workspace);
        result
    }

    /// Makes sure there is a factorisation for this step size.
    fn ensure_factor(
        &mut self,
        workspace: &mut Workspace,
        system: &mut dyn System,
        state: &State,
        u: &[f64],
        h: f64,
    ) -> Result<(), StepError> {
        // Masters pass 0.0010000000000000009 for 1 ms: the same factors serve.
        let serves = |linearisation: &Linearisation| (linearisation.h - h).abs() <= 1e-9 * h;
        match &self.memory.linearisation {
            Some(linearisation) if serves(linearisation) => Ok(()),
            _ => self.linearise(workspace, system, &state.motion(u), h),
        }
    }

    fn linearise(
        &mut self,
        workspace: &mut Workspace,
        system: &mut dyn System,
        motion: &Motion<'_>,
        h: f64,
    ) -> Result<(), StepError> {
        let mut history = Vec::new();
        visit_histories(system, &mut |kept| kept.save(&mut history));
        let linearisation = Linearisation {
            h,
            t: motion.t,
            q: motion.q.to_vec(),
            v: motion.v.to_vec(),
            rotation: motion.rotation.to_vec(),
            u: motion.u.to_vec(),
            history,
        };
        self.factor(workspace, system, &linearisation)?;
        self.memory.convergence_estimate = ConvergenceEstimate::default();
        self.memory.linearisation = Some(Arc::new(linearisation));
        Ok(())
    }

    pub(super) fn factor(
        &self,
        workspace: &mut Workspace,
        system: &mut dyn System,
        linearisation: &Linearisation,
    ) -> Result<(), StepError> {
        let (mass_rate, velocity_rate) = self.scheme.rates(linearisation.h);
        let motion = Motion {
            t: linearisation.t,
            q: &linearisation.q,
            v: &linearisation.v,
            rotation: &linearisation.rotation,
            u: &linearisation.u,
        };
        let weights = Weights {
            q: 1.0,
            v: velocity_rate,
        };
        system.enter(Stage::Factorization);
        let result = workspace.factor(system, &motion, mass_rate, weights);
        system.enter(Stage::Integration);
        result
    }

    /// Ratio of a step of `h` s to the last one: `a` approximates `v̇` at `t + (α_m − α_f) h`, so its distance from
    /// `v̇` goes with the step. Zero, so that `a` is `v̇`, after a step so short that this distance is rounding.
    fn stretch(&self, h: f64) -> f64 {
        match self.memory.last_h {
            Some(last_h) if h > LONGEST_STRETCH * last_h => 0.0,
            Some(last_h) if (last_h - h).abs() > 1e-9 * h => h / last_h,
            _ => 1.0,
        }
    }

    /// Predicts the end of the step with the auxiliary acceleration kept; the start goes to `self.start`.
    fn predict(&mut self, system: &dyn System, state: &mut State, t_end: f64, h: f64) {
        if self.start.q.len() == state.q.len() {
            std::mem::swap(&mut self.start, state);
            state.lambda.clone_from(&self.start.lambda);
            state.rotation.clone_from(&self.start.rotation);
        } else {
            self.start.copy_from(state);
        }
        let stretch = self.stretch(h);
        state.t = t_end;
        Arch::new().dispatch(Predict {
            start: &self.start,
            end: state,
            h,
            alpha_f: self.scheme.alpha_f,
            stretch,
        });
        for &index in system.layout().fixed() {
            state.q[index] = self.start.q[index];
            state.v[index] = 0.0;
            state.v_dot[index] = 0.0;
            state.a[index] = 0.0;
        }
        self.increments.clear();
        for (k, &first) in system.layout().rotations().iter().enumerate() {
            let step = Vector3::new(state.q[first], state.q[first + 1], state.q[first + 2]);
            self.increments.push(step);
            state.rotation[k] = self.start.rotation[k] * UnitQuaternion::from_scaled_axis(step);
            state.q[first..first + 3].fill(0.0);
        }
    }

    /// Applies a Newton correction to the end of the step.
    fn apply(
        &mut self,
        workspace: &Workspace,
        damping: f64,
        (mass_rate, velocity_rate): (f64, f64),
        system: &dyn System,
        state: &mut State,
    ) {
        let n = state.q.len();
        let Scheme { alpha_m, alpha_f, .. } = self.scheme;
        for range in workspace.changed() {
            Arch::new().dispatch(Apply {
                correction: &workspace.correction[range.clone()],
                damping,
                rates: [velocity_rate, mass_rate, (1.0 - alpha_f) / (1.0 - alpha_m) * mass_rate],
                q: &mut state.q[range.clone()],
                v: &mut state.v[range.clone()],
                v_dot: &mut state.v_dot[range.clone()],
                a: &mut state.a[range],
            });
        }
        for (lambda, change) in state.lambda.iter_mut().zip(&workspace.correction[n..]) {
            *lambda += damping * change;
        }
        for (k, &first) in system.layout().rotations().iter().enumerate() {
            self.increments[k] += Vector3::new(state.q[first], state.q[first + 1], state.q[first + 2]);
            state.q[first..first + 3].fill(0.0);
            state.rotation[k] = self.start.rotation[k] * UnitQuaternion::from_scaled_axis(self.increments[k]);
        }
    }

    /// Solves `M v̇ = Q − g_qᵀ λ` together with `g̈ = 0` approximately for the start of a motion: for a state in static
    /// equilibrium the accelerations are zero, so only states that start with velocities or loads need this.
    ///
    /// The second derivative of the constraints at `v` is taken from a difference of `g_q v` over 1e-6 s.
    ///
    /// # Errors
    /// [`StepError::Singular`] where mass matrix and constraints do not determine the accelerations.
    pub fn start_accelerations(
        &mut self,
        system: &mut dyn System,
        state: &mut State,
        u: &[f64],
    ) -> Result<(), StepError> {
        crate::integrate::start::accelerations(system, state, u)?;
        state.a.clone_from(&state.v_dot);
        self.begin_anew();
        Ok(())
    }

    /// Call after a change of the state that no step has made.
    pub(crate) fn begin_anew(&mut self) {
        self.memory.moving.clear();
    }

    /// Takes a jump of the inputs at the present state, from `before` to `u`, into accelerations and multipliers before
    /// a step of `h` s.
    ///
    /// A step without this jump would weigh the old inputs with the new ones, so that inputs held over steps would act
    /// half a step late. The jump of the forces is solved with the iteration matrix `β' M + γ' D + K` in place of `β'
    /// M`: the difference is of the order of `h`, and so is the jump if the inputs are samples of a smooth function.
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub fn jump(
        &mut self,
        system: &mut dyn System,
        state: &mut State,
        before: &[f64],
        u: &[f64],
        h: f64,
    ) -> Result<(), StepError> {
        if before == u {
            return Ok(());
        }
        let mut workspace = self.take_workspace(system, &state.motion(u));
        let (mass_rate, velocity_rate) = self.scheme.rates(h);
        let weights = Weights {
            q: 1.0,
            v: velocity_rate,
        };
        let result = self
            .ensure_factor(&mut workspace, system, state, u, h)
            .and_then(|()| workspace.jump(system, &state.motion(before), &state.motion(u), weights));
        if result.is_ok() {
            let (change, of_multipliers) = workspace.correction.split_at(state.q.len());
            for ((v_dot, a), change) in state.v_dot.iter_mut().zip(&mut state.a).zip(change) {
                *v_dot += mass_rate * change;
                *a += mass_rate * change;
            }
            for (lambda, change) in state.lambda.iter_mut().zip(of_multipliers) {
                *lambda += change;
            }
            self.memory.moving.jump(workspace.moving(), of_multipliers);
        }
        self.keep(workspace);
        result
    }
}

/// Returns `true` if all forces come from the same branch of their law as at their last evaluation.
fn continues_to(system: &mut dyn System, motion: &Motion<'_>) -> bool {
    let mut continues = true;
    visit_histories(system, &mut |kept| continues = continues && kept.continues_to(motion));
    continues
}
