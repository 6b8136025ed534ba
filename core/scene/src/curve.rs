//! `track.curve`: curves with cant and transitions.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::write::shown_number;
use crate::{Scene, Train};

/// One curve: a transition in, a circular arc, and an equal transition out.
///
/// ```text
/// κ(s)   0, rising linearly over the transition to ±1/R, constant, falling linearly to 0                 [clothoid]
/// D(s)   0, rising linearly over the transition to the cant, constant, falling linearly to 0
///        corners of D rounded by parabolas
/// ```
///
/// `s` is the length along the middle of the track in plan, which is the x of the line. The inner rail stays level, the
/// outer one is raised by `D` [EN 13803]: the plane of the rails leans by `asin(D/e)`, `e` the distance of the nominal
/// contact points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Radius of the middle of the track, m.
    pub radius: f64,
    /// Side to which the track turns.
    pub direction: Direction,
    /// Height of the outer rail above the inner one in the arc, m.
    pub cant: f64,
    /// Begin of the transition in, m.
    pub start: f64,
    /// Length of each transition, m.
    pub transition: f64,
    /// Length of the arc, m.
    pub length: f64,
    /// Length over which the slope of the outer rail changes at both ends of each cant ramp, m.
    pub rounding: f64,
}

choice! {
    /// `track.curve.direction`.
    pub enum Direction {
        /// Its middle lies to the left.
        Left = "left",
        /// Its middle lies to the right.
        Right = "right",
    }
    unavailable: []
}

impl Direction {
    /// Sign of the curvature, y being to the left: +1 or −1.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

impl Curve {
    /// Places of a change of slope of curvature and nominal cant, m: begin and end of the transition in, and of the one
    /// out.
    #[must_use]
    pub fn corners(&self) -> [f64; 4] {
        let end = self.start + self.transition;
        [self.start, end, end + self.length, end + self.length + self.transition]
    }

    /// Angle by which the plane of the rails leans in the arc, rad, for the distance (m) of the nominal contact points;
    /// positive.
    #[must_use]
    pub fn cant_angle(&self, distance: f64) -> f64 {
        (self.cant / distance).asin()
    }

    /// Acceleration along the plane of the rails towards the outside of the arc that the cant leaves uncompensated,
    /// m/s²: `v²/R cos φ − g sin φ` [EN 14363]. Negative where the cant is in excess.
    #[must_use]
    pub fn uncompensated_acceleration(&self, speed: f64, gravity: f64, distance: f64) -> f64 {
        let (sine, cosine) = self.cant_angle(distance).sin_cos();
        speed * speed / self.radius * cosine - gravity * sine
    }

    /// Additional cant that would leave no acceleration uncompensated, m, by the formula of EN 13803 for small angles:
    /// `e v²/(g R) − D`.
    #[must_use]
    pub fn cant_deficiency(&self, speed: f64, gravity: f64, distance: f64) -> f64 {
        distance * speed * speed / (gravity * self.radius) - self.cant
    }

    fn check(&self, path: &str, scene: &Scene, found: &mut Found) {
        let mut refuse = |key: &str, value: f64, expected: String| {
            refuse(found, format!("{path}.{key}"), shown_number(value, "m"), expected);
        };
        if self.radius < SMALLEST_RADIUS {
            let expected =
                format!("must be {SMALLEST_RADIUS} m or more, the smallest radius of a running line (EN 13803-2)");
            refuse("radius", self.radius, expected);
        }
        if self.cant > LARGEST_CANT {
            let expected = format!("must be from 0 to {LARGEST_CANT} m: no line in service has more");
            refuse("cant", self.cant, expected);
        }
        for (name, part) in [("transition", self.transition), ("length", self.length)] {
            if self.rounding > part {
                let expected =
                    format!("must be at most {name} = {part} m: the rounded ends of the cant ramps would meet");
                refuse("rounding", self.rounding, expected);
            }
        }
        let speed = scene.run.speed;
        let shortest = STEPS_OF_RAMP * speed * scene.internal_step();
        for (name, part) in [("transition", self.transition), ("rounding", self.rounding)] {
            if part < shortest {
                let expected = format!(
                    "must be {shortest:.3} m or more, {STEPS_OF_RAMP} internal steps of {:.3} ms at run.speed_kmh = \
                     {:.1}: shorter ones are \
                     stepped over",
                    1e3 * scene.internal_step(),
                    3.6 * speed
                );
                refuse(name, part, expected);
            }
        }
        if self.cant <= LARGEST_CANT && self.cant > STEEPEST_RAMP * self.transition {
            let expected = format!(
                "must be {:.3} m or more: with cant = {} m the track is twisted by {:.1} mm per m, and vehicles are \
                 made for {}",
                self.cant / STEEPEST_RAMP,
                self.cant,
                1e3 * self.cant / self.transition,
                1e3 * STEEPEST_RAMP,
            );
            refuse("transition", self.transition, expected);
        }
    }
}

/// Least internal steps on which a ramp of curvature or cant is felt: changes of the frame's rates reach the bodies as
/// forces at the ends of steps.
const STEPS_OF_RAMP: f64 = 10.0;

/// m [EN 13803-2:2006, 7.3].
const SMALLEST_RADIUS: f64 = 150.0;

/// m: more than any line in service has; EN 13803 allows 0.18 m (figures from memory).
const LARGEST_CANT: f64 = 0.2;

/// Steepest cant ramp, –: the largest twist that EN 14363 has vehicles tested on (figure from memory).
const STEEPEST_RAMP: f64 = 7e-3;

impl Entry for Curve {
    const SENTENCES: Sentences = &[
        ("radius", "Radius of the middle of the track."),
        ("direction", "Side to which the track turns."),
        ("cant", "Height of the outer rail above the inner one in the arc."),
        ("start", "Place where the transition into the curve begins."),
        ("transition", "Length of each transition."),
        ("length", "Length of the arc."),
        (
            "rounding",
            "Length over which the slope of the outer rail changes at both ends of each cant ramp.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let length = Number::positive("m");
        Self {
            radius: keys.number(
                "radius",
                was.map(|curve| curve.radius),
                length.at_least(SMALLEST_RADIUS),
            ),
            direction: keys.word("direction", was.map(|curve| curve.direction), None),
            cant: keys.number(
                "cant",
                was.map(|curve| curve.cant),
                Number::not_negative("m").at_most(LARGEST_CANT),
            ),
            start: keys.number("start", was.map(|curve| curve.start), Number::any("m")),
            transition: keys.number("transition", was.map(|curve| curve.transition), length),
            length: keys.number("length", was.map(|curve| curve.length), length),
            rounding: keys.number("rounding", was.map(|curve| curve.rounding), length),
        }
    }
}

/// One curve as a table, several as a list of tables.
pub(crate) fn curves(keys: &mut Keys, was: Option<&[Curve]>) -> Vec<Curve> {
    match was {
        Some([]) => Vec::new(),
        Some([one]) => vec![keys.inline_table("curve", Some(one))],
        Some(several) => keys.table_or_tables("curve", Some(several)),
        None if keys.holds_table("curve") => vec![keys.inline_table("curve", None)],
        None if keys.has("curve", false) => keys.table_or_tables("curve", None),
        None => Vec::new(),
    }
}

/// Refuses curves that no track has, and a speed at which the vehicle would topple in one.
pub(crate) fn check(scene: &Scene, train: &Train, found: &mut Found) {
    let Some(track) = scene.track.as_deref() else {
        return;
    };
    let (curves, path) = (&track.curves, |i: usize| track.curve_key(i));
    for (i, curve) in curves.iter().enumerate() {
        curve.check(&path(i), scene, found);
        train.check_toppling(scene, curve, &path(i), found);
    }
    for (i, pair) in curves.windows(2).enumerate() {
        let free = pair[0].corners()[3] + 0.5 * (pair[0].rounding + pair[1].rounding);
        if pair[1].start < free {
            let free = millimetres_up(free);
            let expected = format!("must be {free:.3} m or more: there the cant ramp of the curve before it ends");
            refuse(
                found,
                format!("{}.start", path(i + 1)),
                shown_number(pair[1].start, "m"),
                expected,
            );
        }
    }
}

/// A bound (m) that holds when it is written with millimetres.
#[must_use]
pub fn millimetres_up(bound: f64) -> f64 {
    (1e3 * bound).ceil() / 1e3
}

impl Train {
    /// Height of the centre of mass of all bodies above the top of rail, m.
    fn centre_height(&self) -> f64 {
        let (mut mass, mut moment) = (0.0, 0.0);
        for body in &self.bodies {
            for position in &body.positions {
                mass += body.mass;
                moment += body.mass * position[2];
            }
        }
        moment / mass
    }

    /// The vehicle as one rigid body on two rails: it topples where the resultant of weight and centrifugal force
    /// passes outside of a rail, `|a_y| h > a_z e/2`.
    fn check_toppling(&self, scene: &Scene, curve: &Curve, path: &str, found: &mut Found) {
        let (speed, gravity, distance) = (scene.run.speed, scene.gravity(), self.wheels.distance);
        let height = self.centre_height();
        if !(curve.cant < distance && height > 0.0 && curve.radius >= SMALLEST_RADIUS) {
            return; // Each of these is refused where it stands.
        }
        let outward = curve.uncompensated_acceleration(speed, gravity, distance);
        let (sine, cosine) = curve.cant_angle(distance).sin_cos();
        let upward = gravity * cosine + speed * speed / curve.radius * sine;
        if outward.abs() * height > 0.5 * upward * distance {
            let over = if outward > 0.0 { "outer" } else { "inner" };
            let expected = format!(
                "must leave less than {:.2} m/s² along the plane of the rails: with run.speed_kmh = {:.1} and cant = \
                 {} m it leaves {:.2} \
                 m/s², and the vehicle topples over the {over} rail, its centre of mass being {height:.2} m above them",
                0.5 * upward * distance / height,
                3.6 * speed,
                curve.cant,
                outward.abs(),
            );
            refuse(
                found,
                format!("{path}.radius"),
                shown_number(curve.radius, "m"),
                expected,
            );
        }
    }
}
