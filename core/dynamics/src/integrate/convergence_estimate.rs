//! What the steps so far say of how much a correction leaves.
use serde::{Deserialize, Serialize};

/// Corrections of a step that are followed; later ones are evaluated.
const FOLLOWED: usize = 6;

/// Part of the tolerance up to which a foreseen residual serves.
const SURE: f64 = 0.5;

/// What remains of the largest contraction with each step that shows a smaller one, by the first correction and by those after it. Of
/// the first one the next residual says nothing more.
const FORGETTING: [f64; 2] = [0.97, 0.9];

/// Steps in a row that end with a foreseen residual.
const UNSEEN: u32 = 16;

/// Foresees the residual that a correction leaves, so that the last one of a step need not be evaluated.
///
/// With a kept matrix Newton's method contracts the residual from one correction to the next, and where the last two residuals of a
/// step have the ratio `Θ` the next one is about `Θ` times the last: who stops there saves an evaluation [Hairer & Wanner, Solving
/// Ordinary Differential Equations II, section IV.8]. On a wire this alone misleads: corrections remove by turns what bends the wire and
/// what stretches it, and contract by turns to a half and to a hundredth. The same correction of the steps before knows better, so
///
/// ```text
/// r_(i+1) ≈ max(r_i/r_(i−1), Θ_i) r_i
/// ```
///
/// with `Θ_i` the largest contraction by correction `i` in the steps that were evaluated, of which a part is forgotten with each. Every
/// so many steps the last residual is evaluated, and `Θ` measured.
///
/// Of the first correction of a step there is `Θ_0` alone. That serves where the wires are linear: contact, droppers and pantographs say
/// themselves where they leave the piece of their law, see [`crate::Force::continues_to`], and what the correction contracts there is
/// not taken for `Θ_0`. On a nonlinear wire `Θ_0` grows with the motion: there it is not followed.
///
/// With the last residuals evaluated too, on the lines of EN 50318 and of the thesis, nonlinear and linearised, whole and windowed, with
/// tolerances of 1e-3 N and 0.3 N: at most 1.2 steps in a hundred end above the tolerance by that, and none above seven times. Where a
/// wheel touches a rail is searched for and not compared: under the vehicle of the thesis on smooth track, with irregularities, and in a
/// curve of 500 m with stronger ones at 140 km/h it is at most 1 in a hundred, and none above five times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ConvergenceEstimate {
    /// `Θ_i` (–); infinite where it is not known.
    contractions: [f64; FOLLOWED],
    /// Steps since the last one that was evaluated to its end.
    unseen: u32,
}

impl Default for ConvergenceEstimate {
    fn default() -> Self {
        Self {
            contractions: [f64::INFINITY; FOLLOWED],
            unseen: 0,
        }
    }
}

impl ConvergenceEstimate {
    /// Takes note that correction `i` (from 0) of a step took the residual from `before` to `after`, both in units of the tolerance.
    pub fn observe(&mut self, i: usize, before: f64, after: f64) {
        if let Some(known) = self.contractions.get_mut(i) {
            let contraction = after / before;
            *known = if known.is_finite() {
                contraction.max(FORGETTING[i.min(1)] * *known)
            } else {
                contraction
            };
        }
    }

    /// The residual after correction `i` of a step, in units of the tolerance, where it is known well enough to be the last one:
    /// `ratio` is the residual before it, `last` the one before that, infinite where there is none.
    pub fn last_residual(&self, i: usize, ratio: f64, last: f64) -> Option<f64> {
        let known = self.contractions.get(i).filter(|_| self.unseen < UNSEEN)?;
        let foreseen = known.max(ratio / last) * ratio;
        (foreseen <= SURE).then_some(foreseen)
    }

    /// Takes note of the end of a step, whose last residual was evaluated or `foreseen`.
    pub fn end_step(&mut self, foreseen: bool) {
        self.unseen = if foreseen { self.unseen + 1 } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step whose residuals are evaluated to the end.
    fn observe(convergence_estimate: &mut ConvergenceEstimate, residuals: &[f64]) {
        for (i, pair) in residuals.windows(2).enumerate() {
            convergence_estimate.observe(i, pair[0], pair[1]);
        }
        convergence_estimate.end_step(false);
    }

    #[test]
    fn what_contracts_alike_in_each_step_is_foreseen() {
        let mut convergence_estimate = ConvergenceEstimate::default();
        assert_eq!(
            convergence_estimate.last_residual(1, 40.0, 1e4),
            None,
            "nothing is known yet"
        );
        observe(&mut convergence_estimate, &[1e4, 40.0, 0.2]);
        let foreseen = convergence_estimate.last_residual(1, 40.0, 1e4).unwrap();
        assert!((foreseen - 0.2).abs() < 1e-12, "{foreseen}");
        assert_eq!(
            convergence_estimate.last_residual(1, 120.0, 3e4),
            None,
            "0.6 is not surely below 1"
        );
        let of_the_first = convergence_estimate.last_residual(0, 25.0, f64::INFINITY).unwrap();
        assert!((of_the_first - 0.1).abs() < 1e-12, "0.004 alone: {of_the_first}");
        assert_eq!(
            convergence_estimate.last_residual(2, 0.01, 40.0),
            None,
            "a third correction has not been seen"
        );
    }

    #[test]
    fn contraction_by_turns_is_not_taken_for_contraction_in_each_correction() {
        let mut convergence_estimate = ConvergenceEstimate::default();
        observe(&mut convergence_estimate, &[1e4, 50.0, 25.0, 0.1]);
        // By the last two residuals alone the next one would be 0.25.
        assert_eq!(convergence_estimate.last_residual(1, 50.0, 1e4), None);
        assert!(
            convergence_estimate.last_residual(2, 25.0, 50.0).is_none(),
            "a half of 25"
        );
        // A step that contracts less than those before it counts at once.
        observe(&mut convergence_estimate, &[1e4, 1.0, 0.1]);
        assert!(convergence_estimate.last_residual(1, 1.0, 1e4).is_some());
        assert!(convergence_estimate.last_residual(1, 1.0, 1.2).is_none());
    }

    #[test]
    fn the_largest_contraction_fades() {
        let mut convergence_estimate = ConvergenceEstimate::default();
        observe(&mut convergence_estimate, &[100.0, 10.0, 6.0, 0.1]);
        let mut steps = 0;
        while convergence_estimate.last_residual(1, 10.0, 1e4).is_none() {
            observe(&mut convergence_estimate, &[100.0, 10.0, 0.1]);
            steps += 1;
        }
        // 0.6 · 0.9ⁿ · 10 ≤ 0.5
        assert_eq!(steps, 24);
    }

    #[test]
    fn every_so_many_steps_are_evaluated_to_the_end() {
        let mut convergence_estimate = ConvergenceEstimate::default();
        observe(&mut convergence_estimate, &[1e4, 1.0, 1e-3]);
        for _ in 0..UNSEEN {
            assert!(convergence_estimate.last_residual(1, 1.0, 1e4).is_some());
            convergence_estimate.end_step(true);
        }
        assert_eq!(convergence_estimate.last_residual(1, 1.0, 1e4), None);
        convergence_estimate.end_step(false);
        assert!(convergence_estimate.last_residual(1, 1.0, 1e4).is_some());
    }
}
