//! Consistent velocities, accelerations and multipliers at the start of a motion.
use crate::integrate::newton::name;
use crate::linear::block_tridiagonal::Precision;
use crate::linear::iteration_matrix::{IterationMatrix, MovingRows, visit_jacobian};
use crate::{Motion, State, StepError, System, Weights};
use nalgebra::{UnitQuaternion, Vector3};

/// Solves `[M g_qᵀ; g_q 0] [v̇; λ] = [Q; −(g_q)˙ v − (g_t)˙]`.
///
/// Constraints that move are first made to hold for the velocities too, by the impulse `μ` of them all that changes the
/// velocities least in the sense of their energy: `[M g_qᵀ; g_q 0] [Δv; μ] = [0; −ġ]`, with `ġ` of other constraints
/// unchanged. A strip that is at rest under a sloping wire, and passes along it, is not at rest on it.
pub(crate) fn accelerations(system: &mut dyn System, state: &mut State, u: &[f64]) -> Result<(), StepError> {
    let n = state.q.len();
    let equations = state.lambda.len();
    let motion = state.motion(u);
    let mut matrix = IterationMatrix::analyse(system, &motion, MovingRows::AsTheyAre, Precision::Double);
    let scale = matrix.mean_mass();
    // The stiffness stays out: weights zero. Contributions that freeze directions during assembly see the start state.
    let nothing = Weights { q: 0.0, v: 0.0 };
    matrix
        .factor(system, &motion, 1.0, nothing, scale)
        .map_err(|singular| StepError::Singular {
            t: state.t,
            coordinate: name(system, singular.unknown),
        })?;
    let (mut right_side, mut solution) = (vec![0.0; n + equations], vec![0.0; n + equations]);
    let moving = moving_rows(system, equations);
    if moving.contains(&true) {
        let found = rates(system, state, &state.v, u);
        for (row, rate) in found.iter().enumerate().filter(|(row, _)| moving[*row]) {
            right_side[n + row] = -scale * rate;
        }
        matrix.solve(&right_side, &mut solution);
        for (v, change) in state.v.iter_mut().zip(&solution) {
            *v += change;
        }
        right_side.fill(0.0);
    }
    // End a step here: contributions prepare the first one.
    system.forces(&mut |force| {
        if let Some(kept) = force.step_history() {
            kept.end_step(&state.motion(u));
        }
        force.add_force(&state.motion(u), &mut right_side[..n]);
    });
    let h = 1e-6;
    let (ahead, behind) = (moved(system, state, h), moved(system, state, -h));
    let (ahead, behind) = (rates(system, &ahead, &state.v, u), rates(system, &behind, &state.v, u));
    for row in 0..equations {
        right_side[n + row] = -scale * (ahead[row] - behind[row]) / (2.0 * h);
    }
    matrix.solve(&right_side, &mut solution);
    state.v_dot.copy_from_slice(&solution[..n]);
    for (lambda, value) in state.lambda.iter_mut().zip(&solution[n..]) {
        *lambda = value * scale;
    }
    Ok(())
}

/// Marks the equations of constraints that move.
fn moving_rows(system: &mut dyn System, equations: usize) -> Vec<bool> {
    let mut rows = Vec::with_capacity(equations);
    system.constraints(&mut |constraint| {
        rows.extend(std::iter::repeat_n(constraint.moves(), constraint.dimension()));
    });
    rows
}

/// `g_q v + g_t` at a state, without the `g_t` of constraints that do not move.
fn rates(system: &mut dyn System, at: &State, v: &[f64], u: &[f64]) -> Vec<f64> {
    let motion = Motion { v, ..at.motion(u) };
    let mut rates = vec![0.0; at.lambda.len()];
    visit_jacobian(system, &motion, &mut |row, columns, values| {
        rates[row] += (columns.iter().zip(values)).map(|(&i, g)| g * v[i]).sum::<f64>();
    });
    let mut first = 0;
    system.constraints(&mut |constraint| {
        let next = first + constraint.dimension();
        if constraint.moves() {
            rates[first..next].fill(0.0);
            constraint.add_rate(&motion, &mut rates[first..next]);
        }
        first = next;
    });
    rates
}

/// The state moved on with its velocities for `h` s.
fn moved(system: &dyn System, state: &State, h: f64) -> State {
    let mut state = state.clone();
    state.t += h;
    for (q, v) in state.q.iter_mut().zip(&state.v) {
        *q += h * v;
    }
    for (k, &first) in system.layout().rotations().iter().enumerate() {
        state.q[first..first + 3].fill(0.0);
        let omega = Vector3::new(state.v[first], state.v[first + 1], state.v[first + 2]);
        state.rotation[k] *= UnitQuaternion::from_scaled_axis(h * omega);
    }
    state
}
