//! Memory of the integrator from step to step, saved and restored.
use crate::capability::visit_histories;
use crate::integrate::convergence_estimate::ConvergenceEstimate;
use crate::integrate::moving_multipliers::MovingMultipliers;
use crate::{Continuity, GeneralizedAlpha, State, StepError, StepHistory, System};
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// State at which a kept factorisation was made: with it a restored run repeats bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Linearisation {
    pub(super) h: f64,
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) rotation: Vec<UnitQuaternion<f64>>,
    pub(super) u: Vec<f64>,
    pub(super) history: Vec<f64>,
}

/// Memory of a [`GeneralizedAlpha`] beside the [`State`]; cheap to clone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Memory {
    pub(super) linearisation: Option<Arc<Linearisation>>,
    pub(super) history: Vec<f64>,
    pub(super) last_h: Option<f64>,
    pub(super) moving: MovingMultipliers,
    pub(super) convergence_estimate: ConvergenceEstimate,
}

impl Memory {
    /// Refuses a memory of another system than that of a state and its inputs.
    ///
    /// # Errors
    /// [`StepError::OtherSystem`].
    pub(crate) fn belongs_beside(&self, own: &State, u: &[f64]) -> Result<(), StepError> {
        let Some(saved) = &self.linearisation else {
            return Ok(());
        };
        StepError::unless_as_many("coordinates", saved.q.len(), own.q.len())?;
        StepError::unless_as_many("coordinates", saved.v.len(), own.v.len())?;
        StepError::unless_as_many("orientations", saved.rotation.len(), own.rotation.len())?;
        StepError::unless_as_many("inputs", saved.u.len(), u.len())
    }
}

impl GeneralizedAlpha {
    /// Adapts to a system that has changed since the last step; see [`Continuity`].
    pub(crate) fn continue_with(&mut self, continuity: Continuity) {
        match continuity {
            Continuity::Kept => {}
            Continuity::Moved => {
                if let Some(workspace) = &mut self.workspace {
                    workspace.forget();
                }
            }
            Continuity::Replaced => {
                self.workspace = None;
                self.memory.linearisation = None;
            }
        }
    }

    /// Stores all that a restored run needs beside the [`State`] to repeat bit for bit.
    pub(crate) fn save(&self, system: &mut dyn System, memory: &mut Memory) {
        memory.linearisation.clone_from(&self.memory.linearisation);
        memory.last_h = self.memory.last_h;
        memory.moving.copy_from(&self.memory.moving);
        memory
            .convergence_estimate
            .clone_from(&self.memory.convergence_estimate);
        memory.history.clear();
        visit_histories(system, &mut |kept| kept.save(&mut memory.history));
    }

    /// Takes back what [`GeneralizedAlpha::save`] stored.
    ///
    /// # Errors
    /// When the matrix of the saved state cannot be factored again.
    pub(crate) fn restore(
        &mut self,
        system: &mut dyn System,
        state: &State,
        u: &[f64],
        memory: &Memory,
    ) -> Result<(), StepError> {
        let same = match (&self.memory.linearisation, &memory.linearisation) {
            (Some(mine), Some(saved)) => Arc::ptr_eq(mine, saved),
            (None, None) => true,
            _ => false,
        };
        self.memory.linearisation.clone_from(&memory.linearisation);
        self.memory.last_h = memory.last_h;
        self.memory.moving.copy_from(&memory.moving);
        self.memory
            .convergence_estimate
            .clone_from(&memory.convergence_estimate);
        if let Some(mut workspace) = self.workspace.take() {
            workspace.forget();
            self.workspace = Some(workspace);
        }
        if !same && let Some(linearisation) = memory.linearisation.clone() {
            restore_history(system, &linearisation.history);
            let mut workspace = self.take_workspace(system, &state.motion(u));
            let result = self.factor(&mut workspace, system, &linearisation);
            self.keep(workspace);
            result?;
        }
        restore_history(system, &memory.history);
        Ok(())
    }
}

pub(super) fn restore_history(system: &mut dyn System, history: &[f64]) {
    take_back(system, history, &mut |kept, values| kept.restore(values));
}

/// Takes back a step that failed.
pub(super) fn restore_after_step(system: &mut dyn System, history: &[f64]) {
    take_back(system, history, &mut |kept, values| kept.restore_after_step(values));
}

fn take_back(
    system: &mut dyn System,
    history: &[f64],
    restore: &mut dyn FnMut(&mut dyn StepHistory, &mut std::slice::Iter<'_, f64>),
) {
    let mut values = history.iter();
    visit_histories(system, &mut |kept| restore(kept, &mut values));
    debug_assert!(values.next().is_none(), "a contribution saved more than it restored");
}
