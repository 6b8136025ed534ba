//! Points of the bodies of a reduced linkage as functions of the two coordinates.
use super::curve::MotionCurve;
use super::one_motion::OneMotion;
use super::plane::{Turn, quarter};
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector2, Vector3};
use std::sync::Arc;

/// Point of a body whose motion in the plane is known by one or two coordinates.
#[derive(Clone, Debug)]
pub struct ReducedPoint {
    pub(super) path: PointPath,
    /// First coordinate of the linkage.
    pub(super) coordinate: usize,
    /// Arm from the body's centre of mass, reference position, m.
    pub(super) arm: Vector3<f64>,
    /// Lateral position of the centre of mass, m.
    pub(super) y: f64,
    /// Axes of the marker in the reference position.
    pub(super) axes: Matrix3<f64>,
}

/// Path of the centre of mass of a body.
#[derive(Clone, Debug)]
pub(super) enum PointPath {
    /// Function of the one motion.
    Follower(Arc<MotionCurve<3>>),
    /// Body of the strip: function of the one motion and the collector suspension.
    StripBody(Arc<OneMotion>),
}

/// Height of a point, m, or turn of a body, rad, as a function of both coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    pub value: f64,
    /// `∂/∂σ`, `∂/∂ζ`
    pub by: [f64; 2],
    /// `∂²/∂σ²`; the other second derivatives are 0.
    pub bend: f64,
}

/// Position of the body: centre of mass in the plane and angle, with their derivatives by both coordinates.
struct PointPosition {
    centre: Vector2<f64>,
    by_sigma: Vector2<f64>,
    by_zeta: Vector2<f64>,
    /// `φ`, and the turn by it.
    angle: f64,
    turn: Turn,
    /// `∂φ/∂σ`
    turning: f64,
    /// `∂²φ/∂σ²`
    bending: f64,
    /// `∂²z/∂σ²` of the centre of mass; its other second derivatives are 0.
    rising: f64,
}

impl ReducedPoint {
    fn place(&self, motion: &Motion<'_>) -> PointPosition {
        let (sigma, rise) = (motion.q[self.coordinate], motion.q[self.coordinate + 1]);
        match &self.path {
            PointPath::Follower(curve) => {
                let [x, z, phi] = curve.at(sigma);
                PointPosition {
                    centre: Vector2::new(x[0], z[0]),
                    by_sigma: Vector2::new(x[1], z[1]),
                    by_zeta: Vector2::zeros(),
                    angle: phi[0],
                    turn: Turn::by(phi[0]),
                    turning: phi[1],
                    bending: phi[2],
                    rising: z[2],
                }
            }
            PointPath::StripBody(motion) => {
                let place = motion.place(sigma, rise);
                PointPosition {
                    centre: Vector2::new(place.x, place.zeta),
                    by_sigma: Vector2::new(place.x_sigma, 0.0),
                    by_zeta: Vector2::new(place.x_zeta, 1.0),
                    angle: place.phi[0],
                    turn: place.turn,
                    turning: place.phi[1],
                    bending: place.phi[2],
                    rising: 0.0,
                }
            }
        }
    }

    /// Height.
    pub(super) fn height(&self, motion: &Motion<'_>) -> Way {
        let place = self.place(motion);
        let arm = self.arm(&place);
        let turned = quarter(arm).y;
        Way {
            value: place.centre.y + arm.y,
            by: [place.by_sigma.y + turned * place.turning, place.by_zeta.y],
            bend: place.rising + turned * place.bending - arm.y * place.turning * place.turning,
        }
    }

    /// Turn of the body about the lateral axis.
    pub(super) fn turn(&self, motion: &Motion<'_>) -> Way {
        let place = self.place(motion);
        Way {
            value: place.angle,
            by: [place.turning, 0.0],
            bend: place.bending,
        }
    }

    /// The arm in the plane, turned.
    fn arm(&self, place: &PointPosition) -> Vector2<f64> {
        place.turn.of(Vector2::new(self.arm.x, self.arm.z))
    }
}

impl Marker for ReducedPoint {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let place = self.place(motion);
        let (sigma_rate, rise_rate) = (motion.v[self.coordinate], motion.v[self.coordinate + 1]);
        let arm = self.arm(&place);
        let velocity = (place.by_sigma + quarter(arm) * place.turning) * sigma_rate + place.by_zeta * rise_rate;
        Frame {
            position: Vector3::new(place.centre.x + arm.x, self.y + self.arm.y, place.centre.y + arm.y),
            axes: place.turn.matrix() * self.axes,
            velocity: Vector3::new(velocity.x, 0.0, velocity.y),
            angular_velocity: Vector3::new(0.0, place.turning * sigma_rate, 0.0),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        let place = self.place(motion);
        let along = place.by_sigma + quarter(self.arm(&place)) * place.turning;
        let turn = Vector3::new(0.0, place.turning, 0.0);
        columns.push(self.coordinate, Vector3::new(along.x, 0.0, along.y), turn);
        // A follower gets the second column too, so that both coordinates stand in one block of the tangent.
        let rise = Vector3::new(place.by_zeta.x, 0.0, place.by_zeta.y);
        columns.push(self.coordinate + 1, rise, Vector3::zeros());
    }
}
