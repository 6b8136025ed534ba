//! The middle of the track as a curve in space: arcs, clothoids and cant ramps.
use crate::wheel_rail::RailFrame;
use nalgebra::{Matrix3, Vector3};
use scene::Curve;

/// Length of the intervals of integration of positions, m, each with three points: in the sharpest clothoid of EN 13803
/// (`κ' = 1/150 m / 10 m`) the error is `15 κ'³ (1 m)⁷/2016000` each, below rounding.
const INTERVAL: f64 = 1.0;

/// Abscissae and weights of Gauss' quadrature by three points on 0…1.
const GAUSS: [[f64; 2]; 3] = [
    [0.112_701_665_379_258_31, 5.0 / 18.0],
    [0.5, 8.0 / 18.0],
    [0.887_298_334_620_741_7, 5.0 / 18.0],
];

/// Middle of the track in plan, and lean of the plane of the rails.
///
/// ```text
/// ψ(s) = ∫ κ ds,   x = ∫ cos ψ ds,   y = ∫ sin ψ ds,   z = D/2,   φ = −sign(κ) asin(D/e)
/// ```
///
/// `s` is the length in plan. Before the first curve the track runs along the x axis with x = s. See [`Curve`] for κ
/// and D; `z = D/2` keeps the inner rail level, at the distance `e/2` from the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    bends: Vec<Bend>,
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

/// Bend of the track at one point. Lists hold a value and the derivatives by s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackBend {
    /// Heading ψ (rad, to the left), curvature κ (1/m) and its rate (1/m²).
    pub heading: [f64; 3],
    /// Angle φ of the rails' plane about the direction of travel, rad, positive where the left rail is higher.
    pub cant: [f64; 3],
    /// Height z of the middle above the level of the inner rail, m.
    pub rise: [f64; 3],
}

impl TrackBend {
    /// A vector along the horizontal direction of travel, left and up, in axes that lean with the plane of the rails.
    pub(crate) fn leaning(&self, vector: Vector3<f64>) -> Vector3<f64> {
        let (lean, upright) = self.cant[0].sin_cos();
        Vector3::new(
            vector.x,
            upright * vector.y + lean * vector.z,
            upright * vector.z - lean * vector.y,
        )
    }
}

/// Signs of the slope changes at the four corners of a curve.
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

    /// First and last s with an influence of the curve, m.
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
    /// Alignment of a track; `None` for straight track. `distance` is the distance of the nominal contact points, m.
    #[must_use]
    pub fn new(curves: &[Curve], distance: f64) -> Option<Self> {
        let bends: Vec<Bend> = curves.iter().map(|curve| Bend::new(curve, distance)).collect();
        (!bends.is_empty()).then_some(Self { bends })
    }

    /// Bend of the track at `s` (m).
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
                // The cants of two curves never overlap.
                let height = bend.outer_rail(s);
                sum.cant = bend.cant(height);
                sum.rise = height.map(|value| 0.5 * value);
            }
        }
        sum
    }

    /// Next corner of the curvature beyond `s`, m.
    fn corner_behind(&self, s: f64) -> f64 {
        let corners = self.bends.iter().flat_map(|bend| bend.corners);
        corners.into_iter().find(|&corner| corner > s).unwrap_or(f64::INFINITY)
    }

    /// Path in plan from `from` to `s` (m), along the direction of travel at `from` and to the left, m.
    ///
    /// Cost grows with the distance between both.
    fn way(&self, from: f64, s: f64) -> [f64; 2] {
        let heading = self.bend(from).heading[0];
        let (low, high) = if from <= s { (from, s) } else { (s, from) };
        let (mut at, mut sum) = (low, [0.0; 2]);
        while at < high {
            // Each interval is smooth.
            let end = self.corner_behind(at).min(high);
            let count = ((end - at) / INTERVAL).ceil().max(1.0);
            let length = (end - at) / count;
            for i in 0..count as usize {
                for [abscissa, weight] in GAUSS {
                    let place = at + (i as f64 + abscissa) * length;
                    let (sine, cosine) = (self.bend(place).heading[0] - heading).sin_cos();
                    sum[0] += weight * length * cosine;
                    sum[1] += weight * length * sine;
                }
            }
            at = end;
        }
        if from <= s { sum } else { sum.map(|way| -way) }
    }

    /// Middle of the track at `s` (m), with the horizontal direction of travel, left and up of the plane of the rails
    /// as axes; all components are in the axes at `from` (m), the middle there being (`from`, 0, 0): a `from` before
    /// the first curve gives world axes.
    #[must_use]
    pub fn seen_from(&self, s: f64, from: f64) -> RailFrame {
        let (bend, origin) = (self.bend(s), self.bend(from));
        let ([heading, curvature, curvature_rate], [cant, twist, twist_rate]) = (bend.heading, bend.cant);
        let [along, aside] = self.way(from, s);
        let ((sine, cosine), (lean, upright)) = ((heading - origin.heading[0]).sin_cos(), cant.sin_cos());
        // Components in horizontal axes at `from` first, then turned by the cant there.
        let (forward, left) = (Vector3::new(cosine, sine, 0.0), Vector3::new(-sine, cosine, 0.0));
        let up = Vector3::z();
        let turned = |vector: Vector3<f64>| origin.leaning(vector);
        RailFrame {
            position: Vector3::new(from, 0.0, 0.0) + turned(Vector3::new(along, aside, bend.rise[0] - origin.rise[0])),
            direction: turned(forward + up * bend.rise[1]),
            bend: turned(left * curvature + up * bend.rise[2]),
            axes: Matrix3::from_columns(&[
                turned(forward),
                turned(left * upright + up * lean),
                turned(up * upright - left * lean),
            ]),
            turn: turned(up * curvature + forward * twist),
            turn_rate: turned(up * curvature_rate + forward * twist_rate + left * (curvature * twist)),
        }
    }
}

#[cfg(test)]
mod tests;
