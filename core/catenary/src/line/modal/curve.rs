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
/// Steps of the search; wires are all but straight over [`COARSE`].
const SEARCH: usize = 2;

/// Parameter on the wire that a contact expects at the end of the present step, m; not a number beyond the wire.
#[derive(Clone, Debug)]
pub(super) struct Place(Arc<AtomicU64>);

impl Default for Place {
    fn default() -> Self {
        Self(Arc::new(AtomicU64::new(f64::NAN.to_bits())))
    }
}

impl Place {
    pub fn set(&self, s: f64) {
        self.0.store(s.to_bits(), Ordering::Relaxed);
    }

    pub fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
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
    /// Parameter of the wire at rest above a strip, near `s`, m.
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
        }
        to(place, FINE)
    }
}

impl WireCurve for ModalCurve {
    fn length(&self) -> f64 {
        self.wire.length()
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        let mut point = self.wire.point(s, &self.rest, &self.rest);
        point.r.z += q[self.coordinate];
        point.velocity.z += v[self.coordinate];
        point
    }

    fn columns(&self, _: f64, columns: &mut CurveColumns) {
        columns.push(self.coordinate, Vector3::z(), Vector3::zeros());
    }

    fn compliance(&self, s: f64) -> Compliance {
        self.wire.compliance(s)
    }

    fn expect(&self, strip: Option<(&Frame, f64)>) {
        let place = strip.map(|(strip, s)| self.above(strip, s));
        self.place.set(place.unwrap_or(f64::NAN));
    }
}
