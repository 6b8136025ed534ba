//! Wheels as surfaces of revolution, rails as profiles swept along a line.
use super::{Profile, ProfilePoint};
use dynamics::rotation::skew;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Side of a wheel of a wheelset, or of a rail of a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// y positive.
    Left,
    /// y negative.
    Right,
}

impl Side {
    /// Outward direction along the lateral axis, –.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Point of a surface with first and second derivatives by both parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePoint {
    pub position: Vector3<f64>,
    pub first: [Vector3<f64>; 2],
    /// Second derivatives by the first parameter twice, by both, by the second twice.
    pub second: [Vector3<f64>; 3],
}

/// Wheel: a profile turned about the axis of the wheelset.
#[derive(Clone, Debug)]
pub struct Wheel {
    /// Profile with the origin on the nominal rolling circle.
    pub profile: Arc<Profile>,
    /// Radius of the nominal rolling circle, m.
    pub radius: f64,
    /// Distance of the nominal rolling circle from the middle of the wheelset, m.
    pub distance: f64,
    /// Side of the wheel.
    pub side: Side,
}

/// Axes that follow a wheelset but not the spin: forward, along the axis to the left, up; as columns.
pub(crate) fn axes_without_spin(axis: &Vector3<f64>) -> Matrix3<f64> {
    let forward = axis.cross(&Vector3::z()).normalize();
    Matrix3::from_columns(&[forward, *axis, forward.cross(axis)])
}

impl Wheel {
    /// Point relative to the middle of the wheelset, world axes; parameters: the angle φ (rad) from straight down,
    /// forward, and the profile's σ (m), given by its point there.
    ///
    /// ```text
    /// r = ±(b + y(σ)) e_y + (R − z(σ)) (sin φ e_x − cos φ e_z)
    /// ```
    pub(crate) fn at(&self, axes: &Matrix3<f64>, phi: f64, profile: &ProfilePoint) -> SurfacePoint {
        let (sine, cosine) = phi.sin_cos();
        let (forward, up) = (axes.column(0), axes.column(2));
        let radial = forward * sine - up * cosine;
        let turned = forward * cosine + up * sine;
        let lateral = axes.column(1) * self.side.sign();
        let radius = self.radius - profile.position.y;
        SurfacePoint {
            position: lateral * (self.distance + profile.position.x) + radial * radius,
            first: [turned * radius, lateral * profile.first.x - radial * profile.first.y],
            second: [
                radial * -radius,
                turned * -profile.first.y,
                lateral * profile.second.x - radial * profile.second.y,
            ],
        }
    }
}

/// Origin of a rail's profile along the track, and the change with the arc length s. "World" axes are the axes of the
/// viewpoint, which are at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RailFrame {
    /// World position of the profile's origin, m.
    pub position: Vector3<f64>,
    /// Derivative of the position by s, –: the direction of the rail, not necessarily of unit length.
    pub direction: Vector3<f64>,
    /// Second derivative of the position by s, 1/m.
    pub bend: Vector3<f64>,
    /// Axes of the rail as columns: along the rail, to the left, up.
    pub axes: Matrix3<f64>,
    /// Rotation of the axes per length, world axes, rad/m.
    pub turn: Vector3<f64>,
    /// Derivative of `turn` by s, rad/m².
    pub turn_rate: Vector3<f64>,
}

impl RailFrame {
    /// Line beside this one, at an offset along the axes that changes with s: the offset (m) and the first two
    /// derivatives by s.
    ///
    /// ```text
    /// r = p + A o,   r' = p' + ω × A o + A o',   r'' = p'' + ω' × A o + ω × (ω × A o) + 2 ω × A o' + A o''
    /// ```
    #[must_use]
    pub fn beside(&self, offset: [Vector3<f64>; 3]) -> Self {
        let [offset, rate, second] = offset.map(|vector| self.axes * vector);
        Self {
            position: self.position + offset,
            direction: self.direction + self.turn.cross(&offset) + rate,
            bend: self.bend
                + self.turn_rate.cross(&offset)
                + self.turn.cross(&(self.turn.cross(&offset) + 2.0 * rate))
                + second,
            ..*self
        }
    }
}

/// The line of one rail: straight, curved, canted, with irregularities.
pub trait RailLine: Send + Sync {
    /// Rail at the arc length `s` (m), in the axes of the track at the arc length `from` (m), the middle of the track
    /// there being at (`from`, 0, 0). On straight track the result does not depend on `from`.
    ///
    /// Seen from nearby, positions across the track are small numbers: penetrations of micrometres would drown in the
    /// rounding of hundreds of metres.
    fn frame(&self, s: f64, from: f64) -> RailFrame;
}

/// A straight, level rail along x.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg(test)]
pub struct StraightRail {
    /// y of the profile's origin, m; signed.
    pub y: f64,
    /// z of the profile's origin, m.
    pub z: f64,
}

#[cfg(test)]
impl RailLine for StraightRail {
    fn frame(&self, s: f64, _from: f64) -> RailFrame {
        RailFrame {
            position: Vector3::new(s, self.y, self.z),
            direction: Vector3::x(),
            bend: Vector3::zeros(),
            axes: Matrix3::identity(),
            turn: Vector3::zeros(),
            turn_rate: Vector3::zeros(),
        }
    }
}

/// Rail: a profile swept along a line.
#[derive(Clone)]
pub struct Rail {
    /// Cross-section, with the inclination.
    pub profile: Arc<Profile>,
    /// Line of the origin of the profile.
    pub line: Arc<dyn RailLine>,
    /// Side of the rail.
    pub side: Side,
}

impl Rail {
    /// Point seen `from` there; parameters: arc length s (m) and the profile's σ (m), given by its point there.
    ///
    /// ```text
    /// r = p(s) + A(s) (0, ±y(σ), z(σ))
    /// ```
    pub(crate) fn at(&self, s: f64, profile: &ProfilePoint, from: f64) -> SurfacePoint {
        let frame = self.line.frame(s, from);
        let to_world = |vector: nalgebra::Vector2<f64>| {
            frame.axes.column(1) * (self.side.sign() * vector.x) + frame.axes.column(2) * vector.y
        };
        let (offset, first, second) = (
            to_world(profile.position),
            to_world(profile.first),
            to_world(profile.second),
        );
        let mut point = SurfacePoint {
            position: frame.position + offset,
            first: [frame.direction, first],
            second: [frame.bend, Vector3::zeros(), second],
        };
        // A rail whose axes do not turn is swept as it is.
        if frame.turn != Vector3::zeros() || frame.turn_rate != Vector3::zeros() {
            let turn = skew(&frame.turn);
            point.first[0] += turn * offset;
            point.second[0] = frame.bend + frame.turn_rate.cross(&offset) + turn * (turn * offset);
            point.second[1] = turn * first;
        }
        point
    }
}
