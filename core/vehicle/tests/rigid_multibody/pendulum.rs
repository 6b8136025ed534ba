//! The double pendulum of two bodies: order of positions, velocities and multipliers.
use super::mechanism::{Mechanism, order, run, set_velocity, shown};
use dynamics::{Formulation, NewtonOptions};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use vehicle::multibody::{Anchor, BaseMarker, BodyMarker, Joint};

const GRAVITY: f64 = 9.81;
const MASSES: [f64; 2] = [2.0, 1.2]; // kg
const INERTIAS: [f64; 2] = [0.15, 0.05]; // kg m² about the axis of the joints
const LENGTH: f64 = 0.9; // m between the joints
const CENTRES: [f64; 2] = [0.4, 0.35]; // m from the joint above
const START: [f64; 4] = [1.2, -0.4, 0.5, 3.0]; // angles from the downward vertical, rad, and rates, rad/s
const AZIMUTH: f64 = 0.6; // rad: the plane of motion is no plane of the coordinates
const DURATION: f64 = 1.0;

/// Angles, rates → accelerations of the angles; Lagrange's equations in absolute angles.
fn accelerations([a, b, a_t, b_t]: [f64; 4]) -> [f64; 2] {
    let [m1, m2] = MASSES;
    let [c1, c2] = CENTRES;
    let m11 = INERTIAS[0] + m1 * c1 * c1 + m2 * LENGTH * LENGTH;
    let m22 = INERTIAS[1] + m2 * c2 * c2;
    let (sine, cosine) = (a - b).sin_cos();
    let coupling = m2 * LENGTH * c2;
    let m12 = coupling * cosine;
    let f1 = -coupling * sine * b_t * b_t - (m1 * c1 + m2 * LENGTH) * GRAVITY * a.sin();
    let f2 = coupling * sine * a_t * a_t - m2 * c2 * GRAVITY * b.sin();
    let determinant = m11 * m22 - m12 * m12;
    [(m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant]
}

/// The classical Runge–Kutta method with `steps` steps.
fn reference(steps: usize) -> [f64; 4] {
    let rate = |y: [f64; 4]| {
        let [a, b] = accelerations(y);
        [y[2], y[3], a, b]
    };
    let ahead = |y: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let h = DURATION / steps as f64;
    (0..steps).fold(START, |y, _| {
        let k1 = rate(y);
        let k2 = rate(ahead(y, k1, 0.5 * h));
        let k3 = rate(ahead(y, k2, 0.5 * h));
        let k4 = rate(ahead(y, k3, h));
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    })
}

/// A vector of the plane of motion, from its horizontal and its vertical part.
fn in_plane(horizontal: f64, vertical: f64) -> Vector3<f64> {
    Vector3::new(AZIMUTH.cos() * horizontal, AZIMUTH.sin() * horizontal, vertical)
}

/// A point `r` m from its joint at `angle`: position, velocity and acceleration relative to the joint.
fn arm(r: f64, angle: f64, rate: f64, acceleration: f64) -> [Vector3<f64>; 3] {
    let (sine, cosine) = angle.sin_cos();
    let (radial, tangential) = (in_plane(sine, -cosine), in_plane(cosine, sine));
    [
        radial * r,
        tangential * (r * rate),
        tangential * (r * acceleration) - radial * (r * rate * rate),
    ]
}

/// Positions, velocities and accelerations of both centres of mass.
fn centres(y: [f64; 4]) -> [[Vector3<f64>; 3]; 2] {
    let [a_tt, b_tt] = accelerations(y);
    let first = arm(CENTRES[0], y[0], y[2], a_tt);
    let joint = arm(LENGTH, y[0], y[2], a_tt);
    let second = arm(CENTRES[1], y[1], y[3], b_tt);
    [first, std::array::from_fn(|k| joint[k] + second[k])]
}

/// Forces of both joints on the body below them, N.
fn reactions(y: [f64; 4]) -> [Vector3<f64>; 2] {
    let weight = Vector3::new(0.0, 0.0, -GRAVITY);
    let needed: Vec<_> = centres(y)
        .iter()
        .zip(MASSES)
        .map(|(centre, mass)| (centre[2] - weight) * mass)
        .collect();
    [needed[0] + needed[1], needed[1]]
}

/// Errors of positions (m), velocities (m/s) and joint forces (N) at the end, and the largest violation of a joint (m).
fn errors(h: f64, rho_inf: f64, formulation: Formulation) -> [f64; 4] {
    let mut pendulum = Mechanism::default();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), AZIMUTH);
    // A turn by −angle about the axis takes the downward vertical to the arm.
    let orientations =
        [START[0], START[1]].map(|angle| turn * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -angle));
    let start = centres(START);
    let inertia = |k: usize| Vector3::new(0.7 * INERTIAS[k], INERTIAS[k], 0.6 * INERTIAS[k]);
    let poses = [0, 1].map(|k| pendulum.add_body(start[k][0], orientations[k], (MASSES[k], inertia(k), GRAVITY)));
    // Third axis along the body's second one.
    let axes = turn.to_rotation_matrix().into_inner() * Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
    let elbow = arm(LENGTH, START[0], 0.0, 0.0)[0];
    let on = |k: usize, point: Vector3<f64>| Anchor::Body(BodyMarker::at(poses[k], &orientations[k], &point, &axes));
    let base = Anchor::Base(BaseMarker {
        position: Vector3::zeros(),
        axes,
    });
    let multipliers = [
        pendulum.add_joint(Joint::revolute(base, on(0, Vector3::zeros()))),
        pendulum.add_joint(Joint::revolute(on(0, elbow), on(1, elbow))),
    ];
    let mut state = pendulum.state();
    for k in 0..2 {
        let omega_b = Vector3::new(0.0, -START[2 + k], 0.0);
        set_velocity(&mut state, &poses[k], start[k][1], omega_b);
    }
    let options = NewtonOptions {
        tolerance: 1e-10,            // below the smallest error here, 1e-5 N
        constraint_tolerance: 1e-14, // rounding at a metre
        formulation,
        ..NewtonOptions::default()
    };
    let mut states = Vec::new();
    let steps = (DURATION / h).round() as usize;
    run(&mut pendulum, &mut state, (h, steps, rho_inf), options, &mut |state| {
        states.push(state.clone())
    });
    let violation = states.iter().map(|state| pendulum.violation(state)).fold(0.0, f64::max);
    let exact = reference(10_000);
    let (exact_centres, exact_forces) = (centres(exact), reactions(exact));
    let motion = state.motion(&[]);
    let mut errors = [0.0_f64, 0.0, 0.0, violation];
    for k in 0..2 {
        errors[0] = errors[0].max((poses[k].position(&motion) - exact_centres[k][0]).norm());
        errors[1] = errors[1].max((poses[k].velocity(&motion) - exact_centres[k][1]).norm());
        // M v̇ = Q − g_qᵀ λ with g = r_second − r_first: the joint pushes the second body with −λ.
        let lambda = &state.lambda[multipliers[k]..multipliers[k] + 3];
        let force = -Vector3::new(lambda[0], lambda[1], lambda[2]);
        errors[2] = errors[2].max((force - exact_forces[k]).norm());
    }
    errors
}

#[test]
fn the_double_pendulum_converges_to_second_order_in_position_velocity_and_multipliers() {
    let fine = reference(20_000);
    for (value, coarse) in fine.iter().zip(reference(10_000)) {
        assert!((value - coarse).abs() < 1e-12, "the reference has converged"); // its error falls by 16
    }
    for rho_inf in [1.0, 0.9, 0.8, 0.5] {
        let runs = [4e-3, 2e-3, 1e-3].map(|h| errors(h, rho_inf, Formulation::Index3));
        for run in &runs {
            println!(
                "rho_inf {rho_inf}: position, velocity, joint force, joint {}",
                shown(run)
            );
        }
        // With rho_inf = 1 the constrained directions have the double root −1: the multipliers of index 3 oscillate
        // without decay [Cardona & Géradin, Computers & Structures 33, 1989], and only positions and velocities
        // converge.
        let kept = if rho_inf < 1.0 { 3 } else { 2 };
        for (what, name) in ["position", "velocity", "multipliers"].iter().enumerate().take(kept) {
            for pair in runs.windows(2) {
                let order = order(pair[0][what], pair[1][what]);
                assert!((order - 2.0).abs() < 0.15, "rho_inf {rho_inf}, {name}: order {order}");
            }
        }
        assert!(runs.iter().all(|run| run[3] < 1e-13)); // rounding
    }
}

#[test]
fn accelerations_and_multipliers_of_the_augmented_equations_converge_to_second_order_as_well() {
    for rho_inf in [1.0, 0.9, 0.5] {
        let runs = [4e-3, 2e-3, 1e-3].map(|h| errors(h, rho_inf, Formulation::Index1Baumgarte));
        for run in &runs {
            println!(
                "rho_inf {rho_inf}, augmented: position, velocity, joint force, joint {}",
                shown(run)
            );
        }
        // The drift of the joints is of second order like the rest.
        for (what, name) in ["position", "velocity", "multipliers", "drift"].iter().enumerate() {
            for pair in runs.windows(2) {
                let order = order(pair[0][what], pair[1][what]);
                assert!((order - 2.0).abs() < 0.3, "rho_inf {rho_inf}, {name}: order {order}");
            }
        }
    }
}
