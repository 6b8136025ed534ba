//! Creepages: sliding of a wheel on a rail relative to the speed of rolling.
use super::ContactPoint;
use dynamics::Frame;
use nalgebra::Vector3;

/// Creepages at a contact point, of the wheel against the rail.
///
/// ```text
/// ξ_x = u·t_x/V,   ξ_y = u·t_y/V,   φ = ω·n/V,   u = v + ω × ρ                  [Kalker 1990, section 1.5]
/// ```
///
/// `t_x` points in the direction of rolling, `n` up, `t_y = n × t_x`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Creepage {
    /// ξ_x, –.
    pub longitudinal: f64,
    /// ξ_y, –.
    pub lateral: f64,
    /// φ, 1/m.
    pub spin: f64,
}

/// The sliding of a wheel at a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sliding {
    pub creepage: Creepage,
    /// V, m/s: speed of the middle of the wheelset along the rail; at least the slowest speed.
    pub speed: f64,
    /// Derivative of `speed` by the component of the velocity along `forward`: 0 below the slowest speed.
    pub speed_rate: f64,
    /// Velocity of the point of the wheel, m/s.
    pub velocity: Vector3<f64>,
    /// `t_x`: the direction of the rail or its opposite.
    pub forward: Vector3<f64>,
    /// `t_y`.
    pub lateral: Vector3<f64>,
    /// +1 for a wheelset that runs along the rail's direction, −1 against it.
    pub sense: f64,
}

impl Sliding {
    /// Sliding at a contact point of a wheelset whose middle moves as `frame` says (angular velocity with all of the
    /// spin). Rolling below `slowest` (m/s) counts as `slowest`: the theory is one of steady rolling and has no limit
    /// at rest.
    pub fn new(point: &ContactPoint, frame: &Frame, slowest: f64) -> Self {
        let along = frame.velocity.dot(&point.longitudinal);
        let sense = if along < 0.0 { -1.0 } else { 1.0 };
        let (forward, lateral) = (point.longitudinal * sense, point.lateral() * sense);
        let rolls = along.abs() > slowest;
        let speed = along.abs().max(slowest);
        let velocity = frame.velocity + frame.angular_velocity.cross(&point.lever);
        Self {
            creepage: Creepage {
                longitudinal: velocity.dot(&forward) / speed,
                lateral: velocity.dot(&lateral) / speed,
                spin: frame.angular_velocity.dot(&point.normal) / speed,
            },
            speed,
            speed_rate: f64::from(u8::from(rolls)),
            velocity,
            forward,
            lateral,
            sense,
        }
    }
}
