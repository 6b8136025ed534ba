//! Numerical energy error of time steps in which droppers go slack or taut.

/// Sum of the energy that time steps make or lose when droppers of a line go slack or taut.
///
/// Derived here. An integrator with the trapezoidal rule's displacement lets a spring work with the mean of its two end
/// forces, `½ (F₀ + F₁)(δ₁ − δ₀)`, which is exactly the change of its energy `½ k δ²`. If the dropper is slack at one
/// end of the step, one of the forces is zero, and the energy changes besides that work by
///
/// ```text
/// ΔU − ½ (F₀ + F₁)(δ₁ − δ₀) = ½ k δ₀ δ₁ in a step that ends taut, −½ k δ₀ δ₁ in one that ends slack     (δ₀ δ₁ < 0)
/// ```
///
/// A step that closes loses energy, a step that opens makes as much as it overshoots. The two cancel in the mean for
/// steps short against the dropper's own oscillation, and not for long ones. Numerical damping takes part of the energy
/// back.
#[derive(Clone, Debug, Default)]
pub struct Slackening {
    stiffness: f64,
    /// Elongations at the beginning of the next step, m; empty if unknown.
    elongations: Vec<f64>,
    made: f64,
}

impl Slackening {
    /// Counter for droppers of `stiffness` N/m.
    #[must_use]
    pub fn new(stiffness: f64) -> Self {
        Self {
            stiffness,
            ..Self::default()
        }
    }

    /// Energy made since the start, J; negative where it was lost.
    #[must_use]
    pub fn made(&self) -> f64 {
        self.made
    }

    /// Takes in the elongations at the end of a step, m.
    pub fn step(&mut self, elongations: &[f64]) {
        let steps = self.elongations.iter().zip(elongations);
        let made = steps.map(|(&start, &end)| energy_made(self.stiffness, start, end));
        self.made += made.sum::<f64>();
        self.restart(elongations);
    }

    /// Restarts with other droppers, which begin the next step with these elongations, m.
    pub fn restart(&mut self, elongations: &[f64]) {
        self.elongations.clear();
        self.elongations.extend_from_slice(elongations);
    }

    /// Restarts with other droppers of unknown elongations: the next step is not counted.
    pub fn forget(&mut self) {
        self.elongations.clear();
    }
}

/// Energy made in one step of one dropper, J; see [`Slackening`].
fn energy_made(stiffness: f64, start: f64, end: f64) -> f64 {
    let product = 0.5 * stiffness * start * end;
    match (start > 0.0, end > 0.0) {
        (false, true) => product,
        (true, false) => -product,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DropperLaw;

    #[test]
    fn steps_of_other_droppers_do_not_begin_where_those_before_have_ended() {
        let mut slackening = Slackening::new(1e5);
        slackening.step(&[-2e-3, 1e-3]);
        slackening.step(&[-1e-3, 1e-3]);
        slackening.restart(&[1e-3, -1e-3]);
        slackening.step(&[2e-3, -2e-3]);
        slackening.forget();
        slackening.step(&[-2e-3, 2e-3]);
        assert_eq!(slackening.made(), 0.0, "none has gone slack or taut");
        slackening.step(&[1e-3, 2e-3]);
        assert_eq!(slackening.made(), energy_made(1e5, -2e-3, 1e-3));
    }

    #[test]
    fn what_a_step_makes_is_what_the_energy_changes_by_besides_the_work_of_the_mean_force() {
        let stiffness = 1e5;
        let law = DropperLaw {
            stiffness,
            damping: 0.0,
        };
        for (start, end) in [(1e-3, 2e-3), (-1e-3, -2e-3), (-1e-3, 3e-3), (2e-3, -1e-3)] {
            let force = |elongation: f64| stiffness * elongation.max(0.0);
            let work = 0.5 * (force(start) + force(end)) * (end - start);
            let beside = law.energy(end) - law.energy(start) - work;
            // Rounding of energies of 0.5 J at most.
            assert!(
                (energy_made(stiffness, start, end) - beside).abs() < 1e-15,
                "{start} {end}"
            );
        }
        assert!(energy_made(stiffness, 2e-3, -1e-3) > 0.0 && energy_made(stiffness, -1e-3, 2e-3) < 0.0);
    }
}
