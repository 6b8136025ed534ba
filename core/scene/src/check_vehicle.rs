//! Checks of bodies, bushings and wheels: they make a vehicle that has a track to run on.

use crate::check::{Found, check_inertia, refuse};
use crate::curve;
use crate::error::What;
use crate::write::shown_number;
use crate::{
    Formulation, GivenMotion, Irregularities, Pantograph, PantographModel, Points, Scene, Spectrum, Stop, Train,
    Vehicle,
};

impl Scene {
    pub(crate) fn check_vehicle(&self, found: &mut Found) {
        match self.vehicle.as_deref() {
            None | Some(Vehicle::RigidMotion(_)) if self.track.is_some() => {
                let because = "no wheel runs on it: it belongs to vehicle.model = \"vertical\" or \"full\"".to_owned();
                found.push(("track".to_owned(), What::LeaveOut { because }));
            }
            _ => {}
        }
        match self.vehicle.as_deref() {
            Some(Vehicle::RigidMotion(motion)) => motion.check(found),
            Some(Vehicle::Vertical(train) | Vehicle::Full(train)) => train.check(found),
            None => {}
        }
        let curved = self.track.as_deref().is_some_and(|track| !track.curves.is_empty());
        if let (Some(Vehicle::Vertical(_)), true) = (self.vehicle.as_deref(), curved) {
            let because = "the bodies of vehicle.model = \"vertical\" stay in the plane along the track, which is \
                           straight; a curve needs \
                           vehicle.model = \"full\""
                .to_owned();
            found.push(("track.curve".to_owned(), What::LeaveOut { because }));
        }
        if let Some(Vehicle::Full(train)) = self.vehicle.as_deref() {
            curve::check(self, train, found);
            let rail = self.track.as_deref().is_some_and(|track| track.rail.is_some());
            let needed = [
                (
                    "vehicle.contact",
                    train.contact.is_some(),
                    "a table with the material, friction and creep law",
                ),
                (
                    "vehicle.wheels.profile",
                    train.wheels.profile.is_some(),
                    "a list of points [outward, up] in m",
                ),
                ("track.rail", rail, "a table with gauge, inclination and profile"),
            ];
            for (key, _, expected) in needed.into_iter().filter(|(_, is_there, _)| !is_there) {
                let expected = format!("{expected}, since vehicle.model is \"full\"");
                found.push((key.to_owned(), What::Missing { expected }));
            }
        }
        let moved = matches!(self.vehicle.as_deref(), Some(Vehicle::RigidMotion(_)));
        let jointed = |pantograph: &Pantograph| matches!(pantograph.model, PantographModel::Linkage(_));
        if moved && self.solver.formulation == Formulation::Index1Baumgarte && self.pantographs.iter().any(jointed) {
            let expected =
                "must be \"index_3\": the joints of a linkage on a base with vehicle.motion change with time";
            let value = format!("{:?}", self.solver.formulation.name());
            refuse(found, "solver.formulation", value, expected);
        }
        match self.track.as_deref().map(|track| &track.irregularities) {
            Some(Irregularities::Spectrum(spectrum)) => spectrum.check(found),
            Some(Irregularities::Points(points)) => points.check(found),
            Some(Irregularities::None) | None => {}
        }
    }
}

/// Refuses a list whose entries do not ascend.
fn check_ascending(found: &mut Found, key: &str, values: &[f64], unit: &str) {
    for (i, pair) in values.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let expected = format!(
                "must be greater than the entry before it, {}",
                shown_number(pair[0], unit)
            );
            refuse(
                found,
                format!("{key}[{}]", i + 2),
                shown_number(pair[1], unit),
                expected,
            );
        }
    }
}

/// Largest angle of a given motion, rad: far more than any vehicle has on rails, and less than what was meant in
/// degrees.
const STEEPEST: f64 = 0.5;

impl GivenMotion {
    fn check(&self, found: &mut Found) {
        check_ascending(found, "vehicle.motion.time", &self.time, "s");
        for (name, angles) in [("roll", &self.roll), ("pitch", &self.pitch), ("yaw", &self.yaw)] {
            for (i, &angle) in angles.iter().enumerate().filter(|(_, angle)| angle.abs() > STEEPEST) {
                let key = format!("vehicle.motion.{name}[{}]", i + 1);
                let expected =
                    format!("must be between -{STEEPEST} and {STEEPEST} rad: it is the angle of a vehicle on rails");
                refuse(found, key, shown_number(angle, "rad"), expected);
            }
        }
    }
}

impl Spectrum {
    fn check(&self, found: &mut Found) {
        let [shortest, longest] = self.wavelengths;
        if longest <= shortest {
            let expected = "must be the shortest and the longest wavelength, in this order";
            refuse(
                found,
                "track.irregularities.wavelengths",
                format!("[{shortest}, {longest}] m"),
                expected,
            );
        }
    }
}

impl Points {
    fn check(&self, found: &mut Found) {
        check_ascending(found, "track.irregularities.x", &self.x, "m");
    }
}

impl Train {
    fn check(&self, found: &mut Found) {
        for (i, body) in self.bodies.iter().enumerate() {
            // The bolster of [Thesis, Table 1] is 4 % beyond.
            check_inertia(found, &format!("vehicle.bodies[{}]", i + 1), &body.inertia, 0.05);
            if self.bodies[..i].iter().any(|other| other.name == body.name) {
                let expected = "must be unique: other bodies have this name; equal bodies are entries of positions";
                refuse(
                    found,
                    format!("vehicle.bodies[{}].name", i + 1),
                    format!("{:?}", body.name),
                    expected,
                );
            }
        }
        self.check_name("vehicle.carrier", &self.carrier, found);
        self.check_name("vehicle.wheels.wheelset", &self.wheels.wheelset, found);
        for (i, entry) in self.bushings.iter().enumerate() {
            let path = format!("vehicle.bushings[{}]", i + 1);
            self.check_pair(&path, [&entry.first, &entry.second], found);
            if let Some(stop) = &entry.stop {
                stop.check(&format!("{path}.stop"), found);
            }
        }
        for (i, entry) in self.bearings.iter().enumerate() {
            let path = format!("vehicle.bearings[{}]", i + 1);
            self.check_pair(&path, [&entry.first, &entry.second], found);
            if entry.second != self.wheels.wheelset {
                let expected = format!("must be the wheelsets, {:?}", self.wheels.wheelset);
                refuse(found, format!("{path}.second"), format!("{:?}", entry.second), expected);
            }
        }
        for (i, entry) in self.joints.iter().enumerate() {
            let path = format!("vehicle.joints[{}]", i + 1);
            self.check_pair(&path, [&entry.first, &entry.second], found);
        }
        let places = self.bodies.iter().find(|body| body.name == self.carrier);
        if places.is_some_and(|body| body.positions.len() != 1) {
            let expected = "must be a body that there is one of: it carries the pantograph and keeps the speed";
            refuse(found, "vehicle.carrier", format!("{:?}", self.carrier), expected);
        }
        self.check_hanging_together(found);
    }

    fn check_name(&self, key: &str, name: &str, found: &mut Found) {
        if self.body(name).is_none() {
            let names: Vec<String> = self.bodies.iter().map(|body| format!("{:?}", body.name)).collect();
            let expected = format!("no such bodies: must be one of {}", names.join(", "));
            refuse(found, key, format!("{name:?}"), expected);
        }
    }

    fn check_pair(&self, path: &str, [first, second]: [&str; 2], found: &mut Found) {
        self.check_name(&format!("{path}.first"), first, found);
        self.check_name(&format!("{path}.second"), second, found);
        if first == second {
            let expected = format!("must differ from first = {first:?}");
            refuse(found, format!("{path}.second"), format!("{second:?}"), expected);
        }
    }

    /// Every body must be joined to the others by something.
    fn check_hanging_together(&self, found: &mut Found) {
        let mut links: Vec<[&str; 2]> = Vec::new();
        links.extend(self.bushings.iter().map(|entry| [entry.first.as_str(), &entry.second]));
        links.extend(self.bearings.iter().map(|entry| [entry.first.as_str(), &entry.second]));
        links.extend(self.joints.iter().map(|entry| [entry.first.as_str(), &entry.second]));
        let mut reached = vec![self.carrier.as_str()];
        while let Some(next) = links
            .iter()
            .find_map(|[a, b]| match (reached.contains(a), reached.contains(b)) {
                (true, false) => Some(*b),
                (false, true) => Some(*a),
                _ => None,
            })
        {
            reached.push(next);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            if !reached.contains(&body.name.as_str()) {
                let expected = format!("must be joined to {:?}, directly or through other bodies", self.carrier);
                refuse(
                    found,
                    format!("vehicle.bodies[{}].name", i + 1),
                    format!("{:?}", body.name),
                    expected,
                );
            }
        }
    }
}

impl Stop {
    fn check(&self, path: &str, found: &mut Found) {
        if self.displacement.len() < 2 {
            let expected = "must have two entries or more";
            refuse(
                found,
                format!("{path}.displacement"),
                format!("{:?} m", self.displacement),
                expected,
            );
        }
        check_ascending(found, &format!("{path}.displacement"), &self.displacement, "m");
        for (i, pair) in self.force.windows(2).enumerate() {
            if pair[1] < pair[0] {
                let expected = format!(
                    "must not be less than the entry before it, {} N: it is the force against the displacement",
                    pair[0]
                );
                refuse(
                    found,
                    format!("{path}.force[{}]", i + 2),
                    shown_number(pair[1], "N"),
                    expected,
                );
            }
        }
    }
}
