//! Travel of the frame of a vehicle along a straight or a curved track.
use crate::Base;
use crate::track::Alignment;
use dynamics::{Columns, Frame};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Travel of the frame in which a vehicle and its pantograph are described.
///
/// On straight track the frame is that of the base. In a curve the origin follows the middle of the track at the same
/// speed, and the axes are the direction of travel, and left and up of the plane of the rails. A point at rest in the
/// frame is at rest beside the track, so that x along the developed track, y and z in this frame are those of the line.
#[derive(Clone, Debug)]
pub struct Travel {
    base: Base,
    alignment: Option<Arc<Alignment>>,
}

/// Travelling frame at one instant, as seen from a point of the track whose axes are the world axes here.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TravellingFrame {
    /// Origin, axes, velocity of the origin, angular velocity.
    frame: Frame,
    /// True if the axes differ from the world axes.
    turned: bool,
}

/// Acceleration and lean of the frame as felt by bodies, along the axes of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apparent {
    /// Acceleration of the origin, m/s².
    pub acceleration: Vector3<f64>,
    /// Ω, rad/s.
    pub angular_velocity: Vector3<f64>,
    /// Ω̇, rad/s².
    pub angular_acceleration: Vector3<f64>,
    /// Direction against gravity, unit length.
    pub upward: Vector3<f64>,
}

impl Travel {
    /// Travel along a track; `None` is along the x axis.
    #[must_use]
    pub fn along(base: Base, alignment: Option<Arc<Alignment>>) -> Self {
        Self { base, alignment }
    }

    /// Alignment of the track; `None` is along the x axis.
    #[must_use]
    pub fn alignment(&self) -> Option<&Arc<Alignment>> {
        self.alignment.as_ref()
    }

    /// Position of the origin along the track at time `t` (s), m.
    #[must_use]
    pub fn place(&self, t: f64) -> f64 {
        self.base.position(t).x
    }

    /// Frame at time `t` (s), seen `from` a point of the track (m), see [`Alignment::seen_from`].
    pub(crate) fn travelling(&self, t: f64, from: f64) -> TravellingFrame {
        let Some(alignment) = &self.alignment else {
            return TravellingFrame {
                frame: Frame {
                    position: self.base.position(t),
                    axes: Matrix3::identity(),
                    velocity: self.base.velocity(),
                    angular_velocity: Vector3::zeros(),
                },
                turned: false,
            };
        };
        let track = alignment.seen_from(self.place(t), from);
        TravellingFrame {
            frame: Frame {
                position: track.position,
                axes: track.axes,
                velocity: track.direction * self.base.speed,
                angular_velocity: track.turn * self.base.speed,
            },
            turned: true,
        }
    }

    /// Apparent motion in the frame at time `t` (s); `None` on straight track.
    ///
    /// ```text
    /// a = v² (0, κ, z''),   Ω = v (φ', 0, κ),   Ω̇ = v² (φ'', κ φ', κ')
    /// ```
    ///
    /// along the horizontal direction of travel, left and up, turned by φ about the first: the derivatives by s of
    /// position and rotation of [`Alignment::seen_from`].
    #[must_use]
    pub fn apparent(&self, t: f64) -> Option<Apparent> {
        let alignment = self.alignment.as_ref()?;
        let bend = alignment.bend(self.place(t));
        let ([_, curvature, curvature_rate], [_, twist, twist_rate]) = (bend.heading, bend.cant);
        let (speed, square) = (self.base.speed, self.base.speed * self.base.speed);
        let turned = |vector: Vector3<f64>| bend.leaning(vector);
        Some(Apparent {
            acceleration: turned(Vector3::new(0.0, curvature, bend.rise[2]) * square),
            angular_velocity: turned(Vector3::new(twist, 0.0, curvature) * speed),
            angular_acceleration: turned(Vector3::new(twist_rate, curvature * twist, curvature_rate) * square),
            upward: turned(Vector3::z()),
        })
    }
}

impl Apparent {
    /// Acceleration of a point at `position` (m) that moves with `velocity` (m/s) in the frame, beside the change of
    /// that velocity, m/s²: `a + Ω̇ × r + Ω × (Ω × r) + 2 Ω × ṙ`.
    #[must_use]
    pub fn acceleration_of(&self, position: &Vector3<f64>, velocity: &Vector3<f64>) -> Vector3<f64> {
        let turning = self.angular_velocity.cross(position) + 2.0 * velocity;
        self.acceleration + self.angular_acceleration.cross(position) + self.angular_velocity.cross(&turning)
    }

    /// Change of the weight per mass with the lean of the frame, m/s²: `−g (e_up − e_z)`.
    #[must_use]
    pub fn leaning_weight(&self, gravity: f64) -> Vector3<f64> {
        (Vector3::z() - self.upward) * gravity
    }
}

impl TravellingFrame {
    /// Velocity of the frame at a point (m) of the world, m/s, and angular velocity of the frame, rad/s.
    pub fn motion_of(&self, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let turn = self.frame.angular_velocity;
        let velocity = self.frame.velocity + turn.cross(&(point - self.frame.position));
        (velocity, turn)
    }

    /// Angular velocity, world axes, rad/s.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        self.frame.angular_velocity
    }

    /// Frame of a marker that is given in the travelling frame.
    pub fn frame_of(&self, inner: &Frame) -> Frame {
        if !self.turned {
            return Frame {
                position: inner.position + self.frame.position,
                velocity: inner.velocity + self.frame.velocity,
                ..*inner
            };
        }
        let axes = &self.frame.axes;
        let offset = axes * inner.position;
        Frame {
            position: self.frame.position + offset,
            axes: axes * inner.axes,
            velocity: self.frame.velocity + self.frame.angular_velocity.cross(&offset) + axes * inner.velocity,
            angular_velocity: self.frame.angular_velocity + axes * inner.angular_velocity,
        }
    }

    /// Columns of a marker that is given in the travelling frame.
    pub fn columns_of(&self, inner: Columns) -> Columns {
        if !self.turned {
            return inner;
        }
        let mut columns = Columns::default();
        for column in inner.as_slice() {
            columns.push(
                column.index,
                self.frame.axes * column.translation,
                self.frame.axes * column.rotation,
            );
        }
        columns
    }
}
