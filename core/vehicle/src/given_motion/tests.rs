//! A given motion as kinematics.
use super::*;
use nalgebra::UnitQuaternion;
use std::f64::consts::TAU;

/// Two seconds of a motion in all directions, sampled every 20 ms.
fn motion() -> GivenMotion {
    let time: Vec<f64> = (0..=100).map(|i| 0.02 * f64::from(i)).collect();
    let wave = |amplitude: f64, frequency: f64| -> Vec<f64> {
        let at = |t: &f64| amplitude * (1.0 - (TAU * frequency * t).cos());
        time.iter().map(at).collect()
    };
    GivenMotion::new(&scene::GivenMotion {
        x: wave(0.01, 1.1),
        y: wave(0.04, 0.7),
        z: wave(0.02, 1.9),
        roll: wave(0.11, 0.6),
        pitch: wave(0.07, 1.3),
        yaw: wave(-0.09, 0.9),
        time,
        file: None,
    })
}

fn marker() -> BaseMarker {
    let axes = UnitQuaternion::from_euler_angles(0.3, -0.5, 0.2).to_rotation_matrix();
    BaseMarker {
        position: Vector3::new(0.4, -0.8, 3.4),
        axes: axes.into_inner(),
    }
}

/// A motion about one axis (0 roll, 1 pitch, 2 yaw) from rest to rest.
fn about(axis: usize, time: &[f64], angle: &[f64]) -> GivenMotion {
    let zero = vec![0.0; time.len()];
    let mut lists = [zero.clone(), zero.clone(), zero.clone()];
    lists[axis] = angle.to_vec();
    let [roll, pitch, yaw] = lists;
    GivenMotion::new(&scene::GivenMotion {
        time: time.to_vec(),
        x: zero.clone(),
        y: zero.clone(),
        z: zero,
        roll,
        pitch,
        yaw,
        file: None,
    })
}

#[test]
fn velocities_are_the_derivatives_of_places_and_axes() {
    let (motion, marker) = (motion(), marker());
    let h = 1e-5;
    for i in 1..40 {
        // Between the samples, where the third derivative of a spline jumps.
        let t = 0.05 * f64::from(i) + 0.003;
        let (behind, now, ahead) = (
            motion.frame_of(&marker, t - h),
            motion.frame_of(&marker, t),
            motion.frame_of(&marker, t + h),
        );
        let velocity = (ahead.position - behind.position) / (2.0 * h);
        // h²/6 of third derivatives of some 100 m/s³, and rounding of 4 m over h.
        assert!((velocity - now.velocity).amax() < 1e-8, "{t}");
        // Ṙ = ω× R
        let rate = (ahead.axes - behind.axes) / (2.0 * h);
        let turned = Matrix3::from_columns(&[0, 1, 2].map(|axis| now.angular_velocity.cross(&now.axes.column(axis))));
        assert!((rate - turned).amax() < 1e-8, "{t}");
        assert!((now.axes.transpose() * now.axes - Matrix3::identity()).amax() < 1e-14);
    }
}

#[test]
fn accelerations_do_not_jump_at_samples() {
    let (motion, marker) = (motion(), marker());
    let h = 1e-7;
    let acceleration = |t: f64| {
        let (behind, ahead) = (motion.frame_of(&marker, t - h), motion.frame_of(&marker, t + h));
        let linear = (ahead.velocity - behind.velocity) / (2.0 * h);
        let angular = (ahead.angular_velocity - behind.angular_velocity) / (2.0 * h);
        (linear, angular)
    };
    // Up to ten samples before the end, where a motion that does not end at rest is stopped.
    for i in 1..90 {
        let sample = 0.02 * f64::from(i);
        let (before, after) = (acceleration(sample - 2.0 * h), acceleration(sample + 2.0 * h));
        // 4h of third derivatives of some 100 m/s³, and rounding of 1 m/s over h.
        assert!((after.0 - before.0).amax() < 1e-3, "{sample}");
        assert!((after.1 - before.1).amax() < 1e-3, "{sample}");
    }
    assert!(acceleration(0.5).0.amax() > 0.5 && acceleration(0.5).1.amax() > 0.5);
}

/// A lever arm `ρ` that turns by `α` about one axis:
///
/// ```text
/// v = α̇ e × ρ,   a = α̈ e × ρ − α̇² ρ
/// ```
#[test]
fn the_end_of_a_turning_lever_arm_moves_as_the_closed_form_says() {
    let (start, rate, angular_acceleration) = (0.1_f64, 0.4_f64, 0.5_f64);
    let angle = |t: f64| start + rate * t + 0.5 * angular_acceleration * t * t;
    let time: Vec<f64> = (-200..=200).map(|i| 0.01 * f64::from(i)).collect();
    let samples: Vec<f64> = time.iter().map(|t| angle(*t)).collect();
    let marker = BaseMarker {
        position: Vector3::new(0.3, -0.7, 3.4),
        axes: Matrix3::identity(),
    };
    for axis in 0..3 {
        let motion = about(axis, &time, &samples);
        let mut normal = Vector3::zeros();
        normal[axis] = 1.0;
        let held = normal * normal.dot(&marker.position);
        let arm = marker.position - held;
        let quarter = normal.cross(&arm);
        for t in [-0.3, 0.0, 0.17, 0.5] {
            let (sine, cosine) = angle(t).sin_cos();
            let now = arm * cosine + quarter * sine;
            let found = motion.frame_of(&marker, t);
            let angular = rate + angular_acceleration * t;
            // A spline is a parabola exactly but for the ends, where it rests: 0.268 per sample over 150 of them.
            assert!((found.position - held - now).amax() < 1e-13, "{axis} {t}");
            assert!(
                (found.velocity - angular * normal.cross(&now)).amax() < 1e-12,
                "{axis} {t}"
            );
            assert!((found.angular_velocity - angular * normal).amax() < 1e-12, "{axis} {t}");
            let h = 1e-4;
            let acceleration =
                (motion.frame_of(&marker, t + h).velocity - motion.frame_of(&marker, t - h).velocity) / (2.0 * h);
            let expected = angular_acceleration * normal.cross(&now) - angular * angular * now;
            // h²/6 of fourth derivatives of some 4 m/s⁴, rounding of 3 m/s over h.
            assert!((acceleration - expected).amax() < 1e-7, "{axis} {t}");
        }
    }
}

#[test]
fn positive_angles_lower_the_right_side_and_the_front_and_turn_the_front_to_the_left() {
    let at = |axis: usize, position: [f64; 3]| {
        let marker = BaseMarker {
            position: position.into(),
            axes: Matrix3::identity(),
        };
        about(axis, &[0.0], &[0.1]).frame_of(&marker, 0.0).position
    };
    assert!(at(0, [0.0, -1.0, 0.0]).z < 0.0);
    assert!(at(1, [1.0, 0.0, 0.0]).z < 0.0);
    assert!(at(2, [1.0, 0.0, 0.0]).y > 0.0);
    // The base goes forward when the vehicle dives.
    assert!(at(1, [0.0, 0.0, 3.4]).x > 0.0);
}

#[test]
fn what_a_motion_was_is_read_from_where_a_marker_is() {
    let (motion, reference) = (motion(), Vector3::new(0.4, -0.8, 3.4));
    let marker = BaseMarker {
        position: reference,
        axes: Matrix3::identity(),
    };
    for t in [0.0, 0.31, 1.2, 1.77] {
        let found = Displaced::to(&motion.frame_of(&marker, t), &reference);
        for axis in 0..3 {
            let (given, angle) = (motion.displacement[axis].at(t)[0], motion.angles[axis].at(t)[0]);
            // Rounding at 4 m.
            assert!((found.displacement[axis] - given).abs() < 1e-14, "{axis} {t}");
            assert!((found.angles[axis] - angle).abs() < 1e-14, "{axis} {t}");
        }
    }
}
