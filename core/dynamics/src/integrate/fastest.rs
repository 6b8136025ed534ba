//! The fastest oscillation of a small system.
use crate::linear::iteration_matrix::mass_matrix;
use crate::{Blocks, Motion, SparseMatrix, System, Weights};
use nalgebra::DMatrix;

/// Mass below which a point is at rest at each moment, kg: it counts as held, which makes the others no slower.
const LEAST_MASS: f64 = 1e-3;

/// Angular frequency of the fastest oscillation about a motion, rad/s, where each mass is held by `outside` N/m
/// besides; none for a system with constraints or rotations, or without mass.
pub(crate) fn fastest(system: &mut dyn System, motion: &Motion<'_>, outside: f64) -> Option<f64> {
    if system.layout().constraints() > 0 || !system.layout().rotations().is_empty() {
        return None;
    }
    let weights = Weights { q: 1.0, v: 0.0 };
    let stiffness = Blocks::collect(|blocks| system.forces(&mut |force| force.add_tangent(motion, weights, blocks)));
    let stiffness = SparseMatrix::from_entries(system.layout().coordinates(), stiffness);
    let mass = mass_matrix(system);
    let heavy: Vec<usize> = (0..mass.size())
        .filter(|&row| entry(&mass, row, row) > LEAST_MASS)
        .collect();
    let between = |matrix: &SparseMatrix| {
        DMatrix::from_fn(heavy.len(), heavy.len(), |row, column| {
            entry(matrix, heavy[row], heavy[column])
        })
    };
    let held = between(&stiffness) + DMatrix::from_diagonal_element(heavy.len(), heavy.len(), outside);
    let factor = between(&mass).cholesky()?.l();
    let by_rows = factor.solve_lower_triangular(&held)?;
    let by_mass = factor.solve_lower_triangular(&by_rows.transpose())?;
    let squares = (0.5 * (&by_mass + by_mass.transpose())).symmetric_eigenvalues();
    (!heavy.is_empty()).then(|| squares.max().max(0.0).sqrt())
}

fn entry(matrix: &SparseMatrix, row: usize, column: usize) -> f64 {
    let at_column = matrix.row(row).filter(|(at, _)| *at == column);
    at_column.map(|(_, value)| value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Continuity, Force, Layout, NewtonOptions, Simulator, State};
    use std::f64::consts::TAU;

    /// Two equal masses between two walls, and a point without mass on the second one.
    struct Masses;

    const MASS: f64 = 2.0;
    const STIFFNESS: f64 = 800.0;

    impl Force for Masses {
        fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
            let [a, b, point] = [0, 1, 2].map(|index| motion.q[index]);
            force[0] -= STIFFNESS * (2.0 * a - b);
            force[1] -= STIFFNESS * (2.0 * b - a) + 300.0 * (b - point);
            force[2] -= 300.0 * (point - b);
        }

        fn add_tangent(&mut self, _: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
            let k = weights.q * STIFFNESS;
            blocks.add(&[0, 1], &[0, 1], &[2.0 * k, -k, -k, 2.0 * k]);
            let k = weights.q * 300.0;
            blocks.add(&[1, 2], &[1, 2], &[k, -k, -k, k]);
        }

        fn add_mass(&self, blocks: &mut Blocks<'_>) {
            for (index, mass) in [MASS, MASS, 1e-9].into_iter().enumerate() {
                blocks.add(&[index], &[index], &[mass]);
            }
        }
    }

    struct Chain(Layout, Masses);

    impl System for Chain {
        fn layout(&self) -> &Layout {
            &self.0
        }

        fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
            visit(&mut self.1);
        }

        fn follow(&mut self, state: &mut State, _: &[f64]) -> Continuity {
            for rates in [&mut state.v, &mut state.v_dot, &mut state.a] {
                rates[2] = 0.0;
            }
            Continuity::Kept
        }
    }

    fn chain() -> (Chain, State) {
        let mut layout = Layout::new();
        layout.add_coordinates(3, "mass");
        let state = layout.state_at_rest();
        (Chain(layout, Masses), state)
    }

    #[test]
    fn the_fastest_oscillation_is_that_of_the_closed_form_with_points_held() {
        let (mut chain, state) = chain();
        let k = STIFFNESS;
        for outside in [0.0, 5e3] {
            // Eigenvalues of [2k + o, −k; −k, 2k + o + 300].
            let mean = 2.0 * k + outside + 150.0;
            let exact = ((mean + k.hypot(150.0)) / MASS).sqrt();
            let found = fastest(&mut chain, &state.motion(&[]), outside).unwrap();
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        }
    }

    /// Velocity after two periods of the slow oscillation in steps of `h` s, part of the largest one.
    fn error(rho_inf: f64, per_period: usize, keeps: bool) -> f64 {
        let (chain, mut state) = chain();
        let omega = (STIFFNESS / MASS).sqrt();
        state.q.fill(1.0);
        state.a.fill(-omega * omega);
        state.v_dot.fill(-omega * omega);
        let h = TAU / omega / per_period as f64;
        let mut simulator = Simulator::new(chain, state, Vec::new(), h, rho_inf, NewtonOptions::default());
        if keeps {
            simulator.keep_periods(0.0);
        }
        for step in 0..2 * per_period {
            let t = step as f64 * h;
            simulator.advance(t, h, &mut |_, _| {}, &mut |_, _, _, _| {}).unwrap();
        }
        (simulator.state().v[0] / omega).abs()
    }

    #[test]
    fn periods_are_kept_to_the_fourth_order_where_that_is_stable() {
        let [coarse, fine, plain] = [(20, true), (40, true), (40, false)].map(|(n, keeps)| error(1.0, n, keeps));
        assert!(fine < 0.01 * plain && coarse > 14.0 * fine, "{coarse} {fine} {plain}");
        let [damped, plain] = [true, false].map(|keeps| error(0.9, 40, keeps));
        assert!(damped < 0.05 * plain, "{damped} {plain}");
        // The faster oscillation turns too far.
        assert_eq!(error(0.9, 4, true), error(0.9, 4, false));
    }
}
