//! `[vehicle]`: what the pantograph stands on.

use crate::Track;
use crate::choice::choice;

mod keys;

/// `[vehicle]`.
///
/// Every pantograph stands on a vehicle of its own; they are all alike.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one per scene")]
pub enum Vehicle {
    /// `model = "rigid_motion"`: the base moves as given.
    RigidMotion(GivenMotion),
    /// `model = "vertical"`: bodies move in the plane along the track, on linear wheel springs.
    Vertical(Train),
    /// `model = "full"`: bodies move in space, on wheels that roll on rails.
    Full(Train),
}

/// `vehicle.motion`: motion of the base relative to straight travel, interpolated by a cubic spline that starts and
/// ends at rest; before the first and after the last time the base stays where it is.
///
/// It is that of a rigid body that the base is fixed to: displacements of its point at the top of rail under the base,
/// and angles about axes through that point, each positive by the right-hand rule. Roll is about the direction of
/// travel, then pitch about the lateral axis, then yaw about the vertical.
///
/// All lists have the same length; one that is left out is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenMotion {
    /// s, ascending.
    pub time: Vec<f64>,
    /// Displacement along the track, m.
    pub x: Vec<f64>,
    /// Lateral displacement, m, to the left.
    pub y: Vec<f64>,
    /// Rise, m.
    pub z: Vec<f64>,
    /// Roll angle, rad: positive lowers the right side.
    pub roll: Vec<f64>,
    /// Pitch angle, rad: positive lowers the front.
    pub pitch: Vec<f64>,
    /// Yaw angle, rad: positive turns the front to the left.
    pub yaw: Vec<f64>,
    /// File that the lists are still to be read from; its columns are called as the keys.
    pub file: Option<String>,
}

/// A vehicle of rigid bodies. Positions are in coordinates of the vehicle, whose axes are those of the track, whose z
/// is above the top of rail, and whose origin along the track is free.
#[derive(Clone, Debug, PartialEq)]
pub struct Train {
    /// The body that carries the pantograph.
    pub carrier: String,
    /// Base of the pantograph on that body in the tabulated position, m, 3 entries (x, y, z); y is from the middle of
    /// the track.
    pub pantograph_base: [f64; 3],
    /// `vehicle.wheels`.
    pub wheels: Wheels,
    /// `vehicle.contact`: between wheels and rails; only for `model = "full"`.
    pub contact: Option<WheelContact>,
    /// `[[vehicle.bodies]]`.
    pub bodies: Vec<VehicleBody>,
    /// `[[vehicle.bushings]]`.
    pub bushings: Vec<BushingEntry>,
    /// `[[vehicle.bearings]]`.
    pub bearings: Vec<BearingEntry>,
    /// `[[vehicle.joints]]`.
    pub joints: Vec<Pivot>,
}

/// `vehicle.wheels`: two wheels on every body of one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheels {
    /// Name of the bodies.
    pub wheelset: String,
    /// Rolling radius, m.
    pub radius: f64,
    /// Lateral distance of both nominal contact points, m.
    pub distance: f64,
    /// Linearised vertical stiffness of one contact, N/m.
    pub stiffness: f64,
    /// Vertical damping of one contact, N·s/m.
    pub damping: f64,
    /// Cross-section from the flange outward: (outward, up) relative to the nominal rolling circle, m; only for `model
    /// = "full"`.
    pub profile: Option<Vec<[f64; 2]>>,
}

/// `vehicle.contact`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelContact {
    /// Shear modulus of wheel and rail, Pa.
    pub shear_modulus: f64,
    /// Poisson's ratio of both, –.
    pub poisson: f64,
    /// Damping of the normal force per penetration, N·s/m².
    pub damping: f64,
    /// Friction coefficient, –.
    pub friction: f64,
    /// Creep forces.
    pub creep: Creep,
}

choice! {
    /// `vehicle.contact.creep`.
    pub enum Creep {
        /// None.
        Frictionless = "frictionless",
        /// Kalker's linear theory with the saturation of Shen, Hedrick & Elkins.
        Saturated = "saturated",
        /// Kalker's simplified theory.
        Fastsim = "fastsim",
        /// Polach's closed form.
        Polach = "polach",
    }
    unavailable: []
}

/// `[[vehicle.bodies]]`: equal rigid bodies whose principal axes are those of the track.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleBody {
    /// Unique name.
    pub name: String,
    /// kg, positive.
    pub mass: f64,
    /// Principal moments of inertia (Ixx, Iyy, Izz) about the centre of mass, kg·m², positive.
    pub inertia: [f64; 3],
    /// Centres of mass, m, one body for each.
    pub positions: Vec<[f64; 3]>,
}

/// `[[vehicle.bushings]]`: equal spring–dampers, one at each of the points, between the bodies of both names that are
/// nearest to it.
#[derive(Clone, Debug, PartialEq)]
pub struct BushingEntry {
    /// Name in reports.
    pub name: String,
    /// Name of bodies; forces act along their axes.
    pub first: String,
    /// Name of other bodies.
    pub second: String,
    /// m, in the tabulated position.
    pub points: Vec<[f64; 3]>,
    /// Euler angles (φ, θ, ψ) of its axes, rad, in the sequence Z-X-Z as for bodies of a linkage; 0 by default.
    pub orientation: [f64; 3],
    /// N/m.
    pub stiffness: [f64; 3],
    /// N·s/m; 0 by default.
    pub damping: [f64; 3],
    /// N·m/rad; 0 by default.
    pub rotational_stiffness: [f64; 3],
    /// N·m·s/rad; 0 by default.
    pub rotational_damping: [f64; 3],
    /// Force on the second body in the tabulated position, N; 0 by default.
    pub preload: [f64; 3],
    /// A characteristic beside the linear stiffness of one axis.
    pub stop: Option<Stop>,
}

/// `stop` of a bushing: force against displacement of one axis, from points.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Which axis of the bushing.
    pub axis: Axis,
    /// m, ascending.
    pub displacement: Vec<f64>,
    /// N, not falling: the force against the displacement.
    pub force: Vec<f64>,
}

choice! {
    /// An axis of a bushing.
    pub enum Axis {
        /// The first one.
        X = "x",
        /// The second one.
        Y = "y",
        /// The third one.
        Z = "z",
    }
    unavailable: []
}

/// `[[vehicle.bearings]]`: bearings of axles, one at each of the points: stiff in all directions but about the axle,
/// which is lateral.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingEntry {
    /// Name of the bodies that the axle turns in.
    pub first: String,
    /// Name of the wheelsets.
    pub second: String,
    /// m, in the tabulated position.
    pub points: Vec<[f64; 3]>,
    /// N/m, positive.
    pub stiffness: [f64; 3],
    /// N·s/m; 0 by default.
    pub damping: [f64; 3],
    /// About x and z, N·m/rad.
    pub tilting_stiffness: [f64; 2],
}

/// `[[vehicle.joints]]`: ideal revolute joints about the vertical, one at each of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Pivot {
    /// Name of bodies.
    pub first: String,
    /// Name of other bodies.
    pub second: String,
    /// m, in the tabulated position.
    pub points: Vec<[f64; 3]>,
}

impl Vehicle {
    /// The word of `vehicle.model`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::RigidMotion(_) => Kind::RigidMotion.name(),
            Self::Vertical(_) => Kind::Vertical.name(),
            Self::Full(_) => Kind::Full.name(),
        }
    }

    /// Why the pantograph's base may leave the plane along the track; `None` where it cannot: a symmetric vehicle on
    /// rails that are alike has nothing that would push it to one side rather than to the other.
    #[must_use]
    pub fn leaves_the_plane(&self, track: Option<&Track>) -> Option<&'static str> {
        let moves = |values: &Vec<f64>| values.iter().any(|value| *value != 0.0);
        match self {
            Self::RigidMotion(motion) if [&motion.y, &motion.roll, &motion.yaw].into_iter().any(moves) => {
                Some("vehicle.motion moves the strip sideways, tilts or turns it")
            }
            Self::Full(train) if !train.is_symmetric() => {
                Some("the vehicle is not symmetric to the plane along the track")
            }
            Self::Full(_) if track.is_some_and(|track| !track.curves.is_empty()) => {
                Some("track.curve makes the vehicle sway and roll")
            }
            Self::Full(_) if track.is_some_and(|track| !track.is_symmetric()) => {
                Some("track.irregularities make the vehicle sway and roll")
            }
            Self::RigidMotion(_) | Self::Vertical(_) | Self::Full(_) => None,
        }
    }

    /// The bodies and what joins them, where there are any.
    #[must_use]
    pub fn train(&self) -> Option<&Train> {
        match self {
            Self::RigidMotion(_) => None,
            Self::Vertical(train) | Self::Full(train) => Some(train),
        }
    }
}

impl GivenMotion {
    /// The lists by their keys, which are also the columns of `file`.
    pub(crate) const COLUMNS: [&str; 7] = ["time", "x", "y", "z", "roll", "pitch", "yaw"];

    /// From the lists, in the order of [`GivenMotion::COLUMNS`].
    pub(crate) fn of_columns([time, x, y, z, roll, pitch, yaw]: [Vec<f64>; 7]) -> Self {
        Self {
            time,
            x,
            y,
            z,
            roll,
            pitch,
            yaw,
            file: None,
        }
    }
}

impl Train {
    /// The body called `name`.
    #[must_use]
    pub fn body(&self, name: &str) -> Option<&VehicleBody> {
        self.bodies.iter().find(|body| body.name == name)
    }

    /// How far the foremost wheel runs ahead of the pantograph's base, m; negative behind it.
    #[must_use]
    pub fn foremost_wheel(&self) -> f64 {
        let wheels = self.body(&self.wheels.wheelset);
        let places = wheels.iter().flat_map(|body| &body.positions);
        let foremost = places.fold(f64::NEG_INFINITY, |most, position| most.max(position[0]));
        foremost - self.pantograph_base[0]
    }

    /// True where everything is symmetric to the plane along the track: each point beside the plane has its mirror
    /// image.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        let mirrored = |points: &[[f64; 3]]| {
            let image = |[x, y, z]: [f64; 3]| points.contains(&[x, -y, z]);
            points.iter().all(|&point| image(point))
        };
        let upright = |bushing: &BushingEntry| {
            let stop = bushing.stop.as_ref().filter(|stop| stop.axis == Axis::Y);
            let odd = |stop: &Stop| {
                let entries = || stop.displacement.iter().zip(&stop.force);
                entries().all(|(s, f)| entries().any(|(other, force)| *other == -s && *force == -f))
            };
            bushing.orientation == [0.0; 3] && bushing.preload[1] == 0.0 && stop.is_none_or(odd)
        };
        self.pantograph_base[1] == 0.0
            && self.bodies.iter().all(|body| mirrored(&body.positions))
            && self
                .bushings
                .iter()
                .all(|entry| mirrored(&entry.points) && upright(entry))
            && self.bearings.iter().all(|entry| mirrored(&entry.points))
            && self.joints.iter().all(|entry| mirrored(&entry.points))
    }

    /// Number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.iter().map(|body| body.positions.len()).sum()
    }
}

impl VehicleBody {
    /// Which of the bodies is nearest to a point, from 0.
    #[must_use]
    pub fn nearest(&self, point: &[f64; 3]) -> usize {
        let distance = |i: usize| -> f64 { (0..3).map(|k| (self.positions[i][k] - point[k]).powi(2)).sum() };
        (0..self.positions.len())
            .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0)
    }
}

choice! {
    /// The words of `vehicle.model`.
    pub(crate) enum Kind {
        RigidMotion = "rigid_motion",
        Vertical = "vertical",
        Full = "full",
    }
    unavailable: []
}
