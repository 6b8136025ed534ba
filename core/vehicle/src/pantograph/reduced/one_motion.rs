//! Strip of a reduced linkage as a function of the two coordinates.
use super::curve::{Jet, MotionCurve};
use super::plane::{Turn, quarter};
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector2, Vector3};
use std::sync::Arc;

/// Functions of `σ`.
#[derive(Debug)]
pub(super) struct OneMotion {
    /// `X`, `Z` (m), `φ` (rad), `V` (J).
    pub curve: MotionCurve<4>,
    /// Turn by `ψ₀`.
    pub tilt: Turn,
    /// Strip's body: kg, weight in N, height of its centre of mass in the reference position.
    pub mass: f64,
    pub weight: f64,
    pub reference_z: f64,
    /// Arm from the centre of mass of the strip's body to the middle of the strip, reference position, m.
    pub strip: Vector3<f64>,
    /// Lateral position of the centre of mass of the strip's body, m.
    pub y: f64,
    /// Axes of the strip's body in the reference position.
    pub axes: Matrix3<f64>,
}

/// Position of the strip's body for given coordinates; subscripts are derivatives.
pub(super) struct StripBodyPosition {
    pub x: f64,
    pub x_sigma: f64,
    pub x_zeta: f64,
    pub x_sigma_sigma: f64,
    pub x_sigma_zeta: f64,
    pub zeta: f64,
    pub phi: Jet,
    /// Turn by `φ`.
    pub turn: Turn,
    pub potential: Jet,
    pub s: f64,
    pub s_q: [f64; 2],
    pub s_sigma_sigma: f64,
    pub s_sigma_zeta: f64,
    /// Arm from the centre of mass to the strip, in the plane.
    pub arm: Vector2<f64>,
}

impl OneMotion {
    pub fn place(&self, sigma: f64, rise: f64) -> StripBodyPosition {
        let [x, z, phi, potential] = self.curve.at(sigma);
        let zeta = self.reference_z + rise;
        let turn = Turn::by(phi[0]);
        let Turn { sine, cosine } = turn.and(self.tilt);
        let tau = sine / cosine;
        let square = 1.0 + tau * tau;
        let tau_1 = square * phi[1];
        let tau_2 = square * (phi[2] + 2.0 * tau * phi[1] * phi[1]);
        let above = zeta - z[0];
        let s_1 = (above * tau * phi[1] - z[1]) / cosine;
        StripBodyPosition {
            x: x[0] + tau * above,
            x_sigma: x[1] + tau_1 * above - tau * z[1],
            x_zeta: tau,
            x_sigma_sigma: x[2] + tau_2 * above - 2.0 * tau_1 * z[1] - tau * z[2],
            x_sigma_zeta: tau_1,
            zeta,
            phi,
            turn,
            potential,
            s: above / cosine,
            s_q: [s_1, 1.0 / cosine],
            s_sigma_sigma: (above * (tau_1 * phi[1] + tau * phi[2]) - tau * phi[1] * z[1] - z[2]) / cosine
                + s_1 * tau * phi[1],
            s_sigma_zeta: tau * phi[1] / cosine,
            arm: turn.of(Vector2::new(self.strip.x, self.strip.z)),
        }
    }
}

impl StripBodyPosition {
    /// Mass matrix, row by row.
    pub fn mass(&self, mass: f64) -> [f64; 4] {
        let coupling = mass * self.x_sigma * self.x_zeta;
        [
            1.0 + mass * self.x_sigma * self.x_sigma,
            coupling,
            coupling,
            mass * (1.0 + self.x_zeta * self.x_zeta),
        ]
    }

    /// Height of the strip and its derivatives with respect to `σ`.
    pub fn strip_height(&self) -> Jet {
        let turning = quarter(self.arm);
        [
            self.zeta + self.arm.y,
            turning.y * self.phi[1],
            turning.y * self.phi[2] - self.arm.y * self.phi[1] * self.phi[1],
        ]
    }
}

/// Strip of a reduced linkage, in the frame of the base, with the axes of the strip's body.
#[derive(Clone, Debug)]
pub struct ReducedStrip {
    pub(super) motion: Arc<OneMotion>,
    pub(super) coordinate: usize,
}

impl Marker for ReducedStrip {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let i = self.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let v = [motion.v[i], motion.v[i + 1]];
        let turning = place.phi[1] * v[0];
        let arm_rate = quarter(place.arm) * turning;
        Frame {
            position: Vector3::new(
                place.x + place.arm.x,
                self.motion.y + self.motion.strip.y,
                place.zeta + place.arm.y,
            ),
            axes: place.turn.matrix() * self.motion.axes,
            velocity: Vector3::new(
                place.x_sigma * v[0] + place.x_zeta * v[1] + arm_rate.x,
                0.0,
                v[1] + arm_rate.y,
            ),
            angular_velocity: Vector3::new(0.0, turning, 0.0),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        let i = self.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let arm_1 = quarter(place.arm) * place.phi[1];
        columns.push(
            i,
            Vector3::new(place.x_sigma + arm_1.x, 0.0, arm_1.y),
            Vector3::new(0.0, place.phi[1], 0.0),
        );
        columns.push(i + 1, Vector3::new(place.x_zeta, 0.0, 1.0), Vector3::zeros());
    }
}
