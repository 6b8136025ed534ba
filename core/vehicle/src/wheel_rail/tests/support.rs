//! Wheels, rails and wheelsets for tests.
use crate::multibody::{BodyMarker, Pose};
use crate::track::Alignment;
use crate::wheel_rail::*;
use crate::{Base, Travel};
use dynamics::{Layout, State};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// Steel as in the Manchester contact benchmark.
pub const STEEL: Material = Material {
    shear_modulus: 82e9,
    poisson: 0.28,
};

/// A profile from a file of `scenes/profiles`.
pub fn profile(text: &str) -> Arc<Profile> {
    let points: Vec<[f64; 2]> = rows(text).map(|row| [1e-3 * row[0], 1e-3 * row[1]]).collect();
    Arc::new(Profile::new(&points, 1e-5).unwrap())
}

/// The rows of numbers of a file.
pub fn rows(text: &str) -> impl Iterator<Item = Vec<f64>> {
    text.lines()
        .filter_map(|line| line.split(',').map(|cell| cell.parse().ok()).collect())
}

pub fn s1002() -> Arc<Profile> {
    profile(include_str!("../../../../../scenes/profiles/s1002.csv"))
}

pub fn uic60() -> Arc<Profile> {
    profile(include_str!("../../../../../scenes/profiles/uic60.csv"))
}

/// A straight profile with the given slope (–), ±60 mm wide.
pub fn cone(slope: f64) -> Arc<Profile> {
    let points: Vec<[f64; 2]> = (-60..=60)
        .map(|i| 1e-3 * f64::from(i))
        .map(|y| [y, slope * y])
        .collect();
    Arc::new(Profile::new(&points, 1e-5).unwrap())
}

/// A circular rail head of the given radius (m).
pub fn round_rail(radius: f64) -> Arc<Profile> {
    let points: Vec<[f64; 2]> = (-60..=60)
        .map(|i| 6e-4 * f64::from(i))
        .map(|y| [y, (radius * radius - y * y).sqrt() - radius])
        .collect();
    Arc::new(Profile::new(&points, 1e-5).unwrap())
}

/// Outward coordinate (m) of the gauge face of a rail, `depth` m below its top.
pub fn gauge_face(rail: &Profile, depth: f64) -> f64 {
    let [start, end] = rail.range();
    let top = rail.parameter_at(0.0).unwrap();
    assert!(start < top && top < end);
    let (mut low, mut high) = (start, top);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rail.at(middle).position.y < -depth {
            low = middle;
        } else {
            high = middle;
        }
    }
    rail.at(low).position.x
}

/// A rail in a curve to the left with growing cant, in the axes of the track's tangent.
pub struct CurvedRail {
    /// Distance of the profile's origin from the middle of the track, m; signed.
    pub y: f64,
    /// Curvature of the middle of the track, 1/m.
    pub curvature: f64,
    /// Rotation of the track about its middle per length, rad/m.
    pub cant_rate: f64,
}

impl RailLine for CurvedRail {
    fn frame(&self, s: f64, _from: f64) -> RailFrame {
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.curvature * s);
        let cant = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.cant_rate * s);
        let axes = (heading * cant).to_rotation_matrix().into_inner();
        let (forward, left) = (heading * Vector3::x(), heading * Vector3::y());
        let turn = Vector3::z() * self.curvature + forward * self.cant_rate;
        let turn_rate = left * (self.curvature * self.cant_rate);
        let offset = axes.column(1) * self.y;
        let middle = Vector3::new((self.curvature * s).sin(), 1.0 - (self.curvature * s).cos(), 0.0) / self.curvature;
        RailFrame {
            position: middle + offset,
            direction: forward + turn.cross(&offset),
            bend: left * self.curvature + turn_rate.cross(&offset) + turn.cross(&turn.cross(&offset)),
            axes,
            turn,
            turn_rate,
        }
    }
}

/// Both wheels of a wheelset on its rails.
pub struct Wheelset {
    pub layout: Layout,
    pub pose: Pose,
    pub wheels: [WheelRail; 2],
}

/// Parts of a wheelset.
#[derive(Clone)]
pub struct Design {
    pub wheel: Arc<Profile>,
    pub rail: Arc<Profile>,
    /// Nominal radius, m.
    pub radius: f64,
    /// Distance from the middle to the nominal rolling circle, m.
    pub distance: f64,
    /// Distance from the middle of the track to the origin of the rail's profile, m.
    pub rail_distance: f64,
    pub speed: f64,
    /// Spin of the wheelset, rad/s, beyond that of the body.
    pub spin: f64,
    pub law: CreepLaw,
    pub friction: f64,
    pub damping: f64,
    /// On rails in a curve with growing cant, see [`CurvedRail`], the frame going straight on.
    pub curved: bool,
    /// In a curve that the frame follows.
    pub alignment: Option<Arc<Alignment>>,
}

/// A rail beside the middle of a track.
struct Beside {
    alignment: Arc<Alignment>,
    y: f64,
}

impl RailLine for Beside {
    fn frame(&self, s: f64, from: f64) -> RailFrame {
        let zero = Vector3::zeros();
        let offset = Vector3::new(0.0, self.y, 0.0);
        self.alignment.seen_from(s, from).beside([offset, zero, zero])
    }
}

impl Design {
    /// Wheelset and track of the Manchester contact benchmark: gauge 1435 mm, 14 mm below the top, back to back 1360 mm
    /// with the nominal rolling circle 70 mm from the back, radius 460 mm.
    pub fn manchester() -> Self {
        let rail = uic60();
        Self {
            wheel: s1002(),
            rail_distance: 0.5 * 1.435 - gauge_face(&rail, 0.014),
            rail,
            radius: 0.46,
            distance: 0.75,
            speed: 2.0,
            spin: 2.0 / 0.46,
            law: CreepLaw::Fastsim(Fastsim { strips: 30, cells: 30 }),
            friction: 0.3,
            damping: 0.0,
            curved: false,
            alignment: None,
        }
    }

    pub fn travel(&self) -> Travel {
        let base = Base {
            start_x: 0.0,
            speed: self.speed,
        };
        Travel::along(base, self.alignment.clone())
    }

    fn line(&self, y: f64) -> Arc<dyn RailLine> {
        if let Some(alignment) = self.alignment.clone() {
            Arc::new(Beside { alignment, y })
        } else if self.curved {
            Arc::new(CurvedRail {
                y,
                curvature: 1.0 / 300.0,
                cant_rate: 5e-3,
            })
        } else {
            Arc::new(StraightRail { y, z: 0.0 })
        }
    }

    pub fn build(&self) -> Wheelset {
        let mut layout = Layout::new();
        let reference = Vector3::new(0.0, 0.0, self.radius);
        let pose = Pose::new(reference, UnitQuaternion::identity(), "wheelset", &mut layout);
        let wheels = [Side::Left, Side::Right].map(|side| {
            WheelRail::new(WheelRailParts {
                marker: Box::new(BodyMarker {
                    pose,
                    offset: Vector3::zeros(),
                    axes: Matrix3::identity(),
                }),
                along: 0.0,
                travel: self.travel(),
                spin: self.spin,
                wheel: Wheel {
                    profile: self.wheel.clone(),
                    radius: self.radius,
                    distance: self.distance,
                    side,
                },
                rail: Rail {
                    profile: self.rail.clone(),
                    line: self.line(side.sign() * self.rail_distance),
                    side,
                },
                hertz: Hertz::new(&STEEL),
                damping: self.damping,
                creep: CreepModel {
                    law: self.law,
                    friction: self.friction,
                    shear_modulus: STEEL.shear_modulus,
                    coefficients: KalkerCoefficients::new(STEEL.poisson),
                },
                slowest: 0.1,
            })
        });
        Wheelset { layout, pose, wheels }
    }
}

impl Wheelset {
    /// At rest in the frame of the base, displaced to the left and up (m), rolled and yawed (rad).
    pub fn placed(&self, left: f64, up: f64, roll: f64, yaw: f64) -> State {
        let mut state = self.layout.state_at_rest();
        state.q[self.pose.translation + 1] = left;
        state.q[self.pose.translation + 2] = up;
        state.rotation[self.pose.orientation] = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll);
        state
    }

    /// Position as [`Wheelset::placed`], at the height with the vertical force `load` (N) on one wheel.
    pub fn loaded(&self, wheel: usize, load: f64, left: f64, roll: f64, yaw: f64) -> State {
        let enough = |up: f64| {
            let state = self.placed(left, up, roll, yaw);
            self.wheels[wheel].force(&state.motion(&[])).z > load
        };
        let mut high = 0.02;
        while !enough(high - 5e-5) {
            high -= 5e-5;
            assert!(high > -0.02, "the wheel falls past its rail");
        }
        let mut low = high - 5e-5;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if enough(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.placed(left, 0.5 * (low + high), roll, yaw)
    }
}
