//! The middle of the track as a curve in space: arcs, clothoids and cant ramps.
use crate::wheel_rail::RailFrame;
use nalgebra::{Matrix3, Vector3};
use scene::Curve;

/// Distance of the places whose position is stored, m. Between them the position is an integral by three points: its error in the
/// sharpest clothoid of EN 13803 (`κ' = 1/150 m / 10 m`) is `15 κ'³ (1 m)⁷/2016000`, far below rounding.
const SPACING: f64 = 1.0;

/// Abscissae and weights of Gauss' quadrature by three points on 0…1.
const GAUSS: [[f64; 2]; 3] = [
    [0.112_701_665_379_258_31, 5.0 / 18.0],
    [0.5, 8.0 / 18.0],
    [0.887_298_334_620_741_7, 5.0 / 18.0],
];

/// Where the middle of the track runs, and how the plane of the rails leans.
///
/// ```text
/// ψ(s) = ∫ κ ds,   x = ∫ cos ψ ds,   y = ∫ sin ψ ds,   z = D/2,   φ = −sign(κ) asin(D/e)
/// ```
///
/// `s` is the length in plan. Before its first curve the track runs along the x axis with x = s. See [`Curve`] for κ and D;
/// `z = D/2` keeps the inner rail level, at the distance `e/2` from the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    bends: Vec<Bend>,
    places: Vec<Place>,
}

/// A place on the plan: s, x, y in m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    s: f64,
    x: f64,
    y: f64,
}

/// One curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bend {
    corners: [f64; 4],
    /// Change of curvature (signed, 1/m²) and of cant (–) per length on the transitions.
    curvature_rate: f64,
    ramp: f64,
    rounding: f64,
    /// +1 to the left.
    sign: f64,
    distance: f64,
}

/// How the track bends at one place. Lists hold a value and its derivatives by s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackBend {
    /// Heading ψ (rad, to the left), curvature κ (1/m) and its rate (1/m²).
    pub heading: [f64; 3],
    /// Angle φ of the rails' plane about the direction of travel, rad, positive where the left rail is higher.
    pub cant: [f64; 3],
    /// Height z of the middle above the level of the inner rail, m.
    pub rise: [f64; 3],
}

/// Signs with which the slopes change at the four corners of a curve.
const CORNERS: [f64; 4] = [1.0, -1.0, -1.0, 1.0];

impl Bend {
    fn new(curve: &Curve, distance: f64) -> Self {
        Self {
            corners: curve.corners(),
            curvature_rate: curve.direction.sign() / (curve.radius * curve.transition),
            ramp: curve.cant / curve.transition,
            rounding: curve.rounding,
            sign: curve.direction.sign(),
            distance,
        }
    }

    /// First and last place that the curve has a say in, m.
    fn range(&self) -> [f64; 2] {
        [
            self.corners[0] - 0.5 * self.rounding,
            self.corners[3] + 0.5 * self.rounding,
        ]
    }

    /// Heading that the curve adds, with its derivatives.
    fn heading(&self, s: f64) -> [f64; 3] {
        let [start, arc, out, end] = self.corners;
        if s >= end {
            return [self.curvature_rate * (arc - start) * (out - start), 0.0, 0.0];
        }
        let mut sum = [0.0; 3];
        for (corner, sign) in self.corners.iter().zip(CORNERS) {
            let past = (s - corner).max(0.0);
            let rate = sign * self.curvature_rate;
            sum[0] += 0.5 * rate * past * past;
            sum[1] += rate * past;
            sum[2] += if s >= *corner { rate } else { 0.0 };
        }
        sum
    }

    /// Height of the outer rail with its derivatives; a parabola rounds each corner.
    fn outer_rail(&self, s: f64) -> [f64; 3] {
        let [first, last] = self.range();
        if s <= first || s >= last {
            return [0.0; 3];
        }
        let (width, mut sum) = (self.rounding, [0.0; 3]);
        for (corner, sign) in self.corners.iter().zip(CORNERS) {
            let past = s - corner;
            let slope = sign * self.ramp;
            if past >= 0.5 * width {
                sum[0] += slope * past;
                sum[1] += slope;
            } else if past > -0.5 * width {
                let within = past + 0.5 * width;
                sum[0] += slope * within * within / (2.0 * width);
                sum[1] += slope * within / width;
                sum[2] += slope / width;
            }
        }
        sum
    }

    /// Angle of the rails' plane with its derivatives: that of `sin φ = −sign D/e`.
    fn cant(&self, [height, slope, bend]: [f64; 3]) -> [f64; 3] {
        let sine = -self.sign * height / self.distance;
        let cosine = (1.0 - sine * sine).sqrt();
        let rate = -self.sign * slope / (self.distance * cosine);
        [
            sine.asin(),
            rate,
            -self.sign * bend / (self.distance * cosine) + rate * rate * sine / cosine,
        ]
    }
}

impl Alignment {
    /// The alignment of a track; `None` where it is straight. `distance` is that of the nominal contact points, m.
    #[must_use]
    pub fn new(curves: &[Curve], distance: f64) -> Option<Self> {
        let bends: Vec<Bend> = curves.iter().map(|curve| Bend::new(curve, distance)).collect();
        let start = bends.first()?.corners[0];
        let mut alignment = Self {
            bends,
            places: vec![Place {
                s: start,
                x: start,
                y: 0.0,
            }],
        };
        // Each piece between two corners is smooth.
        let corners: Vec<f64> = alignment.bends.iter().flat_map(|bend| bend.corners).collect();
        for pair in corners.windows(2) {
            let count = ((pair[1] - pair[0]) / SPACING).ceil().max(1.0);
            for i in 1..=count as usize {
                let s = pair[0] + (pair[1] - pair[0]) * i as f64 / count;
                let [x, y] = alignment.plan(s);
                alignment.places.push(Place { s, x, y });
            }
        }
        Some(alignment)
    }

    /// Where the first curve begins to bend or to lift the track, m.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.bends[0].range()[0]
    }

    /// How the track bends at `s` (m).
    #[must_use]
    pub fn bend(&self, s: f64) -> TrackBend {
        let mut sum = TrackBend {
            heading: [0.0; 3],
            cant: [0.0; 3],
            rise: [0.0; 3],
        };
        for bend in &self.bends {
            let [first, last] = bend.range();
            if s <= first {
                break;
            }
            let heading = bend.heading(s);
            sum.heading = std::array::from_fn(|k| sum.heading[k] + heading[k]);
            if s < last {
                // The cant of no two curves meets.
                let height = bend.outer_rail(s);
                sum.cant = bend.cant(height);
                sum.rise = height.map(|value| 0.5 * value);
            }
        }
        sum
    }

    /// x and y of the middle at `s`, m.
    fn plan(&self, s: f64) -> [f64; 2] {
        let before = self.places.partition_point(|place| place.s <= s);
        let Some(place) = before.checked_sub(1).map(|i| self.places[i]) else {
            return [s, 0.0];
        };
        let length = s - place.s;
        if before == self.places.len() && self.bends.last().is_none_or(|bend| s > bend.corners[3]) {
            let (sine, cosine) = self.bend(s).heading[0].sin_cos();
            return [place.x + length * cosine, place.y + length * sine];
        }
        let (mut x, mut y) = (place.x, place.y);
        for [abscissa, weight] in GAUSS {
            let (sine, cosine) = self.bend(place.s + abscissa * length).heading[0].sin_cos();
            x += weight * length * cosine;
            y += weight * length * sine;
        }
        [x, y]
    }

    /// The middle of the track at `s` (m), in the world: its axes are the horizontal direction of travel, and left and up of the
    /// plane of the rails.
    #[must_use]
    pub fn at(&self, s: f64) -> RailFrame {
        let bend = self.bend(s);
        let ([heading, curvature, curvature_rate], [cant, twist, twist_rate]) = (bend.heading, bend.cant);
        let [x, y] = self.plan(s);
        let ((sine, cosine), (lean, upright)) = (heading.sin_cos(), cant.sin_cos());
        let (forward, left) = (Vector3::new(cosine, sine, 0.0), Vector3::new(-sine, cosine, 0.0));
        let up = Vector3::z();
        RailFrame {
            position: Vector3::new(x, y, bend.rise[0]),
            direction: forward + up * bend.rise[1],
            bend: left * curvature + up * bend.rise[2],
            axes: Matrix3::from_columns(&[forward, left * upright + up * lean, up * upright - left * lean]),
            turn: up * curvature + forward * twist,
            turn_rate: up * curvature_rate + forward * twist_rate + left * (curvature * twist),
        }
    }
}

#[cfg(test)]
mod tests;
