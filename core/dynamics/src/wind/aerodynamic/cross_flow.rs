//! The force of the air on a slender cylinder.
use nalgebra::{Matrix3, Vector3};

/// Drag of a cylinder across its axis, per length: the cross-flow principle [Hoerner, Fluid-Dynamic Drag, 1965, chapter
/// 3].
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

    /// Force per length, N/m, of air that moves with `v_r` (m/s) relative to a cylinder along `r_s`, which need not be
    /// of unit length.
    #[must_use]
    pub fn force(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Vector3<f64> {
        let side_by_side = |vector: &Vector3<f64>| [[vector.x], [vector.y], [vector.z]];
        Vector3::from(self.forces(&side_by_side(v_r), &side_by_side(r_s)).map(|[value]| value))
    }

    /// [`CrossFlow::force`] on `N` cylinders side by side, component by component: for loops that fill vector
    /// registers.
    #[inline(always)]
    #[must_use]
    pub fn forces<const N: usize>(&self, v_r: &[[f64; N]; 3], r_s: &[[f64; N]; 3]) -> [[f64; N]; 3] {
        let mut force = [[0.0; N]; 3];
        for i in 0..N {
            let along = v_r[0][i] * r_s[0][i] + v_r[1][i] * r_s[1][i] + v_r[2][i] * r_s[2][i];
            let square = r_s[0][i] * r_s[0][i] + r_s[1][i] * r_s[1][i] + r_s[2][i] * r_s[2][i];
            let share = along / square;
            let across = [
                v_r[0][i] - r_s[0][i] * share,
                v_r[1][i] - r_s[1][i] * share,
                v_r[2][i] - r_s[2][i] * share,
            ];
            let speed = (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt();
            for axis in 0..3 {
                force[axis][i] = self.factor * speed * across[axis];
            }
        }
        force
    }

    /// `∂f/∂v_r`, N·s/m²: symmetric, not negative.
    #[must_use]
    pub fn by_velocity(&self, v_r: &Vector3<f64>, r_s: &Vector3<f64>) -> Matrix3<f64> {
        let across = v_r - r_s * (r_s.dot(v_r) / r_s.norm_squared());
        let speed = across.norm();
        if speed == 0.0 {
            return Matrix3::zeros();
        }
        let projection = Matrix3::identity() - r_s * r_s.transpose() / r_s.norm_squared();
        (projection * speed + across * across.transpose() / speed) * self.factor
    }
}
