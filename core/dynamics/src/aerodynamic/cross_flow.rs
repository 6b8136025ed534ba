//! The force of the air on a slender cylinder.
use nalgebra::{Matrix3, Vector3};

/// Drag of a cylinder across its axis, per length: the cross-flow principle [Hoerner, Fluid-Dynamic Drag, 1965, chapter 3].
///
/// ```text
/// f = ½ ρ C_D d |v_n| v_n,    v_n = v_r − τ (τ · v_r)
/// ```
///
/// `τ` is the direction of the axis. The drag along the axis, by friction, is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossFlow {
    /// `½ ρ C_D d`, N·s²/m³.
    factor: f64,
}

impl CrossFlow {
    /// A cylinder of `diameter` (m) and `C_D = drag_coefficient` (–, by its diameter) in air of `density` (kg/m³).
    #[must_use]
    pub fn new(density: f64, drag_coefficient: f64, diameter: f64) -> Self {
        Self {
            factor: 0.5 * density * drag_coefficient * diameter,
        }
    }

    /// Part of `v_r` across the direction of `r_s`, which need not be of unit length.
    fn across(v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Vector3<f64> {
        v_r - r_s * (r_s.dot(v_r) / r_s.norm_squared())
    }

    /// Force per length, N/m, of air that moves with `v_r` (m/s) relative to a cylinder along `r_s`.
    #[inline]
    #[must_use]
    pub fn force(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Vector3<f64> {
        let across = Self::across(v_r, r_s);
        across * (self.factor * across.norm())
    }

    /// `∂f/∂v_r`, N·s/m²: symmetric, not negative.
    #[must_use]
    pub fn by_velocity(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Matrix3<f64> {
        let across = Self::across(v_r, r_s);
        let speed = across.norm();
        if speed == 0.0 {
            return Matrix3::zeros();
        }
        let projection = Matrix3::identity() - r_s * r_s.transpose() / r_s.norm_squared();
        (projection * speed + across * across.transpose() / speed) * self.factor
    }
}
