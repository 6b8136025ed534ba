//! The contact wire of a line in its modes, under one strip.
use crate::{Compliance, CurveColumns, CurvePoint, WireCurve};
use dynamics::Frame;
use nalgebra::Vector3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Way along the wire in which the search for a place above a strip begins, m: 2⁻⁶.
const COARSE: f64 = 0.015_625;
/// The same for its end, m: 2⁻³⁰. Strips at the same place along the track have the same place on the wire, whatever
/// lifts the wire.
const FINE: f64 = COARSE / 16_777_216.0;
/// Step of the search behind which no other one is needed, m: wires are all but straight over [`COARSE`].
const LAST: f64 = 1e-3;
/// Most steps of the search.
const SEARCH: usize = 8;
/// Way from a place over which the wire at rest is a parabola, m: errors are below a picometre.
const CLOSE: f64 = 5e-5;

/// Numbers of a place: its parameter, position, two derivatives of that, compliance and its slope.
const NUMBERS: usize = 12;

/// Place on the wire at rest that a contact expects at the end of the present step.
#[derive(Clone, Debug)]
pub(super) struct Place(Arc<[AtomicU64; NUMBERS]>);

impl Default for Place {
    fn default() -> Self {
        Self(Arc::new([(); NUMBERS].map(|()| AtomicU64::new(f64::NAN.to_bits()))))
    }
}

impl Place {
    fn set(&self, s: f64, wire: &dyn WireCurve, rest: &[f64]) {
        let (point, compliance) = (wire.point(s, rest, rest), wire.compliance(s));
        let vectors = [point.r, point.r_s, point.r_ss];
        let vectors = vectors.iter().flat_map(|vector| vector.iter().copied());
        let numbers = vectors.chain([compliance.value, compliance.slope]);
        for (own, number) in self.0.iter().zip(std::iter::once(s).chain(numbers)) {
            own.store(number.to_bits(), Ordering::Relaxed);
        }
    }

    fn clear(&self) {
        self.0[0].store(f64::NAN.to_bits(), Ordering::Relaxed);
    }

    fn number(&self, at: usize) -> f64 {
        f64::from_bits(self.0[at].load(Ordering::Relaxed))
    }

    fn vector(&self, first: usize) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| self.number(first + axis))
    }

    /// Parameter on the wire, m; not a number beyond the wire.
    pub fn get(&self) -> f64 {
        self.number(0)
    }

    /// Way from the place to `s`, m, if that is short.
    fn close(&self, s: f64) -> Option<f64> {
        let way = s - self.get();
        (way.abs() <= CLOSE).then_some(way)
    }

    /// The wire at rest at `s`, close to the place.
    fn point(&self, s: f64) -> Option<CurvePoint> {
        let way = self.close(s)?;
        let [r, r_s, r_ss] = [1, 4, 7].map(|first| self.vector(first));
        Some(CurvePoint {
            r: r + way * (r_s + 0.5 * way * r_ss),
            r_s: r_s + way * r_ss,
            r_ss,
            velocity: Vector3::zeros(),
            velocity_s: Vector3::zeros(),
        })
    }

    /// Its residual compliance there.
    fn compliance(&self, s: f64) -> Option<Compliance> {
        let way = self.close(s)?;
        let [value, slope] = [10, 11].map(|at| self.number(at));
        Some(Compliance {
            value: value + way * slope,
            slope,
        })
    }
}

/// The wire at rest, lifted by one coordinate: its deflection under the strip.
pub(super) struct ModalCurve {
    pub wire: Arc<dyn WireCurve>,
    /// Zeros, one for each coordinate of the wire.
    pub rest: Arc<[f64]>,
    /// Coordinate of the deflection under the strip, m, which rises with the strip's way along the wire too.
    pub coordinate: usize,
    pub place: Place,
}

impl ModalCurve {
    /// Parameter of the wire at rest above a strip, m, sought from `s`.
    fn above(&self, strip: &Frame, s: f64) -> f64 {
        let along = strip.axes.column(1).cross(&Vector3::z());
        let to = |s: f64, step: f64| ((s / step).round() * step).clamp(0.0, self.wire.length());
        let mut place = to(s, COARSE);
        for _ in 0..SEARCH {
            let wire = self.wire.point(place, &self.rest, &self.rest);
            let change = along.dot(&(strip.position - wire.r)) / along.dot(&wire.r_s);
            if !change.is_finite() {
                return s;
            }
            place = (place + change).clamp(0.0, self.wire.length());
            if change.abs() <= LAST {
                break;
            }
        }
        to(place, FINE)
    }
}

impl WireCurve for ModalCurve {
    fn length(&self) -> f64 {
        self.wire.length()
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        let anywhere = || self.wire.point(s, &self.rest, &self.rest);
        let mut point = self.place.point(s).unwrap_or_else(anywhere);
        point.r.z += q[self.coordinate];
        point.velocity.z += v[self.coordinate];
        point
    }

    fn columns(&self, _: f64, columns: &mut CurveColumns) {
        columns.push(self.coordinate, Vector3::z(), Vector3::zeros());
    }

    fn compliance(&self, s: f64) -> Compliance {
        let anywhere = || self.wire.compliance(s);
        self.place.compliance(s).unwrap_or_else(anywhere)
    }

    fn expect(&self, strip: Option<(&Frame, f64)>) -> Option<f64> {
        let place = strip.map(|(strip, s)| self.above(strip, s));
        match place {
            Some(place) => self.place.set(place, &*self.wire, &self.rest),
            None => self.place.clear(),
        }
        place
    }
}
