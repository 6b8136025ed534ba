//! Drag and lift coefficients by angle of attack.
use nalgebra::{Matrix3, Vector3};

/// Coefficients times area by angle of attack, with straight lines between the angles; beyond them they are those of
/// the ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    angles: Vec<f64>,
    drag: Vec<f64>,
    lift: Vec<f64>,
}

/// A coefficient and its derivative by the angle.
type Coefficient = (f64, f64);

impl Polar {
    /// Constant coefficients: `C_D A` and `C_L A` in m².
    #[must_use]
    pub fn constant(drag: f64, lift: f64) -> Self {
        Self::table(vec![0.0], vec![drag], vec![lift])
    }

    /// `C_D A` and `C_L A` (m²) at ascending angles of attack (rad).
    ///
    /// # Panics
    /// When the lists are empty or of different lengths, or the angles do not ascend.
    #[must_use]
    pub fn table(angles: Vec<f64>, drag: Vec<f64>, lift: Vec<f64>) -> Self {
        assert!(
            !angles.is_empty() && angles.len() == drag.len() && angles.len() == lift.len(),
            "{} angles, {} drag and {} lift coefficients",
            angles.len(),
            drag.len(),
            lift.len()
        );
        assert!(angles.windows(2).all(|pair| pair[0] < pair[1]), "angles must ascend");
        Self { angles, drag, lift }
    }

    /// Smallest and largest angle, rad; none for constant coefficients.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        let (first, last) = (self.angles.first()?, self.angles.last()?);
        (first < last).then_some((*first, *last))
    }

    /// `C_D A` and `C_L A` at an angle (rad), each with its slope; of coefficients by width the same per width.
    pub(super) fn at(&self, angle: f64) -> [Coefficient; 2] {
        let after = self.angles.partition_point(|entry| *entry <= angle);
        let ends = after == 0 || after == self.angles.len();
        [&self.drag, &self.lift].map(|values| {
            if ends {
                return (values[after.saturating_sub(1)], 0.0);
            }
            let (low, high) = (after - 1, after);
            let slope = (values[high] - values[low]) / (self.angles[high] - self.angles[low]);
            (values[low] + slope * (angle - self.angles[low]), slope)
        })
    }

    /// Drag and lift of [`Polar::force`], N.
    pub(super) fn drag_and_lift(&self, half: f64, v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> [f64; 2] {
        let square = v_r.norm_squared();
        if square == 0.0 {
            return [0.0; 2];
        }
        let (_, [(drag, _), (lift, _)]) = self.met_by(v_r, axes);
        // Along the third axis there is no direction for it.
        let lift = if across(v_r, axes).norm() > 0.0 { lift } else { 0.0 };
        [drag, lift].map(|coefficient| half * square * coefficient)
    }

    /// The air along the first and the third axis, and the coefficients at its angle of attack.
    fn met_by(&self, v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> ([f64; 2], [Coefficient; 2]) {
        let (w_1, w_3) = (axes.column(0).dot(v_r), axes.column(2).dot(v_r));
        ([w_1, w_3], self.at(w_3.atan2(-w_1)))
    }

    /// The force for `half` the density (kg/m³) and its derivative by `v_r`.
    pub(super) fn force(&self, half: f64, v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let square = v_r.norm_squared();
        if square == 0.0 {
            return (Vector3::zeros(), Matrix3::zeros());
        }
        let speed = square.sqrt();
        let (ahead, up) = (axes.column(0).into_owned(), axes.column(2).into_owned());
        let ([w_1, w_3], [(drag, drag_slope), (lift, lift_slope)]) = self.met_by(v_r, axes);
        // ∂α/∂v_r; air along the second axis has no angle of attack.
        let in_plane = w_1 * w_1 + w_3 * w_3;
        let angle_rate = if in_plane > 0.0 {
            (ahead * w_3 - up * w_1) / in_plane
        } else {
            Vector3::zeros()
        };
        let mut force = v_r * (speed * drag);
        let mut by_velocity = (Matrix3::identity() * speed + v_r * v_r.transpose() / speed) * drag
            + v_r * angle_rate.transpose() * (speed * drag_slope);
        let across = across(v_r, axes);
        let length = across.norm();
        if length > 0.0 {
            let direction = across / length;
            let across_rate = v_r * v_r.transpose() * (2.0 * w_3 / (square * square))
                - (Matrix3::identity() * w_3 + v_r * up.transpose()) / square;
            let turning = (Matrix3::identity() - direction * direction.transpose()) * across_rate / length;
            force += direction * (square * lift);
            by_velocity += (direction * v_r.transpose() * 2.0 + turning * square) * lift
                + direction * angle_rate.transpose() * (square * lift_slope);
        }
        (force * half, by_velocity * half)
    }
}

/// `p = n − v (v·n)/v²`: the part of the third axis `n` across air that moves.
fn across(v_r: &Vector3<f64>, axes: &Matrix3<f64>) -> Vector3<f64> {
    let up = axes.column(2);
    up - v_r * (up.dot(v_r) / v_r.norm_squared())
}
