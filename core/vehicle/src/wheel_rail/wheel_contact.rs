//! One contact of a wheel: forces and their changes.
use super::creepage::Sliding;
use super::overlap::Overlap;
use super::wheel_rail::WheelRailParts;
use super::{ContactPoint, CreepSlopes, Creepage, Ellipse, Patch};
use dynamics::Frame;
use nalgebra::Vector3;

/// One contact at one instant; forces act on the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelContact {
    /// Contact point of wheel and rail.
    pub point: ContactPoint,
    /// Creepages of the wheel against the rail.
    pub creepage: Creepage,
    /// Semi-axes and elastic force.
    pub ellipse: Ellipse,
    /// N.
    pub normal_force: f64,
    /// Creep force along and across the rolling direction (N), moment about the normal (N·m).
    pub creep: [f64; 3],
    /// Counted penetration of contacts that share a patch, m.
    pub penetration: f64,
    /// Force in the axes of the track at the wheelset, N.
    pub force: Vector3<f64>,
    /// Moment about the middle of the wheelset, same axes, N·m.
    pub moment: Vector3<f64>,
    pub(super) sliding: Sliding,
    pub(super) overlap: Overlap,
    /// Rate of the overlap at this point, m/s.
    pub(super) rate: f64,
}

/// Change of the wheelset's motion.
pub(super) struct Change {
    pub displacement: Vector3<f64>,
    pub rotation: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub angular_velocity: Vector3<f64>,
}

impl WheelContact {
    /// Contact at a point of largest overlap, of a wheelset that moves as `frame` says (with all of the spin); none for
    /// separated surfaces.
    pub(super) fn new(parts: &WheelRailParts, point: &ContactPoint, overlap: Overlap, frame: &Frame) -> Option<Self> {
        let penetration = overlap.penetration;
        if penetration <= 0.0 {
            return None;
        }
        let sliding = Sliding::new(point, frame, parts.slowest);
        let rate = -point.normal.dot(&sliding.velocity);
        let ellipse = parts.hertz.contact(penetration, point.curvature.into());
        let normal_force = (ellipse.force + parts.damping * penetration * rate).max(0.0);
        let creep = parts.creep.force(&sliding.creepage, &patch(&ellipse, normal_force));
        let [along, across, about] = creep;
        let force = point.normal * normal_force + sliding.forward * along + sliding.lateral * across;
        Some(Self {
            creepage: sliding.creepage,
            moment: point.lever.cross(&force) + point.normal * about,
            point: *point,
            penetration,
            ellipse,
            normal_force,
            creep,
            force,
            sliding,
            overlap,
            rate,
        })
    }

    /// Derivatives of the creep forces.
    pub(super) fn creep_slopes(&self, parts: &WheelRailParts) -> CreepSlopes {
        parts
            .creep
            .slopes(&self.creepage, &patch(&self.ellipse, self.normal_force))
    }

    /// Change of force and moment with a change of the wheelset's motion `frame` (with all of the spin), from the
    /// derivatives of the creep forces.
    pub(super) fn change(
        &self,
        (parts, slopes): (&WheelRailParts, &CreepSlopes),
        frame: &Frame,
        by: &Change,
    ) -> [Vector3<f64>; 2] {
        if self.normal_force == 0.0 {
            return [Vector3::zeros(); 2];
        }
        let (point, sliding, ellipse) = (&self.point, &self.sliding, &self.ellipse);
        let change = point.change(&by.displacement, &by.rotation);
        let velocity =
            by.velocity + by.angular_velocity.cross(&point.lever) + frame.angular_velocity.cross(&change.lever);
        let rate = -change.normal.dot(&sliding.velocity) - point.normal.dot(&velocity);
        let penetration = self.overlap.rate(&by.displacement, &by.rotation);
        let logarithms: [f64; 3] = std::array::from_fn(|k| {
            ellipse.by_penetration[k] * penetration / self.penetration
                + ellipse.by_curvature[k][0] * change.curvature.x
                + ellipse.by_curvature[k][1] * change.curvature.y
        });
        let normal_force =
            ellipse.force * logarithms[2] + parts.damping * (penetration * self.rate + self.penetration * rate);
        let forward = change.longitudinal * sliding.sense;
        let lateral =
            (change.normal.cross(&point.longitudinal) + point.normal.cross(&change.longitudinal)) * sliding.sense;
        let speed = sliding.speed_rate * (forward.dot(&frame.velocity) + sliding.forward.dot(&by.velocity));
        let creepage = &self.creepage;
        let inputs = [
            (forward.dot(&sliding.velocity) + sliding.forward.dot(&velocity) - creepage.longitudinal * speed)
                / sliding.speed,
            (lateral.dot(&sliding.velocity) + sliding.lateral.dot(&velocity) - creepage.lateral * speed)
                / sliding.speed,
            (change.normal.dot(&frame.angular_velocity) + point.normal.dot(&by.angular_velocity)
                - creepage.spin * speed)
                / sliding.speed,
            ellipse.along * logarithms[0],
            ellipse.across * logarithms[1],
            normal_force,
        ];
        let creep: [f64; 3] = std::array::from_fn(|row| {
            (slopes[row].iter().zip(&inputs))
                .map(|(slope, input)| slope * input)
                .sum()
        });
        let [along, across, about] = self.creep;
        let force = point.normal * normal_force
            + change.normal * self.normal_force
            + sliding.forward * creep[0]
            + forward * along
            + sliding.lateral * creep[1]
            + lateral * across;
        let moment = change.lever.cross(&self.force)
            + point.lever.cross(&force)
            + point.normal * creep[2]
            + change.normal * about;
        [force, moment]
    }
}

fn patch(ellipse: &Ellipse, normal_force: f64) -> Patch {
    Patch {
        along: ellipse.along,
        across: ellipse.across,
        normal_force,
    }
}
