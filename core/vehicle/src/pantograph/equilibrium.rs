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
    /// Height of the middle of the strip above the top of rail, m; of several strips, the mean of their heights.
    pub height: f64,
    /// Contact force, N, positive in compression (presses the strip down); of several strips, the sum.
    pub force: f64,
    /// Contact force of each strip, N. Where the head leaves their division open, one that it can bear.
    pub strip_forces: Vec<f64>,
    /// Heights of the strips, m, where they follow from the mechanism; empty where they are those asked for.
    pub strip_heights: Vec<f64>,
    /// The pantograph's own coordinates, in the order of the layout.
    pub q: Vec<f64>,
    /// Orientations of the pantograph's bodies, body to world.
    pub rotation: Vec<UnitQuaternion<f64>>,
    /// Multipliers of the pantograph's joints, N or N·m.
    pub lambda: Vec<f64>,
    /// Rest of the vehicle under the pantograph, if modelled.
    pub(crate) vehicle: Option<Box<VehicleRest>>,
}

/// Target of an equilibrium.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// Contact force, N.
    Force(f64),
    /// Height of the strip, m.
    Height(f64),
}

impl std::fmt::Display for Target {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Force(force) => write!(formatter, "contact force {force} N"),
            Self::Height(height) => write!(formatter, "strip height {height} m"),
        }
    }
}

impl Equilibrium {
    /// False if the wheels of a vehicle under the pantograph cannot roll steadily: the vehicle is then at rest without
    /// creep forces.
    #[must_use]
    pub fn rolls_steadily(&self) -> bool {
        self.vehicle.as_ref().is_none_or(|vehicle| vehicle.steady)
    }

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
