//! A wire as contact sees it.
use crate::{Compliance, LoadCorrection};
use nalgebra::Vector3;

/// Point of a curve with its derivatives and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Position `r(s)`, m.
    pub r: Vector3<f64>,
    /// `∂r/∂s`, –.
    pub r_s: Vector3<f64>,
    /// `∂²r/∂s²`, 1/m.
    pub r_ss: Vector3<f64>,
    /// Velocity of the material point, m/s.
    pub velocity: Vector3<f64>,
    /// Derivative of the velocity along the wire, 1/s.
    pub velocity_s: Vector3<f64>,
}

/// Effect of one generalised coordinate on the curve at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveColumn {
    /// Index of the generalised coordinate.
    pub index: usize,
    /// `∂r/∂q` (– or m).
    pub n: Vector3<f64>,
    /// `∂r_s/∂q` (1/m or –).
    pub n_s: Vector3<f64>,
}

/// The columns at one point, held without allocation.
#[derive(Clone, Copy, Debug)]
pub struct CurveColumns {
    entries: [CurveColumn; CurveColumns::CAPACITY],
    count: usize,
}

impl Default for CurveColumns {
    fn default() -> Self {
        let empty = CurveColumn {
            index: 0,
            n: Vector3::zeros(),
            n_s: Vector3::zeros(),
        };
        Self {
            entries: [empty; Self::CAPACITY],
            count: 0,
        }
    }
}

impl CurveColumns {
    /// Two nodes with 6 coordinates and an enrichment vector each.
    pub const CAPACITY: usize = 18;

    /// Appends a column.
    ///
    /// # Panics
    /// When there are more than [`CurveColumns::CAPACITY`].
    pub fn push(&mut self, index: usize, n: Vector3<f64>, n_s: Vector3<f64>) {
        self.entries[self.count] = CurveColumn { index, n, n_s };
        self.count += 1;
    }

    /// Removes all columns.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The columns as a slice.
    #[must_use]
    pub fn as_slice(&self) -> &[CurveColumn] {
        &self.entries[..self.count]
    }
}

/// A curve in space, linear in the generalised coordinates: `r(s) = r₀(s) + Σ nᵢ(s) qᵢ`.
///
/// The number of columns per point depends on the wire: 12 for a spatial one, 8 for a planar one, more with
/// enrichments.
pub trait WireCurve: Send + Sync {
    /// Length of the parameter range `0 ≤ s ≤ length`, m.
    fn length(&self) -> f64;

    /// The point at `s` for the coordinates `q` and velocities `v` of the whole system.
    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint;

    /// Appends the columns at `s`.
    fn columns(&self, s: f64, columns: &mut CurveColumns);

    /// Residual compliance at `s`: deflection per strip force beyond the coordinates; zero by default.
    fn compliance(&self, _s: f64) -> Compliance {
        Compliance::default()
    }

    /// Takes in where a strip will be at the end of a step that begins, m; none beyond the ends of the curve.
    fn expect(&self, s: Option<f64>) {
        let _ = s;
    }

    /// Correction of forces that move along the curve; none without corrected inertia.
    fn load_correction(&self) -> Option<LoadCorrection> {
        None
    }
}
