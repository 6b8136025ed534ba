//! The vehicle at rest in the travelling frame, under the loads of the pantograph.
use super::{Vehicle, VehicleWheel};
use crate::VehicleError;
use crate::multibody::{BodyMarker, DeadForce};
use crate::pantograph::Equilibrium;
use dynamics::{Constraint, Force, Frame, Layout, NewtonOptions, State, StaticOptions, System, solve_static};
use nalgebra::{Matrix3, Vector3};

/// `μ` of [`StaticOptions::mass_shift`], 1/s²: holds motions without stiffness; eigenfrequencies of vehicles are above
/// 1 rad/s.
const MASS_SHIFT: f64 = 1e-2;

/// Accepted residual, N or N·m: 1e-10 of a wheel load.
const TOLERANCE: f64 = 1e-5;

/// Vertical force on the body under the pantograph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    /// Point of action, m, in the frame of the base.
    pub point: Vector3<f64>,
    /// Force, upward, N.
    pub force: f64,
}

/// A vehicle at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleRest {
    /// Coordinates of the vehicle; height and force are those of the base of the pantograph.
    pub(crate) equilibrium: Equilibrium,
    /// Frame of the pantograph's base, in the frame of the base.
    pub base: Frame,
    /// χ̇ of the freely rolling wheelsets, rad/s.
    pub(crate) spins: Vec<f64>,
    /// True if rolling wheels roll steadily; if not, the vehicle is at rest without creep forces.
    pub steady: bool,
}

/// A vehicle alone.
struct Alone<'a> {
    vehicle: &'a mut Vehicle,
    layout: &'a Layout,
    loads: Vec<DeadForce>,
}

impl System for Alone<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.vehicle.forces(visit);
        for load in &mut self.loads {
            visit(load);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.vehicle.constraints(visit);
    }
}

impl Vehicle {
    /// State of rest of this vehicle, alone in `layout`, under `loads`; Newton's method begins at `state`.
    ///
    /// # Errors
    /// [`VehicleError::Unsettled`].
    pub(crate) fn rest(
        &mut self,
        layout: &Layout,
        state: &mut State,
        loads: &[Load],
    ) -> Result<VehicleRest, VehicleError> {
        let pose = self.pantograph_base.pose;
        let loads: Vec<DeadForce> = loads
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
                ..StaticOptions::default().newton
            },
            mass_shift: MASS_SHIFT,
            ..StaticOptions::default()
        };
        let start = state.clone();
        self.set_creeping(false);
        let settled = self.settle(layout, state, &loads, &options).or_else(|error| {
            *state = start;
            self.settle_by_and_by(layout, state, &loads, &options)
                .map_err(|_| error)
        });
        self.set_creeping(true);
        settled?;
        let (spins, steady) = self.steady_rolling(layout, state, &loads, &options);
        let base = self.base_frame(&state.motion(&[]));
        Ok(VehicleRest {
            equilibrium: Equilibrium {
                height: base.position.z,
                force: 0.0,
                strip_forces: Vec::new(),
                strip_heights: Vec::new(),
                q: state.q.clone(),
                rotation: state.rotation.clone(),
                lambda: state.lambda.clone(),
                vehicle: None,
            },
            base,
            spins,
            steady,
        })
    }

    /// Newton's method, from `state` on.
    fn settle(
        &mut self,
        layout: &Layout,
        state: &mut State,
        loads: &[DeadForce],
        options: &StaticOptions,
    ) -> Result<(), VehicleError> {
        let mut alone = Alone {
            vehicle: self,
            layout,
            loads: loads.to_vec(),
        };
        let settled = solve_static(&mut alone, state, &[], options);
        settled.map(|_| ()).map_err(VehicleError::Unsettled)
    }

    /// Continuation from smooth rails with growing steps of irregularity: wheels in the air have no stiffness, so that
    /// Newton's method may fail on the full irregularities.
    fn settle_by_and_by(
        &mut self,
        layout: &Layout,
        state: &mut State,
        loads: &[DeadForce],
        options: &StaticOptions,
    ) -> Result<(), VehicleError> {
        const SHORTEST: f64 = 1.0 / 256.0;
        let (mut part, mut reached, mut step) = (0.0_f64, 0.0, 1.0);
        let result = loop {
            let before = state.clone();
            self.set_irregularity(part);
            match self.settle(layout, state, loads, options) {
                Ok(()) if part >= 1.0 => break Ok(()),
                Ok(()) => {
                    reached = part;
                    step *= 2.0;
                }
                Err(error) if part == 0.0 || step <= SHORTEST => break Err(error),
                Err(_) => {
                    *state = before;
                    step *= 0.25;
                }
            }
            part = (reached + step).min(1.0);
        };
        self.set_irregularity(1.0);
        result
    }

    /// Scales the irregularities by `part`, without creep forces.
    fn set_irregularity(&mut self, part: f64) {
        for wheel in &mut self.wheels {
            if let VehicleWheel::Rolling(wheel) = wheel {
                wheel.set_irregularity(part);
            }
        }
    }

    /// Steps from rest without creep forces to rest under the creep forces of steady rolling: a wheel that rolls on a
    /// slope turns about the normal of the contact, which pushes the wheel sideways, and the rail bears the wheel at
    /// another height. Without such a state, `state` stays unchanged. Returns χ̇ of the wheelsets, rad/s, and true for
    /// steady rolling.
    ///
    /// Positions at given spins and spins at given positions are found in turn. A change of a position by `δ` changes
    /// the rolling radius by less than δ and the spin by `Ω δ/r`, which moves nothing that bears weight: two rounds are
    /// enough in most cases.
    fn steady_rolling(
        &mut self,
        layout: &Layout,
        state: &mut State,
        loads: &[DeadForce],
        options: &StaticOptions,
    ) -> (Vec<f64>, bool) {
        /// Accepted relative change of a spin: a creepage of 1e-10, which pushes a wheel of 53 kN by 1 mN.
        const CREEPAGE: f64 = 1e-10;
        const ROUNDS: usize = 20;
        if self.spins.is_empty() {
            return (Vec::new(), true);
        }
        let mut layout = layout.clone();
        for spin in &self.spins {
            layout.fix(spin.coordinate);
        }
        let still = state.clone();
        let mut spins = self.free_rolling(state);
        let without_creep = spins.clone();
        for _ in 0..ROUNDS {
            self.set_rolling(&spins);
            let settled = self.settle(&layout, state, loads, options);
            self.set_rolling(&[]);
            if settled.is_err() {
                // A wheelset that starts on bent rails rolls on, but not steadily.
                break;
            }
            let next = self.free_rolling(state);
            let change = (self.spins.iter().zip(spins.iter().zip(&next)))
                .map(|(spin, (old, new))| ((new - old) / spin.rolling).abs())
                .fold(0.0, f64::max);
            spins = next;
            if change <= CREEPAGE {
                return (spins, true);
            }
        }
        *state = still;
        (without_creep, false)
    }

    /// Lets the wheels of each wheelset turn by χ̇ (rad/s) for statics, in which no coordinate has a velocity; an empty
    /// list is no spin.
    fn set_rolling(&mut self, rates: &[f64]) {
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            if let VehicleWheel::Rolling(wheel) = wheel {
                wheel.set_rolling(rates.get(i / 2).copied().unwrap_or(0.0));
            }
        }
    }

    fn set_creeping(&mut self, creeping: bool) {
        for wheel in &mut self.wheels {
            if let VehicleWheel::Rolling(wheel) = wheel {
                wheel.set_creeping(creeping);
            }
        }
    }

    /// χ̇ of each wheelset (rad/s) without a moment about the axle, the vehicle being otherwise at rest.
    ///
    /// Wheels do not roll on their nominal radius exactly: contacts are pressed in, and lie beside the nominal circle.
    fn free_rolling(&mut self, state: &State) -> Vec<f64> {
        /// Accepted moment, N·m: a creepage of 1e-9.
        const MOMENT: f64 = 1e-3;
        let mut state = state.clone();
        let spins = self.spins.clone();
        let mut force = vec![0.0; state.q.len()];
        let mut moment = |state: &State, coordinate: usize| {
            force.fill(0.0);
            for wheel in &mut self.wheels {
                wheel.contribution().add_force(&state.motion(&[]), &mut force);
            }
            force[coordinate]
        };
        spins
            .iter()
            .map(|spin| {
                let at = spin.coordinate;
                let (mut before, mut rate) = (0.0, 1e-5 * spin.rolling);
                let mut old = moment(&state, at);
                for _ in 0..30 {
                    state.v[at] = rate;
                    let new = moment(&state, at);
                    if new.abs() <= MOMENT || new == old {
                        break;
                    }
                    let next = rate - new * (rate - before) / (new - old);
                    (before, old, rate) = (rate, new, next);
                }
                rate
            })
            .collect()
    }
}
