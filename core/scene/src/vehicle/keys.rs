//! The keys of `[vehicle]`.

use super::{
    BearingEntry, BushingEntry, GivenMotion, Kind, Pivot, Stop, Train, Vehicle, VehicleBody, WheelContact, Wheels,
};
use crate::keys::{Entry, Keys, Length, Number, placeholder};

impl Entry for Vehicle {
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
        match kind {
            Some(Kind::RigidMotion) => {
                let motion = was.and_then(|vehicle| match vehicle {
                    Self::RigidMotion(motion) => Some(motion),
                    _ => None,
                });
                Self::RigidMotion(keys.inline_table("motion", motion))
            }
            Some(Kind::Vertical) => Self::Vertical(Train::entry(keys, train)),
            Some(Kind::Full) => Self::Full(Train::entry(keys, train)),
            None => {
                keys.abandon();
                Self::RigidMotion(placeholder())
            }
        }
    }
}

impl Entry for GivenMotion {
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
        keys.vector(name, was, number)
    } else {
        [0.0; 3]
    }
}

const BODIES: &str = "the name of bodies of the vehicle";

impl Entry for Train {
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
        .then(|| keys.points(name, was.flatten(), Number::any("m")))
}

impl Entry for WheelContact {
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
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            first: keys.text("first", was.map(|entry| entry.first.as_str()), BODIES),
            second: keys.text("second", was.map(|entry| entry.second.as_str()), BODIES),
            points: keys.points("points", was.map(|entry| entry.points.as_slice()), Number::any("m")),
        }
    }
}
