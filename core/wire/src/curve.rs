//! A wire as contact sees it.
use dynamics::Frame;
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

/// Compliance of one point of a wire and its derivative along the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compliance {
    /// m/N, not negative.
    pub value: f64,
    /// 1/N.
    pub slope: f64,
}

/// Correction of forces that move along a wire whose inertia is corrected for the time step `h`.
///
/// In steps of `h` the integrator replaces `d²/dt²` by the operator `D² (1 − ε D²)`, `ε = κ h²`, `D` the time
/// derivative, to this order. The corrected mass `M − ε K` turns the equation of a wire under the nodal forces `φ`,
/// without terms of the order of `ε²`, into
///
/// ```text
/// (M − ε K) D² (1 − ε D²) q + K q = (1 − ε D²) (M D² q + K q) = φ
/// ```
///
/// The result is the equation of the wire if `φ` too is `1 − ε D²` of the true nodal forces, as in the method of
/// Numerov. At a node that the strip runs past, the force changes fast, however slowly the contact force does: a
/// contact force of 20 Hz that moves at two thirds of the speed of the waves sends out waves of 60 Hz. The nodal forces
/// of a contact force `F` at `s` are therefore
///
/// ```text
/// N(s) F − κ (N(s + ṡh) (F + Ḟh) − 2 N(s) F + N(s − ṡh) (F − Ḟh)) = N F − ε (N,ₛₛ ṡ² F + 2 N,ₛ ṡ Ḟ)
/// ```
///
/// The second part has no resultant. The correction is found once per step, with `F` continued in a straight line
/// through the ends of the last two, so that the tangent stays unchanged. `N F̈` is left out: its error `ε F̈` is that
/// of a force at rest, small ahead of a moving strip and of the size of the uncorrected error behind it. Derived here;
/// tested by `a_moving_force_is_corrected_with_the_mass`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadCorrection {
    /// `h`, s.
    pub step: f64,
    /// `κ`, –; 1/6 of the trapezoidal rule.
    pub kappa: f64,
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

    /// Takes in where a strip will be at the end of a step that begins, with the parameter of the last closest point,
    /// m; none beyond the ends of the curve. Returns a parameter near the coming closest point if it is known.
    fn expect(&self, strip: Option<(&Frame, f64)>) -> Option<f64> {
        let _ = strip;
        None
    }

    /// Correction of forces that move along the curve; none without corrected inertia.
    fn load_correction(&self) -> Option<LoadCorrection> {
        None
    }
}
