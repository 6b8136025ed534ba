//! Candidates for contact: local minima of the distance over the width of the profiles.
use super::contact_point::{ContactPoint, Pairing, SurfaceParameters};
use super::{Profile, ProfilePoint, RailFrame, Wheel};
use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

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

impl Found {
    /// The places seen `s` m further along the rail.
    pub fn moved(mut self, s: f64) -> Self {
        let places = self.points.iter_mut().chain(&mut self.valleys);
        places.flatten().for_each(|place| place.s += s);
        self
    }

    /// The point of largest overlap within a sample of `start`, else `start` itself.
    fn nearest(&self, start: SurfaceParameters) -> SurfaceParameters {
        let near = |place: &&SurfaceParameters| {
            (place.wheel - start.wheel).abs() < STEP && (place.rail - start.rail).abs() < STEP
        };
        self.points.iter().flatten().find(near).copied().unwrap_or(start)
    }
}

/// Points of largest overlap, and those of least overlap between them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Points {
    pub highest: [Option<ContactPoint>; MAX_CONTACTS],
    pub valleys: [Option<ContactPoint>; MAX_CONTACTS],
}

impl Points {
    pub fn clear(&mut self) {
        self.highest
            .iter_mut()
            .chain(&mut self.valleys)
            .for_each(|point| *point = None);
    }

    /// Places of these points.
    pub fn found(&self) -> Found {
        let place = |point: &Option<ContactPoint>| point.as_ref().map(|point| point.parameters);
        Found {
            points: self.highest.each_ref().map(place),
            valleys: self.valleys.each_ref().map(place),
        }
    }

    /// Becomes the points from a start nearby; `false` if one is lost, or two have become one.
    pub fn follow(&mut self, pairing: &Pairing<'_>, start: &Found) -> bool {
        self.clear();
        for place in 0..MAX_CONTACTS {
            let Some(parameters) = &start.points[place] else {
                continue;
            };
            self.highest[place] = pairing.solve(parameters);
            if self.highest[place].is_none() {
                return false;
            }
            if let Some(parameters) = &start.valleys[place] {
                self.valleys[place] = pairing.solve(parameters);
                if self.valleys[place].is_none() {
                    return false;
                }
            }
        }
        self.are_apart()
    }

    /// True for points of largest and least overlap in their order on the wheel.
    pub fn are_apart(&self) -> bool {
        let mut last = f64::NEG_INFINITY;
        let mut follows = |point: &ContactPoint| {
            let follows = point.parameters.wheel > last;
            last = point.parameters.wheel;
            follows
        };
        self.highest.iter().zip(&self.valleys).all(|(highest, valley)| {
            highest
                .as_ref()
                .is_none_or(|point| point.curvature.min() > 0.0 && follows(point))
                && valley
                    .as_ref()
                    .is_none_or(|valley| valley.curvature.y < 0.0 && follows(valley))
        })
    }
}

/// Both profiles sampled, for the search.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    wheel: WheelSamples,
    rail: Vec<RailSample>,
    /// Outward coordinate of the first sample of the rail, m.
    first: f64,
    arch: Arch,
}

/// Samples of a wheel's profile, in lists that are read side by side.
#[derive(Clone, Debug)]
struct WheelSamples {
    /// m.
    sigma: Vec<f64>,
    /// Slope of the profile, –; not a number where the profile turns back.
    slope: Vec<f64>,
    /// y of the circle along the axle to the left, m.
    aside: Vec<f64>,
    /// Radius of the circle, m.
    radius: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
struct RailSample {
    sigma: f64,
    up: f64,
}

/// Samples of the wheel that are looked at together.
const LOOK: usize = 64;

/// Consecutive samples of the wheel over the rail.
struct View {
    /// Number of the first one.
    start: usize,
    /// Tilt of the outline's point from the lowest one.
    sine: [f64; LOOK],
    /// The point from the rail, world axes, m.
    point: [[f64; LOOK]; 3],
    /// Place on the rail in steps of the samples, and height above the level of the rail's origin, m.
    place: [f64; LOOK],
    level: [f64; LOOK],
    /// Height over the rail, m; not a number beyond the rail or the outline.
    height: [f64; LOOK],
}

impl Search {
    pub fn new(wheel: &Wheel, rail: &Profile) -> Self {
        let [start, end] = wheel.profile.range();
        let count = ((end - start) / STEP).ceil().max(2.0);
        let sigma: Vec<f64> = (0..=count as usize)
            .map(|i| start + (end - start) * i as f64 / count)
            .collect();
        let list = |of: &dyn Fn(ProfilePoint) -> f64| sigma.iter().map(|&sigma| of(wheel.profile.at(sigma))).collect();
        let wheel = WheelSamples {
            slope: list(&|point| {
                if point.first.x > 0.0 {
                    -point.first.y / point.first.x
                } else {
                    f64::NAN
                }
            }),
            aside: list(&|point| wheel.side.sign() * (wheel.distance + point.position.x)),
            radius: list(&|point| wheel.radius - point.position.y),
            sigma,
        };
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
        Self {
            wheel,
            rail,
            first,
            arch: Arch::new(),
        }
    }

    /// Finds all contact points at a position; `s` is the arc length near the wheelset. Points of the `last` search, as
    /// seen from `s`, are where others nearby start from.
    ///
    /// A wheel's outline, seen along the rail, is compared with the rail; the outline's point on each circle of the
    /// wheel has a normal perpendicular to the rail. At a local minimum of the height between outline and rail both
    /// have the same slope.
    pub fn contacts(&self, pairing: &Pairing<'_>, s: f64, last: &Found, points: &mut Points) {
        let outline = Outline::new(self, pairing, s);
        points.clear();
        let mut found = Candidates(&mut points.highest);
        let mut view = View::default();
        let (mut start, count) = (0, self.wheel.sigma.len());
        // Views share two samples: each sample but the first and the last one is within one of them.
        while start + 2 < count {
            let size = LOOK.min(count - start);
            outline.look(start, size, &mut view);
            for (i, height) in view.height[..size].windows(3).enumerate() {
                // Comparisons with a height that is not a number fail.
                if height[1] < height[0]
                    && height[1] <= height[2]
                    && height[1] < FOLLOWED
                    && let Some(point) = pairing.solve(&last.nearest(outline.start(&view, i + 1)))
                {
                    found.insert(point);
                }
            }
            start += LOOK - 2;
        }
        for place in 0..MAX_CONTACTS - 1 {
            if let [Some(first), Some(second)] = [&points.highest[place], &points.highest[place + 1]] {
                let between = [first, second].map(|point| point.parameters.wheel);
                points.valleys[place] = self.valley(pairing, &outline, between);
            }
        }
    }

    /// Point of least overlap between two points on the wheel.
    fn valley(&self, pairing: &Pairing<'_>, outline: &Outline<'_>, between: [f64; 2]) -> Option<ContactPoint> {
        let [first, last] = between.map(|sigma| self.wheel.sigma.partition_point(|sample| *sample <= sigma));
        let mut highest: Option<(f64, SurfaceParameters)> = None;
        let mut view = View::default();
        for start in (first..last).step_by(LOOK) {
            let size = LOOK.min(last - start);
            outline.look(start, size, &mut view);
            for i in 0..size {
                let height = view.height[i];
                if height.is_nan() {
                    return None;
                }
                if highest.is_none_or(|(highest, _)| highest < height) {
                    highest = Some((height, outline.start(&view, i)));
                }
            }
        }
        let (_, start) = highest.filter(|(height, _)| *height < FOLLOWED)?;
        let point = pairing.solve(&start)?;
        (point.parameters.wheel > between[0] && point.parameters.wheel < between[1]).then_some(point)
    }
}

/// A look at consecutive samples, in the vector registers of the processor.
struct Look<'a, 'b> {
    outline: &'a Outline<'b>,
    size: usize,
    view: &'a mut View,
}

impl WithSimd for Look<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.outline.trace(self.view.start, self.size, self.view);
        self.outline.measure(self.size, self.view);
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

    /// Looks at `size` samples of the wheel from `start` on.
    fn look(&self, start: usize, size: usize, view: &mut View) {
        view.start = start;
        self.search.arch.dispatch(Look {
            outline: self,
            size,
            view,
        });
    }

    /// Heights over the rail.
    #[inline(always)]
    fn measure(&self, size: usize, view: &mut View) {
        let rail = &self.search.rail;
        for i in 0..size {
            // The outline ends where its normal would have to point along the rail.
            let left = view.place[i] as u32 as usize;
            let beside = !(view.sine[i].abs() < 1.0 && view.place[i] >= 0.0);
            view.height[i] = match rail.get(left..left + 2) {
                Some([before, after]) if !beside => {
                    view.level[i] - (before.up + (view.place[i] - left as f64) * (after.up - before.up))
                }
                _ => f64::NAN,
            };
        }
    }

    /// Points of the outline, and places on the rail.
    #[inline(always)]
    fn trace(&self, start: usize, size: usize, view: &mut View) {
        let samples = &self.search.wheel;
        let range = start..start + size;
        let (slope, aside, radius) = (
            &samples.slope[range.clone()],
            &samples.aside[range.clone()],
            &samples.radius[range],
        );
        let list = |vector: Vector3<f64>| [vector.x, vector.y, vector.z];
        let middle = list(self.pairing.middle - self.frame.position);
        let axle = list(self.pairing.axes.column(1).into_owned());
        let [outward, upward] = [1, 2].map(|axis| list(self.frame.axes.column(axis).into_owned()));
        let [forward, down] = self.lowest.map(list);
        // One division for all samples.
        let (lateral, steps) = (self.lateral / self.size, self.pairing.wheel.side.sign() / STEP);
        let first = self.search.first / STEP;
        let [x, y, z] = &mut view.point;
        let (sine, place, level) = (&mut view.sine[..size], &mut view.place[..size], &mut view.level[..size]);
        let (x, y, z) = (&mut x[..size], &mut y[..size], &mut z[..size]);
        for i in 0..size {
            let tilt = slope[i] * lateral;
            let cosine = (1.0 - tilt * tilt).sqrt();
            let at = |axis: usize| {
                let radial = forward[axis] * tilt - down[axis] * cosine;
                middle[axis] + axle[axis] * aside[i] + radial * radius[i]
            };
            let point = [at(0), at(1), at(2)];
            let dot = |axis: [f64; 3]| axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2];
            sine[i] = tilt;
            [x[i], y[i], z[i]] = point;
            place[i] = steps * dot(outward) - first;
            level[i] = dot(upward);
        }
    }

    /// Start of the search for a contact, at a sample that has a height.
    fn start(&self, view: &View, i: usize) -> SurfaceParameters {
        let [x, y, z] = &view.point;
        let forward = self.along.dot(&Vector3::new(x[i], y[i], z[i]));
        let left = view.place[i] as usize;
        let [before, after] = [self.search.rail[left].sigma, self.search.rail[left + 1].sigma];
        SurfaceParameters {
            s: self.s + forward / self.frame.direction.norm(),
            rail: before + (view.place[i] - left as f64) * (after - before),
            angle: view.sine[i].asin() + self.tilt,
            wheel: self.search.wheel.sigma[view.start + i],
        }
    }
}

impl Default for View {
    fn default() -> Self {
        Self {
            start: 0,
            sine: [0.0; LOOK],
            point: [[0.0; LOOK]; 3],
            place: [0.0; LOOK],
            level: [0.0; LOOK],
            height: [f64::NAN; LOOK],
        }
    }
}

/// Deepest points so far, in the order of their position on the wheel.
struct Candidates<'a>(&'a mut [Option<ContactPoint>; MAX_CONTACTS]);

impl Candidates<'_> {
    /// Takes a point in unless it is no minimum, or known already.
    fn insert(&mut self, point: ContactPoint) {
        let is_known = |known: &ContactPoint| (known.parameters.wheel - point.parameters.wheel).abs() < 0.1 * STEP;
        if point.curvature.min() <= 0.0 || self.0.iter().flatten().any(is_known) {
            return;
        }
        if let Some(free) = self.0.iter_mut().find(|place| place.is_none()) {
            *free = Some(point);
            return;
        }
        let depth = |place: &Option<ContactPoint>| place.as_ref().map_or(f64::NEG_INFINITY, |known| known.penetration);
        let mut shallowest = 0;
        for place in 1..MAX_CONTACTS {
            if depth(&self.0[place]) < depth(&self.0[shallowest]) {
                shallowest = place;
            }
        }
        if depth(&self.0[shallowest]) < point.penetration {
            // Keeps the order: the new one is the outermost.
            self.0[shallowest..].rotate_left(1);
            self.0[MAX_CONTACTS - 1] = Some(point);
        }
    }
}
