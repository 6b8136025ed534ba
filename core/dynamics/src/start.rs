//! Consistent accelerations and multipliers at the start of a motion.
use crate::matrix::{IterationMatrix, visit_jacobian};
use crate::newton::name;
use crate::{State, StepError, System, Weights};
use nalgebra::{UnitQuaternion, Vector3};

/// Solves `[M g_qᵀ; g_q 0] [v̇; λ] = [Q; −(g_q)˙ v]`.
pub(crate) fn accelerations(system: &mut dyn System, state: &mut State, u: &[f64]) -> Result<(), StepError> {
    let n = state.q.len();
    let equations = state.lambda.len();
    let motion = state.motion(u);
    let mut matrix = IterationMatrix::analyse(system, &motion);
    let scale = matrix.mean_mass();
    // The stiffness stays out: weights zero. Contributions that freeze directions while assembling see the start state.
    let nothing = Weights { q: 0.0, v: 0.0 };
    matrix
        .factor(system, &motion, 1.0, nothing, scale)
        .map_err(|singular| StepError::Singular {
            t: state.t,
            coordinate: name(system, singular.unknown),
        })?;
    let mut right_side = vec![0.0; n + equations];
    system.forces(&mut |force| force.add_force(&motion, &mut right_side[..n]));
    let product = |system: &mut dyn System, at: &State| {
        let mut rates = vec![0.0; equations];
        visit_jacobian(system, &at.motion(u), &mut |row, columns, values| {
            rates[row] += columns
                .iter()
                .zip(values)
                .map(|(&column, value)| value * state.v[column])
                .sum::<f64>();
        });
        rates
    };
    let h = 1e-6;
    let (ahead, behind) = (moved(system, state, h), moved(system, state, -h));
    let (ahead, behind) = (product(system, &ahead), product(system, &behind));
    for row in 0..equations {
        right_side[n + row] = -scale * (ahead[row] - behind[row]) / (2.0 * h);
    }
    let mut solution = vec![0.0; n + equations];
    matrix.solve(&right_side, &mut solution);
    state.v_dot.copy_from_slice(&solution[..n]);
    for (lambda, value) in state.lambda.iter_mut().zip(&solution[n..]) {
        *lambda = value * scale;
    }
    Ok(())
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
