//! Finite differences in the directions of the generalised velocities, for tests.
use dynamics::{Blocks, Force, Layout, Motion, State, Weights, rotation};
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

/// `state` moved by `distance` along the generalised velocity `index`.
pub(crate) fn moved(layout: &Layout, state: &State, index: usize, distance: f64) -> State {
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

/// Central difference of a vector function of the state along coordinate `index`; error h² relative.
pub(crate) fn derivative(
    layout: &Layout,
    state: &State,
    index: usize,
    function: &mut dyn FnMut(&State) -> DVector<f64>,
) -> DVector<f64> {
    let h = 1e-5;
    let plus = function(&moved(layout, state, index, h));
    (plus - function(&moved(layout, state, index, -h))) / (2.0 * h)
}

/// The Jacobian of a vector function of the state with respect to all coordinates.
pub(crate) fn jacobian(
    layout: &Layout,
    state: &State,
    function: &mut dyn FnMut(&State) -> DVector<f64>,
) -> DMatrix<f64> {
    let columns: Vec<_> = (0..layout.coordinates())
        .map(|index| derivative(layout, state, index, function))
        .collect();
    DMatrix::from_columns(&columns)
}

/// Generalised force of a contribution.
pub(crate) fn force(contribution: &mut dyn Force, motion: &Motion<'_>) -> DVector<f64> {
    let mut force = DVector::zeros(motion.q.len());
    contribution.add_force(motion, force.as_mut_slice());
    force
}

/// A dense matrix from what `add` puts into blocks.
pub(crate) fn dense(n: usize, add: &mut dyn FnMut(&mut Blocks<'_>)) -> DMatrix<f64> {
    let mut places = Vec::new();
    add(&mut Blocks::record(&mut places));
    let places: Vec<u32> = places.iter().map(|(row, column)| row + column * n as u32).collect();
    let mut matrix = DMatrix::zeros(n, n);
    add(&mut Blocks::add_to(&places, matrix.as_mut_slice()));
    matrix
}

/// Asserts that both parts of a contribution's tangent are the derivatives of its force, to 1e-6 of the largest entry.
pub(crate) fn assert_tangent(contribution: &mut dyn Force, layout: &Layout, state: &State, u: &[f64]) {
    let n = layout.coordinates();
    for weights in [Weights { q: 1.0, v: 0.0 }, Weights { q: 0.0, v: 1.0 }] {
        let tangent = dense(n, &mut |blocks| {
            contribution.add_tangent(&state.motion(u), weights, blocks)
        });
        let difference = if weights.q == 1.0 {
            jacobian(layout, state, &mut |state| force(contribution, &state.motion(u)))
        } else {
            let h = 2e-6;
            let columns: Vec<_> = (0..n)
                .map(|index| {
                    let mut side = |sign: f64| {
                        let mut state = state.clone();
                        state.v[index] += sign * h;
                        force(contribution, &state.motion(u))
                    };
                    (side(1.0) - side(-1.0)) / (2.0 * h)
                })
                .collect();
            DMatrix::from_columns(&columns)
        };
        let error = (&tangent + difference).amax();
        let scale = tangent.amax().max(force(contribution, &state.motion(u)).amax());
        assert!(
            error <= 1e-6 * scale,
            "{weights:?}: error {error}, largest entry {}",
            tangent.amax()
        );
    }
}

/// Asserts that the force without velocities is minus the gradient of the energy, to 1e-6 of its largest entry.
pub(crate) fn assert_energy(contribution: &mut dyn Force, layout: &Layout, state: &State) {
    let mut state = state.clone();
    state.v.fill(0.0);
    let force = force(contribution, &state.motion(&[]));
    let gradient = jacobian(layout, &state, &mut |state| {
        DVector::from_element(1, contribution.energy(&state.motion(&[])))
    });
    let error = (gradient.transpose() + &force).amax();
    assert!(error <= 1e-6 * force.amax(), "error {error} of {}", force.amax());
}

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
