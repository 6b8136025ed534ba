//! The force of the air on a slender body whose cross-section is not round: drag and lift by angle of attack.
use super::{CrossFlow, Polar};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use std::sync::Arc;

/// Drag and lift of a slender body across its axis, per length, as for the same body at rest in the same relative air
/// (quasi-steady).
///
/// ```text
/// f = ½ ρ d |w|² (C_D ŵ + C_L ℓ),    w = v_r − τ (τ · v_r),    α = atan2(w · u, |w · h|)
/// ```
///
/// `τ` is the direction of the axis, `u` the part of the vertical across it, `h = u × τ`; `ℓ` is across `ŵ` and `τ`, on
/// the side of `u`: a positive lift acts upwards, whichever side the air comes from. `α` is positive for air from
/// below.
/// The cross-section keeps its place about the axis, and its windward side is the one that the table describes.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionFlow {
    /// `½ ρ d`, N·s²/m³.
    factor: f64,
    polar: Arc<Polar>,
}

/// Drag and lift of a slender body in moving air.
#[derive(Clone, Debug, PartialEq)]
pub enum SlenderFlow {
    /// Round: drag alone.
    Round(CrossFlow),
    /// With a table of drag and lift by angle of attack.
    Section(SectionFlow),
}

/// Axes across a slender body along `r_s`: the horizontal `h` and the upward `u`; none for a vertical body.
fn axes(r_s: &Vector3<f64>) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let along = r_s.normalize();
    let up = (Vector3::z() - along * along.z).try_normalize(1e-9)?;
    Some((up.cross(&along), up))
}

impl SectionFlow {
    /// A body of the width `diameter` (m) that drag and lift coefficients are by, in air of `density` (kg/m³).
    #[must_use]
    pub fn new(density: f64, diameter: f64, polar: Polar) -> Self {
        Self {
            factor: 0.5 * density * diameter,
            polar: Arc::new(polar),
        }
    }

    /// Angle of attack of air that moves with `v_r` (m/s) relative to a body along `r_s`, rad; none for a
    /// vertical body.
    #[must_use]
    pub fn angle(v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Option<f64> {
        let (side, up) = axes(r_s)?;
        Some(up.dot(v_r).atan2(side.dot(v_r).abs()))
    }

    /// Force per length, N/m, as [`CrossFlow::force`].
    #[must_use]
    pub fn force(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Vector3<f64> {
        let Some((side, up)) = axes(r_s) else {
            return Vector3::zeros();
        };
        let (force, _) = self.in_plane(side.dot(v_r), up.dot(v_r));
        side * force.x + up * force.y
    }

    /// `∂f/∂v_r`, N·s/m².
    #[must_use]
    pub fn by_velocity(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Matrix3<f64> {
        let Some((side, up)) = axes(r_s) else {
            return Matrix3::zeros();
        };
        let (_, by) = self.in_plane(side.dot(v_r), up.dot(v_r));
        side * (side * by.m11 + up * by.m12).transpose() + up * (side * by.m21 + up * by.m22).transpose()
    }

    /// Force along `h` and `u` of air with these components, and its derivative by them.
    fn in_plane(&self, w_h: f64, w_u: f64) -> (Vector2<f64>, Matrix2<f64>) {
        let w = Vector2::new(w_h, w_u);
        let speed = w.norm();
        if speed == 0.0 {
            return (Vector2::zeros(), Matrix2::zeros());
        }
        let [(drag, drag_slope), (lift, lift_slope)] = self.polar.at(w_u.atan2(w_h.abs()));
        let sign = if w_h < 0.0 { -1.0 } else { 1.0 };
        // `ℓ = turn · ŵ`.
        let turn = Matrix2::new(0.0, -sign, sign, 0.0);
        let shape = Matrix2::identity() * drag + turn * lift;
        let slope = Matrix2::identity() * drag_slope + turn * lift_slope;
        let angle_rate = Vector2::new(-w_u * sign, w_h.abs()) / (speed * speed);
        let force = shape * w * speed;
        let by = shape * w * w.transpose() / speed + shape * speed + slope * w * angle_rate.transpose() * speed;
        (force * self.factor, by * self.factor)
    }

    /// Damping per length by the air about a body that is driven across its axis by a steady wind, N·s/m²: the negative
    /// derivative of the force by the velocity of the body, horizontal and upward; where the table has an edge, the
    /// mean of both sides.
    ///
    /// ```text
    /// c_uu = ½ ρ d U (C_D + ∂C_L/∂α)        at α = 0: negative where Den Hartog's criterion is met
    /// ```
    ///
    /// [J. P. Den Hartog, Transmission line vibration due to sleet, Transactions of the AIEE 51, 1932]; both directions
    /// together as in [Luongo & Piccardo 2005, Journal of Sound and Vibration 287].
    #[must_use]
    pub fn damping(&self, wind: &Vector3<f64>, r_s: &Vector3<f64>) -> Matrix2<f64> {
        let Some((side, up)) = axes(r_s) else {
            return Matrix2::zeros();
        };
        let (w_h, w_u) = (side.dot(wind), up.dot(wind));
        // Just above and just below the angle of the wind.
        let beside = EDGE * wind.norm();
        let [above, below] = [beside, -beside].map(|more| self.in_plane(w_h, w_u + more).1);
        (above + below) * 0.5
    }

    /// Smallest and largest angle of the table, rad; none for coefficients that hold at all angles.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        self.polar.range()
    }
}

/// Distance from an angle that the derivative of a table is taken at, rad.
const EDGE: f64 = 1e-6;

/// Speed of the wind across a slender body from which on it gallops in one vertical mode, m/s: Den Hartog's criterion
/// with damping of the structure.
///
/// ```text
/// 2 m ζ ω + ½ ρ d U (C_D + ∂C_L/∂α) = 0
/// ```
///
/// `mass` is by length (kg/m), `rate = 2 ζ ω` the damping of the mode (1/s), `density` that of the air (kg/m³),
/// `slope = C_D + ∂C_L/∂α`; none where the slope is not negative.
#[must_use]
pub fn galloping_speed(mass: f64, rate: f64, density: f64, diameter: f64, slope: f64) -> Option<f64> {
    (slope < 0.0).then(|| 2.0 * mass * rate / (density * diameter * -slope))
}

impl SlenderFlow {
    /// Force per length, N/m, of air that moves with `v_r` (m/s) relative to a body along `r_s`, which need not be of
    /// unit length.
    #[must_use]
    pub fn force(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Round(flow) => flow.force(v_r, r_s),
            Self::Section(flow) => flow.force(v_r, r_s),
        }
    }

    /// [`SlenderFlow::force`] on `N` bodies side by side, component by component.
    #[inline(always)]
    #[must_use]
    pub fn forces<const N: usize>(&self, v_r: &[[f64; N]; 3], r_s: &[[f64; N]; 3]) -> [[f64; N]; 3] {
        match self {
            Self::Round(flow) => flow.forces(v_r, r_s),
            Self::Section(flow) => {
                let mut force = [[0.0; N]; 3];
                for i in 0..N {
                    let of = |vectors: &[[f64; N]; 3]| Vector3::new(vectors[0][i], vectors[1][i], vectors[2][i]);
                    let found = flow.force(&of(v_r), &of(r_s));
                    for axis in 0..3 {
                        force[axis][i] = found[axis];
                    }
                }
                force
            }
        }
    }

    /// `∂f/∂v_r`, N·s/m².
    #[must_use]
    pub fn by_velocity(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Matrix3<f64> {
        match self {
            Self::Round(flow) => flow.by_velocity(v_r, r_s),
            Self::Section(flow) => flow.by_velocity(v_r, r_s),
        }
    }
}

impl From<CrossFlow> for SlenderFlow {
    fn from(flow: CrossFlow) -> Self {
        Self::Round(flow)
    }
}

impl From<SectionFlow> for SlenderFlow {
    fn from(flow: SectionFlow) -> Self {
        Self::Section(flow)
    }
}
