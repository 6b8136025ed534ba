//! The contact wire of a window.
use crate::{Compliance, CurveColumns, CurvePoint, LoadCorrection, WireCurve};
use nalgebra::Vector3;
use std::sync::Arc;

/// A contact wire beyond the window, which no strip reaches: a point far behind all strips.
pub(super) struct Elsewhere;

/// x of a wire that no strip reaches, m.
const FAR_BEHIND: f64 = -1e9;

impl WireCurve for Elsewhere {
    fn length(&self) -> f64 {
        0.0
    }

    fn point(&self, _s: f64, _q: &[f64], _v: &[f64]) -> CurvePoint {
        let zero = Vector3::zeros();
        CurvePoint {
            r: Vector3::x() * FAR_BEHIND,
            r_s: Vector3::x(),
            r_ss: zero,
            velocity: zero,
            velocity_s: zero,
        }
    }

    fn columns(&self, _s: f64, _columns: &mut CurveColumns) {}

    fn compliance(&self, _s: f64) -> Compliance {
        Compliance::default()
    }

    fn load_correction(&self) -> Option<LoadCorrection> {
        None
    }
}

/// The contact wire within the window at its place along the track: the wire starts at x = 0 in its own numbers and is
/// shifted by `origin` and one coordinate of the system.
///
/// The parameter is that of the window's own wire and falls back by a span when the window moves on: the search for the
/// contact finds its point again from anywhere.
pub(super) struct WindowCurve {
    pub inner: Arc<dyn WireCurve>,
    /// Coordinate of the distance that the window has travelled, m.
    pub position: usize,
    /// x of the window's left support at the start, m.
    pub origin: f64,
}

impl WireCurve for WindowCurve {
    fn length(&self) -> f64 {
        self.inner.length()
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        let mut point = self.inner.point(s, q, v);
        point.r.x += self.origin + q[self.position];
        point
    }

    fn columns(&self, s: f64, columns: &mut CurveColumns) {
        self.inner.columns(s, columns);
    }

    fn compliance(&self, s: f64) -> Compliance {
        self.inner.compliance(s)
    }

    fn load_correction(&self) -> Option<LoadCorrection> {
        self.inner.load_correction()
    }
}
