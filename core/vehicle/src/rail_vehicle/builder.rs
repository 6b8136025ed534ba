//! From the scene's vehicle to bodies, bushings, joints and wheels.
use super::rolling_wheel::Rolling;
use super::{CurveInertia, RollingWheel, Spin, Vehicle, VehicleWheel, WheelSpring};
use crate::multibody::{Anchor, BodyMarker, Bushing, Bushings, Characteristic, Joint, Pair, Pose, Rates, RigidBody};
use crate::pantograph::Offsets;
use crate::track::{Alignment, TrackShape};
use crate::wheel_rail::{CreepLaw, CreepModel, Fastsim, Hertz, KalkerCoefficients, Material, Profile, Side};
use crate::{Base, Travel, VehicleError};
use dynamics::{Constraint, Layout};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use scene::{BushingEntry, Train as Entry, VehicleBody};
use std::sync::Arc;

/// Rotational coordinates about the axes of a body.
const ROLL: usize = 0;
const PITCH: usize = 1;
const YAW: usize = 2;

struct Builder<'a> {
    entry: &'a Entry,
    /// Origin of the frame of the base, in coordinates of the vehicle, m.
    origin: Vector3<f64>,
    /// First body of each entry, in the order of the scene.
    firsts: Vec<usize>,
    bodies: Vec<RigidBody>,
}

impl Builder<'_> {
    fn point(&self, point: &[f64; 3]) -> Vector3<f64> {
        Vector3::from(*point) - self.origin
    }

    /// The body called `name` nearest to a point.
    fn body(&self, key: &'static str, name: &str, point: &[f64; 3]) -> Result<RigidBody, VehicleError> {
        let entry = self.entry.bodies.iter().position(|body| body.name == name);
        let entry = entry.ok_or_else(|| VehicleError::UnknownBody {
            key,
            name: name.to_owned(),
        })?;
        Ok(self.bodies[self.firsts[entry] + self.entry.bodies[entry].nearest(point)])
    }

    /// Meeting point of two bodies, named under `keys`.
    fn pair(
        &self,
        keys: [&'static str; 2],
        bodies: [&str; 2],
        point: &[f64; 3],
        axes: &Matrix3<f64>,
    ) -> Result<Pair, VehicleError> {
        Ok(Pair {
            first: Anchor::Body(self.anchor(keys[0], bodies[0], point, axes)?),
            second: Anchor::Body(self.anchor(keys[1], bodies[1], point, axes)?),
        })
    }

    /// The marker at a point of the body called `name` nearest to it.
    fn anchor(
        &self,
        key: &'static str,
        name: &str,
        point: &[f64; 3],
        axes: &Matrix3<f64>,
    ) -> Result<BodyMarker, VehicleError> {
        let pose = self.body(key, name, point)?.pose;
        Ok(BodyMarker::at(
            pose,
            &UnitQuaternion::identity(),
            &self.point(point),
            axes,
        ))
    }

    fn bushings(&self, entry: &BushingEntry, into: &mut Vec<Bushing>) -> Result<(), VehicleError> {
        // Z-X-Z, as for the bodies of a linkage.
        let [first, second, third] = entry.orientation;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), first)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), second)
            * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), third);
        let axes = turn.to_rotation_matrix().into_inner();
        let mut characteristics = [None, None, None];
        if let Some(stop) = &entry.stop {
            let curve = Characteristic::new(&stop.displacement, &stop.force);
            let place = match stop.axis {
                scene::Axis::X => 0,
                scene::Axis::Y => 1,
                scene::Axis::Z => 2,
            };
            characteristics[place] = Some(curve.map_err(|_| VehicleError::NoCharacteristic {
                name: entry.name.clone(),
            })?);
        }
        for point in &entry.points {
            into.push(Bushing {
                pair: self.pair(
                    ["bushings.first", "bushings.second"],
                    [&entry.first, &entry.second],
                    point,
                    &axes,
                )?,
                rates: Rates {
                    stiffness: entry.stiffness.into(),
                    damping: entry.damping.into(),
                    rotational_stiffness: entry.rotational_stiffness.into(),
                    rotational_damping: entry.rotational_damping.into(),
                },
                preload: entry.preload.into(),
                characteristics: characteristics.clone(),
            });
        }
        Ok(())
    }

    fn bearings(&self, into: &mut Vec<Bushing>) -> Result<(), VehicleError> {
        let axes = Matrix3::identity();
        for entry in &self.entry.bearings {
            let [about_x, about_z] = entry.tilting_stiffness;
            for point in &entry.points {
                into.push(Bushing {
                    pair: self.pair(
                        ["bearings.first", "bearings.second"],
                        [&entry.first, &entry.second],
                        point,
                        &axes,
                    )?,
                    rates: Rates {
                        stiffness: entry.stiffness.into(),
                        damping: entry.damping.into(),
                        rotational_stiffness: Vector3::new(about_x, 0.0, about_z),
                        rotational_damping: Vector3::zeros(),
                    },
                    preload: Vector3::zeros(),
                    characteristics: [None, None, None],
                });
            }
        }
        Ok(())
    }

    fn joints(&self, in_plane: bool) -> Result<Vec<Joint>, VehicleError> {
        let axes = Matrix3::identity();
        let mut joints = Vec::new();
        for entry in &self.entry.joints {
            for point in &entry.points {
                let Pair { first, second } = self.pair(
                    ["joints.first", "joints.second"],
                    [&entry.first, &entry.second],
                    point,
                    &axes,
                )?;
                joints.push(if in_plane {
                    Joint::upright_in_plane(first, second)
                } else {
                    Joint::revolute(first, second)
                });
            }
        }
        Ok(joints)
    }

    fn wheels(&self, base: Base, track: Option<&TrackShape>) -> Result<Vec<VehicleWheel>, VehicleError> {
        let wheels = &self.entry.wheels;
        let wheelsets = self.entry.body(&wheels.wheelset);
        let wheelsets = wheelsets.ok_or_else(|| VehicleError::UnknownBody {
            key: "wheels.wheelset",
            name: wheels.wheelset.clone(),
        })?;
        let mut springs = Vec::new();
        for position in &wheelsets.positions {
            for (side, lateral) in [0.5, -0.5].map(|share| share * wheels.distance).into_iter().enumerate() {
                let point = [position[0], position[1] + lateral, position[2]];
                let marker = self.anchor("wheels.wheelset", &wheels.wheelset, &point, &Matrix3::identity())?;
                let rail = track.map(|track| Arc::clone(&track.rails[side]));
                let rates = [wheels.stiffness, wheels.damping];
                let spring = WheelSpring::new(marker, self.point(&point), base, rail, rates);
                springs.push(VehicleWheel::Spring(spring));
            }
        }
        Ok(springs)
    }
}

impl Vehicle {
    /// Builds a vehicle whose bodies only move in the plane along the track into `layout`, in the frame of `base`;
    /// `name` begins the names of the coordinates. `gravity` in m/s².
    ///
    /// # Errors
    /// Names that do not fit together.
    pub(crate) fn vertical(
        entry: &Entry,
        track: Option<&TrackShape>,
        base: Base,
        gravity: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Result<Self, VehicleError> {
        let mut vehicle = Self::build(entry, track, base, gravity, name, layout, true)?;
        for body in &vehicle.bodies {
            layout.fix(body.pose.translation + 1);
            layout.fix(body.pose.rotation + ROLL);
            layout.fix(body.pose.rotation + YAW);
        }
        vehicle.fixed += 3 * vehicle.bodies.len();
        vehicle.hold_axles_and_speed(entry, layout);
        Ok(vehicle)
    }

    /// Builds a vehicle whose bodies move in space, on wheels that roll on the rails of `track`; `shape` holds the
    /// deviations of the rails from their ideal lines.
    ///
    /// # Errors
    /// Names that do not fit together; unusable profiles.
    pub(crate) fn full(
        entry: &Entry,
        (track, shape): (&scene::Track, Option<&TrackShape>),
        base: Base,
        gravity: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Result<Self, VehicleError> {
        let mut vehicle = Self::build(entry, None, base, gravity, name, layout, false)?;
        let wheelsets = vehicle.hold_axles_and_speed(entry, layout);
        let alignment = Alignment::new(&track.curves, entry.wheels.distance);
        vehicle.travel = Travel::along(base, alignment.map(Arc::new));
        let rolling = rolling(entry, track, vehicle.travel.clone())?;
        vehicle.wheels.clear();
        for (i, body) in wheelsets.enumerate() {
            let body = vehicle.bodies[body];
            let spin = Spin {
                pose: body.pose,
                coordinate: layout.add_coordinates(1, format!("{name}, spin of wheelset {}", i + 1)),
                rolling: base.speed / entry.wheels.radius,
                inertia: body.inertia.y,
            };
            vehicle.spins.push(spin);
            for (side, number) in [(Side::Left, 0), (Side::Right, 1)] {
                let shape = shape.map(|shape| Arc::clone(&shape.rails[number]));
                let wheel = RollingWheel::new(rolling.clone(), spin, side, shape);
                vehicle.wheels.push(VehicleWheel::Rolling(wheel));
            }
        }
        vehicle.inertia = CurveInertia::new(&vehicle.travel, &vehicle.bodies, &vehicle.spins);
        Ok(vehicle)
    }

    /// Holds the pitch of the bodies that stand for axles without spin, and the position of the travelling body along
    /// the track; returns the numbers of the wheelsets.
    fn hold_axles_and_speed(&mut self, entry: &Entry, layout: &mut Layout) -> std::ops::Range<usize> {
        let wheelsets = entry.bodies.iter().find(|body| body.name == entry.wheels.wheelset);
        let count = wheelsets.map_or(0, |body| body.positions.len());
        let before = entry.bodies.iter();
        let before = before.take_while(|body| body.name != entry.wheels.wheelset);
        let first: usize = before.map(|body| body.positions.len()).sum();
        for body in &self.bodies[first..first + count] {
            layout.fix(body.pose.rotation + PITCH);
        }
        layout.fix(self.pantograph_base.pose.translation);
        self.fixed += count + 1;
        first..first + count
    }

    /// The vehicle with all motions free, on the springs of its wheels alone.
    pub(super) fn build(
        entry: &Entry,
        track: Option<&TrackShape>,
        base: Base,
        gravity: f64,
        name: &str,
        layout: &mut Layout,
        in_plane: bool,
    ) -> Result<Self, VehicleError> {
        let offsets = Offsets {
            coordinate: layout.coordinates(),
            constraint: layout.constraints(),
            orientation: layout.rotations().len(),
        };
        // Along the track the origin is under the pantograph's base, laterally in the middle of the track, so that
        // there is a rail on each side.
        let mut builder = Builder {
            entry,
            origin: Vector3::new(entry.pantograph_base[0], 0.0, 0.0),
            firsts: Vec::new(),
            bodies: Vec::new(),
        };
        let mut names = Vec::new();
        for body in &entry.bodies {
            builder.firsts.push(builder.bodies.len());
            for (i, position) in body.positions.iter().enumerate() {
                let body_name = numbered(body, i);
                let reference = builder.point(position);
                let title = format!("{name}, {body_name}");
                builder.bodies.push(RigidBody {
                    pose: Pose::new(reference, UnitQuaternion::identity(), &title, layout),
                    mass: body.mass,
                    inertia: body.inertia.into(),
                    gravity,
                });
                names.push(body_name);
            }
        }
        let mut bushings = Vec::new();
        for entry in &entry.bushings {
            builder.bushings(entry, &mut bushings)?;
        }
        let before = bushings.len();
        builder.bearings(&mut bushings)?;
        let joints = builder.joints(in_plane)?;
        let constraint_count = joints.iter().map(Constraint::dimension).sum();
        layout.add_constraints(constraint_count);
        Ok(Self {
            offsets,
            constraint_count,
            names,
            bearing_count: bushings.len() - before,
            bushings: Bushings::new(bushings),
            joints,
            wheels: builder.wheels(base, track)?,
            spins: Vec::new(),
            pantograph_base: builder.anchor("carrier", &entry.carrier, &entry.pantograph_base, &Matrix3::identity())?,
            bodies: builder.bodies,
            fixed: 0,
            travel: Travel::along(base, None),
            inertia: None,
        })
    }
}

/// Spacing below which points count as one, m: a hundredth of a millimetre is the digit to which profiles are measured.
const SPACING: f64 = 1e-5;

/// Depth below the top of rail at which the gauge is measured, m [EN 13848-1].
const GAUGE_DEPTH: f64 = 0.014;

/// Data shared by all wheels of a full vehicle.
fn rolling(entry: &Entry, track: &scene::Track, travel: Travel) -> Result<Rolling, VehicleError> {
    let missing = |key| VehicleError::Missing { key };
    let profile = |key: &'static str, points: &[[f64; 2]]| {
        let profile = Profile::new(points, SPACING);
        profile
            .map(Arc::new)
            .map_err(|reason| VehicleError::Profile { key, reason })
    };
    let contact = entry.contact.as_ref().ok_or_else(|| missing("vehicle.contact"))?;
    let wheel = entry.wheels.profile.as_ref();
    let wheel = wheel.ok_or_else(|| missing("vehicle.wheels.profile"))?;
    let rail = track.rail.as_ref().ok_or_else(|| missing("track.rail"))?;
    // The rail leans inward by its inclination, about the middle of its top.
    let (sine, cosine) = rail.inclination.atan().sin_cos();
    let leaning: Vec<[f64; 2]> = (rail.profile.iter())
        .map(|[outward, up]| [outward * cosine - up * sine, outward * sine + up * cosine])
        .collect();
    let rail_profile = profile("track.rail.profile", &leaning)?;
    let face = gauge_face(&rail_profile).ok_or(VehicleError::NoGaugeFace)?;
    let material = Material {
        shear_modulus: contact.shear_modulus,
        poisson: contact.poisson,
    };
    Ok(Rolling {
        travel,
        radius: entry.wheels.radius,
        distance: 0.5 * entry.wheels.distance,
        wheel: profile("vehicle.wheels.profile", wheel)?,
        rail: rail_profile,
        rail_distance: 0.5 * rail.gauge - face,
        hertz: Hertz::new(&material),
        damping: contact.damping,
        creep: CreepModel {
            law: match contact.creep {
                scene::Creep::Frictionless => CreepLaw::Frictionless,
                scene::Creep::Saturated => CreepLaw::Saturated,
                scene::Creep::Fastsim => CreepLaw::Fastsim(Fastsim { strips: 10, cells: 10 }),
                scene::Creep::Polach => CreepLaw::Polach,
            },
            friction: contact.friction,
            shear_modulus: contact.shear_modulus,
            coefficients: KalkerCoefficients::new(contact.poisson),
        },
    })
}

/// Outward coordinate of the gauge face, m: the inner side of the rail [`GAUGE_DEPTH`] below the top.
fn gauge_face(rail: &Profile) -> Option<f64> {
    let [start, end] = rail.range();
    let count = 400;
    let at = |i: i32| start + (end - start) * f64::from(i) / f64::from(count);
    let height = |sigma: f64| rail.at(sigma).position.y;
    let top = (0..=count).map(|i| height(at(i))).fold(f64::NEG_INFINITY, f64::max);
    let first = (0..=count).find(|&i| height(at(i)) >= top - GAUGE_DEPTH)?;
    if first == 0 {
        return None;
    }
    let (mut low, mut high) = (at(first - 1), at(first));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if height(middle) < top - GAUGE_DEPTH {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(rail.at(high).position.x)
}

/// Name of one of several equal bodies.
fn numbered(body: &VehicleBody, i: usize) -> String {
    if body.positions.len() == 1 {
        body.name.clone()
    } else {
        format!("{} {}", body.name, i + 1)
    }
}
