//! The linear system of a Newton correction by itself.
use crate::integrate::newton::name;
use crate::linear::block_tridiagonal::Precision;
use crate::linear::iteration_matrix::{IterationMatrix, MovingRows};
use crate::{Motion, StepError, System, Weights};

/// `[w_m M + w_q K + w_v D, s g_qᵀ; s g_q, 0]` of a system, factored as in a time step: for linear answers of a system
/// to forces, and for benchmarks.
pub struct FactoredMatrix(IterationMatrix);

impl FactoredMatrix {
    /// Analyses the pattern of a system at a motion.
    pub fn analyse(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        Self(IterationMatrix::analyse(
            system,
            motion,
            MovingRows::Placeholders,
            Precision::Double,
        ))
    }

    /// Assembles and factors at a motion; `mass_weight` is `w_m`, 1/s².
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub fn factor(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        mass_weight: f64,
        weights: Weights,
    ) -> Result<(), StepError> {
        let scale = self.0.mean_mass() * mass_weight.max(1.0);
        self.0
            .factor(system, motion, mass_weight, weights, scale)
            .map_err(|singular| StepError::Singular {
                t: motion.t,
                coordinate: name(system, singular.unknown),
            })
    }

    /// Solves for a right side with one entry per coordinate, then per multiplier (a multiplier comes out divided by
    /// the scale `s`); fixed coordinates stay at zero.
    pub fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) {
        self.0.solve(right_side, solution);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Blocks, Force, Layout, State};

    /// A chain of `n` masses `m` on springs `k` between two walls.
    struct Chain {
        layout: Layout,
        k: f64,
        m: f64,
    }

    impl Force for Chain {
        fn add_force(&mut self, _motion: &Motion<'_>, _force: &mut [f64]) {}

        fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
            let k = weights.q * self.k;
            for i in 0..self.layout.coordinates() {
                blocks.add(&[i], &[i], &[2.0 * k]);
                if i > 0 {
                    blocks.add(&[i - 1, i], &[i - 1, i], &[0.0, -k, -k, 0.0]);
                }
            }
        }

        fn add_mass(&self, blocks: &mut Blocks<'_>) {
            for i in 0..self.layout.coordinates() {
                blocks.add(&[i], &[i], &[self.m]);
            }
        }
    }

    struct Masses(Chain);

    impl System for Masses {
        fn layout(&self) -> &Layout {
            &self.0.layout
        }

        fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
            visit(&mut self.0);
        }
    }

    #[test]
    fn a_mode_of_a_chain_answers_with_its_own_stiffness() {
        let (n, k, m, mass_weight) = (200, 3.0, 0.7, 5.0);
        let mut layout = Layout::new();
        layout.add_coordinates(n, "mass".to_owned());
        let mut system = Masses(Chain { layout, k, m });
        let rest = State::at_rest(n, 0, Vec::new());
        let motion = rest.motion(&[]);
        let mut matrix = FactoredMatrix::analyse(&mut system, &motion);
        let weights = Weights { q: 2.0, v: 0.0 };
        matrix.factor(&mut system, &motion, mass_weight, weights).unwrap();
        let angle = 3.0 * std::f64::consts::PI / (n as f64 + 1.0);
        let mode: Vec<f64> = (1..=n).map(|i| (angle * i as f64).sin()).collect();
        let mut answer = vec![0.0; n];
        matrix.solve(&mode, &mut answer);
        let stiffness = mass_weight * m + weights.q * k * (2.0 - 2.0 * angle.cos());
        for (answer, mode) in answer.iter().zip(&mode) {
            assert!((answer * stiffness - mode).abs() < 1e-12);
        }
    }
}
