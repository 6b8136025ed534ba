//! The force of one wheel on its rail.
use super::contact_point::Pairing;
use super::overlap::overlaps;
use super::search::{Found, MAX_CONTACTS, Points, Search};
use super::wheel_contact::{Change, WheelContact};
use super::{CreepModel, Hertz, Rail, SurfaceParameters, Wheel};
use crate::travel::{Travel, TravellingFrame};
use dynamics::{Blocks, Columns, Force, Frame, Marker, Motion, Power, StepHistory, Weights};
use nalgebra::Vector3;

/// Parts of a wheel on a rail.
pub struct WheelRailParts {
    /// The middle of the wheelset, with the second axis along the axle to the left, in the frame of the vehicle. A
    /// marker of a rigid body.
    pub marker: Box<dyn Marker>,
    /// Travel of that frame.
    pub travel: Travel,
    /// Nominal position of the middle of the wheelset along the track in that frame, m: the viewpoint of the contact.
    pub along: f64,
    /// Spin of the wheelset about the axle beyond that of the marker, rad/s, positive for forward; 0 if the marker's
    /// body spins with the wheels. If the body stands for the axle without spin, this is the spin held by a drive.
    pub spin: f64,
    /// The wheel.
    pub wheel: Wheel,
    /// The rail, at rest in the world.
    pub rail: Rail,
    /// Normal force.
    pub hertz: Hertz,
    /// `c` of the normal force, N·s/m².
    pub damping: f64,
    /// Tangential forces.
    pub creep: CreepModel,
    /// Speed below which rolling counts as this speed in the creepages, m/s, positive.
    pub slowest: f64,
}

/// The contact of one wheel with its rail.
///
/// ```text
/// N = max(0, F_H(δ) + c δ δ̇)                     [Hertz; damping: Shabana, Zaazaa, Escalona & Sany 2004, section 4]
/// Q = Σ_contacts ∂r/∂q · (N n + T_x t_x + T_y t_y) + ∂θ/∂q · M_z n
/// ```
///
/// The forces act at the point of the undeformed wheel. All points of largest overlap count (tread, flange). A search
/// over the whole width at the begin of a step finds the points and Newton's method follows them within the step; a
/// lost point starts another search. A wheelset that goes straight on over a smooth rail is not searched anew.
pub struct WheelRail {
    parts: WheelRailParts,
    search: Search,
    start: Start,
    /// None before the first search.
    kept: Option<Box<Kept>>,
}

/// Points of the last search, and the position that they belong to: the first force of a step is asked at the motion
/// with which the step begins.
#[derive(Default)]
struct Kept {
    points: Points,
    at: Option<(f64, Frame)>,
}

/// A wheelset at one instant.
struct WheelsetPosition {
    /// Viewpoint, see [`super::RailLine::frame`], m: the axes there are the world axes below.
    from: f64,
    /// Middle of the wheelset, with all of the spin.
    frame: Frame,
    /// Arc length of the rail nearby, m.
    s: f64,
    /// Travelling frame of the coordinates.
    travelling: TravellingFrame,
}

/// Start of the next search.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Start {
    /// Arc length of the rail near the wheelset; none before the first search.
    s: Option<f64>,
    found: Found,
    /// Position at the last search over the whole width.
    searched: Option<OverRail>,
}

/// Position of a wheelset over its rail, as far as it decides which points there are: y and z of the middle, the axle,
/// and the direction of the rail, in the axes of the rail.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OverRail([f64; OverRail::COUNT]);

impl OverRail {
    const COUNT: usize = 8;

    /// Changes below which points stay the same but for rounding, m and –. The height decides only which points are
    /// followed before they touch, far above the rail.
    const STILL: f64 = 1e-12;
    const STILL_HEIGHT: f64 = 1e-4;

    fn new(pairing: &Pairing<'_>, s: f64) -> Self {
        let rail = pairing.rail.line.frame(s, pairing.from);
        let own = |vector: Vector3<f64>| rail.axes.tr_mul(&vector);
        let middle = own(pairing.middle - rail.position);
        let [axle, along] = [own(pairing.axes.column(1).into_owned()), own(rail.direction)];
        Self([middle.y, middle.z, axle.x, axle.y, axle.z, along.x, along.y, along.z])
    }

    fn is_as(&self, other: &Self) -> bool {
        let mut changes = self.0.iter().zip(&other.0).map(|(a, b)| (a - b).abs());
        changes.next().is_some_and(|aside| aside < Self::STILL)
            && changes.next().is_some_and(|height| height < Self::STILL_HEIGHT)
            && changes.all(|turn| turn < Self::STILL)
    }
}

/// The contacts of a wheel at one instant.
pub type WheelContacts = [Option<WheelContact>; MAX_CONTACTS];

impl WheelRail {
    /// A wheel on its rail.
    #[must_use]
    pub fn new(parts: WheelRailParts) -> Self {
        Self {
            search: Search::new(&parts.wheel, &parts.rail.profile),
            parts,
            start: Start {
                s: None,
                found: Found::default(),
                searched: None,
            },
            kept: None,
        }
    }

    /// Parts of the wheel and the rail.
    #[must_use]
    #[cfg(test)]
    pub fn parts(&self) -> &WheelRailParts {
        &self.parts
    }

    /// Replaces the tangential forces: a static solution, in which nothing rolls, has none.
    pub fn set_creep(&mut self, creep: CreepModel) {
        self.parts.creep = creep;
    }

    /// Replaces the spin, rad/s, see [`WheelRailParts::spin`].
    pub fn set_spin(&mut self, spin: f64) {
        self.parts.spin = spin;
    }

    /// Contacts at a motion, without those of no force.
    #[must_use]
    pub fn contacts(&self, motion: &Motion<'_>) -> WheelContacts {
        self.contacts_at(&self.place(motion)).0
    }

    /// Sum of the forces of the rail on the wheel, N, in the axes of the track under the wheelset: along the track, to
    /// the left, and up from the plane of the rails.
    #[must_use]
    pub fn force(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.contacts(motion)
            .iter()
            .flatten()
            .map(|contact| contact.force)
            .sum()
    }

    /// Position of the wheelset at a motion.
    fn place(&self, motion: &Motion<'_>) -> WheelsetPosition {
        let origin = self.parts.travel.place(motion.t);
        let from = origin + self.parts.along;
        let travelling = self.parts.travel.travelling(motion.t, from);
        let inner = self.parts.marker.frame(motion);
        let frame = travelling.frame_of(&inner);
        WheelsetPosition {
            from,
            s: origin + inner.position.x,
            frame: Frame {
                angular_velocity: frame.angular_velocity + frame.axes.column(1) * self.parts.spin,
                ..frame
            },
            travelling,
        }
    }

    fn columns(&self, motion: &Motion<'_>, place: &WheelsetPosition) -> Columns {
        let mut columns = Columns::default();
        self.parts.marker.columns(motion, &mut columns);
        place.travelling.columns_of(columns)
    }

    fn pairing(&self, place: &WheelsetPosition) -> Pairing<'_> {
        Pairing::new(
            &self.parts.wheel,
            (&self.parts.rail, place.from),
            place.frame.position,
            &place.frame.axes.column(1).into_owned(),
        )
    }

    /// Searches over the whole width of the profiles.
    fn search(&self, pairing: &Pairing<'_>, s: f64, points: &mut Points) -> Start {
        self.search.contacts(pairing, s, &self.found_from(s), points);
        Start {
            s: Some(s),
            found: points.found(),
            searched: Some(OverRail::new(pairing, s)),
        }
    }

    /// Points of the beginning step: those of the last one where the wheelset goes straight on over a smooth rail, else
    /// those of a search.
    fn search_or_go_on(&self, pairing: &Pairing<'_>, s: f64, points: &mut Points) -> Start {
        let goes_on = self
            .start
            .searched
            .filter(|last| last.is_as(&OverRail::new(pairing, s)));
        if goes_on.is_some() && points.follow(pairing, &self.found_from(s)) {
            return Start {
                s: Some(s),
                found: points.found(),
                searched: goes_on,
            };
        }
        self.search(pairing, s, points)
    }

    /// The points of the last search as seen from `s`.
    fn found_from(&self, s: f64) -> Found {
        self.start.found.moved(s - self.start.s.unwrap_or(s))
    }

    /// Arc length whose normal plane holds the middle of the wheelset, m.
    fn arc_length(&self, pairing: &Pairing<'_>, place: &WheelsetPosition) -> f64 {
        let mut s = self.start.s.unwrap_or(place.s);
        for _ in 0..20 {
            let rail = self.parts.rail.line.frame(s, place.from);
            let to_middle = pairing.middle - rail.position;
            let change = rail.direction.dot(&to_middle) / rail.direction.norm_squared();
            s += change;
            if change.abs() < 1e-6 {
                break; // A start is enough.
            }
        }
        s
    }

    /// Finds the points from those of the last search, or by another one; returns the start of the next search.
    fn find(&self, place: &WheelsetPosition, points: &mut Points) -> Start {
        let pairing = self.pairing(place);
        if self.start.s.is_some() && points.follow(&pairing, &self.start.found) {
            return Start {
                found: points.found(),
                ..self.start
            };
        }
        let start = self.search(&pairing, self.arc_length(&pairing, place), points);
        if !points.are_apart() {
            points.clear();
        }
        start
    }

    /// Calls `see` for each contact at these points, with its number.
    fn see_contacts(&self, points: &Points, place: &WheelsetPosition, mut see: impl FnMut(usize, &WheelContact)) {
        let overlaps = overlaps(&points.highest, &points.valleys);
        for (number, (point, overlap)) in points.highest.iter().zip(overlaps).enumerate() {
            if let (Some(point), Some(overlap)) = (point, overlap)
                && let Some(contact) = WheelContact::new(&self.parts, point, overlap, &place.frame)
            {
                see(number, &contact);
            }
        }
    }

    /// The contacts, and the start of the next search.
    fn contacts_at(&self, place: &WheelsetPosition) -> (WheelContacts, Start) {
        let mut points = Points::default();
        let start = self.find(place, &mut points);
        let mut contacts = [None; MAX_CONTACTS];
        self.see_contacts(&points, place, |number, contact| contacts[number] = Some(*contact));
        (contacts, start)
    }
}

impl Force for WheelRail {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let place = self.place(motion);
        let columns = self.columns(motion, &place);
        let mut kept = self.kept.take().unwrap_or_default();
        if kept.at.take() != Some((place.from, place.frame)) {
            self.start = self.find(&place, &mut kept.points);
        }
        self.see_contacts(&kept.points, &place, |_, contact| {
            for column in columns.as_slice() {
                force[column.index] += column.translation.dot(&contact.force) + column.rotation.dot(&contact.moment);
            }
        });
        self.kept = Some(kept);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let place = self.place(motion);
        let (contacts, start) = self.contacts_at(&place);
        self.start = start;
        let slopes = contacts.map(|contact| contact.map(|contact| contact.creep_slopes(&self.parts)));
        let frame = &place.frame;
        let columns = self.columns(motion, &place);
        // Angular velocity of the travelling frame turns with the frame, not with the body.
        let carried = place.travelling.angular_velocity();
        let own = frame.angular_velocity - carried;
        let columns = columns.as_slice();
        let n = columns.len();
        // Part of the velocity that turns with the body.
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
                velocity: (by.rotation.cross(&turning) + carried.cross(&by.translation)) * weights.q
                    + by.translation * weights.v,
                angular_velocity: by.rotation.cross(&own) * weights.q + by.rotation * weights.v,
            };
            for (contact, slopes) in contacts.iter().flatten().zip(slopes.iter().flatten()) {
                let [force, moment] = contact.change((&self.parts, slopes), frame, &change);
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
            .map(|contact| 0.4 * contact.ellipse.force * contact.penetration)
            .sum()
    }

    /// Power is brought in by the travel of the frame over the resting rail and by the drive that holds the spin, and
    /// turned into heat by sliding and by the damping of the normal force.
    ///
    /// Hertz' stiffness changes with the contact point, and the counted penetration with the neighbours in a patch.
    /// This change of the elastic energy comes from no force and counts as brought in.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let place = self.place(motion);
        let frame = &place.frame;
        let axle = frame.axes.column(1);
        let mut power = Power::default();
        let (travel, turn) = place.travelling.motion_of(&frame.position);
        for contact in self.contacts_at(&place).0.iter().flatten() {
            let (point, sliding) = (&contact.point, &contact.sliding);
            let by_wheel =
                contact.force.dot(&sliding.velocity) + contact.creep[2] * point.normal.dot(&frame.angular_velocity);
            let stored = contact.ellipse.force * contact.rate;
            power.dissipated -= by_wheel + stored;
            power.driven -= contact.force.dot(&travel) + contact.moment.dot(&turn);
            power.driven -= axle.dot(&contact.moment) * self.parts.spin;
            let change = point.change(&frame.velocity, &frame.angular_velocity);
            let growth = contact.ellipse.by_curvature[2][0] * change.curvature.x
                + contact.ellipse.by_curvature[2][1] * change.curvature.y;
            power.driven += 0.4 * contact.ellipse.force * contact.penetration * growth;
            let rate = contact.overlap.rate(&frame.velocity, &frame.angular_velocity);
            power.driven += contact.ellipse.force * (rate - contact.rate);
        }
        Some(power)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl StepHistory for WheelRail {
    fn begin_step(&mut self, motion: &Motion<'_>, _: f64) {
        let place = self.place(motion);
        let mut kept = self.kept.take().unwrap_or_default();
        let pairing = self.pairing(&place);
        let start = self.search_or_go_on(&pairing, self.arc_length(&pairing, &place), &mut kept.points);
        self.start = start;
        kept.at = kept.points.are_apart().then_some((place.from, place.frame));
        self.kept = Some(kept);
    }

    fn save(&self, out: &mut Vec<f64>) {
        out.push(self.start.s.unwrap_or(f64::NAN));
        let found = &self.start.found;
        for place in found.points.iter().chain(&found.valleys) {
            match place {
                Some(at) => out.extend([1.0, at.s, at.rail, at.angle, at.wheel]),
                None => out.extend([0.0; 5]),
            }
        }
        out.extend(self.start.searched.map_or([f64::NAN; OverRail::COUNT], |over| over.0));
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || values.next().copied().unwrap_or(f64::NAN);
        let s = next();
        self.start.s = (!s.is_nan()).then_some(s);
        let found = &mut self.start.found;
        for place in found.points.iter_mut().chain(&mut found.valleys) {
            let is_there = next() == 1.0;
            let at = SurfaceParameters {
                s: next(),
                rail: next(),
                angle: next(),
                wheel: next(),
            };
            *place = is_there.then_some(at);
        }
        // Nothing is as what is not a number.
        self.start.searched = Some(OverRail(std::array::from_fn(|_| next())));
    }
}
