//! The law trio of the contact force.
use super::support::{CurvedRail, Design, Wheelset};
use crate::check::{LawTrio, force};
use crate::wheel_rail::{CreepLaw, Fastsim, RailLine, WheelRail};
use dynamics::testing::moved;
use dynamics::{Force, Layout, State, StepHistory};
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

/// Asserts the tangent by central differences over 10 nm and 20 µm/s: the penetration is some 30 µm, so that h² is
/// 1e-8, and rounding of 1e-16 m of it by h is the same.
pub(super) fn assert_tangent(wheel: &mut WheelRail, layout: &Layout, state: &State) {
    let trio = LawTrio {
        q_step: 1e-8,
        v_step: 2e-5,
        tolerance: 2e-7,
    };
    trio.assert_tangent(wheel, layout, state, &[]);
}

#[test]
fn the_tangent_is_the_derivative_of_the_force_for_every_creep_law() {
    for law in LAWS {
        for left in [0.0, 3.2e-3, -4.1e-3, -7.3e-3] {
            let (mut set, state) = moving(law, left);
            let mut touching = 0;
            for wheel in &mut set.wheels {
                wheel.begin_step(&state.motion(&[]), 1e-3);
                touching += wheel.contacts(&state.motion(&[])).iter().flatten().count();
                assert_tangent(wheel, &set.layout, &state);
            }
            assert!(touching > 0);
        }
    }
}

#[test]
fn the_tangent_holds_in_a_curve_with_growing_cant() {
    let design = Design {
        law: CreepLaw::Polach,
        speed: 20.0,
        spin: 20.0 / 0.46,
        damping: 4e8,
        curved: true,
        ..Design::manchester()
    };
    let mut set = design.build();
    let mut state = set.loaded(0, 40e3, 1e-3, 0.0, 2e-3);
    for (k, value) in [0.01, -0.006, 0.004, 0.002, 0.02, 0.003].into_iter().enumerate() {
        state.v[k] = value;
    }
    let wheel = &mut set.wheels[0];
    wheel.begin_step(&state.motion(&[]), 1e-3);
    assert_eq!(wheel.contacts(&state.motion(&[])).iter().flatten().count(), 1);
    assert_tangent(wheel, &set.layout, &state);
}

#[test]
fn the_frame_of_a_curved_rail_is_consistent() {
    let rail = CurvedRail {
        y: 0.76,
        curvature: 1.0 / 300.0,
        cant_rate: 5e-3,
    };
    let (s, h) = (7.0, 1e-3);
    let [plus, minus, frame] = [s + h, s - h, s].map(|s| rail.frame(s, 0.0));
    // Central differences: h² and rounding / h.
    let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() < 1e-10;
    assert!(near((plus.position - minus.position) / (2.0 * h), frame.direction));
    assert!(near((plus.direction - minus.direction) / (2.0 * h), frame.bend));
    assert!(near((plus.turn - minus.turn) / (2.0 * h), frame.turn_rate));
    for axis in 0..3 {
        let rate = (plus.axes.column(axis) - minus.axes.column(axis)) / (2.0 * h);
        assert!(near(rate, frame.turn.cross(&frame.axes.column(axis))));
    }
}

#[test]
fn a_wheel_above_its_rail_exerts_no_force() {
    let set = Design::manchester().build();
    for mut wheel in set.wheels {
        let mut state = set.layout.state_at_rest();
        state.q[2] = 1e-3;
        let motion = state.motion(&[]);
        wheel.begin_step(&motion, 1e-3);
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
    wheel.begin_step(&motion, 1e-3);
    force(wheel, &motion);
    let mut saved = Vec::new();
    wheel.save(&mut saved);
    let moved_state = moved(&set.layout, &state, 1, 2e-5);
    let first = force(wheel, &moved_state.motion(&[]));
    // Search at another position before.
    wheel.begin_step(&other_state(&state).motion(&[]), 1e-3);
    wheel.restore(&mut saved.iter());
    assert_eq!(force(wheel, &moved_state.motion(&[])), first);
    other.begin_step(&motion, 1e-3);
}

#[test]
fn a_search_from_the_last_points_finds_those_of_a_search_from_nowhere() {
    let (mut known, state) = moving(CreepLaw::Polach, -4.1e-3);
    let (mut unknown, _) = moving(CreepLaw::Polach, -4.1e-3);
    for way in [0.0, 0.0, 1e-13, 1e-9, 2e-5, -1e-4, 3e-4, 4e-3] {
        let moved = moved(&known.layout, &state, 1, way);
        let motion = moved.motion(&[]);
        for (known, unknown) in known.wheels.iter_mut().zip(&mut unknown.wheels) {
            known.begin_step(&motion, 1e-3);
            unknown.restore(&mut [].iter());
            unknown.begin_step(&motion, 1e-3);
            // The force of the points just found, and of points that are followed.
            for _ in 0..2 {
                let [found, expected] = [force(known, &motion), force(unknown, &motion)];
                // Rounding of penetrations of some 10 µm at 0.5 m.
                assert!((&found - &expected).amax() < 1e-9 * expected.amax().max(1.0), "{way}");
            }
            assert_eq!(
                known.contacts(&motion).iter().flatten().count(),
                unknown.contacts(&motion).iter().flatten().count()
            );
        }
    }
}

fn other_state(state: &State) -> State {
    let mut other = state.clone();
    other.q[1] += 5e-3;
    other
}

#[test]
fn no_force_jumps_where_contacts_become_one() {
    let design = Design {
        law: CreepLaw::Frictionless,
        ..Design::manchester()
    };
    let mut set = design.build();
    // Through the middle, and from tread to flange root on the right wheel.
    for [from, to] in [[-1.5e-3, 1.5e-3], [-4.4e-3, -5.6e-3]] {
        let height = set.loaded(1, 10e3, 0.5 * (from + to), 0.0, 0.0).q[2];
        let (mut forces, mut counts) = (Vec::new(), Vec::new());
        for i in 0..=3000 {
            let state = set.placed(from + (to - from) * f64::from(i) / 3e3, height, 0.0, 0.0);
            let motion = state.motion(&[]);
            set.wheels[1].begin_step(&motion, 1e-3);
            forces.push(set.wheels[1].force(&motion));
            counts.push(set.wheels[1].contacts(&motion).iter().flatten().count());
        }
        assert!(
            counts.iter().min() < counts.iter().max(),
            "the number of contacts does not change"
        );
        let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let jump = forces
            .windows(3)
            .map(|three| (three[0] - three[1] * 2.0 + three[2]).norm())
            .fold(0.0, f64::max);
        println!("{from}: largest second difference {:.1e} of the force", jump / largest);
        // Second differences over 1 µm (0.4 µm) of 30 µm of penetration: (1/30)² where nothing jumps.
        assert!(jump < 2e-3 * largest, "{jump} {largest}");
    }
}
