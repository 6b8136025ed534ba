//! Rates of what an FMU offers without its rate.

/// Least and most mass that the response of an FMU is believed to be, kg.
const BELIEVED: std::ops::Range<f64> = 0.01..1e4;

/// The velocity of a coordinate known at communication points only.
///
/// With the acceleration `g + f/m` over the last two steps, `g` being the same in both, `f` the force of each and
/// `d₁ = (z₁ − z₀)/h₁`, `d₂ = (z₂ − z₁)/h₂`:
///
/// ```text
/// v₂ = d₂ + h₂ (d₂ − d₁)/(h₁ + h₂) + h₁ h₂ (f₂ − f₁)/(2 m (h₁ + h₂))        (derived here)
/// ```
///
/// The first two terms alone are the backward differentiation formula of order 2, whose error is `h² z‴/3`; with the
/// last one a force that jumps from step to step makes none, and what is left is `h² ġ/3`. Where the mass is not known,
/// the last term is left out. After one step the formula is the difference quotient.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rate {
    /// Last positions, newest first, in m or rad.
    z: [f64; 2],
    /// Last step, s.
    h: f64,
    /// Mean force over the last step, N.
    force: f64,
    /// Positions known, two at most.
    known: usize,
    /// 1/m, 1/kg; 0 where it is not known.
    compliance: f64,
}

impl Rate {
    /// For a coordinate that a force moves like `mass` in kg.
    pub fn of_mass(mass: Option<f64>) -> Self {
        Self {
            compliance: mass.filter(|mass| BELIEVED.contains(mass)).map_or(0.0, f64::recip),
            ..Self::default()
        }
    }

    /// The first position: what was known before counts no more.
    pub fn restart(&mut self, z: f64) {
        *self = Self {
            z: [z, z],
            known: 1,
            compliance: self.compliance,
            ..Self::default()
        };
    }

    /// Velocity at the end of a step of `h` s that ends at `z`, under the mean force `force` in N in the direction of
    /// z.
    pub fn next(&mut self, z: f64, h: f64, force: f64) -> f64 {
        let last = (z - self.z[0]) / h;
        let velocity = if self.known < 2 {
            last
        } else {
            let before = (self.z[0] - self.z[1]) / self.h;
            let both = h + self.h;
            last + h * (last - before) / both + 0.5 * self.compliance * h * self.h * (force - self.force) / both
        };
        self.z = [z, self.z[0]];
        (self.h, self.force) = (h, force);
        self.known = (self.known + 1).min(2);
        velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error for z = sin t in steps of h, of which every second one is longer by `stretch`.
    fn error(h: f64, stretch: f64) -> f64 {
        let mut rate = Rate::default();
        rate.restart(0.0);
        let (mut t, mut worst, mut n) = (0.0, 0.0_f64, 0);
        while t < 2.0 {
            let step = if n % 2 == 0 { h } else { stretch * h };
            t += step;
            n += 1;
            let velocity = rate.next(f64::sin(t), step, 0.0);
            if n > 1 {
                worst = worst.max((velocity - f64::cos(t)).abs());
            }
        }
        worst
    }

    #[test]
    fn a_smooth_motion_is_differentiated_with_order_two_also_in_unequal_steps() {
        for stretch in [1.0, 1.7] {
            let order = (error(0.02, stretch) / error(0.01, stretch)).log2();
            assert!((order - 2.0).abs() < 0.05, "order {order} with stretch {stretch}");
        }
        let expected = 0.01_f64.powi(2) / 3.0;
        assert!((error(0.01, 1.0) / expected - 1.0).abs() < 0.05, "h² z‴/3");
    }

    /// A mass of 7 kg under a force that jumps at every communication point.
    #[test]
    fn forces_that_jump_make_no_error_where_the_mass_is_known() {
        let (m, h) = (7.0, 1e-3);
        let errors = [Some(m), None].map(|mass| {
            let mut rate = Rate::of_mass(mass);
            rate.restart(0.0);
            let (mut z, mut v, mut worst) = (0.0, 0.0, 0.0_f64);
            for n in 0..50 {
                let force = 120.0 * f64::sin(1.7 * f64::from(n));
                z += h * v + 0.5 * h * h * force / m;
                v += h * force / m;
                let found = rate.next(z, h, force);
                if n > 0 {
                    worst = worst.max((found - v).abs());
                }
            }
            worst
        });
        assert!(errors[0] < 1e-11, "{errors:?}");
        assert!(errors[1] > 1e-4, "{errors:?}");
    }
}
