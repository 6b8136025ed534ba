//! The penalty law.
use dynamics::unilateral::unilateral_force;

/// Unilateral penalty law between contact wire and collector strip.
///
/// ```text
/// F = max(0, k δ + φ d δ̇)                                          [Thesis, Eq. (17), with φ = 1 for δ > 0, else 0]
/// ```
///
/// `φ` is the part of a time step in which the contact is closed, see [`dynamics::unilateral::UnilateralStep`]: 1 in a
/// step that begins closed. The thesis' Eq. (17) holds both normals of the wire with a bilateral spring; here only the
/// common normal of wire and strip carries a force, which never pulls, so that contact can be lost and, with stagger,
/// the wire slides along the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyContact {
    /// `k`, N/m, positive.
    pub stiffness: f64,
    /// `d`, N·s/m, non-negative.
    pub damping: f64,
}

impl PenaltyContact {
    /// Magnitude of the normal force in N, with the damper acting for the `part` `φ` of the step; never negative, so
    /// the pair cannot pull.
    ///
    /// `penetration` in m is positive when the strip overlaps the wire; `penetration_rate` is its time derivative in
    /// m/s.
    #[must_use]
    pub fn normal_force(&self, part: f64, penetration: f64, penetration_rate: f64) -> f64 {
        unilateral_force((self.stiffness, self.damping), part, penetration, penetration_rate)
    }

    /// Slopes `(∂F/∂δ, ∂F/∂δ̇)` of the closed contact in series with a compliance that leaves the contact spring the
    /// `share` of the penetration, see [`super::ContactState`].
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
    use dynamics::unilateral::{UnilateralStart, UnilateralStep};

    const LAW: PenaltyContact = PenaltyContact {
        stiffness: 5e4,
        damping: 200.0,
    };
    const H: f64 = 1e-3;
    const OPEN: UnilateralStart = UnilateralStart::Known(-1e-4);
    const CLOSED: UnilateralStart = UnilateralStart::Known(1e-4);

    /// Force at the end of a step of [`H`] that began with `start`.
    fn force_of(start: UnilateralStart, penetration: f64, penetration_rate: f64) -> f64 {
        let step = UnilateralStep::new(start, 0.5 * H);
        let (part, _) = step.closed_part(step.ahead(penetration, penetration_rate), penetration_rate);
        LAW.normal_force(part, penetration, penetration_rate)
    }

    #[test]
    fn what_ends_apart_half_a_step_ahead_exerts_no_force_however_fast_it_closes() {
        for start in [UnilateralStart::Unknown, OPEN, UnilateralStart::APART] {
            assert_eq!(force_of(start, -0.5 * H * 10.0, 10.0), 0.0);
            assert_eq!(force_of(start, -1e-9, -10.0), 0.0);
        }
        assert_eq!(LAW.energy(-1e-3), 0.0);
    }

    #[test]
    fn damping_never_turns_compression_into_tension() {
        for start in [UnilateralStart::Unknown, OPEN, CLOSED] {
            assert_eq!(force_of(start, 1e-3, -1.0), 0.0);
        }
        assert_eq!(force_of(CLOSED, -1e-3, 0.1), 0.0);
    }

    #[test]
    fn a_closed_contact_is_a_spring_with_a_damper_that_acts_for_the_part_of_a_step_in_which_it_is_closed() {
        // 5e4 N/m * 1 mm + 200 N s/m * 0.1 m/s
        assert_eq!(force_of(CLOSED, 1e-3, 0.1), 70.0);
        assert_eq!(force_of(UnilateralStart::Unknown, 1e-3, 0.1), 70.0);
        assert_eq!(force_of(UnilateralStart::Known(0.0), 1e-3, 0.1), 70.0);
        assert_eq!(force_of(UnilateralStart::Known(0.0), 1e-3, -0.1), 30.0);
        // A quarter of the way half a step ahead: 4e-4 m of 1e-4 + 0.5 ms * 0.1 m/s + 4.5e-4 m.
        let quarter = force_of(UnilateralStart::Known(-4.5e-4), 1e-4, 0.1);
        assert!(
            (quarter - (5.0 + 0.25 * 20.0)).abs() < 1e-12,
            "rounding of 10 N: {quarter}"
        );
        // A member that moves apart again is under the whole damper.
        assert_eq!(force_of(UnilateralStart::Known(-4.5e-4), 1e-3, -0.1), 30.0);
        // Denormal numbers at most remain of the damper.
        assert!((force_of(UnilateralStart::APART, 1e-3, 0.1) - 50.0).abs() < 1e-12);
    }

    /// Along a step of `h`, `δ̇ = A + 2 δ/h` (trapezoid).
    #[test]
    fn along_a_step_the_force_neither_jumps_nor_falls() {
        for start in [
            OPEN,
            CLOSED,
            UnilateralStart::Known(-1e-9),
            UnilateralStart::Known(0.0),
            UnilateralStart::APART,
        ] {
            for offset in [-1.0, -0.1, 0.0, 0.1, 1.0] {
                let force = |penetration: f64| force_of(start, penetration, offset + 2.0 * penetration / H);
                let step = 1e-9;
                let forces: Vec<f64> = (-600_000..600_000).map(|i| force(f64::from(i) * step)).collect();
                let name = format!("{start:?}, {offset} m/s");
                assert!(
                    forces.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12),
                    "rounding of 300 N: {name}"
                );
                // A step that begins just open may be of any steepness.
                if !matches!(start, UnilateralStart::Known(start) if start > -1e-6 && start < 0.0) {
                    // The steepest is 2 d A/|δ⁺₀| beside k + 2 d/h: 4.5e6 N/m.
                    let rise = forces.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
                    assert!(rise < 4.6e6 * step, "{name}: {rise} N in {step} m");
                }
            }
        }
    }

    #[test]
    fn the_force_is_continuous_in_where_the_step_begins_while_it_ends_closed() {
        for (penetration, rate) in [(1e-6, 0.1), (1e-4, 0.1), (1e-4, -0.01)] {
            let [before, after] =
                [-1e-12, 1e-12].map(|start| force_of(UnilateralStart::Known(start), penetration, rate));
            // 20 N of damping, of which 1e-12/5e-5 is left out.
            assert!((after - before).abs() < 5e-7, "{before} {after}");
        }
    }

    #[test]
    fn the_elastic_force_is_the_derivative_of_the_energy() {
        let h = 1e-6;
        let slope = (LAW.energy(2e-3 + h) - LAW.energy(2e-3 - h)) / (2.0 * h);
        assert!(
            (slope - force_of(CLOSED, 2e-3, 0.0)).abs() < 1e-6 * slope,
            "central difference"
        );
    }
}
