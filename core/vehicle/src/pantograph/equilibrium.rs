//! A pantograph at rest under a contact force.
use crate::rail_vehicle::VehicleRest;
use dynamics::State;
use nalgebra::UnitQuaternion;

/// First indices of a pantograph's coordinates in a shared layout.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Offsets {
    pub coordinate: usize,
    pub constraint: usize,
    pub orientation: usize,
}

/// A pantograph at rest in the frame of its base.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Height of the middle of the strip above the top of rail, m.
    pub height: f64,
    /// Contact force, N, positive in compression (presses the strip down).
    pub force: f64,
    /// The pantograph's own coordinates, in the order of the layout.
    pub q: Vec<f64>,
    /// Orientations of the pantograph's bodies, body to world.
    pub rotation: Vec<UnitQuaternion<f64>>,
    /// Multipliers of the pantograph's joints, N or N·m.
    pub lambda: Vec<f64>,
    /// Rest of the vehicle under the pantograph, if modelled.
    pub vehicle: Option<Box<VehicleRest>>,
}

impl Equilibrium {
    /// Writes the pantograph's part of a state at rest.
    pub(crate) fn write(&self, offsets: Offsets, state: &mut State) {
        let range = offsets.coordinate..offsets.coordinate + self.q.len();
        state.q[range.clone()].copy_from_slice(&self.q);
        for rates in [&mut state.v, &mut state.v_dot, &mut state.a] {
            rates[range.clone()].fill(0.0);
        }
        state.rotation[offsets.orientation..][..self.rotation.len()].copy_from_slice(&self.rotation);
        state.lambda[offsets.constraint..][..self.lambda.len()].copy_from_slice(&self.lambda);
    }
}
