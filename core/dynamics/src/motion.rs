//! The state of a system and what a contribution sees of it.
use crate::StepError;
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

/// Everything a contribution may depend on, at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Time, s.
    pub t: f64,
    /// Generalised coordinates, one per generalised velocity (m, –, …). The three entries of a rotation are unused
    /// (zero); the orientation itself stands in [`Motion::rotation`].
    pub q: &'a [f64],
    /// Generalised velocities: the rates of `q`; for a rotation the angular velocity in the body frame, rad/s.
    pub v: &'a [f64],
    /// Orientation of each rigid body with rotation, body to world.
    pub rotation: &'a [UnitQuaternion<f64>],
    /// Inputs of the system at time `t` (prescribed strip motion, applied forces); their meaning is the model's.
    pub u: &'a [f64],
}

/// The complete state of a system between two time steps.
///
/// `a` is the auxiliary acceleration of generalized-α [Arnold & Brüls 2007, Eq. (5)].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time, s.
    pub t: f64,
    /// Generalised coordinates, see [`Motion::q`].
    pub q: Vec<f64>,
    /// Generalised velocities, see [`Motion::v`].
    pub v: Vec<f64>,
    /// Accelerations `v̇`, m/s², rad/s².
    pub v_dot: Vec<f64>,
    /// Auxiliary accelerations of the integrator, as `v_dot`.
    pub a: Vec<f64>,
    /// Multipliers of the constraints, N or N·m. After a step, those of constraints that [`crate::Constraint::moves`]
    /// are the straight line through the mean forces of the last two steps, at the end of the last one.
    pub lambda: Vec<f64>,
    /// Orientations, body to world.
    pub rotation: Vec<UnitQuaternion<f64>>,
}

impl State {
    /// A state at rest with all coordinates zero.
    #[must_use]
    pub fn at_rest(coordinates: usize, constraints: usize, rotation: Vec<UnitQuaternion<f64>>) -> Self {
        let zeros = vec![0.0; coordinates];
        Self {
            t: 0.0,
            q: zeros.clone(),
            v: zeros.clone(),
            v_dot: zeros.clone(),
            a: zeros,
            lambda: vec![0.0; constraints],
            rotation,
        }
    }

    /// Takes over `other` without allocating where the sizes agree.
    pub fn copy_from(&mut self, other: &Self) {
        self.t = other.t;
        self.q.clone_from(&other.q);
        self.v.clone_from(&other.v);
        self.v_dot.clone_from(&other.v_dot);
        self.a.clone_from(&other.a);
        self.lambda.clone_from(&other.lambda);
        self.rotation.clone_from(&other.rotation);
    }

    /// Refuses a state with another number of anything than one of the same system.
    ///
    /// # Errors
    /// [`StepError::OtherSystem`].
    pub(crate) fn belongs_beside(&self, own: &Self) -> Result<(), StepError> {
        for (found, expected) in [
            (&self.q, &own.q),
            (&self.v, &own.v),
            (&self.v_dot, &own.v_dot),
            (&self.a, &own.a),
        ] {
            StepError::unless_as_many("coordinates", found.len(), expected.len())?;
        }
        StepError::unless_as_many("multipliers", self.lambda.len(), own.lambda.len())?;
        StepError::unless_as_many("orientations", self.rotation.len(), own.rotation.len())
    }

    /// The view of this state that contributions take, with the inputs `u`.
    #[must_use]
    pub fn motion<'a>(&'a self, u: &'a [f64]) -> Motion<'a> {
        Motion {
            t: self.t,
            q: &self.q,
            v: &self.v,
            rotation: &self.rotation,
            u,
        }
    }
}
