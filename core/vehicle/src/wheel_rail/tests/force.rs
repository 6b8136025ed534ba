//! The law trio of the contact force.
use super::support::Design;
use super::support::Wheelset;
use crate::check::{dense, force, moved};
use crate::wheel_rail::{CreepLaw, Fastsim, WheelRail};
use dynamics::{Force, Layout, State, Weights};
use nalgebra::Vector3;

const LAWS: [CreepLaw; 4] = [
    CreepLaw::Frictionless,
    CreepLaw::Saturated,
    CreepLaw::Polach,
    CreepLaw::Fastsim(Fastsim { strips: 10, cells: 10 }),
];

/// A wheelset in contact that moves against the rail in all directions.
fn moving(law: CreepLaw, left: f64) -> (Wheelset, State) {
    let design = Design {
        law,
        speed: 20.0,
        spin: 20.0 / 0.46,
        damping: 4e8,
        ..Design::manchester()
    };
    let set = design.build();
    let mut state = set.loaded(0, 40e3, left, 0.0, 2e-3);
    for (k, value) in [0.01, -0.006, 0.004, 0.002, 0.02, 0.003].into_iter().enumerate() {
        state.v[k] = value;
    }
    (set, state)
}

/// The tangent of a contact is compared with central differences over 10 nm and 20 µm/s: the penetration is some 30 µm, so that
/// h² is 1e-8; rounding of 1e-16 m of it by h is the same.
fn assert_tangent(wheel: &mut WheelRail, layout: &Layout, state: &State) {
    let n = layout.coordinates();
    let h = 1e-8;
    for weights in [Weights { q: 1.0, v: 0.0 }, Weights { q: 0.0, v: 1.0 }] {
        let tangent = dense(n, &mut |blocks| wheel.add_tangent(&state.motion(&[]), weights, blocks));
        for index in 0..n {
            let mut side = |sign: f64| {
                let mut state = state.clone();
                if weights.q == 1.0 {
                    state = moved(layout, &state, index, sign * h);
                } else {
                    state.v[index] += sign * 2000.0 * h;
                }
                force(wheel, &state.motion(&[]))
            };
            let difference = (side(1.0) - side(-1.0)) / (2.0 * h * if weights.q == 1.0 { 1.0 } else { 2000.0 });
            let error = (tangent.column(index) + difference).amax();
            assert!(
                error <= 2e-7 * tangent.amax(),
                "{weights:?}, {index}: error {error} of {}",
                tangent.amax()
            );
        }
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_force_for_every_creep_law() {
    for law in LAWS {
        for left in [0.0, 3.2e-3, -4.1e-3, -7.3e-3] {
            let (mut set, state) = moving(law, left);
            let mut touching = 0;
            for wheel in &mut set.wheels {
                wheel.begin_step(&state.motion(&[]));
                touching += wheel.contacts(&state.motion(&[])).iter().flatten().count();
                assert_tangent(wheel, &set.layout, &state);
            }
            assert!(touching > 0);
        }
    }
}

#[test]
fn a_wheel_above_its_rail_exerts_no_force() {
    let set = Design::manchester().build();
    for mut wheel in set.wheels {
        let mut state = set.layout.state_at_rest();
        state.q[2] = 1e-3;
        let motion = state.motion(&[]);
        wheel.begin_step(&motion);
        assert_eq!(force(&mut wheel, &motion).amax(), 0.0);
        assert_eq!(wheel.energy(&motion), 0.0);
        assert_eq!(wheel.force(&motion), Vector3::zeros());
    }
}

#[test]
fn a_contact_that_opens_fast_does_not_pull() {
    let (set, mut state) = moving(CreepLaw::Polach, 0.0);
    state.v[2] = 10.0;
    for wheel in &set.wheels {
        let contacts = wheel.contacts(&state.motion(&[]));
        assert!(contacts.iter().flatten().count() > 0);
        assert!(
            contacts
                .iter()
                .flatten()
                .all(|contact| contact.normal_force == 0.0 && contact.force.norm() == 0.0)
        );
    }
}

#[test]
fn the_power_of_a_contact_is_what_it_brings_in_less_heat_and_stored_energy() {
    for law in LAWS {
        for left in [0.0, -4.1e-3, -7.3e-3] {
            let (mut set, state) = moving(law, left);
            for wheel in &mut set.wheels {
                let motion = state.motion(&[]);
                let work_rate: f64 = force(wheel, &motion)
                    .iter()
                    .zip(&state.v)
                    .map(|(force, v)| force * v)
                    .sum();
                let h = 1e-6;
                let energy = |sign: f64| {
                    let mut moved_state = state.clone();
                    for index in 0..6 {
                        moved_state = moved(&set.layout, &moved_state, index, sign * h * state.v[index]);
                    }
                    wheel.energy(&moved_state.motion(&[]))
                };
                let stored = (energy(1.0) - energy(-1.0)) / (2.0 * h);
                let power = wheel.power(&motion).unwrap();
                assert!(power.dissipated >= 0.0);
                let balance = power.driven - power.dissipated - stored;
                // h² of displacements of 20 nm against 30 µm of penetration.
                let scale = power.driven.abs() + power.dissipated + stored.abs();
                assert!(
                    (work_rate - balance).abs() < 1e-6 * scale + 1e-8,
                    "{law:?}: {work_rate} {balance}"
                );
            }
        }
    }
}

#[test]
fn a_restored_search_repeats_bit_for_bit() {
    let (mut set, state) = moving(CreepLaw::Polach, -4.1e-3);
    let motion = state.motion(&[]);
    let [wheel, other] = &mut set.wheels;
    wheel.begin_step(&motion);
    force(wheel, &motion);
    let mut saved = Vec::new();
    wheel.save(&mut saved);
    let moved_state = moved(&set.layout, &state, 1, 2e-5);
    let first = force(wheel, &moved_state.motion(&[]));
    // A search that has been elsewhere.
    wheel.begin_step(&other_state(&state).motion(&[]));
    wheel.restore(&mut saved.iter());
    assert_eq!(force(wheel, &moved_state.motion(&[])), first);
    other.begin_step(&motion);
}

fn other_state(state: &State) -> State {
    let mut other = state.clone();
    other.q[1] += 5e-3;
    other
}
