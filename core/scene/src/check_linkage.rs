//! Checks of bodies and joints: they make a mechanism that can carry a strip.

use crate::check::{Found, check_inertia, refuse};
use crate::write::shown_number;
use crate::{Body, Joint, JointKind, Linkage};

/// Below this a length in m is zero.
const NO_LENGTH: f64 = 1e-9;

/// Largest deviation of the cosine of an upright axis from 1, –: a milliradian.
const UPRIGHT: f64 = 1e-6;

impl Linkage {
    pub(crate) fn check(&self, path: &str, found: &mut Found) {
        crate::head::check(&self.strips, None, path, found);
        if let Some(sprung) = self.strips.iter().position(|strip| strip.spring.is_some()) {
            let expected = "must be left out: strips of a linkage are fixed to its head; strips on springs of their \
                            own need model = \"lumped\"";
            refuse(found, format!("{path}.strips[{}].mass", sprung + 1), "given", expected);
        }
        self.check_bodies(path, found);
        self.check_joints(path, found);
        for (key, name) in [("strip.body", &self.strip.body), ("uplift.body", &self.uplift.body)] {
            if self.body(name).is_none() {
                refuse(found, format!("{path}.{key}"), format!("{name:?}"), self.names());
            }
        }
        // What follows walks from body to body by name.
        if found.is_empty() {
            self.check_upright(path, found);
            self.check_mobility(path, found);
            self.check_collector_suspension(path, found);
            self.check_uplift(path, found);
        }
    }

    /// The third axis of the strip's body points up from its horns.
    fn check_upright(&self, path: &str, found: &mut Found) {
        let Some(body) = self.body(&self.strip.body).filter(|_| self.strip.horns.is_some()) else {
            return;
        };
        let [_, across, up] = body.rotation();
        if (across[1] - 1.0).abs().max((up[2] - 1.0).abs()) > UPRIGHT {
            let expected = format!(
                "must be left out, or orientation of {:?} be such that its second axis is lateral and its third one \
                 upright, as [0, 0, 0] is: horns fall from the strip against the third axis of its body",
                self.strip.body
            );
            refuse(found, format!("{path}.strip.horns"), "{ … }", expected);
        }
    }

    /// Names that a body may have, in a message.
    fn names(&self) -> String {
        let names: Vec<String> = self.bodies.iter().map(|body| format!("{:?}", body.name)).collect();
        format!("no such body: must be one of {}", names.join(", "))
    }

    fn check_bodies(&self, path: &str, found: &mut Found) {
        for (i, body) in self.bodies.iter().enumerate() {
            let path = format!("{path}.bodies[{}]", i + 1);
            if body.name == Self::BASE {
                let expected = "is taken by what the mechanism stands on: must be another name";
                refuse(found, format!("{path}.name"), format!("{:?}", body.name), expected);
            }
            if self.bodies[..i].iter().any(|other| other.name == body.name) {
                let expected = "must be unique: another body has this name";
                refuse(found, format!("{path}.name"), format!("{:?}", body.name), expected);
            }
            // The last printed digit.
            check_inertia(found, &path, &body.inertia, 1e-9);
        }
    }

    fn check_joints(&self, path: &str, found: &mut Found) {
        for (i, joint) in self.joints.iter().enumerate() {
            let path = format!("{path}.joints[{}]", i + 1);
            for (key, name) in [("first", &joint.first), ("second", &joint.second)] {
                if name != Self::BASE && self.body(name).is_none() {
                    let expected = format!("{}, or \"{}\"", self.names(), Self::BASE);
                    refuse(found, format!("{path}.{key}"), format!("{name:?}"), expected);
                }
            }
            if joint.first == joint.second {
                let expected = format!("must differ from first = {:?}", joint.first);
                refuse(found, format!("{path}.second"), format!("{:?}", joint.second), expected);
            }
            if let JointKind::Revolute { axis } | JointKind::Prismatic { axis } = joint.kind
                && length(axis) < NO_LENGTH
            {
                refuse(
                    found,
                    format!("{path}.axis"),
                    format!("{axis:?}"),
                    "must have a direction: not all zero",
                );
            }
        }
    }

    /// Every body must hang together with the base, and something must be able to move.
    fn check_mobility(&self, path: &str, found: &mut Found) {
        let mut reached = vec![Self::BASE];
        while let Some(next) = self.joints.iter().find_map(|joint| {
            let (first, second) = (joint.first.as_str(), joint.second.as_str());
            match (reached.contains(&first), reached.contains(&second)) {
                (true, false) => Some(second),
                (false, true) => Some(first),
                _ => None,
            }
        }) {
            reached.push(next);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            if !reached.contains(&body.name.as_str()) {
                let expected = "must be joined to the base, directly or through other bodies";
                refuse(
                    found,
                    format!("{path}.bodies[{}].name", i + 1),
                    format!("{:?}", body.name),
                    expected,
                );
            }
        }
        let free = 6 * self.bodies.len();
        let held: usize = self.joints.iter().map(|joint| joint.kind.constraints()).sum();
        if held >= free {
            let expected = format!("hold {held} of the bodies' {free} motions, must leave at least one free");
            refuse(
                found,
                format!("{path}.joints"),
                format!("{} joints", self.joints.len()),
                expected,
            );
        }
    }

    fn check_collector_suspension(&self, path: &str, found: &mut Found) {
        let guides = self.guides().count();
        if guides != 1 {
            let expected = format!(
                "must have exactly one prismatic joint, along which collector_suspension acts, and has {guides}"
            );
            refuse(
                found,
                format!("{path}.strip.body"),
                format!("{:?}", self.strip.body),
                expected,
            );
        }
    }

    fn check_uplift(&self, path: &str, found: &mut Found) {
        let key = format!("{path}.uplift.body");
        let name = format!("{:?}", self.uplift.body);
        match (self.uplift_joint(), self.body(&self.uplift.body)) {
            (Some(joint), Some(body)) => {
                let arm = [0, 1, 2].map(|i| body.position[i] - joint.point[i]);
                if length(arm) < NO_LENGTH {
                    let expected = "must have its centre of mass away from its joint with the base, or there is no \
                                    direction to measure uplift.distance in";
                    refuse(found, key, name, expected);
                } else if self.uplift.distance > 2.0 * length(arm) * (1.0 + NO_LENGTH) {
                    let expected = format!(
                        "must be at most {} m, twice the way from the base joint to the centre of mass of {name}",
                        2.0 * length(arm)
                    );
                    refuse(
                        found,
                        format!("{path}.uplift.distance"),
                        shown_number(self.uplift.distance, "m"),
                        expected,
                    );
                }
            }
            _ => refuse(
                found,
                key,
                name,
                "must have a joint with the base, from which uplift.distance is measured",
            ),
        }
    }

    fn guides(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| {
            matches!(joint.kind, JointKind::Prismatic { .. })
                && (joint.first == self.strip.body || joint.second == self.strip.body)
        })
    }

    /// The prismatic joint that guides the strip's body, along which the collector suspension acts.
    #[must_use]
    pub fn collector_guide(&self) -> Option<&Joint> {
        self.guides().next()
    }

    /// The joint with the base from which `uplift.distance` is measured.
    #[must_use]
    pub fn uplift_joint(&self) -> Option<&Joint> {
        let joins = |joint: &&Joint, a: &str, b: &str| joint.first == a && joint.second == b;
        self.joints
            .iter()
            .find(|joint| joins(joint, Self::BASE, &self.uplift.body) || joins(joint, &self.uplift.body, Self::BASE))
    }

    /// Point of the uplift in the tabulated position, m: `uplift.distance` from its joint with the base, towards the
    /// centre of mass of its body and beyond.
    #[must_use]
    pub fn uplift_point(&self) -> Option<[f64; 3]> {
        let (joint, body): (&Joint, &Body) = (self.uplift_joint()?, self.body(&self.uplift.body)?);
        let arm = [0, 1, 2].map(|i| body.position[i] - joint.point[i]);
        let share = self.uplift.distance / length(arm);
        Some([0, 1, 2].map(|i| joint.point[i] + share * arm[i]))
    }
}

impl JointKind {
    /// How many of the six relative motions it holds.
    #[must_use]
    pub fn constraints(self) -> usize {
        match self {
            Self::Revolute { .. } | Self::Prismatic { .. } => 5,
            Self::Spherical => 3,
        }
    }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
