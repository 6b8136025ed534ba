//! States and orientations that favour no direction, for tests; the checks of laws are those of [`dynamics::testing`].
pub(crate) use dynamics::dense;
pub(crate) use dynamics::testing::{
    LawTrio, assert_energy, assert_law, assert_tangent, generalised_force as force, jacobian,
};
use dynamics::{Force, Layout, State, rotation};
use nalgebra::{UnitQuaternion, Vector3};

/// A state with displacements and velocities that favour no direction.
pub(crate) fn awkward(layout: &Layout) -> State {
    let mut state = layout.state_at_rest();
    let wave = |i: usize, phase: f64| (1.7 * i as f64 + phase).sin();
    for i in 0..layout.coordinates() {
        state.q[i] = 0.2 * wave(i, 0.3);
        state.v[i] = 1.5 * wave(i, 1.1);
    }
    for (k, &first) in layout.rotations().iter().enumerate() {
        let turn = Vector3::new(state.q[first], state.q[first + 1], state.q[first + 2]);
        state.rotation[k] *= rotation::exp(&(3.0 * turn));
        state.q[first..first + 3].fill(0.0);
    }
    for (i, lambda) in state.lambda.iter_mut().enumerate() {
        *lambda = 40.0 * wave(i, 2.0);
    }
    state
}

/// An orientation that favours no direction.
pub(crate) fn tilted(seed: f64) -> UnitQuaternion<f64> {
    rotation::exp(&Vector3::new(0.4 + seed, -0.7 * seed, 0.9 - seed))
}

/// Asserts that all power of a contribution comes from outside.
pub(crate) fn assert_driven(law: &mut dyn Force, state: &State, u: &[f64]) {
    let motion = state.motion(u);
    let expected: f64 = force(law, &motion).iter().zip(&state.v).map(|(f, v)| f * v).sum();
    let power = law.power(&motion).unwrap();
    // Rounding of some hundred watts.
    assert!(
        (power.driven - expected).abs() < 1e-10 && power.dissipated == 0.0,
        "{power:?} {expected}"
    );
}
