use super::*;
use crate::check::{assert_energy, assert_tangent, awkward, force, tilted};
use crate::multibody::{Anchor, BaseMarker, BodyMarker, Pose};
use dynamics::Layout;
use nalgebra::Matrix3;

fn rates() -> Rates {
    Rates {
        stiffness: Vector3::new(31e3, 3.9e3, 1.2e3),
        damping: Vector3::new(150.0, 20.0, 40.0),
        rotational_stiffness: Vector3::new(500.0, 0.0, 900.0),
        rotational_damping: Vector3::new(3.0, 5.0, 0.0),
    }
}

/// A bushing between two bodies in skew positions, or a body and the base.
fn bushing(layout: &mut Layout, to_base: bool) -> Bushing {
    let point = Vector3::new(0.6, 0.1, 0.9);
    let axes = tilted(0.7).to_rotation_matrix().into_inner();
    let mut body = |name: &str, at: Vector3<f64>, tilt: f64| {
        let pose = Pose::new(at, tilted(tilt), name, layout);
        Anchor::Body(BodyMarker::at(pose, &tilted(tilt), &point, &axes))
    };
    let first = body("first", Vector3::new(0.3, -0.2, 1.0), 0.1);
    let second = if to_base {
        Anchor::Base(BaseMarker { position: point, axes })
    } else {
        body("second", Vector3::new(1.1, 0.4, 0.7), -0.5)
    };
    Bushing {
        pair: Pair { first, second },
        rates: rates(),
        preload: Vector3::new(10.0, -20.0, 700.0),
        characteristics: [
            None,
            Characteristic::new(&[-1.0, -0.05, 0.05, 1.0], &[-9e3, 0.0, 0.0, 9e3]).ok(),
            None,
        ],
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    for to_base in [false, true] {
        let mut layout = Layout::new();
        let mut bushing = bushing(&mut layout, to_base);
        let state = awkward(&layout);
        assert_tangent(&mut bushing, &layout, &state, &[]);
    }
}

#[test]
fn the_force_without_velocities_is_minus_the_gradient_of_the_energy() {
    let mut layout = Layout::new();
    let mut bushing = bushing(&mut layout, false);
    let state = awkward(&layout);
    assert_energy(&mut bushing, &layout, &state);
}

#[test]
fn forces_on_both_bodies_cancel_and_only_dampers_turn_power_into_heat() {
    let mut layout = Layout::new();
    let mut bushing = bushing(&mut layout, false);
    let mut state = awkward(&layout);
    let total = force(&mut bushing, &state.motion(&[]));
    for axis in 0..3 {
        // Rounding of forces of a few ten kilonewtons.
        assert!((total[axis] + total[6 + axis]).abs() < 1e-10);
    }
    let heat = bushing.load(&state.motion(&[])).dissipated;
    assert!(heat > 0.0);
    let power = |force: &nalgebra::DVector<f64>, v: &[f64]| -> f64 { force.iter().zip(v).map(|(f, v)| f * v).sum() };
    let moving = power(&total, &state.v);
    let v = state.v.clone();
    state.v.fill(0.0);
    let elastic = power(&force(&mut bushing, &state.motion(&[])), &v);
    assert!(
        (elastic - moving - heat).abs() < 1e-9 * heat,
        "{elastic} {moving} {heat}"
    );
}

#[test]
fn nothing_acts_on_a_rigid_motion_of_both_bodies() {
    let mut layout = Layout::new();
    let mut bushing = bushing(&mut layout, false);
    bushing.preload = Vector3::zeros();
    let mut state = layout.state_at_rest();
    // A turn about the origin by the same rotation, with the angular velocity (0.3, −0.2, 0.5) rad/s.
    let turn = tilted(1.3);
    let omega = Vector3::new(0.3, -0.2, 0.5);
    for k in 0..2 {
        let reference = [Vector3::new(0.3, -0.2, 1.0), Vector3::new(1.1, 0.4, 0.7)][k];
        let moved = turn * reference;
        state.rotation[k] = turn * state.rotation[k];
        let (shift, velocity) = (moved - reference, omega.cross(&moved));
        let spin = state.rotation[k].inverse() * omega;
        for axis in 0..3 {
            state.q[6 * k + axis] = shift[axis];
            state.v[6 * k + axis] = velocity[axis];
            state.v[6 * k + 3 + axis] = spin[axis];
        }
    }
    // Rounding of 1e-16 m times 31 kN/m.
    assert!(force(&mut bushing, &state.motion(&[])).amax() < 1e-10);
}

#[test]
fn a_known_displacement_gives_the_force_of_each_axis() {
    let mut layout = Layout::new();
    let pose = Pose::new(
        Vector3::zeros(),
        nalgebra::UnitQuaternion::identity(),
        "body",
        &mut layout,
    );
    let mut bushing = Bushing {
        pair: Pair {
            first: Anchor::Base(BaseMarker {
                position: Vector3::zeros(),
                axes: Matrix3::identity(),
            }),
            second: Anchor::Body(BodyMarker {
                pose,
                offset: Vector3::zeros(),
                axes: Matrix3::identity(),
            }),
        },
        rates: rates(),
        preload: Vector3::zeros(),
        characteristics: [None, None, None],
    };
    let mut state = layout.state_at_rest();
    state.q[..3].copy_from_slice(&[1e-3, 2e-3, -3e-3]);
    state.v[5] = 0.1;
    let angle = 0.02_f64;
    state.rotation[0] = dynamics::rotation::exp(&Vector3::new(0.0, 0.0, angle));
    let found = force(&mut bushing, &state.motion(&[]));
    assert!((found[0] + 31.0).abs() < 1e-12);
    assert!((found[1] + 7.8).abs() < 1e-12);
    assert!((found[2] - 3.6).abs() < 1e-12);
    // No rotational damper about z; κ sin φ acts with the lever cos φ of its potential.
    assert!((found[5] + 900.0 * angle.sin() * angle.cos()).abs() < 1e-12);
}
