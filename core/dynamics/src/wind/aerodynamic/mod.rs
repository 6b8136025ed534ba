//! Forces of the air on bodies, by the velocity of the air relative to them.
//!
//! ```text
//! v_r = W(t, x) − v
//! F_D = ½ ρ (C_D A) |v_r|² v̂_r,    F_L = ½ ρ (C_L A) |v_r|² v̂_L                              [Thesis, Eq. (18)]
//! ```
//!
//! `v̂_r` is the direction of the air relative to the body. The thesis draws `v̂_L` in its Fig. 5 only; here it is the
//! part of the marker's third axis that is perpendicular to `v̂_r`, of unit length: a positive lift acts on the side
//! that the axis points to, whether the air comes from ahead or from behind. Air exactly along that axis has no such
//! direction, and no lift. The angle of attack is that between the air and the plane of the marker's first two axes,
//!
//! ```text
//! α = atan2(w₃, −w₁),   w = Aᵀ v_r          0: from ahead, along −axis 1;  positive: from below, along +axis 3
//! ```
//!
//! | file | subject |
//! | --- | --- |
//! | `polar` | drag and lift coefficients by angle of attack |
//! | `cross_flow` | drag of a slender cylinder across its axis |
//! | `section` | drag and lift of a slender body that is not round; galloping |
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois
//!   at Chicago, 2016.
mod cross_flow;
mod polar;
mod section;
#[cfg(test)]
mod tests;

pub use cross_flow::CrossFlow;
pub use polar::Polar;
pub use section::{SectionFlow, SlenderFlow, galloping_speed};

use crate::rotation::skew;
use crate::{Blocks, Column, Columns, Force, Marker, Motion, Power, Weights, Wind};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// The air that a body moves through.
#[derive(Clone, Debug)]
pub struct Flow {
    /// Velocity of the air over the ground.
    pub wind: Arc<Wind>,
    /// `ρ`, kg/m³.
    pub density: f64,
    /// First of three inputs of the system that are added to the wind (world axes, m/s), if it has them.
    pub input: Option<usize>,
}

impl Flow {
    /// Velocity of the air at `x` (m), m/s.
    #[must_use]
    pub fn velocity(&self, motion: &Motion<'_>, x: f64) -> Vector3<f64> {
        let wind = self.wind.velocity(motion.t, x);
        let added = self.input.and_then(|first| motion.u.get(first..first + 3));
        added.map_or(wind, |added| wind + Vector3::from_column_slice(added))
    }
}

/// Law of the force of the air on a marker.
#[derive(Clone, Debug, PartialEq)]
pub enum AerodynamicLaw {
    /// Drag and lift by coefficients: see the module.
    Polar(Polar),
    /// Quasi-steady uplift, the form in which pantograph makers give it: `F_z = c w²`, upward, with `w` the speed of
    /// the air along the track relative to the marker.
    Uplift {
        /// `c`, N/(m/s)²; at the air density it was measured at.
        coefficient: f64,
    },
}

/// A force of the air and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AerodynamicLoad {
    /// World axes, N.
    pub force: Vector3<f64>,
    /// `∂F/∂v_r`, N·s/m.
    pub by_velocity: Matrix3<f64>,
    /// `∂F/∂φ` for a small turn `φ` of the marker's axes (world), N/rad.
    pub by_rotation: Matrix3<f64>,
}

impl AerodynamicLaw {
    /// The force in air of `density` (kg/m³) that moves with `v_r` (m/s) relative to a marker with the axes `axes`
    /// (columns).
    #[must_use]
    pub fn load(&self, density: f64, v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> AerodynamicLoad {
        match self {
            Self::Polar(polar) => {
                let (force, by_velocity) = polar.force(0.5 * density, v_r, axes);
                AerodynamicLoad {
                    force,
                    by_velocity,
                    // Turning air and axes alike turns the force: F(R v, R A) = R F(v, A).
                    by_rotation: by_velocity * skew(v_r) - skew(&force),
                }
            }
            Self::Uplift { coefficient } => {
                let mut by_velocity = Matrix3::zeros();
                by_velocity[(2, 0)] = 2.0 * coefficient * v_r.x;
                AerodynamicLoad {
                    force: Vector3::new(0.0, 0.0, coefficient * v_r.x * v_r.x),
                    by_velocity,
                    by_rotation: Matrix3::zeros(),
                }
            }
        }
    }

    /// The drag, along the air that meets the marker, and the lift, across it, N: `F = F_D v̂_r + F_L v̂_L`. A
    /// quasi-steady uplift is all lift. For the arguments see [`AerodynamicLaw::load`].
    #[must_use]
    pub fn drag_and_lift(&self, density: f64, v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> [f64; 2] {
        match self {
            Self::Polar(polar) => polar.drag_and_lift(0.5 * density, v_r, axes),
            Self::Uplift { .. } => [0.0, self.load(density, v_r, axes).force.z],
        }
    }
}

/// The force of the air on a marker.
#[derive(Clone, Debug)]
pub struct AerodynamicForce<M> {
    /// Point of action, in the world: its velocity is that over the ground.
    pub marker: M,
    /// Law of the force.
    pub law: AerodynamicLaw,
    /// The air.
    pub flow: Flow,
}

/// A marker in the air at one instant.
struct View {
    v_r: Vector3<f64>,
    axes: Matrix3<f64>,
    columns: Columns,
    /// Velocity by the generalised velocities, without what is prescribed, m/s.
    own: Vector3<f64>,
}

impl<M: Marker> AerodynamicForce<M> {
    /// Velocity of the air relative to the marker, m/s.
    #[must_use]
    pub fn relative_velocity(&self, motion: &Motion<'_>) -> Vector3<f64> {
        let frame = self.marker.frame(motion);
        self.flow.velocity(motion, frame.position.x) - frame.velocity
    }

    /// The force now.
    #[must_use]
    pub fn load(&self, motion: &Motion<'_>) -> AerodynamicLoad {
        let frame = self.marker.frame(motion);
        let v_r = self.flow.velocity(motion, frame.position.x) - frame.velocity;
        self.law.load(self.flow.density, &v_r, &frame.axes)
    }

    /// Drag and lift now, N; see [`AerodynamicLaw::drag_and_lift`].
    #[must_use]
    pub fn drag_and_lift(&self, motion: &Motion<'_>) -> [f64; 2] {
        let frame = self.marker.frame(motion);
        let v_r = self.flow.velocity(motion, frame.position.x) - frame.velocity;
        self.law.drag_and_lift(self.flow.density, &v_r, &frame.axes)
    }

    fn view(&self, motion: &Motion<'_>) -> View {
        let frame = self.marker.frame(motion);
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        View {
            v_r: self.flow.velocity(motion, frame.position.x) - frame.velocity,
            axes: frame.axes,
            own: velocity(columns.as_slice(), motion),
            columns,
        }
    }
}

/// Velocity that the generalised velocities give a marker, m/s.
fn velocity(columns: &[Column], motion: &Motion<'_>) -> Vector3<f64> {
    columns
        .iter()
        .map(|column| column.translation * motion.v[column.index])
        .sum()
}

impl<M: Marker> Force for AerodynamicForce<M> {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let view = self.view(motion);
        let load = self.law.load(self.flow.density, &view.v_r, &view.axes);
        view.columns.add_force(&load.force, &Vector3::zeros(), force);
    }

    /// Columns (translation `t`, rotation `c`) of velocity k move a point by `t_k` and turn axes by `c_k`; columns of
    /// rotations themselves turn with the body. The change of the wind along the track is left out: it is negligible
    /// over the millimetres of a Newton step.
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let view = self.view(motion);
        let load = self.law.load(self.flow.density, &view.v_r, &view.axes);
        let columns = view.columns.as_slice();
        let turns = |column: &Column| column.rotation != Vector3::zeros();
        let turning = columns.iter().filter(|column| turns(column));
        let turning: Vector3<f64> = turning.map(|column| column.translation * motion.v[column.index]).sum();
        let n = columns.len();
        let mut values = [0.0; Columns::CAPACITY * Columns::CAPACITY];
        let mut indices = [0; Columns::CAPACITY];
        for (l, by) in columns.iter().enumerate() {
            indices[l] = by.index;
            let along_v = -(load.by_velocity * by.translation);
            let along_q = load.by_rotation * by.rotation - load.by_velocity * by.rotation.cross(&turning);
            for (k, of) in columns.iter().enumerate() {
                let lever = if turns(of) {
                    load.force.dot(&by.rotation.cross(&of.translation))
                } else {
                    0.0
                };
                let stiffness = of.translation.dot(&along_q) + lever;
                values[k * n + l] = -weights.q * stiffness - weights.v * of.translation.dot(&along_v);
            }
        }
        blocks.add(&indices[..n], &indices[..n], &values[..n * n]);
    }

    /// The force on a body that stands still on its base counts as brought in, the rest as lost to the air.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let view = self.view(motion);
        let force = |v_r: Vector3<f64>| self.law.load(self.flow.density, &v_r, &view.axes).force;
        let (moving, standing) = (force(view.v_r), force(view.v_r + view.own));
        Some(Power {
            driven: standing.dot(&view.own),
            dissipated: (standing - moving).dot(&view.own),
        })
    }
}
