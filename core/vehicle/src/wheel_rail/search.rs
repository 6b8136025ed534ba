//! Candidates for contact: local minima of the distance over the width of the profiles.
use super::contact_point::{ContactPoint, Pairing, SurfaceParameters};
use super::{Profile, ProfilePoint, RailFrame};
use nalgebra::Vector3;

/// Distance of the samples of a profile, m.
const STEP: f64 = 5e-4;

/// Vertical distance up to which a minimum is followed, m: more than a wheelset moves against the rail within a time
/// step, at the slope of a flange.
const FOLLOWED: f64 = 3e-3;

/// Largest number of contact points of one wheel at once: tread, root and face of the flange.
pub const MAX_CONTACTS: usize = 3;

/// Contact points of one wheel, from the flange outward, and between two of them the point of least overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found {
    pub points: [Option<SurfaceParameters>; MAX_CONTACTS],
    /// Point of least overlap after each point; none if the outline is broken, or the distance too large to matter.
    pub valleys: [Option<SurfaceParameters>; MAX_CONTACTS],
}

/// Both profiles sampled, for the search.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    wheel: Vec<(f64, ProfilePoint)>,
    rail: Vec<RailSample>,
    /// Outward coordinate of the first sample of the rail, m.
    first: f64,
}

#[derive(Clone, Copy, Debug)]
struct RailSample {
    sigma: f64,
    up: f64,
}

/// A sample of the wheel over the rail.
#[derive(Clone, Copy, Debug)]
struct Gap {
    height: f64,
    /// Tilt of the outline's point from the lowest one.
    sine: f64,
    /// Forward along the rail, m.
    forward: f64,
    /// σ of the rail and the wheel, m.
    rail: f64,
    wheel: f64,
}

impl Search {
    pub fn new(wheel: &Profile, rail: &Profile) -> Self {
        let [start, end] = wheel.range();
        let count = ((end - start) / STEP).ceil().max(2.0);
        let sample = |i: f64| start + (end - start) * i / count;
        let wheel = (0..=count as usize)
            .map(|i| sample(i as f64))
            .map(|sigma| (sigma, wheel.at(sigma)))
            .collect();
        let [start, end] = rail.range();
        let first = rail.at(start).position.x;
        let width = rail.at(end).position.x - first;
        let rail = (0..=(width / STEP) as usize)
            .map_while(|i| {
                rail.parameter_at(first + i as f64 * STEP)
                    .map(|sigma| (sigma, rail.at(sigma)))
            })
            .map(|(sigma, point)| RailSample {
                sigma,
                up: point.position.y,
            })
            .collect();
        Self { wheel, rail, first }
    }

    /// All contact points at a position; `s` is the arc length near the wheelset.
    ///
    /// A wheel's outline, seen along the rail, is compared with the rail; the outline's point on each circle of the
    /// wheel has a normal perpendicular to the rail. At a local minimum of the height between outline and rail both
    /// have the same slope.
    pub fn contacts(&self, pairing: &Pairing<'_>, s: f64) -> Found {
        let outline = Outline::new(self, pairing, s);
        let mut found = Candidates::default();
        let mut before: [Option<Gap>; 2] = [None, None];
        for sample in &self.wheel {
            let next = outline.gap(sample);
            if let [Some(first), Some(middle)] = before
                && let Some(last) = next
                && middle.height < first.height
                && middle.height <= last.height
                && middle.height < FOLLOWED
                && let Some(point) = pairing.solve(&outline.start(&middle))
            {
                found.insert(point);
            }
            before = [before[1], next];
        }
        let mut found = found.into_found();
        for place in 0..MAX_CONTACTS - 1 {
            if let [Some(first), Some(second)] = [found.points[place], found.points[place + 1]] {
                found.valleys[place] = self.valley(pairing, &outline, [first.wheel, second.wheel]);
            }
        }
        found
    }

    /// Point of least overlap between two points on the wheel.
    fn valley(&self, pairing: &Pairing<'_>, outline: &Outline<'_>, between: [f64; 2]) -> Option<SurfaceParameters> {
        let [first, last] = between.map(|sigma| self.wheel.partition_point(|sample| sample.0 <= sigma));
        let mut highest: Option<Gap> = None;
        for sample in &self.wheel[first..last] {
            let gap = outline.gap(sample)?;
            if highest.is_none_or(|highest| highest.height < gap.height) {
                highest = Some(gap);
            }
        }
        let highest = highest.filter(|highest| highest.height < FOLLOWED)?;
        let point = pairing.solve(&outline.start(&highest))?.parameters;
        (point.wheel > between[0] && point.wheel < between[1]).then_some(point)
    }
}

/// The outline of a wheel over a rail, seen along the rail.
struct Outline<'a> {
    search: &'a Search,
    pairing: &'a Pairing<'a>,
    s: f64,
    frame: RailFrame,
    along: Vector3<f64>,
    /// Component of the lateral axis, outward, along the rail.
    lateral: f64,
    /// Size and direction of the components of the other two axes along the rail.
    size: f64,
    tilt: f64,
    /// The other two axes, turned by `tilt`: the second one is perpendicular to the rail's direction.
    lowest: [Vector3<f64>; 2],
}

impl<'a> Outline<'a> {
    fn new(search: &'a Search, pairing: &'a Pairing<'a>, s: f64) -> Self {
        let frame = pairing.rail.line.frame(s, pairing.from);
        let along = frame.direction.normalize();
        let axes = &pairing.axes;
        let (forward, upward) = (axes.column(0).dot(&along), axes.column(2).dot(&along));
        let tilt = upward.atan2(forward);
        let (sine, cosine) = tilt.sin_cos();
        Self {
            search,
            pairing,
            s,
            frame,
            lowest: [
                axes.column(0) * cosine + axes.column(2) * sine,
                axes.column(2) * cosine - axes.column(0) * sine,
            ],
            along,
            lateral: pairing.wheel.side.sign() * axes.column(1).dot(&along),
            size: forward.hypot(upward),
            tilt,
        }
    }

    /// Height of a sample of the wheel over the rail; none beyond the rail or the outline.
    fn gap(&self, (sigma, profile): &(f64, ProfilePoint)) -> Option<Gap> {
        let sine = -profile.first.y / profile.first.x * self.lateral / self.size;
        if !(profile.first.x > 0.0 && sine.abs() < 1.0) {
            return None;
        }
        let (axes, wheel) = (&self.pairing.axes, self.pairing.wheel);
        let side = wheel.side.sign();
        let cosine = (1.0 - sine * sine).sqrt();
        let radial = self.lowest[0] * sine - self.lowest[1] * cosine;
        let point = self.pairing.middle - self.frame.position
            + axes.column(1) * (side * (wheel.distance + profile.position.x))
            + radial * (wheel.radius - profile.position.y);
        let outward = side * self.frame.axes.column(1).dot(&point);
        let place = (outward - self.search.first) / STEP;
        let left = place.floor();
        if left < 0.0 {
            return None;
        }
        let pair = self.search.rail.get(left as usize..left as usize + 2)?;
        let part = place - left;
        let up = pair[0].up + part * (pair[1].up - pair[0].up);
        Some(Gap {
            height: self.frame.axes.column(2).dot(&point) - up,
            sine,
            forward: self.along.dot(&point),
            rail: pair[0].sigma + part * (pair[1].sigma - pair[0].sigma),
            wheel: *sigma,
        })
    }

    /// Start of the search for a contact.
    fn start(&self, gap: &Gap) -> SurfaceParameters {
        SurfaceParameters {
            s: self.s + gap.forward / self.frame.direction.norm(),
            rail: gap.rail,
            angle: gap.sine.asin() + self.tilt,
            wheel: gap.wheel,
        }
    }
}

/// Deepest points so far, in the order of their position on the wheel.
#[derive(Default)]
struct Candidates {
    points: [Option<ContactPoint>; MAX_CONTACTS],
}

impl Candidates {
    /// Takes a point in unless it is no minimum, or known already.
    fn insert(&mut self, point: ContactPoint) {
        let is_known = |known: &ContactPoint| (known.parameters.wheel - point.parameters.wheel).abs() < 0.1 * STEP;
        if point.curvature.min() <= 0.0 || self.points.iter().flatten().any(is_known) {
            return;
        }
        if let Some(free) = self.points.iter_mut().find(|place| place.is_none()) {
            *free = Some(point);
            return;
        }
        let depth = |place: &Option<ContactPoint>| place.map_or(f64::NEG_INFINITY, |known| known.penetration);
        let mut shallowest = 0;
        for place in 1..MAX_CONTACTS {
            if depth(&self.points[place]) < depth(&self.points[shallowest]) {
                shallowest = place;
            }
        }
        if depth(&self.points[shallowest]) < point.penetration {
            // Keeps the order: the new one is the outermost.
            self.points[shallowest..].rotate_left(1);
            self.points[MAX_CONTACTS - 1] = Some(point);
        }
    }

    fn into_found(self) -> Found {
        Found {
            points: self.points.map(|place| place.map(|point| point.parameters)),
            valleys: [None; MAX_CONTACTS],
        }
    }
}
