//! Forces of the air against hand calculations and differences.
use super::*;
use crate::testing::LawTrio;
use crate::{Frame, Layout, rotation};
use nalgebra::UnitQuaternion;

const DENSITY: f64 = 1.225;

/// A point fixed in a body with six coordinates: displacements, and the turn of its axes.
struct Arm {
    offset: Vector3<f64>,
    axes: Matrix3<f64>,
    travel: Vector3<f64>,
}

impl Marker for Arm {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let body = motion.rotation[0].to_rotation_matrix().into_inner();
        let offset = body * self.offset;
        let omega = body * Vector3::from_column_slice(&motion.v[3..6]);
        Frame {
            position: Vector3::from_column_slice(&motion.q[..3]) + offset,
            axes: body * self.axes,
            velocity: Vector3::from_column_slice(&motion.v[..3]) + omega.cross(&offset) + self.travel,
            angular_velocity: omega,
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        let body = motion.rotation[0].to_rotation_matrix().into_inner();
        let offset = body * self.offset;
        for axis in 0..3 {
            columns.push(axis, Vector3::ith(axis, 1.0), Vector3::zeros());
        }
        for axis in 0..3 {
            let turn = body.column(axis).into_owned();
            columns.push(3 + axis, turn.cross(&offset), turn);
        }
    }
}

fn polar() -> Polar {
    Polar::table(vec![-0.5, 0.1, 0.9], vec![0.05, 0.07, 0.2], vec![-0.02, 0.02, 0.06])
}

fn force(law: AerodynamicLaw) -> AerodynamicForce<Arm> {
    AerodynamicForce {
        marker: Arm {
            offset: Vector3::new(0.7, -0.2, 0.4),
            axes: rotation::exp(&Vector3::new(0.1, -0.2, 0.3))
                .to_rotation_matrix()
                .into_inner(),
            travel: Vector3::new(30.0, 0.0, 0.0),
        },
        law,
        flow: Flow {
            wind: Arc::new(Wind::uniform(Vector3::new(-12.0, 7.0, 1.5))),
            density: DENSITY,
            input: Some(0),
        },
    }
}

#[test]
fn drag_and_lift_are_those_of_the_hand_calculation() {
    // 20 m/s from ahead on a plate that stands still: q = 245 Pa.
    let law = AerodynamicLaw::Polar(Polar::constant(0.07, 0.02));
    let load = law.load(DENSITY, &Vector3::new(-20.0, 0.0, 0.0), &Matrix3::identity());
    assert!((load.force - Vector3::new(-245.0 * 0.07, 0.0, 245.0 * 0.02)).amax() < 1e-13); // rounding
    // From behind the drag turns and the lift does not.
    let load = law.load(DENSITY, &Vector3::new(20.0, 0.0, 0.0), &Matrix3::identity());
    assert!((load.force - Vector3::new(245.0 * 0.07, 0.0, 245.0 * 0.02)).amax() < 1e-13);
    // Obliquely from below: drag along (−3, 0, 4)/5, lift across it, towards +z: (4, 0, 3)/5.
    let load = law.load(DENSITY, &Vector3::new(-12.0, 0.0, 16.0), &Matrix3::identity());
    let expected = Vector3::new(-0.6, 0.0, 0.8) * (245.0 * 0.07) + Vector3::new(0.8, 0.0, 0.6) * (245.0 * 0.02);
    assert!((load.force - expected).amax() < 1e-13);
    // Along the third axis there is no direction for the lift.
    let load = law.load(DENSITY, &Vector3::new(0.0, 0.0, 20.0), &Matrix3::identity());
    assert!((load.force - Vector3::new(0.0, 0.0, 245.0 * 0.07)).amax() < 1e-13);
    let still = law.load(DENSITY, &Vector3::zeros(), &Matrix3::identity());
    assert_eq!(still.force, Vector3::zeros());
}

#[test]
fn drag_and_lift_are_the_parts_of_the_force_along_the_air_and_across_it() {
    let axes = rotation::exp(&Vector3::new(0.1, -0.2, 0.3))
        .to_rotation_matrix()
        .into_inner();
    for v_r in [
        Vector3::new(-20.0, 3.0, 2.0),
        Vector3::new(15.0, -6.0, -8.0),
        Vector3::zeros(),
    ] {
        let law = AerodynamicLaw::Polar(polar());
        let [drag, lift] = law.drag_and_lift(DENSITY, &v_r, &axes);
        let force = law.load(DENSITY, &v_r, &axes).force;
        let along = v_r.try_normalize(0.0).unwrap_or_default();
        let up = axes.column(2) - along * axes.column(2).dot(&along);
        assert!((force.dot(&along) - drag).abs() < 1e-12, "{v_r}"); // rounding of some 50 N
        // The polar's lift has both signs; the third axis is the side of a positive one.
        let across = force - along * drag;
        assert!((across.dot(&up) - lift * up.norm()).abs() < 1e-12, "{v_r}");
        assert!((across.norm() - lift.abs()).abs() < 1e-12, "{v_r}");
    }
    // Along the third axis there is no direction for the lift.
    let law = AerodynamicLaw::Polar(Polar::constant(0.07, 0.02));
    let [drag, lift] = law.drag_and_lift(DENSITY, &Vector3::new(0.0, 0.0, 20.0), &Matrix3::identity());
    assert!((drag - 245.0 * 0.07).abs() < 1e-13 && lift == 0.0, "{drag} {lift}");
    let law = AerodynamicLaw::Uplift { coefficient: 0.0125 };
    let v_r = Vector3::new(-80.0, 9.0, 3.0);
    assert_eq!(
        law.drag_and_lift(DENSITY, &v_r, &axes),
        [0.0, law.load(DENSITY, &v_r, &axes).force.z]
    );
}

#[test]
fn coefficients_follow_the_angle_of_attack() {
    let law = AerodynamicLaw::Polar(polar());
    let at = |angle: f64| {
        let v_r = Vector3::new(-20.0 * angle.cos(), 0.0, 20.0 * angle.sin());
        let force = law.load(DENSITY, &v_r, &Matrix3::identity()).force / 245.0;
        let across = Vector3::new(angle.sin(), 0.0, angle.cos());
        (force.dot(&v_r) / 20.0, force.dot(&across))
    };
    // Half way between 0.1 and 0.9; at an angle of the table; beyond its end.
    for (angle, drag, lift) in [
        (0.5, 0.135, 0.04),
        (0.1, 0.07, 0.02),
        (1.4, 0.2, 0.06),
        (-0.7, 0.05, -0.02),
    ] {
        let found = at(angle);
        assert!(
            (found.0 - drag).abs() < 1e-14 && (found.1 - lift).abs() < 1e-14,
            "{angle}: {found:?}"
        );
    }
}

#[test]
fn uplift_grows_with_the_square_of_the_speed_along_the_track() {
    let law = AerodynamicLaw::Uplift { coefficient: 0.0125 };
    let load = law.load(DENSITY, &Vector3::new(-80.0, 9.0, 3.0), &Matrix3::identity());
    assert!((load.force - Vector3::new(0.0, 0.0, 80.0)).amax() < 1e-12); // rounding
}

#[test]
fn an_input_of_the_system_is_added_to_the_wind() {
    let mut force = force(AerodynamicLaw::Polar(polar()));
    let rotation = [UnitQuaternion::identity()];
    let motion = |u| Motion {
        t: 0.0,
        q: &[0.0; 6],
        v: &[0.0; 6],
        rotation: &rotation,
        u,
    };
    let expected = Vector3::new(-42.0, 7.0, 1.5);
    assert_eq!(force.relative_velocity(&motion(&[])), expected);
    let added = force.relative_velocity(&motion(&[1.0, -2.0, 0.5]));
    assert_eq!(added, expected + Vector3::new(1.0, -2.0, 0.5));
    force.flow.input = None;
    assert_eq!(force.relative_velocity(&motion(&[1.0, -2.0, 0.5])), expected);
}

#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    for law in [
        AerodynamicLaw::Polar(polar()),
        AerodynamicLaw::Polar(Polar::constant(0.07, 0.02)),
        AerodynamicLaw::Uplift { coefficient: 0.01 },
    ] {
        let mut layout = Layout::new();
        layout.add_coordinates(3, "body");
        layout.add_rotation(rotation::exp(&Vector3::new(0.3, 0.4, -0.2)), "body");
        let mut state = layout.state_at_rest();
        state.q[..3].copy_from_slice(&[0.1, -0.2, 0.3]);
        state.v.copy_from_slice(&[1.0, -2.0, 3.0, 4.0, -5.0, 6.0]);
        // Central difference: h² of a smooth function of the order of 100, rounding 1e-14/h.
        let trio = LawTrio {
            q_step: 1e-6,
            v_step: 1e-6,
            tolerance: 1e-8,
        };
        trio.assert_tangent(&mut force(law), &layout, &state, &[]);
    }
}

#[test]
fn power_brought_in_less_power_lost_is_that_of_the_force() {
    let force = force(AerodynamicLaw::Polar(polar()));
    let v = [1.0, -2.0, 3.0, 4.0, -5.0, 6.0];
    let rotation = [rotation::exp(&Vector3::new(0.3, 0.4, -0.2))];
    let motion = Motion {
        t: 0.0,
        q: &[0.0; 6],
        v: &v,
        rotation: &rotation,
        u: &[],
    };
    let mut generalised = vec![0.0; 6];
    let mut moving = force.clone_for_test();
    moving.add_force(&motion, &mut generalised);
    let expected: f64 = generalised.iter().zip(v).map(|(q, v)| q * v).sum();
    let power = Force::power(&force, &motion).unwrap();
    assert!((power.driven - power.dissipated - expected).abs() < 1e-10); // rounding of some 1000 W
    // Drag on a body that moves into the wind brakes it more than the wind drives one that stands.
    assert!(power.dissipated > 0.0);
}

impl AerodynamicForce<Arm> {
    fn clone_for_test(&self) -> Self {
        force(self.law.clone())
    }
}

#[test]
fn a_cylinder_feels_the_air_across_its_axis_only() {
    let wire = CrossFlow::new(DENSITY, 1.2, 0.012);
    let axis = Vector3::new(3.0, 0.0, 0.0);
    let f = wire.force(&Vector3::new(-50.0, 20.0, 0.0), &axis);
    // ½ 1.225 · 1.2 · 0.012 · 20²
    assert!((f - Vector3::new(0.0, 3.528, 0.0)).amax() < 1e-14, "{f}"); // rounding
    assert_eq!(wire.force(&Vector3::new(-50.0, 0.0, 0.0), &axis), Vector3::zeros());
    let (v_r, axis) = (Vector3::new(3.0, -20.0, 5.0), Vector3::new(1.0, 0.1, -0.05));
    let exact = wire.by_velocity(&v_r, &axis);
    let h = 1e-5;
    for l in 0..3 {
        let side = |h: f64| wire.force(&(v_r + Vector3::ith(l, h)), &axis);
        let difference = (side(h) - side(-h)) / (2.0 * h);
        assert!((exact.column(l) - difference).amax() < 1e-10); // rounding 1e-15/h
    }
}

/// Section whose coefficients have slopes.
fn section() -> SectionFlow {
    let degrees = [-60.0_f64, -20.0, 10.0, 40.0, 80.0];
    let angles = degrees.iter().map(|angle| angle.to_radians()).collect();
    let polar = Polar::table(angles, vec![1.5, 1.1, 0.9, 1.4, 2.0], vec![-0.3, 0.8, -0.6, -0.9, 0.2]);
    SectionFlow::new(DENSITY, 0.03, polar)
}

#[test]
fn drag_of_a_section_is_along_the_air_and_its_lift_upwards_from_either_side() {
    let flat = SectionFlow::new(DENSITY, 0.03, Polar::constant(1.2, 0.5));
    let half = 0.5 * DENSITY * 0.03;
    for side in [1.0, -1.0] {
        // Air along (0, 3, 4)/5 lifts along (0, −4, 3)/5, or its mirror image; that along the axis is without effect.
        let f = flat.force(&Vector3::new(7.0, 6.0 * side, 8.0), &(Vector3::x() * 2.0));
        let expected = Vector3::new(0.0, 0.6 * side, 0.8) * 1.2 + Vector3::new(0.0, -0.8 * side, 0.6) * 0.5;
        assert!((f - expected * (half * 100.0)).amax() < 1e-14, "{f}"); // rounding
        assert_eq!(flat.force(&(Vector3::y() * side), &Vector3::z()), Vector3::zeros());
    }
    // Without lift and slopes it is the round cylinder.
    let round = CrossFlow::new(DENSITY, 1.2, 0.03);
    let alike = SectionFlow::new(DENSITY, 0.03, Polar::constant(1.2, 0.0));
    let (v_r, axis) = (Vector3::new(3.0, -20.0, 5.0), Vector3::new(1.0, 0.1, -0.05));
    assert!((round.force(&v_r, &axis) - alike.force(&v_r, &axis)).amax() < 1e-14); // rounding
    assert!((round.by_velocity(&v_r, &axis) - alike.by_velocity(&v_r, &axis)).amax() < 1e-14); // rounding
}

#[test]
fn the_derivative_of_a_section_is_that_of_its_force() {
    let section = section();
    let h = 1e-5;
    for v_r in [
        Vector3::new(3.0, -20.0, 5.0),
        Vector3::new(0.0, 9.0, -7.0),
        Vector3::new(1.0, 2.0, 6.0),
    ] {
        let axis = Vector3::new(1.0, 0.1, -0.05);
        let exact = section.by_velocity(&v_r, &axis);
        for l in 0..3 {
            let side = |h: f64| section.force(&(v_r + Vector3::ith(l, h)), &axis);
            let difference = (side(h) - side(-h)) / (2.0 * h);
            assert!((exact.column(l) - difference).amax() < 1e-9, "{v_r}"); // rounding 1e-15/h
        }
    }
}

#[test]
fn air_about_a_section_damps_up_and_down_motion_by_drag_and_the_slope_of_the_lift() {
    // An edge at 0 whose sides have the slopes −2 and −4 by the angle.
    let polar = Polar::table(vec![-0.5, 0.0, 0.5], vec![1.2; 3], vec![1.0, 0.0, -2.0]);
    let section = SectionFlow::new(DENSITY, 0.03, polar);
    let wind = Vector3::new(0.0, -12.0, 0.0);
    let damping = section.damping(&wind, &Vector3::x());
    let half = 0.5 * DENSITY * 0.03 * 12.0;
    // 1e-6 of the width of the table: the derivative is taken beside the edge.
    assert!((damping.m22 - half * (1.2 - 3.0)).abs() < 1e-5 * half);
    assert!((damping.m11 - half * 2.4).abs() < 1e-5 * half);
    let speed = galloping_speed(2.0, 0.05, DENSITY, 0.03, 1.2 - 3.0).unwrap();
    let per_speed = damping.m22 / 12.0;
    assert!((2.0 * 0.05 + per_speed * speed).abs() < 1e-5, "{speed}");
    assert_eq!(galloping_speed(2.0, 0.05, DENSITY, 0.03, 0.1), None);
}
