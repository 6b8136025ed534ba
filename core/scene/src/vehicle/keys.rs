//! The keys of `[vehicle]`.

use super::{
    BearingEntry, BushingEntry, GivenMotion, Kind, Pivot, Stop, Train, Vehicle, VehicleBody, WheelContact, Wheels,
};
use crate::keys::{Entry, Keys, Length, Number, Sentences, placeholder};

impl Entry for Vehicle {
    const SENTENCES: Sentences = &[
        (
            "model",
            "Given motion of the base, bodies in the plane along the track, or bodies on wheels that roll on rails.",
        ),
        ("motion", "Motion of the base relative to straight travel."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let kind = was.map(|vehicle| match vehicle {
            Self::RigidMotion(_) => Kind::RigidMotion,
            Self::Vertical(_) => Kind::Vertical,
            Self::Full(_) => Kind::Full,
        });
        let names = <Kind as crate::choice::Choice>::NAMES;
        let unavailable = <Kind as crate::choice::Choice>::UNAVAILABLE;
        let kind = keys.word_among("model", kind, names, unavailable, None);
        let train = was.and_then(Self::train);
        if keys.describes() {
            let motion = keys.only("`model = \"rigid_motion\"`", |keys| keys.inline_table("motion", None));
            keys.only("`model = \"vertical\"` or `\"full\"`", |keys| keys.part::<Train>(None));
            return Self::RigidMotion(motion);
        }
        match kind {
            Some(Kind::RigidMotion) => {
                let motion = was.and_then(|vehicle| match vehicle {
                    Self::RigidMotion(motion) => Some(motion),
                    _ => None,
                });
                Self::RigidMotion(keys.inline_table("motion", motion))
            }
            Some(Kind::Vertical) => Self::Vertical(keys.part(train)),
            Some(Kind::Full) => Self::Full(keys.part(train)),
            None => {
                keys.abandon();
                Self::RigidMotion(placeholder())
            }
        }
    }
}

impl Entry for GivenMotion {
    const SENTENCES: Sentences = &[
        (
            "file",
            "Path of a CSV file with the lists as columns, relative to the scene file.",
        ),
        (
            "time",
            "Times, ascending; the base rests before the first and after the last one.",
        ),
        ("x", "Displacement along the track; 0 where left out."),
        ("y", "Lateral displacement, positive to the left; 0 where left out."),
        ("z", "Rise; 0 where left out."),
        ("roll", "Roll angle, positive lowers the right side; 0 where left out."),
        ("pitch", "Pitch angle, positive lowers the front; 0 where left out."),
        (
            "yaw",
            "Yaw angle, positive turns the front to the left; 0 where left out.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let file = was.map(|motion| motion.file.as_deref());
        if let file @ Some(_) = keys.column_file(file, &Self::COLUMNS) {
            return Self {
                file,
                ..Self::default()
            };
        }
        let time = keys.numbers(
            "time",
            was.map(|motion| motion.time.as_slice()),
            Number::any("s"),
            Length::NotEmpty,
        );
        let n = time.len();
        let mut list = |name: &str, was: Option<&[f64]>, unit| keys.column(name, was, unit, n);
        Self {
            x: list("x", was.map(|motion| motion.x.as_slice()), "m"),
            y: list("y", was.map(|motion| motion.y.as_slice()), "m"),
            z: list("z", was.map(|motion| motion.z.as_slice()), "m"),
            roll: list("roll", was.map(|motion| motion.roll.as_slice()), "rad"),
            pitch: list("pitch", was.map(|motion| motion.pitch.as_slice()), "rad"),
            yaw: list("yaw", was.map(|motion| motion.yaw.as_slice()), "rad"),
            time,
            file: None,
        }
    }
}

/// Tables of a list that may be left out.
fn optional_tables<T: Entry>(keys: &mut Keys, name: &str, was: Option<&[T]>) -> Vec<T> {
    if keys.has(name, was.is_some_and(|values| !values.is_empty())) {
        keys.tables(name, was)
    } else {
        Vec::new()
    }
}

/// Three numbers that are 0 where they are left out.
fn vector_or_zero(keys: &mut Keys, name: &str, was: Option<[f64; 3]>, number: Number) -> [f64; 3] {
    if keys.has(name, was.is_some()) {
        keys.vector(name, was, number.default(0.0))
    } else {
        [0.0; 3]
    }
}

const BODIES: &str = "the name of bodies of the vehicle";

impl Entry for Train {
    const SENTENCES: Sentences = &[
        ("carrier", "Name of the body that carries the pantograph."),
        (
            "pantograph_base",
            "Base of the pantograph on it in the tabulated position.",
        ),
        ("wheels", "Wheels, two on every wheelset."),
        ("contact", "Contact of wheels and rails; only for `model = \"full\"`."),
        ("bodies", "Rigid bodies whose principal axes are those of the track."),
        ("bushings", "Spring-dampers between bodies."),
        (
            "bearings",
            "Axle bearings: stiff in all directions but about the lateral axle.",
        ),
        ("joints", "Ideal revolute joints about the vertical."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            carrier: keys.text("carrier", was.map(|train| train.carrier.as_str()), BODIES),
            pantograph_base: keys.vector(
                "pantograph_base",
                was.map(|train| train.pantograph_base),
                Number::any("m"),
            ),
            wheels: keys.table("wheels", was.map(|train| &train.wheels)),
            contact: keys.optional_inline_table("contact", was.map(|train| train.contact.as_ref())),
            bodies: keys.tables("bodies", was.map(|train| train.bodies.as_slice())),
            bushings: optional_tables(keys, "bushings", was.map(|train| train.bushings.as_slice())),
            bearings: optional_tables(keys, "bearings", was.map(|train| train.bearings.as_slice())),
            joints: optional_tables(keys, "joints", was.map(|train| train.joints.as_slice())),
        }
    }
}

impl Entry for Wheels {
    const SENTENCES: Sentences = &[
        ("wheelset", "Name of the bodies that carry the wheels."),
        ("radius", "Rolling radius."),
        ("distance", "Lateral distance of both nominal contact points."),
        ("stiffness", "Linearised vertical stiffness of one contact."),
        ("damping", "Vertical damping of one contact."),
        (
            "profile",
            "Cross-section from the flange outward: (outward, up) from the nominal rolling circle; only for `model \
             = \"full\"`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            wheelset: keys.text("wheelset", was.map(|wheels| wheels.wheelset.as_str()), BODIES),
            radius: keys.number("radius", was.map(|wheels| wheels.radius), Number::positive("m")),
            distance: keys.number("distance", was.map(|wheels| wheels.distance), Number::positive("m")),
            stiffness: keys.number("stiffness", was.map(|wheels| wheels.stiffness), Number::positive("N/m")),
            damping: keys.number(
                "damping",
                was.map(|wheels| wheels.damping),
                Number::not_negative("N s/m"),
            ),
            profile: optional_points(keys, "profile", was.map(|wheels| wheels.profile.as_deref())),
        }
    }
}

/// Points of a cross-section that may be left out.
fn optional_points(keys: &mut Keys, name: &str, was: Option<Option<&[[f64; 2]]>>) -> Option<Vec<[f64; 2]>> {
    keys.has(name, was.flatten().is_some())
        .then(|| keys.points(name, was.flatten(), Number::of_cross_section()))
}

impl Entry for WheelContact {
    const SENTENCES: Sentences = &[
        ("shear_modulus", "Shear modulus of wheel and rail."),
        ("poisson", "Poisson's ratio of both."),
        ("damping", "Damping of the normal force per penetration."),
        ("friction", "Friction coefficient."),
        ("creep", "Creep force law."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            shear_modulus: keys.number(
                "shear_modulus",
                was.map(|contact| contact.shear_modulus),
                Number::positive("Pa"),
            ),
            poisson: keys.number("poisson", was.map(|contact| contact.poisson), Number::between(0.0, 0.5)),
            damping: keys.number(
                "damping",
                was.map(|contact| contact.damping),
                Number::not_negative("N s/m²"),
            ),
            friction: keys.number(
                "friction",
                was.map(|contact| contact.friction),
                Number::not_negative(""),
            ),
            creep: keys.word("creep", was.map(|contact| contact.creep), None),
        }
    }
}

impl Entry for VehicleBody {
    const SENTENCES: Sentences = &[
        ("name", "Unique name."),
        ("mass", "Mass of one body."),
        ("inertia", "Principal moments of inertia about the centre of mass."),
        ("positions", "Centres of mass, one body for each."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            name: keys.text("name", was.map(|body| body.name.as_str()), "a name"),
            mass: keys.number("mass", was.map(|body| body.mass), Number::positive("kg")),
            inertia: keys.vector("inertia", was.map(|body| body.inertia), Number::positive("kg m²")),
            positions: keys.points("positions", was.map(|body| body.positions.as_slice()), Number::any("m")),
        }
    }
}

impl Entry for BushingEntry {
    const SENTENCES: Sentences = &[
        ("name", "Name in reports."),
        ("first", "Name of bodies; forces act along their axes."),
        ("second", "Name of other bodies."),
        (
            "points",
            "Places in the tabulated position, one bushing for each between the nearest bodies of both names.",
        ),
        (
            "orientation",
            "Euler angles of its axes in the sequence Z-X-Z; 0 where left out.",
        ),
        ("stiffness", "Stiffness along its axes."),
        ("damping", "Damping along its axes; 0 where left out."),
        ("rotational_stiffness", "Stiffness about its axes; 0 where left out."),
        ("rotational_damping", "Damping about its axes; 0 where left out."),
        (
            "preload",
            "Force on the second body in the tabulated position; 0 where left out.",
        ),
        ("stop", "Characteristic beside the linear stiffness of one axis."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let [spring, damper] = [Number::not_negative("N/m"), Number::not_negative("N s/m")];
        let [turning, turning_damper] = [Number::not_negative("N m/rad"), Number::not_negative("N m s/rad")];
        Self {
            name: keys.text("name", was.map(|entry| entry.name.as_str()), "a name"),
            first: keys.text("first", was.map(|entry| entry.first.as_str()), BODIES),
            second: keys.text("second", was.map(|entry| entry.second.as_str()), BODIES),
            points: keys.points("points", was.map(|entry| entry.points.as_slice()), Number::any("m")),
            orientation: vector_or_zero(
                keys,
                "orientation",
                was.map(|entry| entry.orientation),
                Number::any("rad"),
            ),
            stiffness: keys.vector("stiffness", was.map(|entry| entry.stiffness), spring),
            damping: vector_or_zero(keys, "damping", was.map(|entry| entry.damping), damper),
            rotational_stiffness: vector_or_zero(
                keys,
                "rotational_stiffness",
                was.map(|entry| entry.rotational_stiffness),
                turning,
            ),
            rotational_damping: vector_or_zero(
                keys,
                "rotational_damping",
                was.map(|entry| entry.rotational_damping),
                turning_damper,
            ),
            preload: vector_or_zero(keys, "preload", was.map(|entry| entry.preload), Number::any("N")),
            stop: keys.optional_inline_table("stop", was.map(|entry| entry.stop.as_ref())),
        }
    }
}

impl Entry for Stop {
    const SENTENCES: Sentences = &[
        ("axis", "Axis of the bushing."),
        ("displacement", "Displacements, ascending, at least two."),
        ("force", "Force against each displacement, not falling."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let axis = keys.word("axis", was.map(|stop| stop.axis), None);
        let displacement = keys.numbers(
            "displacement",
            was.map(|stop| stop.displacement.as_slice()),
            Number::any("m"),
            Length::NotEmpty,
        );
        let length = Length::Exactly(displacement.len());
        Self {
            axis,
            force: keys.numbers("force", was.map(|stop| stop.force.as_slice()), Number::any("N"), length),
            displacement,
        }
    }
}

impl Entry for BearingEntry {
    const SENTENCES: Sentences = &[
        ("first", "Name of the bodies that the axle turns in."),
        ("second", "Name of the wheelsets."),
        ("points", "Places in the tabulated position, one bearing for each."),
        ("stiffness", "Stiffness along the axes of the track."),
        ("damping", "Damping along the axes of the track; 0 where left out."),
        ("tilting_stiffness", "Stiffness about x and z."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            first: keys.text("first", was.map(|entry| entry.first.as_str()), BODIES),
            second: keys.text("second", was.map(|entry| entry.second.as_str()), BODIES),
            points: keys.points("points", was.map(|entry| entry.points.as_slice()), Number::any("m")),
            stiffness: keys.vector("stiffness", was.map(|entry| entry.stiffness), Number::positive("N/m")),
            damping: vector_or_zero(
                keys,
                "damping",
                was.map(|entry| entry.damping),
                Number::not_negative("N s/m"),
            ),
            tilting_stiffness: keys.pair(
                "tilting_stiffness",
                was.map(|entry| entry.tilting_stiffness),
                Number::not_negative("N m/rad"),
            ),
        }
    }
}

impl Entry for Pivot {
    const SENTENCES: Sentences = &[
        ("first", "Name of bodies."),
        ("second", "Name of other bodies."),
        ("points", "Places in the tabulated position, one joint for each."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            first: keys.text("first", was.map(|entry| entry.first.as_str()), BODIES),
            second: keys.text("second", was.map(|entry| entry.second.as_str()), BODIES),
            points: keys.points("points", was.map(|entry| entry.points.as_slice()), Number::any("m")),
        }
    }
}
