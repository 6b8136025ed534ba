//! Mechanisms with only one motion that a contact force can excite.

use crate::{JointKind, Linkage, PantographModel, Scene};

/// Below this an angle (rad), a length (m) or a ratio of inertias is zero.
const NOTHING: f64 = 1e-9;

/// Lowest share of the vertical in the axis of the collector suspension.
const UPRIGHT: f64 = 0.7;

impl Linkage {
    /// Why the mechanism may move otherwise than by one motion in its plane and the collector suspension; `None` where
    /// these two are all that a force on the strip can excite, in whatever direction and wherever on the strip it acts.
    ///
    /// The mechanism is then symmetric to the plane through its middle along the track, so that only a lateral force
    /// could make it leave the plane; and revolute and prismatic joints between base and strip hold the latter in the
    /// plane, so that lateral forces and rolling moments on it do no work. Bars between two spherical joints may spin
    /// about themselves: nothing turns them.
    #[must_use]
    pub fn motions_beyond_one(&self) -> Option<String> {
        self.out_of_plane()
            .or_else(|| self.strip_not_held())
            .or_else(|| self.other_motions())
    }

    /// Part that is not symmetric to the plane.
    fn out_of_plane(&self) -> Option<String> {
        let middle = self.base[1];
        for body in &self.bodies {
            if (body.position[1] - middle).abs() > NOTHING {
                return Some(format!("the centre of mass of \"{}\" is beside the middle", body.name));
            }
            let rows = body.rotation();
            let product = |row: usize, column: usize| -> f64 {
                (0..3).map(|k| rows[row][k] * rows[column][k] * body.inertia[k]).sum()
            };
            let trace: f64 = body.inertia.iter().sum();
            if product(0, 1).abs().max(product(1, 2).abs()) > NOTHING * trace {
                return Some(format!(
                    "the lateral axis of \"{}\" is not one of its principal axes",
                    body.name
                ));
            }
        }
        for (i, joint) in self.joints.iter().enumerate() {
            let number = i + 1;
            if (joint.point[1] - middle).abs() > NOTHING {
                return Some(format!("joints[{number}].point is beside the middle"));
            }
            // Length of the part of the axis that would have to vanish.
            let astray = |axis: [f64; 3], part: f64| part / axis.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            match joint.kind {
                JointKind::Revolute { axis } if astray(axis, axis[0].hypot(axis[2])) > NOTHING => {
                    return Some(format!("joints[{number}].axis of the revolute joint is not lateral"));
                }
                JointKind::Prismatic { axis } if astray(axis, axis[1].abs()) > NOTHING => {
                    return Some(format!(
                        "joints[{number}].axis of the prismatic joint has a lateral part"
                    ));
                }
                _ => {}
            }
        }
        None
    }

    /// Why the strip may leave the plane.
    fn strip_not_held(&self) -> Option<String> {
        let mut held = vec![Self::BASE];
        while let Some(next) = self.joints.iter().find_map(|joint| {
            let (first, second) = (joint.first.as_str(), joint.second.as_str());
            match (joint.kind, held.contains(&first), held.contains(&second)) {
                (JointKind::Spherical, ..) => None,
                (_, true, false) => Some(second),
                (_, false, true) => Some(first),
                _ => None,
            }
        }) {
            held.push(next);
        }
        let strip = self.strip.body.as_str();
        if !held.contains(&strip) {
            return Some(format!(
                "\"{strip}\" may leave the plane: revolute and prismatic joints alone do not join it to the base"
            ));
        }
        let joints = self
            .joints
            .iter()
            .filter(|joint| joint.first == strip || joint.second == strip);
        if joints.count() != 1 {
            return Some(format!(
                "\"{strip}\" has other joints than the guide of the collector suspension"
            ));
        }
        match self.collector_guide().map(|joint| (joint, joint.kind)) {
            Some((joint, JointKind::Prismatic { axis })) => {
                if joint.first == Self::BASE || joint.second == Self::BASE {
                    return Some("the collector suspension stands on the base".to_owned());
                }
                (axis[2].abs() < UPRIGHT * axis[0].hypot(axis[2]))
                    .then(|| "the axis of the collector suspension is far from vertical".to_owned())
            }
            _ => Some(format!("\"{strip}\" has no prismatic joint")),
        }
    }

    /// How many motions the joints leave in the plane, where these are not two.
    fn other_motions(&self) -> Option<String> {
        let (coordinates, held) = (3 * self.bodies.len(), 2 * self.joints.len());
        (coordinates != held + 2).then(|| {
            format!(
                "{} joints hold {held} of the bodies' {coordinates} motions in the plane, not all but two",
                self.joints.len()
            )
        })
    }
}

impl Scene {
    /// Why the linkages cannot be reduced to one motion each; `None` where this changes nothing.
    #[must_use]
    pub fn linkage_not_reducible(&self) -> Option<String> {
        let linkages = self.pantographs.iter().enumerate().filter_map(|(index, pantograph)| {
            let PantographModel::Linkage(linkage) = &pantograph.model else {
                return None;
            };
            Some((index, linkage))
        });
        let linkages: Vec<_> = linkages.collect();
        if linkages.is_empty() {
            return Some("no pantograph is a linkage".to_owned());
        }
        if self.vehicle.is_some() {
            return Some("its base moves with the vehicle, and the one motion is that on a base at rest".to_owned());
        }
        linkages.into_iter().find_map(|(index, linkage)| {
            let reason = linkage.motions_beyond_one()?;
            Some(format!("pantograph[{}]: {reason}", index + 1))
        })
    }
}
