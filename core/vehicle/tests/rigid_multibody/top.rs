//! The heavy symmetric top in steady precession.
use super::mechanism::{Mechanism, order, run, set_velocity, shown};
use dynamics::NewtonOptions;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use vehicle::multibody::{Anchor, BaseMarker, BodyMarker, Joint};

const MASS: f64 = 1.7; // kg
const ARM: f64 = 0.35; // m from the fixed point to the centre of mass
const TRANSVERSE: f64 = 0.03; // kg m² about the centre of mass
const AXIAL: f64 = 0.05; // kg m²
const GRAVITY: f64 = 9.81;
const TILT: f64 = 1.1; // rad from the vertical
const SPIN: f64 = 70.0; // rad/s, the component of the angular velocity along the axis

const OPTIONS: NewtonOptions = NewtonOptions {
    tolerance: 1e-9,             // 1e-10 of the weight
    constraint_tolerance: 1e-14, // rounding at 0.35 m
    max_iterations: 30,
    jacobian: dynamics::Jacobian::Modified,
    formulation: dynamics::Formulation::Index3,
    passes: None,
};

/// Both rates of steady precession: `I' Ω² cos θ − I₃ ω₃ Ω + m g l = 0` with `I'` about the fixed point. [Goldstein,
/// 5.7]
fn precession() -> [f64; 2] {
    let a = (TRANSVERSE + MASS * ARM * ARM) * TILT.cos();
    let (b, c) = (AXIAL * SPIN, MASS * GRAVITY * ARM);
    let root = (b * b - 4.0 * a * c).sqrt();
    // Without a difference of like numbers for the slow one.
    [2.0 * c / (b + root), (b + root) / (2.0 * a)]
}

/// Largest departure of the tilt from its start and error of the azimuth after 1.5 s, rad, and the violation of the
/// joint, m.
fn errors(rate: f64, h: f64) -> [f64; 3] {
    let mut top = Mechanism::default();
    let orientation = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), TILT);
    let centre = orientation * Vector3::new(0.0, 0.0, ARM);
    let inertia = Vector3::new(TRANSVERSE, TRANSVERSE, AXIAL);
    let pose = top.add_body(centre, orientation, (MASS, inertia, GRAVITY));
    let axes = Matrix3::identity();
    top.add_joint(Joint::spherical(
        Anchor::Base(BaseMarker {
            position: Vector3::zeros(),
            axes,
        }),
        Anchor::Body(BodyMarker::at(pose, &orientation, &Vector3::zeros(), &axes)),
    ));
    let mut state = top.state();
    // ω = Ω e_z + ψ' e₃ with ω₃ given; about the body's axes e_z is (−sin θ, 0, cos θ).
    let omega_b = Vector3::new(-rate * TILT.sin(), 0.0, SPIN);
    set_velocity(&mut state, &pose, (orientation * omega_b).cross(&centre), omega_b);
    let (mut tilt, mut violation, mut azimuth) = (0.0_f64, 0.0_f64, 0.0);
    let steps = (1.5 / h).round() as usize;
    let mut states = Vec::with_capacity(steps);
    run(&mut top, &mut state, (h, steps, 0.9), OPTIONS, &mut |state| {
        states.push(state.clone())
    });
    for state in &states {
        let centre = pose.position(&state.motion(&[]));
        tilt = tilt.max(((centre.z / ARM).acos() - TILT).abs());
        violation = violation.max(top.violation(state));
        let angle = centre.y.atan2(centre.x) - rate * state.t;
        azimuth = (angle + std::f64::consts::PI).rem_euclid(2.0 * std::f64::consts::PI) - std::f64::consts::PI;
    }
    [tilt, azimuth.abs(), violation]
}

#[test]
fn a_heavy_top_precesses_steadily_at_both_rates_of_the_closed_form() {
    for rate in precession() {
        let [coarse, fine] = [1e-3, 5e-4].map(|h| errors(rate, h));
        println!(
            "precession {rate:.4} rad/s: tilt, azimuth, joint {} at 1 ms, {} at 0.5 ms",
            shown(&coarse),
            shown(&fine)
        );
        for (quantity, (coarse, fine)) in ["tilt", "azimuth"].iter().zip(coarse.into_iter().zip(fine)) {
            let order = order(coarse, fine);
            assert!((order - 2.0).abs() < 0.1, "{quantity} at {rate} rad/s: order {order}");
        }
        // 70 rad/s turn by 0.035 rad in 0.5 ms: second order leaves (0.035)²/12 = 1e-4 of the moments, and so about as
        // many radians of tilt; of azimuth it leaves that part of the 2.6 rad and 46 rad gone, and the difference of
        // the tilts besides.
        assert!(fine[0] < 3e-4 && fine[1] < 2e-3, "{fine:?}");
        assert!(fine[2] < 1e-13, "{}", fine[2]); // rounding
    }
}
