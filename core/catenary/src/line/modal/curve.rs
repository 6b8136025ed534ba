//! The contact wire of a line in its modes, under one strip.
use crate::{Compliance, CurveColumns, CurvePoint, WireCurve};
use nalgebra::Vector3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

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

    fn expect(&self, s: Option<f64>) {
        self.place.set(s.unwrap_or(f64::NAN));
    }
}
