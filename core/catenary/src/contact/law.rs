//! The penalty law.

/// Unilateral penalty law between contact wire and collector strip.
///
/// ```text
/// F = max(0, k δ + d δ̇)    δ > 0                                   [Thesis, Eq. (17)]
/// F = 0                     δ ≤ 0
/// ```
///
/// The thesis' Eq. (17) holds both normals of the wire with the bilateral spring; here only the common normal of wire and
/// strip carries a force and it never pulls, so that contact can be lost and, with stagger, the wire slides along the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyContact {
    /// `k`, N/m, positive.
    pub stiffness: f64,
    /// `d`, N·s/m, non-negative.
    pub damping: f64,
}

impl PenaltyContact {
    /// Magnitude of the normal force in N; never negative, so the pair cannot pull.
    ///
    /// `penetration` in m is positive when the strip overlaps the wire; `penetration_rate` is its time derivative in m/s.
    #[must_use]
    pub fn normal_force(&self, penetration: f64, penetration_rate: f64) -> f64 {
        if penetration <= 0.0 {
            return 0.0;
        }
        (self.stiffness * penetration + self.damping * penetration_rate).max(0.0)
    }

    /// `(∂F/∂δ, ∂F/∂δ̇)`: `(k, d)` where the force is positive, else zero.
    #[must_use]
    pub fn derivatives(&self, penetration: f64, penetration_rate: f64) -> (f64, f64) {
        if self.normal_force(penetration, penetration_rate) > 0.0 {
            (self.stiffness, self.damping)
        } else {
            (0.0, 0.0)
        }
    }

    /// Slopes `(∂F/∂δ, ∂F/∂δ̇)` of the closed contact in series with a part that leaves it the `share` of the penetration, see
    /// [`super::ContactState`].
    #[must_use]
    pub fn yielding(&self, share: f64) -> (f64, f64) {
        (share * self.stiffness, share * share * self.damping)
    }

    /// Energy `½ k δ²` stored in the closed contact, J.
    #[must_use]
    pub fn energy(&self, penetration: f64) -> f64 {
        0.5 * self.stiffness * penetration.max(0.0).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: PenaltyContact = PenaltyContact {
        stiffness: 5e4,
        damping: 200.0,
    };

    #[test]
    fn separated_bodies_exert_no_force_however_fast_they_close() {
        assert_eq!(LAW.normal_force(-1e-9, 10.0), 0.0);
        assert_eq!(LAW.normal_force(0.0, 10.0), 0.0);
        assert_eq!(LAW.energy(-1e-3), 0.0);
    }

    #[test]
    fn damping_never_makes_the_contact_pull() {
        assert_eq!(LAW.normal_force(1e-3, -1.0), 0.0);
        assert_eq!(LAW.derivatives(1e-3, -1.0), (0.0, 0.0));
    }

    #[test]
    fn the_elastic_force_is_the_derivative_of_the_energy() {
        let h = 1e-6;
        let slope = (LAW.energy(2e-3 + h) - LAW.energy(2e-3 - h)) / (2.0 * h);
        assert!(
            (slope - LAW.normal_force(2e-3, 0.0)).abs() < 1e-6 * slope,
            "central difference"
        );
    }

    #[test]
    fn the_derivatives_are_those_of_the_force() {
        let (delta, rate, h) = (2e-3, 0.05, 1e-7);
        let (k, d) = LAW.derivatives(delta, rate);
        let by_delta = (LAW.normal_force(delta + h, rate) - LAW.normal_force(delta - h, rate)) / (2.0 * h);
        let by_rate = (LAW.normal_force(delta, rate + h) - LAW.normal_force(delta, rate - h)) / (2.0 * h);
        assert!((k - by_delta).abs() < 1e-6 * k && (d - by_rate).abs() < 1e-6 * d);
    }
}
