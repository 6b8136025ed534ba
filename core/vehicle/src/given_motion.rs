//! A base that moves as it is told.
use crate::multibody::BaseMarker;
use crate::spline::RestingSpline;
use dynamics::Frame;
use nalgebra::{Matrix3, Vector3};

/// Motion of the base relative to straight travel: lateral, up, and a roll about the direction of travel at the top of rail.
///
/// ```text
/// r(t) = (0, y(t), z(t)) + R_x(φ(t)) r₀
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GivenMotion {
    y: RestingSpline,
    z: RestingSpline,
    roll: RestingSpline,
}

impl GivenMotion {
    /// From the samples of a scene, whose lists have been checked.
    #[must_use]
    pub fn new(entry: &scene::GivenMotion) -> Self {
        let curve = |values: &[f64]| RestingSpline::new(entry.time.clone(), values.to_vec());
        Self {
            y: curve(&entry.y),
            z: curve(&entry.z),
            roll: curve(&entry.roll),
        }
    }

    /// Rise, its rate (m/s) and acceleration (m/s²) of the base at time `t`, m.
    #[must_use]
    pub fn rise(&self, t: f64) -> [f64; 3] {
        self.z.at(t)
    }

    /// Roll angle, rad.
    #[must_use]
    pub fn roll(&self, t: f64) -> f64 {
        self.roll.at(t)[0]
    }

    /// Where a marker that rides on the base is at time `t` (s).
    #[must_use]
    pub fn carry(&self, marker: &BaseMarker, t: f64) -> Frame {
        let ([y, y_rate, _], [z, z_rate, _], [roll, roll_rate, _]) = (self.y.at(t), self.z.at(t), self.roll.at(t));
        let (sine, cosine) = roll.sin_cos();
        let turn = Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
        let arm = turn * marker.position;
        let omega = Vector3::x() * roll_rate;
        Frame {
            position: Vector3::new(0.0, y, z) + arm,
            axes: turn * marker.axes,
            velocity: Vector3::new(0.0, y_rate, z_rate) + omega.cross(&arm),
            angular_velocity: omega,
        }
    }
}
