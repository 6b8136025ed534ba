//! Base with a prescribed motion.
use crate::multibody::BaseMarker;
use dynamics::Frame;
use dynamics::RestingSpline;
use nalgebra::{Matrix3, Vector3};

/// Motion of the base relative to straight travel, as that of a rigid body.
///
/// ```text
/// r(t) = u(t) + R(t) r₀,   R = R_z(ψ) R_y(θ) R_x(φ)
/// ω(t) = φ̇ R_z R_y e_x + θ̇ R_z e_y + ψ̇ e_z,   ṙ = u̇ + ω × R r₀
/// ```
///
/// `u` (along the track, lateral, up) is the displacement of the top of rail under the base; roll `φ`, pitch `θ` and
/// yaw `ψ` are about axes through it. Each of the six is a cubic spline that begins and ends at rest, so that
/// accelerations are continuous between the first and the last sample.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenMotion {
    /// `u`.
    displacement: [RestingSpline; 3],
    /// `φ`, `θ`, `ψ`.
    angles: [RestingSpline; 3],
}

/// Displacement and angles of a [`GivenMotion`] at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displaced {
    /// `u`, m, 3 entries.
    pub displacement: [f64; 3],
    /// `φ`, `θ`, `ψ`, rad, 3 entries.
    pub angles: [f64; 3],
}

impl Displaced {
    /// Displacement and angles that bring a point from `reference` (m) and axes from those of the track to `frame`;
    /// pitch within ±π/2.
    #[must_use]
    pub fn to(frame: &Frame, reference: &Vector3<f64>) -> Self {
        Self {
            displacement: (frame.position - frame.axes * reference).into(),
            angles: angles(&frame.axes),
        }
    }
}

/// Roll, pitch and yaw (rad) of axes that are the columns of a rotation matrix: `R = R_z(ψ) R_y(θ) R_x(φ)`, pitch
/// within ±π/2.
#[must_use]
pub fn angles(axes: &Matrix3<f64>) -> [f64; 3] {
    let (lateral, upright) = (axes[(2, 1)], axes[(2, 2)]);
    [
        lateral.atan2(upright),
        (-axes[(2, 0)]).atan2(lateral.hypot(upright)),
        axes[(1, 0)].atan2(axes[(0, 0)]),
    ]
}

/// `R_x`, `R_y`, `R_z` for roll, pitch and yaw, rad.
fn turns([roll, pitch, yaw]: [f64; 3]) -> [Matrix3<f64>; 3] {
    let [(s, c), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(f64::sin_cos);
    [
        Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp),
        Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0),
    ]
}

impl GivenMotion {
    /// From the samples of a scene, whose lists have been checked.
    #[must_use]
    pub fn new(entry: &scene::GivenMotion) -> Self {
        let curve = |values: &Vec<f64>| RestingSpline::new(entry.time.clone(), values.clone());
        Self {
            displacement: [&entry.x, &entry.y, &entry.z].map(curve),
            angles: [&entry.roll, &entry.pitch, &entry.yaw].map(curve),
        }
    }

    /// Displacement (m) at time `t` (s) of a point that is `height` m above the base's at rest, and the lateral axis of
    /// the base.
    #[must_use]
    pub fn above(&self, height: f64, t: f64) -> ([f64; 3], [f64; 3]) {
        let position = Vector3::new(0.0, 0.0, height);
        let axes = Matrix3::identity();
        let frame = self.frame_of(&BaseMarker { position, axes }, t);
        (
            (frame.position - position).into(),
            frame.axes.column(1).into_owned().into(),
        )
    }

    /// Frame of a marker that rides on the base, at time `t` (s).
    #[must_use]
    pub fn frame_of(&self, marker: &BaseMarker, t: f64) -> Frame {
        let displacement = self.displacement.each_ref().map(|curve| curve.at(t));
        let angles = self.angles.each_ref().map(|curve| curve.at(t));
        let vector = |of: &[[f64; 3]; 3], order: usize| Vector3::from(of.map(|curve| curve[order]));
        let rates = vector(&angles, 1);
        let [about_x, about_y, about_z] = turns(angles.map(|angle| angle[0]));
        let outer = about_z * about_y;
        let turn = outer * about_x;
        let omega = outer.column(0) * rates.x + about_z.column(1) * rates.y + Vector3::z() * rates.z;
        let arm = turn * marker.position;
        Frame {
            position: vector(&displacement, 0) + arm,
            axes: turn * marker.axes,
            velocity: vector(&displacement, 1) + omega.cross(&arm),
            angular_velocity: omega,
        }
    }
}

#[cfg(test)]
mod tests;
