//! Air on a pantograph: the points exposed to the wind, and the effect on the state of rest.
use super::curve::MotionCurve;
use super::one_motion::OneMotion;
use super::plane::{Turn, quarter};
use super::{HeadMarker, ReducedStrip};
use crate::multibody::BodyMarker;
use crate::{Base, Travelling};
use dynamics::{AerodynamicForce, AerodynamicLaw, Columns, Flow, Force, Frame, Marker, Motion};
use nalgebra::{Matrix3, UnitQuaternion, Vector2, Vector3};
use scene::{AerodynamicMarker, Scene, WindSurface};
use std::sync::Arc;

/// Part of a scene's wind that acts on one pantograph.
#[derive(Clone, Debug)]
pub struct Air {
    /// Flow of the air.
    pub flow: Flow,
    /// Quasi-steady uplift of the strip, N/(m/s)².
    pub uplift: Option<f64>,
    /// Bodies with drag and lift.
    pub surfaces: Vec<WindSurface>,
}

impl Air {
    /// Air on pantograph `index` (from 0) of a scene; `None` if the scene lets no wind act on pantographs.
    #[must_use]
    pub fn of_scene(scene: &Scene, index: usize) -> Option<Self> {
        let table = scene.wind.as_ref()?;
        let acts = table.pantograph.as_ref()?;
        // One uplift for all pantographs, or one for each.
        let uplift = acts.uplift.get(index).or(acts.uplift.first()).copied();
        Some(Self {
            flow: Flow {
                wind: Arc::new(scene.wind_field()?),
                density: table.air_density,
                input: None,
            },
            uplift,
            surfaces: acts.surfaces.clone(),
        })
    }

    /// The force on a point of a surface, or of the uplift on the strip.
    pub(crate) fn force(&self, marker: AirMarker, base: Base, law: AerodynamicLaw) -> AirForce {
        AerodynamicForce {
            marker: Travelling { marker, base },
            law,
            flow: self.flow.clone(),
        }
    }
}

/// The force of the air on a point of a pantograph.
pub(crate) type AirForce = AerodynamicForce<Travelling<AirMarker>>;

/// The forces of the air on a pantograph.
#[derive(Clone, Debug, Default)]
pub(crate) struct AirForces {
    forces: Vec<AirForce>,
    /// True for forces on the body of the strip.
    on_head: Vec<bool>,
}

impl AirForces {
    pub(super) fn push(&mut self, force: AirForce, on_head: bool) {
        self.forces.push(force);
        self.on_head.push(on_head);
    }

    pub(super) fn as_slice(&self) -> &[AirForce] {
        &self.forces
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [AirForce] {
        &mut self.forces
    }

    /// Drag and lift on the body of the strip, N: sums over the points.
    pub(crate) fn on_head(&self, motion: &Motion<'_>) -> [f64; 2] {
        let on_head = self.forces.iter().zip(&self.on_head).filter(|(_, on_head)| **on_head);
        on_head.fold([0.0; 2], |[drag, lift], (force, _)| {
            let [more_drag, more_lift] = force.drag_and_lift(motion);
            [drag + more_drag, lift + more_lift]
        })
    }
}

/// Points of a surface: offset from the body's centre of mass (m) and axes in body axes, and area in m².
pub(crate) fn points_of(
    surface: &WindSurface,
    orientation: &UnitQuaternion<f64>,
) -> Vec<(Vector3<f64>, Matrix3<f64>, f64)> {
    if surface.markers.is_empty() {
        let track = orientation.to_rotation_matrix().transpose().into_inner();
        return vec![(Vector3::zeros(), track, 1.0)];
    }
    let point = |marker: &AerodynamicMarker| {
        let [x, y, z] = marker.axes;
        let axes = Matrix3::from_rows(&[x.into(), y.into(), z.into()]);
        (marker.position.into(), axes, marker.area)
    };
    surface.markers.iter().map(point).collect()
}

/// A point of a pantograph in the frame of its base.
#[derive(Clone, Debug)]
pub enum AirMarker {
    /// The strip of a lumped pantograph.
    Head(HeadMarker),
    /// A point of a body of a linkage.
    Body(BodyMarker),
    /// The strip of a reduced linkage.
    Strip(ReducedStrip),
    /// A point of a body of a reduced linkage.
    Reduced(ReducedPoint),
}

impl Marker for AirMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        match self {
            Self::Head(marker) => marker.frame(motion),
            Self::Body(marker) => marker.frame(motion),
            Self::Strip(marker) => marker.frame(motion),
            Self::Reduced(marker) => marker.frame(motion),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        match self {
            Self::Head(marker) => marker.columns(motion, columns),
            Self::Body(marker) => marker.columns(motion, columns),
            Self::Strip(marker) => marker.columns(motion, columns),
            Self::Reduced(marker) => marker.columns(motion, columns),
        }
    }
}

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

/// Position of the body: centre of mass in the plane and angle, with their derivatives by both coordinates.
struct PointPosition {
    centre: Vector2<f64>,
    by_sigma: Vector2<f64>,
    by_zeta: Vector2<f64>,
    turn: Turn,
    /// `∂φ/∂σ`
    turning: f64,
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
                    turn: Turn::by(phi[0]),
                    turning: phi[1],
                }
            }
            PointPath::StripBody(motion) => {
                let place = motion.place(sigma, rise);
                PointPosition {
                    centre: Vector2::new(place.x, place.zeta),
                    by_sigma: Vector2::new(place.x_sigma, 0.0),
                    by_zeta: Vector2::new(place.x_zeta, 1.0),
                    turn: place.turn,
                    turning: place.phi[1],
                }
            }
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

/// Adds the generalised forces of the air at rest to `force`, which has one entry per coordinate known to the markers.
pub(super) fn add_at_rest(air: &mut [AirForce], q: &[f64], force: &mut [f64]) {
    let v = vec![0.0; q.len()];
    let motion = Motion {
        t: 0.0,
        q,
        v: &v,
        rotation: &[],
        u: &[],
    };
    for part in air {
        part.add_force(&motion, force);
    }
}
