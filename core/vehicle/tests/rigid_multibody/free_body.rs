//! A free asymmetric body: energy, angular momentum and period over many revolutions.
use super::mechanism::{Mechanism, order, run, set_velocity, shown};
use dynamics::{NewtonOptions, State};
use nalgebra::{UnitQuaternion, Vector3};

const INERTIA: Vector3<f64> = Vector3::new(1.0, 2.0, 3.2); // kg m²
/// Close to the axis of the smallest moment, with a nutation of half its rate.
const OMEGA: Vector3<f64> = Vector3::new(6.0, 3.0, 0.0); // rad/s

const OPTIONS: NewtonOptions = NewtonOptions {
    tolerance: 1e-10, // 1e-12 of the gyroscopic moment
    constraint_tolerance: 1e-12,
    max_iterations: 30,
    jacobian: dynamics::Jacobian::Modified,
    formulation: dynamics::Formulation::Index3,
    passes: None,
};

fn body() -> (Mechanism, State) {
    let mut mechanism = Mechanism::default();
    let orientation = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9);
    let pose = mechanism.add_body(Vector3::zeros(), orientation, (1.0, INERTIA, 0.0));
    let mut state = mechanism.state();
    set_velocity(&mut state, &pose, Vector3::new(0.5, -0.2, 0.1), OMEGA);
    (mechanism, state)
}

fn omega(state: &State) -> Vector3<f64> {
    Vector3::new(state.v[3], state.v[4], state.v[5])
}

/// Angular momentum in world axes, N·m·s.
fn momentum(state: &State) -> Vector3<f64> {
    state.rotation[0] * INERTIA.component_mul(&omega(state))
}

/// Period of the angular velocity in body axes, s, for a start on the plane ω₃ = 0.
///
/// With `I₁ < I₂ < I₃` and `L² < 2 T I₂` the motion is about the first axis. Euler's equations have the solution `ω₁ ∝
/// dn τ, ω₂ ∝ cn τ, ω₃ ∝ sn τ` [Goldstein, 5.6; Landau & Lifshitz, Mechanics, § 37, with the axes in the opposite
/// order]:
///
/// ```text
/// τ = t √((I₁ − I₂)(L² − 2 T I₃)/(I₁ I₂ I₃)),   k² = (I₂ − I₃)(2 T I₁ − L²)/((I₁ − I₂)(L² − 2 T I₃))
/// ```
///
/// and the period is four times the complete elliptic integral K(k), π/2 over the arithmetic–geometric mean of 1 and
/// √(1 − k²).
fn period() -> f64 {
    let [i1, i2, i3] = [INERTIA.x, INERTIA.y, INERTIA.z];
    let momentum_2 = INERTIA.component_mul(&OMEGA).norm_squared();
    let twice_energy = OMEGA.dot(&INERTIA.component_mul(&OMEGA));
    assert!(momentum_2 < twice_energy * i2, "the start is beyond the separatrix");
    let rate_2 = (i1 - i2) * (momentum_2 - twice_energy * i3) / (i1 * i2 * i3);
    let k_2 = (i2 - i3) * (twice_energy * i1 - momentum_2) / ((i1 - i2) * (momentum_2 - twice_energy * i3));
    let (mut a, mut b) = (1.0, (1.0 - k_2).sqrt());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    2.0 * std::f64::consts::PI / (a + b) * 2.0 / rate_2.sqrt()
}

/// Largest relative errors of energy and angular momentum (vector) over `seconds`, with `h` s and rho_inf = 1.
fn drift(h: f64, seconds: f64) -> [f64; 2] {
    let (mut mechanism, mut state) = body();
    let (energy, start) = (mechanism.energy(&state), momentum(&state));
    let mut worst = [0.0_f64; 2];
    let mut last = state.clone();
    let body = mechanism.bodies[0];
    run(
        &mut mechanism,
        &mut state,
        (h, (seconds / h).round() as usize, 1.0),
        OPTIONS,
        &mut |state| {
            worst[0] = worst[0].max((body.kinetic_energy(&state.motion(&[])) / energy - 1.0).abs());
            worst[1] = worst[1].max((momentum(state) - start).norm() / start.norm());
            last.copy_from(state);
        },
    );
    assert!(
        (last.rotation[0].norm() - 1.0).abs() < 1e-9,
        "the quaternion keeps its length"
    );
    worst
}

#[test]
fn a_free_body_keeps_energy_and_angular_momentum_over_a_thousand_revolutions_to_second_order() {
    let revolution = 2.0 * std::f64::consts::PI / OMEGA.norm();
    let steps = [100.0, 200.0];
    let [coarse, fine] = steps.map(|per| drift(revolution / per, 1000.0 * revolution));
    println!(
        "1000 revolutions, energy and angular momentum: {} at 100 steps each, {} at 200",
        shown(&coarse),
        shown(&fine)
    );
    let hundred = drift(revolution / 200.0, 100.0 * revolution);
    println!("100 revolutions at 200 steps each: {}", shown(&hundred));
    for (quantity, (coarse, fine)) in ["energy", "angular momentum"].iter().zip(coarse.into_iter().zip(fine)) {
        let order = order(coarse, fine);
        assert!((order - 2.0).abs() < 0.1, "{quantity}: order {order}");
    }
    // The errors go to and fro with the nutation and do not grow: ten times as long makes them no larger than a sample
    // missed.
    for (long, short) in fine.into_iter().zip(hundred) {
        assert!(
            long < 1.01 * short,
            "{long:e} after 1000 revolutions, {short:e} after 100"
        );
    }
    // (0.0314 rad per step)²/12 = 8e-5 of a revolution's phase.
    assert!(fine[0] < 5e-5 && fine[1] < 3e-4, "{fine:?}");
}

#[test]
fn the_angular_velocity_of_a_free_body_returns_after_the_period_of_the_elliptic_functions() {
    let period = period();
    let errors = [200_u16, 400].map(|steps| {
        let (mut mechanism, mut state) = body();
        let mut farthest = 0.0_f64;
        run(
            &mut mechanism,
            &mut state,
            (period / f64::from(steps), 5 * usize::from(steps), 1.0),
            OPTIONS,
            &mut |state| farthest = farthest.max((omega(state) - OMEGA).norm()),
        );
        // The state has been elsewhere: a constant would pass otherwise.
        assert!(farthest > 0.5 * OMEGA.norm(), "{farthest}");
        (omega(&state) - OMEGA).norm() / OMEGA.norm()
    });
    println!("period {period:.6} s; after 5 periods: {}", shown(&errors));
    let order = order(errors[0], errors[1]);
    assert!((order - 2.0).abs() < 0.1, "order {order}");
}
