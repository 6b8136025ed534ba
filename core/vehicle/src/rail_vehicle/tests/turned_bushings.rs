//! Bushings whose axes a scene turns.
use super::full::{full, rolling};
use super::*;
use crate::check;
use dynamics::{NewtonOptions, Simulator};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Place of the pedestals among the entries of the scene, and of the first of them among the bushings.
const PEDESTAL: (&str, usize) = ("vehicle.bushings.8", 40);

#[test]
fn a_bushing_that_is_turned_acts_along_its_own_axes() {
    let [phi, theta, psi] = [0.3, -0.7, 1.1_f64];
    let rates = Vector3::new(3e7, 4e6, 5e5);
    let key = PEDESTAL.0;
    let alone = full(
        &full_scene(&[
            &format!("{key}.orientation=[{phi:?},{theta:?},{psi:?}]"),
            &format!("{key}.stiffness=[3e7,4e6,5e5]"),
        ]),
        None,
    );
    let frame = alone.vehicle.names().iter().position(|name| name == "frame 1").unwrap();
    let place = alone.vehicle.bodies()[frame].pose.translation;
    let mut state = alone.layout.state_at_rest();
    let moved = Vector3::new(2e-3, -1e-3, 3e-3);
    state.q[place..place + 3].copy_from_slice(moved.as_slice());
    let mut pedestal = alone.vehicle.bushings()[PEDESTAL.1].clone();
    let found = check::force(&mut pedestal, &state.motion(&[]));
    let found: Vector3<f64> = found.fixed_rows::<3>(place).into_owned();
    // Z-X-Z: −R k Rᵀ d with R = R_z(φ) R_x(θ) R_z(ψ), written out.
    let about_z = |angle: f64| {
        let (s, c) = angle.sin_cos();
        Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
    };
    let (s, c) = theta.sin_cos();
    let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    let turn = about_z(phi) * about_x * about_z(psi);
    let expected = -(turn * Matrix3::from_diagonal(&rates) * turn.transpose() * moved);
    println!("{found:?} of {expected:?}");
    assert!((found - expected).norm() < 1e-12 * expected.norm()); // rounding
}

#[test]
fn bushings_together_are_the_sum_of_each_by_itself() {
    let mut alone = full(&full_scene(&[]), None);
    let state = check::awkward(&alone.layout);
    let motion = state.motion(&[]);
    let mut sum = vec![0.0; alone.layout.coordinates()];
    for bushing in alone.vehicle.bushings() {
        bushing.clone().add_force(&motion, &mut sum);
    }
    let found = check::force(&mut alone.vehicle.bushings, &motion);
    let largest = found.amax();
    for (found, expected) in found.iter().zip(&sum) {
        assert!((found - expected).abs() < 1e-13 * largest, "{found} {expected}"); // rounding
    }
    assert!(largest > 1e5);
}

/// Displacements (m) after a second at 200 km/h, with the wheelsets pushed aside at the start.
fn pushed(overrides: &[&str]) -> Vec<f64> {
    let mut alone = full(&full_scene(overrides), None);
    let mut state = rolling(&mut alone);
    for spin in &alone.vehicle.spins {
        state.v[spin.pose.translation + 1] = 1e-2;
    }
    let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 0.9, NewtonOptions::default());
    simulator
        .advance(0.0, 1.0, &mut |_, _| (), &mut |_, _, _, _| ())
        .unwrap();
    simulator.state().q[..78].to_vec()
}

#[test]
fn a_quarter_of_a_turn_exchanges_two_axes_of_a_bushing() {
    let key = PEDESTAL.0;
    let turned = format!("{key}.orientation=[{FRAC_PI_2:?},0.0,0.0]");
    let stiffness = format!("{key}.stiffness=[3.884e6,3.1391e7,0.0]");
    let damping = format!("{key}.damping=[2000.0,15000.0,0.0]");
    let plain = pushed(&[]);
    let exchanged = pushed(&[&turned, &stiffness, &damping]);
    let other = pushed(&[&turned]);
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let moved = plain.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let (same, different) = (apart(&plain, &exchanged), apart(&plain, &other));
    println!("moved {moved:e} m, turned and exchanged {same:e} m apart, turned alone {different:e} m");
    // Newton's tolerance, and the cosine of a quarter of a turn of 6e-17; a pedestal that is eight times softer along
    // the track.
    assert!(moved > 1e-4 && same < 1e-8 && different > 1e-2 * moved);
}
