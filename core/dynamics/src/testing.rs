//! Checks of laws by differences, for tests: energy → force → tangent, and a symmetric mass matrix.
//!
//! Differences go in the directions of the generalised velocities: a rotation turns about the axes of its body. A check
//! panics with the largest error, as an assertion does.
use crate::{Force, Layout, Motion, SparseMatrix, State, Updates, Weights, dense, rotation};
use nalgebra::{DMatrix, DVector, Vector3};

/// Largest asymmetry of a mass matrix, part of its largest entry: rounding.
const ASYMMETRY: f64 = 1e-14;

/// Steps and tolerance of the law trio. The error of a central difference is `h²` relative, and rounding by `h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawTrio {
    /// Step of a coordinate to each side, m or rad.
    pub q_step: f64,
    /// Step of a velocity to each side, m/s or rad/s.
    pub v_step: f64,
    /// Largest error, part of the largest entry.
    pub tolerance: f64,
}

impl Default for LawTrio {
    fn default() -> Self {
        Self {
            q_step: 1e-5,
            v_step: 2e-6,
            tolerance: 1e-6,
        }
    }
}

impl LawTrio {
    /// Asserts energy, tangent and mass of a contribution without inputs: see the single checks.
    ///
    /// # Panics
    /// When one of them fails.
    pub fn assert(&self, law: &mut dyn Force, layout: &Layout, state: &State) {
        self.assert_energy(law, layout, state);
        self.assert_tangent(law, layout, state, &[]);
        assert_mass(law, layout.coordinates());
    }

    /// Asserts that the force without velocities is minus the gradient of the energy, to the tolerance of its largest
    /// entry.
    ///
    /// # Panics
    /// When it is not.
    pub fn assert_energy(&self, law: &mut dyn Force, layout: &Layout, state: &State) {
        let mut state = state.clone();
        state.v.fill(0.0);
        let force = generalised_force(law, &state.motion(&[]));
        for index in 0..layout.coordinates() {
            let slope = derivative(layout, &state, (index, self.q_step), &mut |state| {
                DVector::from_element(1, law.energy(&state.motion(&[])))
            })[0];
            assert!(
                (slope + force[index]).abs() <= self.tolerance * force.amax(),
                "{}: slope {slope} of the energy against {}",
                layout.name(index),
                -force[index]
            );
        }
    }

    /// Asserts stiffness and damping: see [`LawTrio::assert_stiffness`] and [`LawTrio::assert_damping`].
    ///
    /// # Panics
    /// When one of them is wrong.
    pub fn assert_tangent(&self, law: &mut dyn Force, layout: &Layout, state: &State, u: &[f64]) {
        self.assert_stiffness(law, layout, state, u);
        self.assert_damping(law, layout, state, u);
    }

    /// Asserts that the stiffness of a contribution, low-rank updates included, is minus the derivative of its force by
    /// the coordinates, to the tolerance of the largest entry.
    ///
    /// # Panics
    /// When it is not.
    pub fn assert_stiffness(&self, law: &mut dyn Force, layout: &Layout, state: &State, u: &[f64]) {
        let stiffness = tangent(law, layout.coordinates(), &state.motion(u), Weights { q: 1.0, v: 0.0 });
        let scale = scale(&stiffness, law, &state.motion(u));
        for index in 0..layout.coordinates() {
            let mut force = |state: &State| generalised_force(law, &state.motion(u));
            let difference = derivative(layout, state, (index, self.q_step), &mut force);
            self.compare(layout, index, stiffness.column(index) + difference, scale, "stiffness");
        }
    }

    /// Asserts that the damping of a contribution, low-rank updates included, is minus the derivative of its force by
    /// the velocities, to the tolerance of the largest entry.
    ///
    /// # Panics
    /// When it is not.
    pub fn assert_damping(&self, law: &mut dyn Force, layout: &Layout, state: &State, u: &[f64]) {
        let damping = tangent(law, layout.coordinates(), &state.motion(u), Weights { q: 0.0, v: 1.0 });
        let scale = scale(&damping, law, &state.motion(u));
        for index in 0..layout.coordinates() {
            let mut side = |distance: f64| {
                let mut state = state.clone();
                state.v[index] += distance;
                generalised_force(law, &state.motion(u))
            };
            let difference = (side(self.v_step) - side(-self.v_step)) / (2.0 * self.v_step);
            self.compare(layout, index, damping.column(index) + difference, scale, "damping");
        }
    }

    fn compare(&self, layout: &Layout, index: usize, left: DVector<f64>, scale: f64, name: &str) {
        let error = left.amax();
        assert!(
            error <= self.tolerance * scale,
            "{name}, {}: error {error}, largest entry {scale}",
            layout.name(index)
        );
    }
}

/// Largest entry of a tangent, or of the force where the tangent is zero.
fn scale(tangent: &DMatrix<f64>, law: &mut dyn Force, motion: &Motion<'_>) -> f64 {
    if tangent.amax() > 0.0 {
        tangent.amax()
    } else {
        generalised_force(law, motion).amax()
    }
}

/// Asserts that the mass matrix of a contribution on `n` coordinates is symmetric to rounding.
///
/// # Panics
/// When it is not.
pub fn assert_mass(law: &dyn Force, n: usize) {
    let mass = dense(n, &mut |blocks| law.add_mass(blocks));
    let asymmetry = (&mass - mass.transpose()).amax();
    assert!(
        asymmetry <= ASYMMETRY * mass.amax(),
        "asymmetry {asymmetry} of {}",
        mass.amax()
    );
}

/// [`LawTrio::assert`] with the default steps and tolerance.
///
/// # Panics
/// When a check fails.
pub fn assert_law(law: &mut dyn Force, layout: &Layout, state: &State) {
    LawTrio::default().assert(law, layout, state);
}

/// [`LawTrio::assert_tangent`] with the default steps and tolerance.
///
/// # Panics
/// When the check fails.
pub fn assert_tangent(law: &mut dyn Force, layout: &Layout, state: &State, u: &[f64]) {
    LawTrio::default().assert_tangent(law, layout, state, u);
}

/// [`LawTrio::assert_energy`] with the default steps and tolerance.
///
/// # Panics
/// When the check fails.
pub fn assert_energy(law: &mut dyn Force, layout: &Layout, state: &State) {
    LawTrio::default().assert_energy(law, layout, state);
}

/// Generalised force of a contribution, N, N·m.
pub fn generalised_force(law: &mut dyn Force, motion: &Motion<'_>) -> DVector<f64> {
    let mut force = DVector::zeros(motion.q.len());
    law.add_force(motion, force.as_mut_slice());
    force
}

/// Tangent of a contribution on `n` coordinates at a motion: blocks and low-rank updates.
pub fn tangent(law: &mut dyn Force, n: usize, motion: &Motion<'_>, weights: Weights) -> DMatrix<f64> {
    let mut tangent = dense(n, &mut |blocks| law.add_tangent(motion, weights, blocks));
    if let Some(low_rank) = law.low_rank() {
        let mut updates = Updates::default();
        low_rank.push_updates(motion, weights, &mut updates);
        let mut rows = vec![0.0; n * n];
        updates.add_to_dense(n, &mut rows);
        tangent += DMatrix::from_row_slice(n, n, &rows);
    }
    tangent
}

/// A layout of `n` coordinates without rotations.
#[must_use]
pub fn plain_layout(n: usize) -> Layout {
    let mut layout = Layout::new();
    layout.add_coordinates(n, "law");
    layout
}

/// `state` moved by `distance` (m, rad) along the generalised velocity `index`.
#[must_use]
pub fn moved(layout: &Layout, state: &State, index: usize, distance: f64) -> State {
    let mut state = state.clone();
    for (k, &first) in layout.rotations().iter().enumerate() {
        if (first..first + 3).contains(&index) {
            state.rotation[k] *= rotation::exp(&Vector3::ith(index - first, distance));
            return state;
        }
    }
    state.q[index] += distance;
    state
}

/// Central difference of a vector function of the state along coordinate `index` over `step` (m, rad) to each side.
pub fn derivative(
    layout: &Layout,
    state: &State,
    (index, step): (usize, f64),
    function: &mut dyn FnMut(&State) -> DVector<f64>,
) -> DVector<f64> {
    let plus = function(&moved(layout, state, index, step));
    (plus - function(&moved(layout, state, index, -step))) / (2.0 * step)
}

/// The Jacobian of a vector function of the state with respect to all coordinates, with the default step.
pub fn jacobian(layout: &Layout, state: &State, function: &mut dyn FnMut(&State) -> DVector<f64>) -> DMatrix<f64> {
    let step = LawTrio::default().q_step;
    let columns: Vec<_> = (0..layout.coordinates())
        .map(|index| derivative(layout, state, (index, step), function))
        .collect();
    DMatrix::from_columns(&columns)
}

/// `K` and `M` of a string of `n` masses of 1 kg and springs of 1 N/m between them and to both ends, with
/// `ω² = 4 sin²(k π / (2 n + 2))`, `k = 1…n`, 1/s².
#[must_use]
pub fn string_of_masses(n: u32) -> [SparseMatrix; 2] {
    let mut entries = Vec::new();
    for i in 0..n {
        entries.push((i, i, 2.0));
        if i > 0 {
            entries.push((i, i - 1, -1.0));
            entries.push((i - 1, i, -1.0));
        }
    }
    let mass = (0..n).map(|i| (i, i, 1.0)).collect();
    [entries, mass].map(|entries| SparseMatrix::from_entries(n as usize, entries))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Blocks;

    /// A hardening spring with a damper on one coordinate; each error is a factor on one of its four answers.
    struct Spring {
        energy: f64,
        stiffness: f64,
        damping: f64,
        coupling: f64,
    }

    impl Force for Spring {
        fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
            let q = motion.q[0];
            force[0] -= 100.0 * q + 1e3 * q * q * q + 4.0 * motion.v[0];
        }

        fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
            let q = motion.q[0];
            let (stiffness, damping) = (self.stiffness * (100.0 + 3e3 * q * q), self.damping * 4.0);
            blocks.add(&[0], &[0], &[weights.q * stiffness + weights.v * damping]);
        }

        fn add_mass(&self, blocks: &mut Blocks<'_>) {
            blocks.add(&[0, 1], &[0, 1], &[2.0, 0.5, 0.5 * self.coupling, 2.0]);
        }

        fn energy(&self, motion: &Motion<'_>) -> f64 {
            let q = motion.q[0];
            self.energy * (50.0 * q * q + 250.0 * q * q * q * q)
        }
    }

    /// Returns `true` if the trio accepts a spring with these factors.
    fn accepts([energy, stiffness, damping, coupling]: [f64; 4]) -> bool {
        let layout = plain_layout(2);
        let mut state = layout.state_at_rest();
        (state.q[0], state.v[0]) = (0.2, 1.5);
        let mut spring = Spring {
            energy,
            stiffness,
            damping,
            coupling,
        };
        let check = std::panic::AssertUnwindSafe(|| assert_law(&mut spring, &layout, &state));
        std::panic::catch_unwind(check).is_ok()
    }

    #[test]
    fn the_trio_accepts_a_consistent_law_and_refuses_an_error_in_any_of_its_answers() {
        assert!(accepts([1.0; 4]));
        for wrong in 0..4 {
            let mut factors = [1.0; 4];
            factors[wrong] = 1.001;
            assert!(!accepts(factors), "{factors:?}");
        }
    }
}
