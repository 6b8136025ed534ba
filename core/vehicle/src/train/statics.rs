//! The vehicle at rest under what stands on it.
use super::Train;
use crate::VehicleError;
use crate::multibody::{BodyMarker, DeadForce};
use crate::pantograph::Equilibrium;
use dynamics::{Constraint, Force, Frame, Layout, NewtonOptions, State, StaticOptions, System, solve_static};
use nalgebra::{Matrix3, Vector3};

/// `μ` of [`StaticOptions::mass_shift`], 1/s²: holds what has no stiffness; eigenfrequencies of vehicles are above 1 rad/s.
const MASS_SHIFT: f64 = 1e-2;

/// Accepted residual, N or N·m: 1e-10 of a wheel load.
const TOLERANCE: f64 = 1e-5;

/// A vertical force on the body that carries the pantograph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    /// Where it acts, m, in the frame of the base.
    pub point: Vector3<f64>,
    /// N, upward.
    pub force: f64,
}

/// A vehicle at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainRest {
    /// Its coordinates; height and force are those of the base of the pantograph.
    pub(crate) equilibrium: Equilibrium,
    /// The base of the pantograph, in the frame of the base.
    pub base: Frame,
}

/// A vehicle alone.
struct Alone<'a> {
    train: &'a mut Train,
    layout: &'a Layout,
    loads: Vec<DeadForce>,
}

impl System for Alone<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.train.forces(visit);
        for load in &mut self.loads {
            visit(load);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.train.constraints(visit);
    }
}

impl Train {
    /// The state of rest of this vehicle, alone in `layout`, under `loads`; Newton's method begins at `state`.
    ///
    /// # Errors
    /// [`VehicleError::Unsettled`].
    pub(crate) fn rest(
        &mut self,
        layout: &Layout,
        state: &mut State,
        loads: &[Load],
    ) -> Result<TrainRest, VehicleError> {
        let pose = self.carrier.pose;
        let loads = loads
            .iter()
            .map(|load| {
                let motion = state.motion(&[]);
                let offset = pose.axes(&motion).transpose() * (load.point - pose.position(&motion));
                DeadForce {
                    marker: BodyMarker {
                        pose,
                        offset,
                        axes: Matrix3::identity(),
                    },
                    force: Vector3::new(0.0, 0.0, load.force),
                }
            })
            .collect();
        let options = StaticOptions {
            newton: NewtonOptions {
                tolerance: TOLERANCE,
                max_iterations: 200,
                ..NewtonOptions::default()
            },
            mass_shift: MASS_SHIFT,
            ..StaticOptions::default()
        };
        let mut alone = Alone {
            train: self,
            layout,
            loads,
        };
        solve_static(&mut alone, state, &[], &options).map_err(VehicleError::Unsettled)?;
        let base = self.base_frame(&state.motion(&[]));
        Ok(TrainRest {
            equilibrium: Equilibrium {
                height: base.position.z,
                force: 0.0,
                q: state.q.clone(),
                rotation: state.rotation.clone(),
                lambda: state.lambda.clone(),
                train: None,
            },
            base,
        })
    }
}
