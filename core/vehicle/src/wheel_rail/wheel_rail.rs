//! The force of one wheel on its rail.
use super::contact_point::{ContactPoint, Pairing};
use super::creepage::Sliding;
use super::search::{Found, MAX_CONTACTS, Search};
use super::{CreepForce, CreepModel, Creepage, Ellipse, Hertz, Patch, Rail, SurfaceParameters, Wheel};
use crate::Base;
use dynamics::{Blocks, Columns, Force, Frame, Marker, Motion, Power, Weights};
use nalgebra::Vector3;

/// What a wheel on a rail is made of.
pub struct WheelRailParts {
    /// The middle of the wheelset, its second axis along the axle to the left, in the frame of the base. A marker of a rigid body.
    pub marker: Box<dyn Marker>,
    /// What the marker's frame travels with.
    pub base: Base,
    /// What the wheelset turns about its axle faster than its marker does, rad/s, positive for forward; 0 where the marker's body
    /// spins with the wheels. Where the body stands for the axle without its spin, this is the spin, which a drive holds.
    pub spin: f64,
    /// The wheel.
    pub wheel: Wheel,
    /// Its rail, at rest in the world.
    pub rail: Rail,
    /// Normal force.
    pub hertz: Hertz,
    /// `c` of the normal force, N·s/m².
    pub damping: f64,
    /// Tangential forces.
    pub creep: CreepModel,
    /// Rolling slower than this counts as this in the creepages, m/s, positive.
    pub slowest: f64,
}

/// The contact of one wheel with its rail.
///
/// ```text
/// N = max(0, F_H(δ) + c δ δ̇)                     [Hertz; damping: Shabana, Zaazaa, Escalona & Sany 2004, section 4]
/// Q = Σ_contacts ∂r/∂q · (N n + T_x t_x + T_y t_y) + ∂θ/∂q · M_z n
/// ```
///
/// The forces act at the point of the undeformed wheel. All points where wheel and rail overlap most count (tread, flange). They
/// are searched for over the whole width at the begin of a step and followed by Newton's method within it; they are searched for
/// again where one is lost.
pub struct WheelRail {
    parts: WheelRailParts,
    search: Search,
    start: Start,
}

/// Where the next search begins.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Start {
    /// Arc length of the rail near the wheelset; none before the first search.
    s: Option<f64>,
    found: Found,
}

/// One contact at one instant; forces act on the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelContact {
    /// Where wheel and rail touch.
    pub point: ContactPoint,
    /// Of the wheel against the rail.
    pub creepage: Creepage,
    /// Semi-axes and elastic force.
    pub ellipse: Ellipse,
    /// N.
    pub normal_force: f64,
    /// Creep force along and across the rolling direction (N), moment about the normal (N·m).
    pub creep: CreepForce,
    /// World axes, N.
    pub force: Vector3<f64>,
    /// About the middle of the wheelset, world axes, N·m.
    pub moment: Vector3<f64>,
    sliding: Sliding,
    /// `δ̇`, m/s.
    rate: f64,
}

/// The contacts of a wheel at one instant.
pub type WheelContacts = [Option<WheelContact>; MAX_CONTACTS];

/// Change of the wheelset's motion.
struct Change {
    displacement: Vector3<f64>,
    rotation: Vector3<f64>,
    velocity: Vector3<f64>,
    angular_velocity: Vector3<f64>,
}

impl WheelRail {
    /// A wheel on its rail.
    #[must_use]
    pub fn new(parts: WheelRailParts) -> Self {
        Self {
            search: Search::new(&parts.wheel.profile, &parts.rail.profile),
            parts,
            start: Start {
                s: None,
                found: Found::default(),
            },
        }
    }

    /// What it is made of.
    #[must_use]
    pub fn parts(&self) -> &WheelRailParts {
        &self.parts
    }

    /// Puts other tangential forces in place: a static solution, in which nothing rolls, takes none.
    pub fn set_creep(&mut self, creep: CreepModel) {
        self.parts.creep = creep;
    }

    /// The contacts at a motion, those with no force left out.
    #[must_use]
    pub fn contacts(&self, motion: &Motion<'_>) -> WheelContacts {
        self.evaluate(motion).0
    }

    /// Sum of the forces of the rail on the wheel, world axes, N.
    #[must_use]
    pub fn force(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.contacts(motion)
            .iter()
            .flatten()
            .map(|contact| contact.force)
            .sum()
    }

    /// The middle of the wheelset in the world, with all of the spin.
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let frame = self.parts.marker.frame(motion);
        Frame {
            position: frame.position + self.parts.base.position(motion.t),
            velocity: frame.velocity + self.parts.base.velocity(),
            angular_velocity: frame.angular_velocity + frame.axes.column(1) * self.parts.spin,
            ..frame
        }
    }

    fn pairing(&self, frame: &Frame) -> Pairing<'_> {
        Pairing::new(
            &self.parts.wheel,
            &self.parts.rail,
            frame.position,
            &frame.axes.column(1).into_owned(),
        )
    }

    /// Searches over the whole width of the profiles.
    fn search(&self, pairing: &Pairing<'_>) -> Start {
        // The arc length whose normal plane holds the middle of the wheelset; a wheelset starts where x is the arc length.
        let mut s = self.start.s.unwrap_or(pairing.middle.x);
        for _ in 0..20 {
            let rail = self.parts.rail.line.frame(s);
            let to_middle = pairing.middle - rail.position;
            let change = rail.direction.dot(&to_middle) / rail.direction.norm_squared();
            s += change;
            if change.abs() < 1e-6 {
                break; // A start is enough.
            }
        }
        Start {
            s: Some(s),
            found: self.search.contacts(pairing, s),
        }
    }

    /// The contacts, and the start of the next search.
    fn evaluate(&self, motion: &Motion<'_>) -> (WheelContacts, Start) {
        let frame = self.frame(motion);
        let pairing = self.pairing(&frame);
        let (points, start) = match self.start.s.and_then(|_| follow(&pairing, &self.start)) {
            Some(followed) => followed,
            None => {
                let start = self.search(&pairing);
                follow(&pairing, &start).unwrap_or(([None; MAX_CONTACTS], start))
            }
        };
        let contacts = points.map(|point| point.and_then(|point| self.contact(point, &frame)));
        (contacts, start)
    }

    fn contact(&self, point: ContactPoint, frame: &Frame) -> Option<WheelContact> {
        if point.penetration <= 0.0 {
            return None;
        }
        let sliding = Sliding::new(&point, frame, self.parts.slowest);
        let rate = -point.normal.dot(&sliding.velocity);
        let ellipse = self.parts.hertz.contact(point.penetration, point.curvature.into());
        let normal_force = (ellipse.force + self.parts.damping * point.penetration * rate).max(0.0);
        let patch = Patch {
            along: ellipse.along,
            across: ellipse.across,
            normal_force,
        };
        let creep = self.parts.creep.force(&sliding.creepage, &patch);
        let [along, across, about] = creep.components;
        let force = point.normal * normal_force + sliding.forward * along + sliding.lateral * across;
        Some(WheelContact {
            creepage: sliding.creepage,
            moment: point.lever.cross(&force) + point.normal * about,
            point,
            ellipse,
            normal_force,
            creep,
            force,
            sliding,
            rate,
        })
    }
}

/// The points of a start at a new position; `None` where one is lost, or two have become one.
fn follow(pairing: &Pairing<'_>, start: &Start) -> Option<([Option<ContactPoint>; MAX_CONTACTS], Start)> {
    let mut points = [None; MAX_CONTACTS];
    let mut next = *start;
    let mut last = f64::NEG_INFINITY;
    for (place, parameters) in start.found.iter().enumerate() {
        let point = pairing.solve(parameters)?;
        let is_minimum = point.curvature.min() > 0.0;
        if !is_minimum || point.parameters.wheel <= last {
            return None;
        }
        last = point.parameters.wheel;
        next.found.set(place, point.parameters);
        points[place] = Some(point);
    }
    Some((points, next))
}

impl WheelContact {
    /// Change of force and moment with a change of the wheelset's motion, at an angular velocity `omega` (rad/s).
    fn change(&self, parts: &WheelRailParts, frame: &Frame, by: &Change) -> [Vector3<f64>; 2] {
        if self.normal_force == 0.0 {
            return [Vector3::zeros(); 2];
        }
        let (point, sliding, ellipse) = (&self.point, &self.sliding, &self.ellipse);
        let change = point.change(&by.displacement, &by.rotation);
        let velocity =
            by.velocity + by.angular_velocity.cross(&point.lever) + frame.angular_velocity.cross(&change.lever);
        let rate = -change.normal.dot(&sliding.velocity) - point.normal.dot(&velocity);
        let logarithms: [f64; 3] = std::array::from_fn(|k| {
            ellipse.by_penetration[k] * change.penetration / point.penetration
                + ellipse.by_curvature[k][0] * change.curvature.x
                + ellipse.by_curvature[k][1] * change.curvature.y
        });
        let normal_force =
            ellipse.force * logarithms[2] + parts.damping * (change.penetration * self.rate + point.penetration * rate);
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
            (self.creep.slopes[row].iter().zip(&inputs))
                .map(|(slope, input)| slope * input)
                .sum()
        });
        let [along, across, about] = self.creep.components;
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

impl Force for WheelRail {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let (contacts, start) = self.evaluate(motion);
        self.start = start;
        let mut columns = Columns::default();
        self.parts.marker.columns(motion, &mut columns);
        for contact in contacts.iter().flatten() {
            for column in columns.as_slice() {
                force[column.index] += column.translation.dot(&contact.force) + column.rotation.dot(&contact.moment);
            }
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let (contacts, start) = self.evaluate(motion);
        self.start = start;
        let frame = self.frame(motion);
        let mut columns = Columns::default();
        self.parts.marker.columns(motion, &mut columns);
        let columns = columns.as_slice();
        let n = columns.len();
        // The part of the velocity that turns with the body.
        let turning: Vector3<f64> = (columns.iter())
            .filter(|column| column.rotation != Vector3::zeros())
            .map(|column| column.translation * motion.v[column.index])
            .sum();
        let mut values = [0.0; Columns::CAPACITY * Columns::CAPACITY];
        let mut indices = [0; Columns::CAPACITY];
        for (l, by) in columns.iter().enumerate() {
            indices[l] = by.index;
            let change = Change {
                displacement: by.translation * weights.q,
                rotation: by.rotation * weights.q,
                velocity: by.rotation.cross(&turning) * weights.q + by.translation * weights.v,
                angular_velocity: by.rotation.cross(&frame.angular_velocity) * weights.q + by.rotation * weights.v,
            };
            for contact in contacts.iter().flatten() {
                let [force, moment] = contact.change(&self.parts, &frame, &change);
                for (k, of) in columns.iter().enumerate() {
                    let mut sum = of.translation.dot(&force) + of.rotation.dot(&moment);
                    if of.rotation != Vector3::zeros() {
                        // The column itself turns with the body.
                        sum += weights.q
                            * (by.rotation.cross(&of.translation).dot(&contact.force)
                                + by.rotation.cross(&of.rotation).dot(&contact.moment));
                    }
                    values[k * n + l] -= sum;
                }
            }
        }
        blocks.add(&indices[..n], &indices[..n], &values[..n * n]);
    }

    /// Elastic energy of the contacts, `⅖ F_H δ`.
    fn energy(&self, motion: &Motion<'_>) -> f64 {
        (self.contacts(motion).iter().flatten())
            .map(|contact| 0.4 * contact.ellipse.force * contact.point.penetration)
            .sum()
    }

    /// Brought in by the travel of the base over the resting rail and by the drive that holds the spin; turned into heat by
    /// sliding and by the damping of the normal force.
    ///
    /// Hertz' stiffness changes with the place of the contact. What the elastic energy changes by that, at the same penetration,
    /// comes from no force and is counted as brought in.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let frame = self.frame(motion);
        let axle = frame.axes.column(1);
        let mut power = Power::default();
        for contact in self.contacts(motion).iter().flatten() {
            let (point, sliding) = (&contact.point, &contact.sliding);
            let by_wheel = contact.force.dot(&sliding.velocity)
                + contact.creep.components[2] * point.normal.dot(&frame.angular_velocity);
            let stored = contact.ellipse.force * contact.rate;
            power.dissipated -= by_wheel + stored;
            power.driven -= contact.force.dot(&self.parts.base.velocity());
            power.driven -= axle.dot(&contact.moment) * self.parts.spin;
            let change = point.change(&frame.velocity, &frame.angular_velocity);
            let growth = contact.ellipse.by_curvature[2][0] * change.curvature.x
                + contact.ellipse.by_curvature[2][1] * change.curvature.y;
            power.driven += 0.4 * contact.ellipse.force * point.penetration * growth;
        }
        Some(power)
    }

    fn begin_step(&mut self, motion: &Motion<'_>) {
        let frame = self.frame(motion);
        self.start = self.search(&self.pairing(&frame));
    }

    fn save(&self, out: &mut Vec<f64>) {
        out.push(self.start.s.unwrap_or(f64::NAN));
        for place in self.start.found.places() {
            match place {
                Some(at) => out.extend([1.0, at.s, at.rail, at.angle, at.wheel]),
                None => out.extend([0.0; 5]),
            }
        }
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || values.next().copied().unwrap_or(f64::NAN);
        let s = next();
        self.start.s = (!s.is_nan()).then_some(s);
        self.start.found = Found::default();
        for place in 0..MAX_CONTACTS {
            let is_there = next() == 1.0;
            let at = SurfaceParameters {
                s: next(),
                rail: next(),
                angle: next(),
                wheel: next(),
            };
            if is_there {
                self.start.found.set(place, at);
            }
        }
    }
}
