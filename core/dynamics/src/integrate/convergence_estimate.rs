//! Residual that a correction leaves, estimated from the steps before.
use serde::{Deserialize, Serialize};

/// Corrections of a step that are estimated; later ones are evaluated.
const FOLLOWED: usize = 6;

/// Part of the tolerance up to which an estimated residual serves.
const SURE: f64 = 0.5;

/// Factor by which the stored worst contraction decays per step: first correction, later corrections. The first one
/// decays more slowly, because the residual of the step before carries no information about it.
const FORGETTING: [f64; 2] = [0.97, 0.9];

/// Steps in a row that end with an estimated residual.
const UNSEEN: u32 = 16;

/// Estimates the residual that a correction leaves, so that the last one of a step need not be evaluated.
///
/// Newton's method with a kept matrix contracts the residual from one correction to the next: if the last two residuals
/// of a step have the ratio `Θ`, the next one is about `Θ` times the last, and a step that stops there saves an
/// evaluation [Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.8]. This ratio alone misleads on
/// a wire: corrections remove bending and stretching by turns, with different contractions. The same correction of
/// earlier steps is the better measure, so
///
/// ```text
/// r_(i+1) ≈ max(r_i/r_(i−1), Θ_i) r_i
/// ```
///
/// with `Θ_i` the largest contraction by correction `i` in the steps that were evaluated; `Θ_i` decays with each step.
/// Every [`UNSEEN`] steps the last residual is evaluated, and `Θ` measured.
///
/// Only `Θ_0` is known of the first correction of a step. `Θ_0` suffices on linear wires: contact, droppers and
/// pantographs report themselves when they leave the branch of their law, see [`crate::StepHistory::continues_to`], and
/// a contraction across such a change does not enter `Θ_0`. `Θ_0` of a nonlinear wire grows with the motion: it is not
/// used there.
///
/// A step may therefore end above the tolerance by a small factor, rarely: the search for the contact point of wheel
/// and rail has no branch to compare. Tests that evaluate the last residuals too bound both the number of such steps
/// and the factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ConvergenceEstimate {
    /// `Θ_i` (–); infinite as long as it is unknown.
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
    /// Records that correction `i` (from 0) of a step took the residual from `before` to `after`, both in units of the
    /// tolerance.
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

    /// The residual after correction `i` of a step, in units of the tolerance, if the estimate is sure enough to be the
    /// last one: `ratio` is the residual before the correction, `last` the one before that, infinite if there is none.
    pub fn last_residual(&self, i: usize, ratio: f64, last: f64) -> Option<f64> {
        let known = self.contractions.get(i).filter(|_| self.unseen < UNSEEN)?;
        let estimated = known.max(ratio / last) * ratio;
        (estimated <= SURE).then_some(estimated)
    }

    /// Records the end of a step, whose last residual was evaluated, or `estimated`.
    pub fn end_step(&mut self, estimated: bool) {
        self.unseen = if estimated { self.unseen + 1 } else { 0 };
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
    fn what_contracts_alike_in_each_step_is_estimated() {
        let mut convergence_estimate = ConvergenceEstimate::default();
        assert_eq!(
            convergence_estimate.last_residual(1, 40.0, 1e4),
            None,
            "nothing is known yet"
        );
        observe(&mut convergence_estimate, &[1e4, 40.0, 0.2]);
        let estimated = convergence_estimate.last_residual(1, 40.0, 1e4).unwrap();
        assert!((estimated - 0.2).abs() < 1e-12, "{estimated}");
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
