//! Quasi-static equilibrium of a linkage.
//!
//! ```text
//! Q(q) − f ∂z_s/∂q − g_qᵀ λ = 0,    g(q) = 0,    z_s(q) = h  or  f given
//! ```
//!
//! `z_s` is the height of the strip, `f` the contact force that presses the strip down. A head with several strips that
//! is free to pitch has another such pair: its slope `a`, given, and the moment of its contact forces.
//!
//! The Jacobian includes the geometric stiffness of the joints: nearly all the stiffness of a linkage against being
//! lowered comes from the joints. Bars between two spherical joints may spin freely; a stiffness far below any other
//! holds their spin.
use super::Linkage;
use crate::VehicleError;
use crate::multibody::{AxialSpring, DeadForce, Pose};
use crate::pantograph::{Equilibrium, Pantograph, Target};
use dynamics::{Constraint, Force, JacobianRows, Layout, Marker, State, Weights, dense, rotation};
use nalgebra::{DMatrix, DVector, Vector3};

/// Accepted residual relative to the largest force on the mechanism; rounding is four orders below.
const TOLERANCE: f64 = 1e-10;

/// Accepted gap of a joint or of the strip's height, m or –; rounding at the size of a pantograph is below 1e-14.
const CLOSURE: f64 = 1e-13;

/// Stiffness against free spinning relative to the largest stiffness.
const REGULARISATION: f64 = 1e-8;

/// Longest rotation step of an iteration, rad.
const LONGEST_TURN: f64 = 0.1;

const ITERATIONS: usize = 60;

/// Forces that balance the tabulated position.
pub(super) struct Balance {
    /// Preload of the collector suspension, N.
    pub preload: f64,
    /// Contact force, N.
    pub force: f64,
    /// True for a head with several strips that is free to pitch.
    pub pitches: bool,
}

/// Forces, Jacobian and residuals of a linkage alone, in one configuration.
struct Terms {
    /// `Q` without the contact force.
    force: DVector<f64>,
    /// `∂z_s/∂q`, and `∂a/∂q` of a head that is free to pitch.
    strip: DMatrix<f64>,
    /// `g_q`.
    g_q: DMatrix<f64>,
    g: DVector<f64>,
}

fn terms(linkage: &mut Linkage, state: &State) -> Terms {
    let (n, m) = (state.q.len(), state.lambda.len());
    let motion = state.motion(&[]);
    let mut force = DVector::zeros(n);
    linkage.forces(&mut |contribution| contribution.add_force(&motion, force.as_mut_slice()));
    let mut strip = DMatrix::zeros(n, 1 + usize::from(linkage.head().pitch));
    for (of, mut column) in strip.column_iter_mut().enumerate() {
        for mut load in loads(linkage, of, 1.0) {
            load.add_force(&motion, column.as_mut_slice());
        }
    }
    let mut g = DVector::zeros(m);
    let mut g_q = DMatrix::zeros(m, n);
    let mut first = 0;
    linkage.constraints(&mut |joint| {
        let count = joint.dimension();
        joint.residual(&motion, &mut g.as_mut_slice()[first..first + count]);
        let mut sink = |row: usize, columns: &[usize], values: &[f64]| {
            for (&column, value) in columns.iter().zip(values) {
                g_q[(first + row, column)] += value;
            }
        };
        joint.jacobian(&motion, &mut JacobianRows::new(&mut sink));
        first += count;
    });
    Terms { force, strip, g_q, g }
}

/// Dead forces on the head for a vertical force (N) in the mean place of the strips, or for a moment (N·m): a pair a
/// metre apart.
fn loads(linkage: &Linkage, of: usize, size: f64) -> Vec<DeadForce> {
    let mut loads = vec![linkage.vertical_force_on_strip(size)];
    if of == 1 {
        let marker = linkage.head().ahead;
        loads = vec![DeadForce { marker, ..loads[0] }, linkage.vertical_force_on_strip(-size)];
    }
    loads
}

/// `∂/∂q` of `−Q + f ∂z_s/∂q + g_qᵀ λ`, with force and moment of the contact.
fn stiffness(linkage: &mut Linkage, state: &State, contact: &DVector<f64>) -> DMatrix<f64> {
    let n = state.q.len();
    let motion = state.motion(&[]);
    let weights = Weights { q: 1.0, v: 0.0 };
    dense(n, &mut |blocks| {
        linkage.forces(&mut |force| force.add_tangent(&motion, weights, blocks));
        let mut first = 0;
        for joint in linkage.joints() {
            joint.add_geometric_stiffness(&motion, &state.lambda[first..], blocks);
            first += joint.dimension();
        }
        // The contact force is a dead force on the strip.
        for (of, size) in contact.iter().enumerate() {
            for mut load in loads(linkage, of, -size) {
                load.add_tangent(&motion, weights, blocks);
            }
        }
    })
}

/// True where the strips' slope can change with their mean height and the suspension as they are: `∂a/∂q` is then no
/// combination of their gradients and those of the joints.
fn is_free_to_pitch(linkage: &mut Linkage, state: &State, g_q: &DMatrix<f64>, stretch: &DVector<f64>) -> bool {
    /// Share of the gradient that is rounding.
    const ROUNDING: f64 = 1e-6;
    if linkage.head().markers.len() < 2 {
        return false;
    }
    let motion = state.motion(&[]);
    let (n, m) = (state.q.len(), state.lambda.len());
    let mut others = DMatrix::zeros(n, m + 2);
    others.columns_mut(0, m).copy_from(&g_q.transpose());
    others.column_mut(m).copy_from(stretch);
    let mut slope = DVector::zeros(n);
    for mut load in loads(linkage, 0, 1.0) {
        load.add_force(&motion, others.column_mut(m + 1).as_mut_slice());
    }
    for mut load in loads(linkage, 1, 1.0) {
        load.add_force(&motion, slope.as_mut_slice());
    }
    let fitted = others.clone().svd(true, true).solve(&slope, 1e-12);
    fitted.is_ok_and(|fitted| (&slope - others * fitted).norm() > ROUNDING * slope.norm())
}

/// Contact force and preload of the collector suspension under which the reference position is at rest.
pub(super) fn balance(linkage: &mut Linkage, layout: &Layout) -> Result<Balance, VehicleError> {
    let state = layout.state_at_rest();
    let Terms { force, g_q, .. } = terms(linkage, &state);
    let pitches = is_free_to_pitch(linkage, &state, &g_q, &along_suspension(linkage, &state));
    linkage.strips.pitch = pitches;
    let [preload, force] = balanced(linkage, layout, &force)?;
    Ok(Balance {
        preload,
        force,
        pitches,
    })
}

/// Contact force that a load on the mechanism bears beyond the others while nothing moves, by virtual work: the load is
/// given by its generalised forces in the reference position.
pub(super) fn borne(linkage: &mut Linkage, layout: &Layout, load: &DVector<f64>) -> Result<f64, VehicleError> {
    balanced(linkage, layout, load).map(|[_, force]| force)
}

/// `∂s/∂q` of the length of the collector suspension.
fn along_suspension(linkage: &Linkage, state: &State) -> DVector<f64> {
    let mut along = DVector::zeros(state.q.len());
    let mut unit = AxialSpring {
        stiffness: 0.0,
        damping: 0.0,
        preload: 1.0,
        ..linkage.suspension().clone()
    };
    unit.add_force(&state.motion(&[]), along.as_mut_slice());
    along
}

/// Force of the collector suspension and contact force that hold the mechanism in its reference position under `force`.
fn balanced(linkage: &mut Linkage, layout: &Layout, force: &DVector<f64>) -> Result<[f64; 2], VehicleError> {
    let state = layout.state_at_rest();
    let (n, m) = (state.q.len(), state.lambda.len());
    let Terms { strip, g_q, .. } = terms(linkage, &state);
    // Q + P s_q − f z_q − g_qᵀ λ = 0, unknown (λ, P, f).
    let contacts = strip.ncols();
    let mut matrix = DMatrix::zeros(n, m + 1 + contacts);
    matrix.columns_mut(0, m).copy_from(&g_q.transpose());
    matrix.column_mut(m).copy_from(&-along_suspension(linkage, &state));
    matrix.columns_mut(m + 1, contacts).copy_from(&strip);
    let scale = force.amax();
    let unknown = matrix
        .clone()
        .svd(true, true)
        .solve(force, 1e-12)
        .unwrap_or_else(|_| DVector::zeros(m + 1 + contacts));
    let residual = force - matrix * &unknown;
    if residual.amax() > 1e-6 * scale {
        return Err(VehicleError::NotBalanced {
            residual: residual.amax(),
            coordinate: layout.name(residual.iamax()),
        });
    }
    Ok([unknown[m], unknown[m + 1]])
}

/// Newton's method from `start`.
pub(super) fn solve(
    linkage: &mut Linkage,
    start: State,
    start_force: f64,
    (target, slope): (Target, f64),
) -> Result<Equilibrium, VehicleError> {
    let mut state = start;
    let (n, m) = (state.q.len(), state.lambda.len());
    // Force of the contact, and its moment where the head is free to pitch.
    let contacts = 1 + usize::from(linkage.head().pitch);
    let mut contact = DVector::zeros(contacts);
    contact[0] = match target {
        Target::Force(force) => force,
        Target::Height(_) => start_force,
    };
    let mut residual = f64::INFINITY;
    let mut tolerance = 0.0;
    for iteration in 0..ITERATIONS {
        let Terms { force, strip, g_q, g } = terms(linkage, &state);
        let scale = force.amax().max(contact[0].abs());
        tolerance = TOLERANCE * scale;
        if iteration == 0 {
            // Multipliers that bear the forces of the start in the least-squares sense.
            let lambda = g_q
                .transpose()
                .svd(true, true)
                .solve(&(&force - &strip * &contact), 1e-12);
            if let Ok(lambda) = lambda {
                state.lambda.copy_from_slice(lambda.as_slice());
            }
        }
        let lambda = DVector::from_column_slice(&state.lambda);
        let unbalanced = force - &strip * &contact - g_q.transpose() * lambda;
        let height = linkage.strip_marker().frame(&state.motion(&[])).position.z;
        let inclined = linkage.head().ahead.frame(&state.motion(&[])).position.z - height;
        let mut missing = DVector::from_element(contacts, slope - inclined);
        missing[0] = match target {
            Target::Force(force) => force - contact[0],
            Target::Height(target) => target - height,
        };
        // Gaps count in units of the force tolerance.
        residual = unbalanced
            .amax()
            .max(g.amax().max(missing.amax()) * tolerance / CLOSURE);
        if residual <= tolerance {
            return Ok(Equilibrium {
                height,
                force: contact[0],
                strip_forces: linkage
                    .head()
                    .forces(contact[0], contact.get(1).copied().unwrap_or(0.0)),
                strip_heights: linkage.head().heights(height, inclined),
                q: state.q,
                rotation: state.rotation,
                lambda: state.lambda,
                vehicle: None,
            });
        }

        let mut matrix = DMatrix::zeros(n + m + contacts, n + m + contacts);
        let stiffness = stiffness(linkage, &state, &contact);
        matrix.view_mut((0, 0), (n, n)).copy_from(&stiffness);
        let soft = REGULARISATION * stiffness.amax();
        for diagonal in 0..n {
            matrix[(diagonal, diagonal)] += soft;
        }
        matrix.view_mut((n, 0), (m, n)).copy_from(&g_q);
        matrix.view_mut((0, n), (n, m)).copy_from(&g_q.transpose());
        matrix.view_mut((0, n + m), (n, contacts)).copy_from(&strip);
        matrix.view_mut((n + m, 0), (contacts, n)).copy_from(&strip.transpose());
        if let Target::Force(_) = target {
            matrix.view_mut((n + m, 0), (1, n)).fill(0.0);
            matrix[(n + m, n + m)] = 1.0;
        }
        let mut right = DVector::zeros(n + m + contacts);
        right.rows_mut(0, n).copy_from(&unbalanced);
        right.rows_mut(n, m).copy_from(&-g);
        right.rows_mut(n + m, contacts).copy_from(&missing);
        let Some(step) = matrix.lu().solve(&right) else {
            break;
        };
        if !step.iter().all(|entry| entry.is_finite()) {
            break;
        }
        advance(linkage, &mut state, &step);
        contact += step.rows(n + m, contacts);
    }
    Err(VehicleError::NotConverged {
        target: target.to_string(),
        iterations: ITERATIONS,
        residual,
        tolerance,
    })
}

/// Moves the state along a Newton step (displacements, rotations, multipliers, force), shortened if a body would turn
/// too far.
fn advance(linkage: &Linkage, state: &mut State, step: &DVector<f64>) {
    let (n, m) = (state.q.len(), state.lambda.len());
    let turn = |pose: Pose| Vector3::new(step[pose.rotation], step[pose.rotation + 1], step[pose.rotation + 2]);
    let longest = linkage
        .bodies()
        .iter()
        .map(|body| turn(body.pose).norm())
        .fold(0.0, f64::max);
    let fraction = (LONGEST_TURN / longest).min(1.0);
    for body in linkage.bodies() {
        let pose = body.pose;
        for axis in 0..3 {
            state.q[pose.translation + axis] += fraction * step[pose.translation + axis];
        }
        let orientation = &mut state.rotation[pose.orientation];
        *orientation *= rotation::exp(&(turn(pose) * fraction));
        orientation.renormalize();
    }
    // Multipliers and forces take the full step, because both enter linearly.
    for (lambda, change) in state.lambda.iter_mut().zip(step.rows(n, m).iter()) {
        *lambda += change;
    }
}
