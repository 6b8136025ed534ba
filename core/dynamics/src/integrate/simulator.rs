//! A system in time: sub-steps inside a communication step, with its state saved and restored as a whole.
use crate::capability::visit_histories;
use crate::integrate::fastest::fastest;
use crate::integrate::memory::Memory;
use crate::integrate::newton::MOST_MICRO_STEPS;
use crate::linear::iteration_matrix::mass_matrix;
use crate::{
    Continuity, Counters, EnergyBalance, GeneralizedAlpha, NewtonOptions, SparseMatrix, State, StaticOptions,
    StaticReport, StaticSolver, StepError, System,
};
use serde::{Deserialize, Serialize};

/// Largest turn of the fastest oscillation in a step by which periods are kept, rad: the half of √6, as springs of a
/// motion may be stiffer than those of its start.
const MOST_TURNED: f64 = 1.2;

/// State and memory of a [`Simulator`], from which it continues bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    state: State,
    memory: Memory,
    u: Vec<f64>,
}

/// Sees the system, its motion, its multipliers and the length (s) of an internal step at its end.
type AfterStep<'a, S> = dyn FnMut(&mut S, crate::Motion<'_>, &[f64], f64) + 'a;

/// A system, its state and its integrator.
pub struct Simulator<S> {
    /// The model.
    pub system: S,
    state: State,
    integrator: GeneralizedAlpha,
    micro_step: f64,
    u: Vec<f64>,
    /// Room for inputs before a jump.
    before: Vec<f64>,
    mass: Option<SparseMatrix>,
    /// Solver of starts, until the first step: starts are searched for by turns with pantographs.
    statics: Option<StaticSolver>,
    /// Times that an internal step which fails is parted into halves before it is given up.
    halvings: u32,
    halved: Halved,
}

/// Internal steps that failed and were done in halves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Halved {
    /// Number of such steps and parts.
    pub count: u64,
    /// Words of the first failure.
    pub first: Option<String>,
}

impl<S: System> Simulator<S> {
    /// A simulator at `state`, with inputs `u` there; no internal step is longer than `micro_step` s.
    pub fn new(system: S, state: State, u: Vec<f64>, micro_step: f64, rho_inf: f64, options: NewtonOptions) -> Self {
        Self {
            system,
            state,
            integrator: GeneralizedAlpha::new(rho_inf, options),
            micro_step,
            before: Vec::new(),
            u,
            mass: None,
            statics: None,
            halvings: 0,
            halved: Halved::default(),
        }
    }

    /// Keeps periods of oscillations to the fourth order of the step where that is stable; to be called before the
    /// first step. Points with next to no mass begin each step without rates; other systems may hold each mass by up to
    /// `outside` N/m.
    pub fn keep_periods(&mut self, outside: f64) {
        let motion = self.state.motion(&self.u);
        let fastest = fastest(&mut self.system, &motion, outside);
        if fastest.is_some_and(|omega| omega * self.micro_step < MOST_TURNED) {
            self.integrator.keep_periods();
        }
    }

    /// Parts an internal step that fails into halves, and these again, `halvings` times at most, before it is given up;
    /// 0 leaves that to the caller.
    pub fn halve(&mut self, halvings: u32) {
        self.halvings = halvings;
    }

    /// Internal steps so far that failed and were done in halves.
    #[must_use]
    pub fn halved(&self) -> &Halved {
        &self.halved
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The inputs at the present state.
    #[must_use]
    pub fn inputs(&self) -> &[f64] {
        &self.u
    }

    /// Puts other inputs in place of the present ones, for outputs that depend on them directly.
    pub fn set_inputs(&mut self, u: &[f64]) {
        self.u.copy_from_slice(u);
    }

    /// The model and its present motion.
    pub fn parts(&mut self) -> (&mut S, crate::Motion<'_>) {
        (&mut self.system, self.state.motion(&self.u))
    }

    /// The model, its present motion and the multipliers.
    pub fn parts_with_multipliers(&mut self) -> (&mut S, crate::Motion<'_>, &[f64]) {
        (&mut self.system, self.state.motion(&self.u), &self.state.lambda)
    }

    /// The model, its present motion and the whole state.
    pub fn parts_with_state(&mut self) -> (&mut S, crate::Motion<'_>, &crate::State) {
        (&mut self.system, self.state.motion(&self.u), &self.state)
    }

    /// Goes to the static equilibrium with the present inputs.
    ///
    /// # Errors
    /// See [`crate::solve_static`].
    pub fn settle(&mut self, options: &StaticOptions) -> Result<StaticReport, StepError> {
        self.integrator.begin_anew();
        let motion = self.state.motion(&self.u);
        let solver = (self.statics).get_or_insert_with(|| StaticSolver::new(&mut self.system, &motion));
        solver.solve(&mut self.system, &mut self.state, &self.u, options)
    }

    /// Kinetic energy `½ vᵀ M v`, J.
    pub fn kinetic_energy(&mut self) -> f64 {
        let mass = self.mass.get_or_insert_with(|| mass_matrix(&mut self.system));
        0.5 * mass.quadratic_form(&self.state.v)
    }

    /// Replaces the present state, for starts that are found elsewhere.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
        self.integrator.begin_anew();
    }

    /// Consistent accelerations for a start that is not an equilibrium.
    ///
    /// # Errors
    /// See [`GeneralizedAlpha::start_accelerations`].
    pub fn start_accelerations(&mut self) -> Result<(), StepError> {
        self.integrator
            .start_accelerations(&mut self.system, &mut self.state, &self.u)
    }

    /// Starts a motion at the present state with known accelerations: contributions prepare the first step.
    pub fn begin(&mut self) {
        let motion = self.state.motion(&self.u);
        visit_histories(&mut self.system, &mut |kept| kept.end_step(&motion));
    }

    /// Factors for internal steps of full length ahead of the first one, where steps have fixed
    /// [`NewtonOptions::passes`].
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub fn prepare(&mut self) -> Result<(), StepError> {
        self.integrator
            .prepare(&mut self.system, &self.state, &self.u, self.micro_step)
    }

    /// Takes a jump of the inputs from `before` to the present ones into the accelerations, at the start of a
    /// communication step of `h` s.
    ///
    /// # Errors
    /// See [`GeneralizedAlpha::jump`].
    pub fn jump(&mut self, before: &[f64], h: f64) -> Result<(), StepError> {
        let dt = h / self.micro_steps(h) as f64;
        self.integrator
            .jump(&mut self.system, &mut self.state, before, &self.u, dt)
    }

    /// Lets `change` make the inputs jump at the start of a step of `h` s, as [`Simulator::jump`] does.
    ///
    /// # Errors
    /// See [`GeneralizedAlpha::jump`].
    pub fn jump_by(&mut self, change: &mut dyn FnMut(&mut [f64]), h: f64) -> Result<(), StepError> {
        let mut before = std::mem::take(&mut self.before);
        before.clone_from(&self.u);
        change(&mut self.u);
        let result = self.jump(&before, h);
        self.before = before;
        result
    }

    /// Number of equal internal steps within a communication step of `h` s: a rest of rounding makes no extra step.
    #[must_use]
    pub fn micro_steps(&self, h: f64) -> usize {
        ((h / self.micro_step - 1e-9).ceil() as usize).max(1)
    }

    /// Advances from `t` to `t + h`; `inputs_at(τ, u)` writes the inputs at `t + τ`, `after(system, motion, lambda,
    /// dt)` sees each internal step of `dt` s at its end, the multipliers included.
    ///
    /// # Errors
    /// See [`StepError`]; the caller restores the state it saved before.
    pub fn advance(
        &mut self,
        t: f64,
        h: f64,
        inputs_at: &mut dyn FnMut(f64, &mut [f64]),
        after: &mut AfterStep<'_, S>,
    ) -> Result<(), StepError> {
        let count = self.micro_steps(h);
        if count > MOST_MICRO_STEPS {
            let micro_step = self.micro_step;
            return Err(StepError::TooLong { t, h, micro_step });
        }
        let dt = h / count as f64;
        self.statics = None;
        for step in 1..=count {
            let tau = if step == count { h } else { step as f64 * dt };
            self.step((t, tau, dt), self.halvings, inputs_at, after)?;
        }
        Ok(())
    }

    /// An internal step of `dt` s to `t + tau`, in halves where that is allowed and needed.
    fn step(
        &mut self,
        (t, tau, dt): (f64, f64, f64),
        halvings: u32,
        inputs_at: &mut dyn FnMut(f64, &mut [f64]),
        after: &mut AfterStep<'_, S>,
    ) -> Result<(), StepError> {
        inputs_at(tau, &mut self.u);
        let done = self
            .integrator
            .step(&mut self.system, &mut self.state, &self.u, t + tau, dt);
        match done {
            Err(error) if halvings > 0 && error.is_retryable() => {
                self.halved.count += 1;
                self.halved.first.get_or_insert_with(|| error.to_string());
                let half = 0.5 * dt;
                self.step((t, tau - half, half), halvings - 1, inputs_at, after)?;
                return self.step((t, tau, half), halvings - 1, inputs_at, after);
            }
            done => done?,
        }
        after(&mut self.system, self.state.motion(&self.u), &self.state.lambda, dt);
        let continuity = self.system.follow(&mut self.state, &self.u);
        self.continue_with(continuity);
        Ok(())
    }

    fn continue_with(&mut self, continuity: Continuity) {
        self.integrator.continue_with(continuity);
        if continuity == Continuity::Replaced {
            self.mass = None;
        }
    }

    /// Begins to follow the energy from the present state on.
    pub fn energy_balance(&mut self) -> EnergyBalance {
        EnergyBalance::start(&mut self.system, &self.state, &self.u)
    }

    /// Adds the internal step of `dt` s that has just been made to an energy balance.
    pub fn balance(&mut self, balance: &mut EnergyBalance, dt: f64) {
        balance.step(&mut self.system, &self.state, &self.u, dt);
    }

    /// Work done so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.integrator.counters()
    }

    /// Stores everything into `checkpoint`, reusing its memory.
    pub fn save(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.state.copy_from(&self.state);
        checkpoint.u.clone_from(&self.u);
        self.integrator.save(&mut self.system, &mut checkpoint.memory);
    }

    /// Goes back to a checkpoint.
    ///
    /// # Errors
    /// A state of another system, and one whose matrix cannot be factored again.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), StepError> {
        checkpoint.state.belongs_beside(&self.state)?;
        StepError::unless_as_many("inputs", checkpoint.u.len(), self.u.len())?;
        checkpoint.memory.belongs_beside(&self.state, &self.u)?;
        self.state.copy_from(&checkpoint.state);
        self.u.clone_from(&checkpoint.u);
        let continuity = self.system.adopt(&self.state);
        self.continue_with(continuity);
        self.integrator
            .restore(&mut self.system, &self.state, &self.u, &checkpoint.memory)
    }
}
