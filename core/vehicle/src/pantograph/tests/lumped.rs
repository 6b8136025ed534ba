use super::Alone;
use crate::check::{assert_driven, assert_law, assert_tangent, awkward, force, tilted};
use crate::multibody::{Anchor, AppliedForce, BodyMarker, Pose};
use crate::pantograph::{ChainDrive, ChainElement, Foot, Lumped};
use crate::{PantographModel, Placement, VehicleError};
use dynamics::{Force, GeneralizedAlpha, Layout, NewtonOptions, State};
use nalgebra::{Matrix3, Vector3};

/// EN 50318:2002, Annex A, without damping.
fn en50318() -> scene::Lumped {
    scene::Lumped {
        strip: scene::Strip {
            width: 1.2,
            horns: None,
        },
        static_force: 120.0,
        aero_coefficient: 0.0,
        masses: vec![7.2, 15.0],
        stiffnesses: vec![4200.0, 50.0],
        dampings: vec![0.0, 0.0],
        reference_height: Some(5.3),
        unilateral: vec![false, false],
        friction: vec![0.0, 0.0],
        strips: Vec::new(),
        pitch: None,
    }
}

fn alone(entry: scene::Lumped, with_contact: bool) -> (Alone, State) {
    let mut layout = Layout::new();
    let placement = Placement {
        start_x: 20.0,
        speed: 70.0,
        gravity: 9.81,
        one_motion: false,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let model = PantographModel::new(
        &scene::PantographModel::Lumped(entry),
        placement,
        "pantograph",
        &mut layout,
    )
    .unwrap();
    let state = layout.state_at_rest();
    let loads: Vec<Box<dyn Force>> = if with_contact {
        vec![Box::new(model.applied_force(0))]
    } else {
        Vec::new()
    };
    (Alone { layout, model, loads }, state)
}

fn kinetic(entry: &scene::Lumped, state: &State) -> f64 {
    entry.masses.iter().zip(&state.v).map(|(m, v)| 0.5 * m * v * v).sum()
}

fn potential(alone: &mut Alone, state: &State) -> f64 {
    let mut sum = 0.0;
    alone
        .model
        .forces(&mut |force| sum += force.energy(&state.motion(&[0.0; 4])));
    sum
}

fn integrator(rho_inf: f64) -> GeneralizedAlpha {
    let tight = NewtonOptions {
        tolerance: 1e-10,
        ..NewtonOptions::default()
    };
    GeneralizedAlpha::new(rho_inf, tight)
}

/// Force at rest with the strip at the height of unstretched unloaded springs: 50 N/m bear what 120 N shorten the 4200
/// N/m by.
const AT_REFERENCE: f64 = 120.0 / (1.0 + 50.0 / 4200.0);

#[test]
fn the_air_adds_its_coefficient_times_the_square_of_the_speed_to_the_static_force() {
    // The placement runs at 70 m/s.
    let (plain, _) = alone(
        scene::Lumped {
            static_force: 120.0 + 0.01 * 4900.0,
            ..en50318()
        },
        false,
    );
    let (lifted, _) = alone(
        scene::Lumped {
            aero_coefficient: 0.01,
            ..en50318()
        },
        false,
    );
    assert_eq!(lifted.model.uplift_force(), plain.model.uplift_force());
    assert_eq!(lifted.model.static_force(), plain.model.static_force());
}

#[test]
fn the_reference_state_is_at_rest_under_the_static_force_less_what_the_ground_spring_takes() {
    let (mut alone, state) = alone(en50318(), true);
    let u = [0.0, 0.0, -AT_REFERENCE, 0.0];
    let mut force = [0.0; 2];
    alone
        .model
        .forces(&mut |part| part.add_force(&state.motion(&u), &mut force));
    alone.loads[0].add_force(&state.motion(&u), &mut force);
    assert!(force.iter().all(|force| force.abs() < 1e-12), "{force:?}");
    let frame = alone.model.strip().frame(&state.motion(&u));
    assert_eq!(
        (frame.position.x, frame.position.z, frame.velocity.x),
        (20.0, 5.3, 70.0)
    );
}

#[test]
fn an_equilibrium_bears_its_contact_force() {
    let (mut alone, mut state) = alone(en50318(), true);
    for height in [5.25, 5.3, 5.36] {
        let equilibrium = alone.model.equilibrium_at_height(height).unwrap();
        alone.model.set_initial(&equilibrium, &mut state);
        assert!((alone.model.strip().frame(&state.motion(&[])).position.z - height).abs() < 1e-14);
        let u = [0.0, 0.0, -equilibrium.force, 0.0];
        let mut force = [0.0; 2];
        alone
            .model
            .forces(&mut |part| part.add_force(&state.motion(&u), &mut force));
        alone.loads[0].add_force(&state.motion(&u), &mut force);
        assert!(force.iter().all(|force| force.abs() < 1e-9), "{force:?}");
        let again = alone.model.equilibrium_at_force(equilibrium.force).unwrap();
        assert!((again.height - height).abs() < 1e-12);
    }
}

#[test]
fn a_chain_without_grounded_stiffness_has_its_static_force_at_any_height() {
    let mut entry = en50318();
    entry.stiffnesses[1] = 0.0;
    let (mut alone, mut state) = alone(entry, false);
    let equilibrium = alone.model.equilibrium_at_height(5.0).unwrap();
    assert_eq!(equilibrium.force, 120.0);
    alone.model.set_initial(&equilibrium, &mut state);
    assert!(state.q.iter().all(|q| (q + 0.3).abs() < 1e-14));
    let error = alone.model.equilibrium_at_force(100.0).unwrap_err();
    assert_eq!(
        error,
        VehicleError::OutOfReach {
            force: 100.0,
            static_force: 120.0
        }
    );
}

#[test]
fn an_unknown_reference_height_is_refused() {
    let entry = scene::Lumped {
        reference_height: None,
        ..en50318()
    };
    let error = Lumped::new(&entry, "pantograph", &mut Layout::new()).unwrap_err();
    assert_eq!(error, VehicleError::NoReferenceHeight);
}

#[test]
fn two_masses_vibrate_with_the_frequencies_of_the_closed_form() {
    let entry = en50318();
    let ([m1, m2], [k1, k2]) = ([7.2, 15.0], [4200.0, 50.0]);
    // det(K − ω² M) = 0
    let (a, b, c) = (m1 * m2, -(m1 * (k1 + k2) + m2 * k1), k1 * k2);
    let root = f64::sqrt(b * b - 4.0 * a * c);
    for squared in [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)] {
        let omega: f64 = squared.sqrt();
        let (mut alone, mut state) = alone(entry.clone(), true);
        // One mode about the reference state, released.
        let shape = [1.0, 1.0 - m1 * squared / k1];
        state.q = shape.iter().map(|q| 1e-2 * q).collect();
        let u = [0.0, 0.0, -AT_REFERENCE, 0.0];
        let mut solver = integrator(1.0);
        solver.start_accelerations(&mut alone, &mut state, &u).unwrap();
        let (h, steps) = (0.01 / omega, 1000);
        for step in 1..=steps {
            solver.step(&mut alone, &mut state, &u, f64::from(step) * h, h).unwrap();
        }
        // The trapezoid's frequency is ω (1 − (ωh)²/12).
        let phase: f64 = 10.0 * (1.0 - 1e-4 / 12.0);
        for (q, shape) in state.q.iter().zip(shape) {
            assert!(
                (q - 1e-2 * shape * phase.cos()).abs() < 1e-8 * shape.abs(),
                "{omega}: {q}"
            );
        }
    }
}

#[test]
fn energy_is_kept_without_damping() {
    let entry = en50318();
    let (mut alone, mut state) = alone(entry.clone(), true);
    state.q = vec![0.02, -0.01];
    state.v = vec![-0.3, 0.4];
    let (u, h) = ([0.0; 4], 1e-3);
    let mut solver = integrator(1.0);
    solver.start_accelerations(&mut alone, &mut state, &u).unwrap();
    let start = kinetic(&entry, &state) + potential(&mut alone, &state);
    for step in 1..=10_000 {
        solver.step(&mut alone, &mut state, &u, f64::from(step) * h, h).unwrap();
    }
    let end = kinetic(&entry, &state) + potential(&mut alone, &state);
    let scale = kinetic(&entry, &state) + start.abs();
    // Newton's tolerance times the way, over 10 000 steps.
    assert!((end - start).abs() < 1e-7 * scale, "{start} {end}");
}

#[test]
fn momentum_changes_by_the_impulse_of_the_outer_forces_alone() {
    let mut entry = en50318();
    entry.stiffnesses[1] = 0.0;
    entry.dampings[0] = 10.0;
    entry.friction[0] = 5.0;
    let (mut alone, mut state) = alone(entry, true);
    state.v = vec![0.5, -0.2];
    let momentum = |state: &State| 7.2 * state.v[0] + 15.0 * state.v[1];
    let start = momentum(&state);
    let (u, h) = ([0.0, 0.0, -70.0, 0.0], 1e-3);
    let mut solver = integrator(0.8);
    solver.start_accelerations(&mut alone, &mut state, &u).unwrap();
    for step in 1..=500 {
        solver.step(&mut alone, &mut state, &u, f64::from(step) * h, h).unwrap();
    }
    // (120 N − 70 N) for half a second.
    assert!(
        (momentum(&state) - start - 25.0).abs() < 1e-8,
        "{}",
        momentum(&state) - start
    );
}

fn elements() -> (Layout, Vec<ChainElement>) {
    let mut layout = Layout::new();
    layout.add_coordinates(3, "mass");
    let plain = ChainElement::new(0, Some(2), 900.0, 30.0, 120.0);
    let mut pushing = ChainElement::new(1, None, 900.0, 0.0, 5.0);
    pushing.unilateral = true;
    let mut rubbing = ChainElement::new(0, Some(1), 900.0, 30.0, 120.0);
    rubbing.friction = 4.0;
    (layout, vec![plain, pushing, rubbing])
}

#[test]
fn the_tangent_and_the_power_of_a_chain_drive_are_those_of_its_force() {
    let mut layout = Layout::new();
    layout.add_coordinates(1, "mass");
    let reference = Vector3::new(0.6, 0.1, 4.2);
    let pose = Pose::new(Vector3::new(0.3, -0.2, 1.0), tilted(0.1), "carrier", &mut layout);
    let foot = Anchor::Body(BodyMarker::at(pose, &tilted(0.1), &reference, &Matrix3::identity()));
    let (state, u) = (awkward(&layout), [0.0, 70.0]);
    for foot in [None, Some(Foot::new(foot, reference, 110.0))] {
        let mut drive = ChainDrive {
            coordinate: 0,
            input: 1,
            foot,
        };
        assert_tangent(&mut drive, &layout, &state, &u);
        assert_driven(&mut drive, &state, &u);
    }
}

#[test]
fn the_tangent_of_a_chain_element_is_the_derivative_of_its_force() {
    let (layout, elements) = elements();
    let mut state = awkward(&layout);
    for v in &mut state.v {
        *v *= 1e-2; // within the rounding of the friction
    }
    state.q[1] = -0.01; // pushes
    for mut element in elements {
        assert_law(&mut element, &layout, &state);
    }
}

#[test]
fn an_element_that_pushes_only_never_pulls() {
    let mut layout = Layout::new();
    layout.add_coordinates(1, "mass");
    let mut element = ChainElement::new(0, None, 1000.0, 50.0, 20.0);
    element.unilateral = true;
    for (q, v) in [(0.03, 0.0), (0.03, -2.0), (0.0, 1.0), (-0.01, 1.0)] {
        let mut state = layout.state_at_rest();
        (state.q[0], state.v[0]) = (q, v);
        assert_eq!(force(&mut element, &state.motion(&[]))[0], 0.0, "{q} {v}");
    }
    let mut state = layout.state_at_rest();
    state.q[0] = -0.01;
    assert_eq!(force(&mut element, &state.motion(&[]))[0], 30.0);
}

#[test]
fn friction_opposes_the_sliding_and_is_bounded() {
    let mut layout = Layout::new();
    layout.add_coordinates(1, "mass");
    let mut element = ChainElement::new(0, None, 0.0, 0.0, 0.0);
    element.friction = 6.0;
    for v in [-1.0, -0.003, 0.003, 1.0] {
        let mut state = layout.state_at_rest();
        state.v[0] = v;
        let friction = force(&mut element, &state.motion(&[]))[0];
        assert!(friction * v < 0.0 && friction.abs() <= 6.0);
    }
}

#[test]
fn a_strip_bounces_on_a_stop_without_energy() {
    // A loose head on a stop: falls back under a constant force and never gains height.
    let mut entry = en50318();
    entry.unilateral[0] = true;
    entry.stiffnesses[0] = 1e5;
    let (mut alone, mut state) = alone(entry.clone(), true);
    state.v = vec![1.0, 0.0];
    let (u, h) = ([0.0, 0.0, -120.0, 0.0], 1e-4);
    let mut solver = integrator(0.9);
    solver.start_accelerations(&mut alone, &mut state, &u).unwrap();
    let energy =
        |alone: &mut Alone, state: &State| kinetic(&entry, state) + potential(alone, state) + 120.0 * state.q[0];
    let start = energy(&mut alone, &state);
    let mut opened = false;
    for step in 1..=5_000 {
        solver.step(&mut alone, &mut state, &u, f64::from(step) * h, h).unwrap();
        opened |= state.q[0] - state.q[1] > 120.0 / 1e5;
    }
    let end = energy(&mut alone, &state);
    assert!(opened, "the head never left its stop");
    // Switching inside a step costs the order but adds less than a percent of the 3.6 J.
    assert!((end - start).abs() < 0.036, "{start} {end}");
    assert_eq!(AppliedForce::INPUTS, 4);
}
