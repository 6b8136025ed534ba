//! Rotation vectors and the exponential map of the rotation group.
//!
//! A rotation increment `φ` (rad, 3 entries, body frame) acts from the right: `R ← R exp(φ̃)`, so that the rate of `R`
//! is `Ṙ = R ω̃` with the angular velocity `ω` in the body frame.
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Below this angle (rad) the coefficients come from their series; the first term left out is below rounding.
const SERIES_ANGLE: f64 = 0.02;

/// The matrix of the cross product, `skew(a) b = a × b`.
#[must_use]
pub fn skew(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// The rotation by the rotation vector `phi` (rad), accurate to rounding at any angle, zero included.
#[must_use]
pub fn exp(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = 0.5 * phi.norm();
    // sin(½|φ|)/|φ|; the quotient keeps its digits at any angle that is not zero.
    let scale = if half > 0.0 { 0.5 * half.sin() / half } else { 0.5 };
    UnitQuaternion::new_normalize(Quaternion::from_parts(half.cos(), phi * scale))
}

/// The rotation vector (rad, length at most π) of a rotation; the inverse of [`exp`].
#[must_use]
pub fn log(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let (w, imaginary) = (rotation.w, rotation.imag());
    let sine = imaginary.norm();
    if sine == 0.0 {
        return Vector3::zeros();
    }
    // Take the quaternion with the smaller angle: two stand for each rotation.
    let half = if w < 0.0 { (-sine).atan2(-w) } else { sine.atan2(w) };
    imaginary * (2.0 * half / sine)
}

/// The matrix `T` that takes the rate of a rotation vector to the body-frame angular velocity, `ω = T(φ) φ̇`.
///
/// ```text
/// T(φ) = I − (1 − cos a)/a² φ̃ + (a − sin a)/a³ φ̃²,   a = |φ|      [Brüls, Cardona & Arnold 2012]
/// ```
#[must_use]
pub fn tangent(phi: &Vector3<f64>) -> Matrix3<f64> {
    let angle = phi.norm();
    let a2 = angle * angle;
    let (first, second) = if angle < SERIES_ANGLE {
        (
            0.5 - a2 / 24.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0)),
            1.0 / 6.0 - a2 / 120.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0)),
        )
    } else {
        let half_sine = (0.5 * angle).sin();
        (2.0 * half_sine * half_sine / a2, (angle - angle.sin()) / (a2 * angle))
    };
    let phi = skew(phi);
    Matrix3::identity() - phi * first + phi * phi * second
}

#[cfg(test)]
mod tests {
    use super::*;

    fn awkward() -> [Vector3<f64>; 6] {
        let axis = Vector3::new(0.6, -0.48, 0.64);
        [0.0, 1e-12, 1e-5, 0.0199, 0.0201, 2.5].map(|angle| axis * angle)
    }

    #[test]
    fn the_logarithm_undoes_the_exponential() {
        for phi in awkward() {
            let back = log(&exp(&phi));
            // Rounding of the quaternion's entries.
            assert!((back - phi).norm() <= 4e-16 * (1.0 + phi.norm()), "{phi}");
        }
    }

    #[test]
    fn the_exponential_of_a_skew_matrix_solves_its_differential_equation() {
        for phi in awkward() {
            let series = (1..40).rev().fold(Matrix3::identity(), |sum, n| {
                Matrix3::identity() + skew(&phi) * sum / f64::from(n)
            });
            let rotation = exp(&phi).to_rotation_matrix();
            assert!((rotation.matrix() - series).norm() < 1e-14, "{phi}");
        }
    }

    #[test]
    fn the_tangent_takes_rates_of_the_vector_to_the_angular_velocity() {
        let h = 1e-6;
        for phi in awkward() {
            for axis in 0..3 {
                let rate = Vector3::ith(axis, h);
                let turn = log(&(exp(&(phi - rate)).inverse() * exp(&(phi + rate)))) / (2.0 * h);
                // Central difference: h² and rounding / h.
                assert!((turn - tangent(&phi).column(axis)).norm() < 1e-9, "{phi}");
            }
        }
    }
}
