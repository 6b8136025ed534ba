//! A wire with corrections for its mesh and for the time step under strips.
use super::{ResidualCompliance, RunningSurface};
use std::sync::Arc;
use wire::{Compliance, CurveColumns, CurvePoint, LoadCorrection, WireCurve, WireGeometry};

/// A wire with its running surface, and with corrections for its mesh and for the time step under strips.
#[derive(Clone, Debug)]
pub struct CorrectedWire {
    /// The wire.
    pub geometry: Arc<WireGeometry>,
    /// Residual compliance of the mesh.
    pub compliance: Option<Arc<ResidualCompliance>>,
    /// Correction of the contact force that belongs to the corrected inertia.
    pub load: Option<LoadCorrection>,
    /// Running surface that is not even.
    pub surface: Option<Arc<RunningSurface>>,
}

impl WireCurve for CorrectedWire {
    fn length(&self) -> f64 {
        self.geometry.length()
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        let mut point = self.geometry.point(s, q, v);
        if let Some(surface) = &self.surface {
            surface.raise(s, &mut point);
        }
        point
    }

    fn columns(&self, s: f64, columns: &mut CurveColumns) {
        self.geometry.columns(s, columns);
    }

    fn compliance(&self, s: f64) -> Compliance {
        self.compliance
            .as_ref()
            .map_or(Compliance::default(), |residual| residual.at(s))
    }

    fn load_correction(&self) -> Option<LoadCorrection> {
        self.load
    }
}
