//! Closest points of a wire and a strip.
use dynamics::{Frame, MonotoneCubic};
use nalgebra::Vector3;
use wire::{CurvePoint, WireCurve};

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
///
/// *Horns.* The top of a head with horns is the curve `c(y) = p + y e + h(|y|) u`, `u` the third axis of the marker.
/// The closest points of wire and curve are those of the wire and the tangent of the curve at its own point, the line
/// through `p + a` with the unit tangent `t` for axis, so that `η = 0`; its turn along the arc length `σ` of the curve
/// is the only other term (*derived here*):
///
/// ```text
/// d · t = 0,    δσ = γ (t · δd + d · δt)|σ,    γ = 1/(1 − d · t_σ),    a = y e + h u
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactGeometry {
    /// Parameter of the point on the wire, m.
    pub s: f64,
    /// The point on the wire.
    pub wire: CurvePoint,
    /// Axis of the strip, unit vector.
    pub axis: Vector3<f64>,
    /// Position of the contact along the axis, m from the foot of the axis.
    pub eta: f64,
    /// Place of the contact on the head, m from the marker: `eta` on a straight strip.
    pub place: f64,
    /// Foot of the axis from the marker, m; zero on a straight strip.
    pub foot: Vector3<f64>,
    /// Turn of the axis along the top of the head, `t_σ`, 1/m; zero on a straight strip.
    pub bend: Vector3<f64>,
    /// `γ`, –: way of the contact along a bent top for each metre along the axis; 1 on a straight strip.
    pub gain: f64,
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

/// Distance of the contact from the foot of its tangent at which the search on a horn stops, m.
const ON_HORN: f64 = 1e-10;
/// More than halving the longest horn down to [`ON_HORN`] takes.
const HALVINGS: usize = 60;

impl ContactGeometry {
    /// [`ContactGeometry::search`] on a head whose top is at the height `top` over the distance from its middle: on the
    /// straight part between the horns that search itself. Beyond the end of a horn its end tangent goes on.
    #[must_use]
    pub fn search_on(
        top: &MonotoneCubic,
        curve: &dyn WireCurve,
        strip: &Frame,
        start: f64,
        (q, v): (&[f64], &[f64]),
    ) -> Option<Self> {
        let mut found = Self::search(curve, strip, start, q, v)?;
        let [mut low, mut high] = top.range();
        let (side, end) = (found.eta.signum(), high);
        if found.eta.abs() <= low {
            return Some(found);
        }
        let (across, up): (Vector3<f64>, Vector3<f64>) = (found.axis, strip.axes.column(2).into());
        let mut place = found.eta.abs().min(end);
        for _ in 0..HALVINGS {
            let [height, slope, bend] = top.at(place);
            let length = slope.hypot(1.0);
            let foot = side * place * across + height * up;
            let mut tangent = *strip;
            tangent.position += foot;
            tangent.velocity += strip.angular_velocity.cross(&foot);
            tangent.axes.set_column(1, &((across + side * slope * up) / length));
            found = Self::search(curve, &tangent, found.s, q, v)?;
            let turn = bend / length.powi(4) * (up - side * slope * across);
            found.gain = 1.0 / (1.0 - found.gap * found.normal.dot(&turn));
            let beyond = side * found.eta;
            (found.place, found.foot, found.bend) = (side * (place + beyond / length), foot, turn);
            if beyond.abs() <= ON_HORN || (place == end && beyond > 0.0) {
                break;
            }
            if beyond > 0.0 {
                low = place;
            } else {
                high = place;
            }
            place += found.gain * beyond / length;
            if place >= end {
                place = end;
            } else if !(low < place && place < high) {
                place = 0.5 * (low + high);
            }
        }
        // ∂C_e/∂s with the contact that moves on along the bent top.
        let along = found.axis.dot(&found.wire.r_s);
        found.slope += (1.0 - found.gain) * along * along;
        Some(found)
    }

    /// Contact on the head from the strip's marker, m.
    #[must_use]
    pub fn lever(&self) -> Vector3<f64> {
        self.foot + self.eta * self.axis
    }

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
            place: eta,
            foot: Vector3::zeros(),
            bend: Vector3::zeros(),
            gain: 1.0,
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
        (self.wire.r_s - self.axis * (self.gain * self.axis.dot(&self.wire.r_s))) / self.slope
    }
}

/// `C_e` and `∂C_e/∂s`.
fn condition(wire: &CurvePoint, strip: &Frame, axis: &Vector3<f64>) -> (f64, f64) {
    let offset = wire.r - strip.position;
    let d = offset - axis.dot(&offset) * axis;
    let along = wire.r_s - axis.dot(&wire.r_s) * axis;
    (d.dot(&wire.r_s), along.dot(&wire.r_s) + d.dot(&wire.r_ss))
}
