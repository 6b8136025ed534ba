//! Multipliers of constraints that move: held by the time steps, and reported.
use crate::integrate::scheme::Scheme;
use serde::{Deserialize, Serialize};

/// The multipliers of constraints that move along the coordinates of a system, [`crate::Constraint::moves`], in
/// generalized-α.
///
/// Such a constraint holds by its rate at both ends of a step, so that the impulse of its multiplier over the step
/// follows from velocities alone and carries no memory of earlier steps. The multiplier at the end of the step does.
/// With `ℓ` the multiplier's share in the auxiliary accelerations,
///
/// ```text
/// (1 − α_m) ℓₙ₊₁ + α_m ℓₙ = (1 − α_f) λₙ₊₁ + α_f λₙ
/// I / h = (1 − γ) ℓₙ + γ ℓₙ₊₁                                        derived here
/// ```
///
/// an error of `λ` comes back in the next step `−α_f/(1 − α_f) = −rho_inf` times, though `I` has none. The mean force
/// `I/h` belongs to the middle of the step, to second order for all coefficients with `γ = ½ + α_f − α_m`. The reported
/// multiplier is the straight line through the last two means, at the end of the step: of second order, and without the
/// memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MovingMultipliers {
    histories: Vec<MultiplierHistory>,
    /// Time from the middle of the last step up to now, s.
    age: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct MultiplierHistory {
    /// `λ`, N.
    end: f64,
    /// `ℓ`, N.
    auxiliary: f64,
    /// `I/h` of the last step, N.
    mean: f64,
}

impl MultiplierHistory {
    /// `ℓ` for a step that is `stretch` times the last one; [`crate::State::a`] changes likewise.
    fn auxiliary(&self, stretch: f64) -> f64 {
        self.end + (self.auxiliary - self.end) * stretch
    }
}

impl MovingMultipliers {
    /// Takes over `other` without allocating where the sizes agree.
    pub fn copy_from(&mut self, other: &Self) {
        self.histories.clone_from(&other.histories);
        self.age = other.age;
    }

    /// Forgets earlier steps.
    pub fn clear(&mut self) {
        self.histories.clear();
    }

    /// Starts the histories of these `equations` from the reported multipliers, unless a step was made before, and
    /// writes a first guess for the end of the next step in their place: the mean force stays the one reported last.
    pub fn begin(&mut self, equations: &[usize], scheme: &Scheme, stretch: f64, lambda: &mut [f64]) {
        if self.histories.len() != equations.len() {
            let initial = |&equation: &usize| MultiplierHistory {
                end: lambda[equation],
                auxiliary: lambda[equation],
                mean: lambda[equation],
            };
            self.histories.clear();
            self.histories.extend(equations.iter().map(initial));
            self.age = 0.0;
        }
        let Scheme {
            alpha_m,
            alpha_f,
            gamma,
            ..
        } = *scheme;
        for (history, &equation) in self.histories.iter().zip(equations) {
            let before = history.auxiliary(stretch);
            let after = (lambda[equation] - (1.0 - gamma) * before) / gamma;
            lambda[equation] = ((1.0 - alpha_m) * after + alpha_m * before - alpha_f * history.end) / (1.0 - alpha_f);
        }
    }

    /// Takes in the multipliers at the end of a step of `h` s and writes the reported ones in their place.
    pub fn end(&mut self, equations: &[usize], scheme: &Scheme, (h, stretch): (f64, f64), lambda: &mut [f64]) {
        if equations.is_empty() {
            return;
        }
        let Scheme {
            alpha_m,
            alpha_f,
            gamma,
            ..
        } = *scheme;
        let half = 0.5 * h;
        for (history, &equation) in self.histories.iter_mut().zip(equations) {
            let before = history.auxiliary(stretch);
            let end = lambda[equation];
            let auxiliary = ((1.0 - alpha_f) * end + alpha_f * history.end - alpha_m * before) / (1.0 - alpha_m);
            let mean = (1.0 - gamma) * before + gamma * auxiliary;
            lambda[equation] = mean + (mean - history.mean) * half / (self.age + half);
            *history = MultiplierHistory { end, auxiliary, mean };
        }
        self.age = half;
    }

    /// Takes in a jump of the multipliers between two steps.
    pub fn jump(&mut self, equations: &[usize], changes: &[f64]) {
        for (history, &equation) in self.histories.iter_mut().zip(equations) {
            let change = changes[equation];
            history.end += change;
            history.auxiliary += change;
            history.mean += change;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EQUATIONS: [usize; 1] = [1];

    /// Reported multipliers for steps of these lengths (s) with these multipliers at their ends, from `start` on.
    fn reported(rho_inf: f64, start: f64, steps: &[(f64, f64)]) -> Vec<f64> {
        let (scheme, mut moving, mut last) = (Scheme::new(rho_inf), MovingMultipliers::default(), None);
        let mut lambda = [7.0, start];
        let mut found = Vec::new();
        for &(h, end) in steps {
            let stretch = last.map_or(1.0, |last| h / last);
            moving.begin(&EQUATIONS, &scheme, stretch, &mut lambda);
            lambda[1] = end;
            moving.end(&EQUATIONS, &scheme, (h, stretch), &mut lambda);
            assert_eq!(lambda[0], 7.0, "not one of its equations");
            found.push(lambda[1]);
            last = Some(h);
        }
        found
    }

    #[test]
    fn an_error_that_comes_back_in_every_step_is_not_reported() {
        for (rho_inf, n) in [(0.4_f64, 12), (0.9, 60), (1.0, 190)] {
            let Scheme { alpha_f, .. } = Scheme::new(rho_inf);
            let root = -alpha_f / (1.0 - alpha_f);
            assert!((root + rho_inf).abs() < 1e-12, "rounding: {root}");
            let steps: Vec<_> = (1..200).map(|n| (1e-3, 100.0 + 5.0 * root.powi(n))).collect();
            let found = reported(rho_inf, 105.0, &steps);
            // The start is one of the two points of the first straight line; ℓ has the start's error for a while where
            // α_m is not α_f.
            let (left, raw) = ((found[n] - 100.0).abs(), (steps[n].1 - 100.0).abs());
            assert!(left < 1e-3 * raw, "rho_inf = {rho_inf}: {left} N of {raw} N");
        }
    }

    #[test]
    fn a_force_that_grows_evenly_is_reported_as_it_is_whatever_the_steps() {
        for rho_inf in [0.0, 0.4, 0.9, 1.0] {
            let mut t = 0.0;
            let lengths = std::iter::repeat_n(1e-3, 60).chain(std::iter::repeat_n(4e-4, 60));
            let steps: Vec<_> = lengths
                .map(|h| {
                    t += h;
                    (h, 50.0 + 300.0 * t)
                })
                .collect();
            let found = reported(rho_inf, 50.0, &steps);
            for n in [59, 119] {
                // Rounding, and what is left of a start without the shift of ℓ.
                assert!(
                    (found[n] - steps[n].1).abs() < 1e-9,
                    "rho_inf = {rho_inf}, step {n}: {}",
                    found[n] - steps[n].1
                );
            }
        }
    }

    #[test]
    fn the_first_guess_goes_on_with_the_mean_force_and_a_jump_moves_everything() {
        let (scheme, mut moving) = (Scheme::new(0.9), MovingMultipliers::default());
        let mut lambda = [0.0, 20.0];
        for end in [22.0, 17.0] {
            moving.begin(&EQUATIONS, &scheme, 1.0, &mut lambda);
            lambda[1] = end;
            moving.end(&EQUATIONS, &scheme, (1e-3, 1.0), &mut lambda);
        }
        moving.jump(&EQUATIONS, &[0.0, 3.0]);
        lambda[1] += 3.0;
        let before = lambda[1];
        moving.begin(&EQUATIONS, &scheme, 1.0, &mut lambda);
        moving.end(&EQUATIONS, &scheme, (1e-3, 1.0), &mut lambda);
        let mean = moving.histories[0].mean;
        assert!(
            (mean - before).abs() < 1e-12 * before.abs(),
            "rounding: {mean} of {before}"
        );
    }
}
