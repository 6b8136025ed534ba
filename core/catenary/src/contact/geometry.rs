//! Closest points of a wire and a strip.
use crate::{CurvePoint, WireCurve};
use dynamics::Frame;
use nalgebra::Vector3;

/// The closest points of a wire and the line of a strip, and their common normal.
///
/// With `w = r(s) − p`, `p` the strip's marker and `e` its axis, the point on the strip is `p + η e`, `η = e·w`, and
///
/// ```text
/// C_e = d · r_s = 0,    d = w − η e                                [Thesis, Eq. (10), first row]
/// n = r_s × e / |r_s × e|                                          [Thesis, Eq. (8): n₂ for e = ŷ, normalised]
/// g = w · n,            ġ = n · (ṙ − ṗ − ω × η e)
/// ```
///
/// `d` is normal to both `r_s` and `e`, so `d = g n`. The thesis takes `p` as one point of the pan-head and holds that
/// point to the wire along both normals; the strip here is a line, so its point follows the wire and `n₁` carries no
/// force. The normal is vertical for parallel wire and strip [Thesis, Eq. (9)].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactGeometry {
    /// Parameter of the point on the wire, m.
    pub s: f64,
    /// The point on the wire.
    pub wire: CurvePoint,
    /// Axis of the strip, unit vector.
    pub axis: Vector3<f64>,
    /// Position of the contact along the strip, m from the marker.
    pub eta: f64,
    /// Common normal, unit vector from the strip to the wire: upwards.
    pub normal: Vector3<f64>,
    /// `|r_s × e|`, –; 0 for parallel wire and strip.
    pub normal_length: f64,
    /// Gap, m, positive when open.
    pub gap: f64,
    /// Rate of the gap along the path of the strip, m/s.
    pub gap_rate: f64,
    /// `∂C_e/∂s`, –.
    pub slope: f64,
}

/// Change of the parameter at which Newton's method stops, m: the gap's error is of second order in it.
const TOLERANCE: f64 = 1e-11;
const ITERATIONS: usize = 12;

impl ContactGeometry {
    /// Finds the contact by Newton on the arc length [Thesis, section 4.2.2] from `start`, else by bisection over the
    /// whole wire. `None` for a strip before the beginning or behind the end of the wire.
    #[must_use]
    pub fn search(curve: &dyn WireCurve, strip: &Frame, start: f64, q: &[f64], v: &[f64]) -> Option<Self> {
        let axis: Vector3<f64> = strip.axes.column(1).into();
        let length = curve.length();
        let mut s = start.clamp(0.0, length);
        for _ in 0..ITERATIONS {
            let wire = curve.point(s, q, v);
            let (residual, slope) = condition(&wire, strip, &axis);
            let change = -residual / slope;
            let next = s + change;
            if !next.is_finite() || slope <= 0.0 {
                break;
            }
            if change.abs() <= TOLERANCE {
                return Some(Self::at(s, wire, slope, strip, &axis));
            }
            if (s == 0.0 && next < 0.0) || (s == length && next > length) {
                return None;
            }
            s = next.clamp(0.0, length);
        }
        Self::bisect(curve, strip, &axis, q, v)
    }

    fn bisect(curve: &dyn WireCurve, strip: &Frame, axis: &Vector3<f64>, q: &[f64], v: &[f64]) -> Option<Self> {
        let (mut low, mut high) = (0.0, curve.length());
        let residual = |s: f64| condition(&curve.point(s, q, v), strip, axis).0;
        if residual(low) > 0.0 || residual(high) < 0.0 {
            return None;
        }
        while high - low > TOLERANCE {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if residual(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let wire = curve.point(low, q, v);
        let (_, slope) = condition(&wire, strip, axis);
        Some(Self::at(low, wire, slope, strip, axis))
    }

    fn at(s: f64, wire: CurvePoint, slope: f64, strip: &Frame, axis: &Vector3<f64>) -> Self {
        let offset = wire.r - strip.position;
        let eta = axis.dot(&offset);
        let cross = wire.r_s.cross(axis);
        let length = cross.norm();
        // Wire along the strip: [Thesis, Eq. (9)].
        let (normal, normal_length) = if length > 1e-9 * wire.r_s.norm() {
            (cross / length, length)
        } else {
            (Vector3::z(), 0.0)
        };
        let strip_velocity = strip.velocity + strip.angular_velocity.cross(&(eta * axis));
        Self {
            s,
            axis: *axis,
            eta,
            normal,
            normal_length,
            gap: offset.dot(&normal),
            gap_rate: normal.dot(&(wire.velocity - strip_velocity)),
            slope,
            wire,
        }
    }

    /// `∂s/∂p`, –: gain of the contact's parameter on the wire per metre of a translation of the strip, as a vector
    /// along the wire's direction across the strip.
    #[must_use]
    pub fn tangent(&self) -> Vector3<f64> {
        (self.wire.r_s - self.axis * self.axis.dot(&self.wire.r_s)) / self.slope
    }
}

/// `C_e` and `∂C_e/∂s`.
fn condition(wire: &CurvePoint, strip: &Frame, axis: &Vector3<f64>) -> (f64, f64) {
    let offset = wire.r - strip.position;
    let d = offset - axis.dot(&offset) * axis;
    let along = wire.r_s - axis.dot(&wire.r_s) * axis;
    (d.dot(&wire.r_s), along.dot(&wire.r_s) + d.dot(&wire.r_ss))
}
