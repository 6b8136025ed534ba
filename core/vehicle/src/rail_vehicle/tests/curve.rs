//! Vehicles in curves.
use super::equilibrium::{
    DISTANCE, Equilibrium, MASS, RADIUS, axles_beside_the_track, centre, contacts_beside_the_track, moments_on_axles,
    track_under, wheel_forces,
};
use super::full::{full, rolling};
use super::*;
use crate::check::{assert_tangent, awkward};
use crate::multibody::{Pose, RigidBody};
use crate::rail_vehicle::CurveInertia;
use crate::track::Alignment;
use crate::{Base, Travel};
use dynamics::{NewtonOptions, Simulator};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::sync::Arc;

fn travel(curve: scene::Curve, speed: f64) -> Travel {
    let base = Base { start_x: 0.0, speed };
    Travel::along(base, Alignment::new(&[curve], DISTANCE).map(Arc::new))
}

fn sharp() -> scene::Curve {
    scene::Curve {
        radius: 300.0,
        direction: scene::Direction::Left,
        cant: 0.15,
        start: 30.0,
        transition: 60.0,
        length: 60.0,
        rounding: 8.0,
    }
}

/// Bodies without any force but their weight.
struct Flying {
    layout: Layout,
    body: RigidBody,
    inertia: CurveInertia,
}

impl System for Flying {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.body);
        visit(&mut self.inertia);
    }
}

/// The body of a frame that runs through a curve at 40 m/s, after 4 s: position, velocity and angular momentum in the
/// world.
fn flown(step: f64) -> [Vector3<f64>; 3] {
    let travel = travel(sharp(), 40.0);
    let mut layout = Layout::new();
    let pose = Pose::new(
        Vector3::new(2.0, -0.5, 3.0),
        UnitQuaternion::identity(),
        "body",
        &mut layout,
    );
    let body = RigidBody {
        pose,
        mass: 700.0,
        inertia: Vector3::new(100.0, 250.0, 300.0),
        gravity: 9.81,
    };
    let inertia = CurveInertia::new(&travel, &[body], &[]).unwrap();
    let mut state = layout.state_at_rest();
    state.v.copy_from_slice(&[1.0, 0.5, 2.0, 0.8, -0.5, 0.3]);
    let system = Flying { layout, body, inertia };
    let mut simulator = Simulator::new(system, state, Vec::new(), step, 1.0, NewtonOptions::default());
    simulator.start_accelerations().unwrap();
    for i in 0..(4.0 / step).round() as usize {
        simulator
            .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
            .unwrap();
    }
    let motion = simulator.state().motion(&[]);
    let marker = BodyMarker {
        pose,
        offset: Vector3::zeros(),
        axes: Matrix3::identity(),
    };
    let frame = travel.travelling(motion.t, 0.0).frame_of(&marker.frame(&motion));
    let omega_b = frame.axes.transpose() * frame.angular_velocity;
    [
        frame.position,
        frame.velocity,
        frame.axes * body.inertia.component_mul(&omega_b),
    ]
}

#[test]
fn a_body_without_forces_flies_straight_on_and_keeps_its_angular_momentum_where_the_track_bends() {
    let velocity = Vector3::new(41.0, 0.5, 2.0);
    let position = Vector3::new(2.0, -0.5, 3.0) + velocity * 4.0 - Vector3::z() * (0.5 * 9.81 * 16.0);
    let expected = [
        position,
        velocity - Vector3::z() * (9.81 * 4.0),
        Vector3::new(80.0, -125.0, 90.0),
    ];
    let errors = |step: f64| {
        let found = flown(step);
        [0, 1, 2].map(|k| (found[k] - expected[k]).norm())
    };
    // The rate of Ω jumps where a clothoid begins or ends: with both steps in the middle of a step, where the trapezoid
    // does not mind.
    let (coarse, fine) = (errors(4e-3), errors(4e-3 / 3.0));
    println!("{coarse:?} {fine:?}");
    // The body has flown 15 m aside in the frame and turned by 0.4 rad.
    for k in 0..3 {
        assert!(coarse[k] < [1e-4, 3e-5, 2e-3][k], "{coarse:?}");
        assert!(fine[k] < 0.15 * coarse[k], "second order: {fine:?} {coarse:?}");
    }
}

#[test]
fn the_tangent_of_what_a_curve_adds_is_the_derivative_of_its_force() {
    let scene = curved(&sharp());
    let mut alone = full(&scene, None);
    let mut state = awkward(&alone.layout);
    // On the ramp within the transition, and in its rounding, where everything changes.
    for place in [75.0, 92.0] {
        state.t = (place - BASE.start_x) / scene.run.speed;
        let inertia = alone.vehicle.inertia.as_mut().unwrap();
        assert_tangent(inertia, &alone.layout, &state, &[]);
    }
}

/// The thesis' scene on a curve.
fn curved(curve: &scene::Curve) -> Scene {
    let mut scene = full_scene(&[]);
    Arc::make_mut(scene.track.as_mut().unwrap()).curves = vec![*curve];
    scene
}

/// A long curve of a main line that begins in front of the first wheel.
fn gentle() -> scene::Curve {
    scene::Curve {
        radius: 800.0,
        direction: scene::Direction::Left,
        cant: 0.1,
        start: 70.0,
        transition: 100.0,
        length: 600.0,
        rounding: 10.0,
    }
}

/// The vehicle after `duration` (s) from a start on straight track.
fn run(scene: &Scene, duration: f64) -> Simulator<Alone> {
    let mut alone = full(scene, None);
    let state = rolling(&mut alone);
    let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 0.9, NewtonOptions::default());
    simulator
        .advance(0.0, duration, &mut |_, _| (), &mut |_, _, _, _| ())
        .unwrap();
    simulator
}

#[test]
fn in_an_arc_the_rails_push_with_the_uncompensated_acceleration_and_the_outer_wheels_bear_its_moment() {
    // Cant in excess, and deficient.
    for speed in [18.0, 32.0] {
        let curve = gentle();
        let mut scene = curved(&curve);
        scene.run.speed = speed;
        let mut simulator = run(&scene, 120.0 / speed + 9.0);
        let equilibrium = Equilibrium::of(&mut simulator, &curve, speed);
        equilibrium.assert(&mut simulator);
        let forces = wheel_forces(&mut simulator);
        let load: f64 = forces.iter().map(|force| force.z).sum();
        // The curve is to the left: the right wheels are the outer ones.
        let outer = forces.iter().skip(1).step_by(2).map(|force| force.z).sum::<f64>();
        assert_eq!(outer > 0.5 * load, equilibrium.outward > 0.0);
    }
}

#[test]
fn at_the_speed_that_the_cant_balances_no_bogie_is_pushed_to_a_side() {
    let mut scene = curved(&gentle());
    scene.run.speed = (9.81 * 800.0 * gentle().cant_angle(DISTANCE).tan()).sqrt();
    let mut simulator = run(&scene, 320.0 / scene.run.speed);
    let forces = wheel_forces(&mut simulator);
    let moments = moments_on_axles(&mut simulator);
    let weight = MASS * 9.81;
    for (bogie, moments) in forces.chunks(4).zip(moments.chunks(2)) {
        let axle = |i: usize| bogie[2 * i].y + bogie[2 * i + 1].y;
        // The stiff bogie is turned into the curve by the creep forces of its axles; the sums on both axles make the
        // moment.
        let turning = moments[0][1] + moments[1][1] + 0.5 * 2.5908 * (axle(1) - axle(0));
        println!(
            "{:.1} {:.1} N, {turning:.1} N m of {:.1}",
            axle(0),
            axle(1),
            moments[0][1]
        );
        assert!((axle(0) + axle(1)).abs() < 1e-4 * weight, "{bogie:?}");
        assert!(turning.abs() < 0.1 * moments[0][1].abs(), "{turning}");
    }
    let equilibrium = Equilibrium::of(&mut simulator, &gentle(), scene.run.speed);
    equilibrium.assert(&mut simulator);
    // Bogies that run outside the middle of the track, and wheels that touch with their flanges, load the outer rail:
    // each axle makes the moment of its load times the middle of its contacts, and of the difference times half their
    // distance.
    let contacts = contacts_beside_the_track(&mut simulator);
    let axles = || forces.chunks(2).zip(&contacts);
    let offset: f64 = axles()
        .map(|(force, y)| (force[0].z + force[1].z) * 0.5 * (y[0] + y[1]))
        .sum();
    let arm = contacts.iter().map(|y| 0.5 * (y[0] - y[1])).sum::<f64>() / 4.0;
    let difference: f64 = forces.chunks(2).map(|axle| axle[0].z - axle[1].z).sum();
    let expected = (equilibrium.moment - offset) / arm;
    println!("load difference {difference:.1} N of {expected:.1}, {contacts:.5?}");
    // 1e-4 for the moment, by 0.75 m, and as much for arms and radii of axles that differ by some mm.
    assert!(
        (difference - expected).abs() < 2.5e-4 * weight,
        "{difference} {expected}"
    );
    // The centre of the vehicle is above its axles but for the roll that it shares with them.
    let shift = centre(&mut simulator).1 - track_under(&mut simulator);
    let beside = axles_beside_the_track(&mut simulator)
        .iter()
        .map(|axle| axle.y)
        .sum::<f64>()
        / 4.0;
    let (alone, motion) = simulator.parts();
    let rolls = alone.vehicle.spins.iter().map(|spin| spin.pose.axes(&motion)[(2, 1)]);
    let roll = rolls.sum::<f64>() / 4.0;
    let leaning = -roll * (shift.z - RADIUS);
    let aside = shift.y - beside;
    println!("centre {aside:.2e} m beside the axles of {leaning:.2e}, these {beside:.2e} m beside the track");
    // The bolster springs let six tenths of the mass lean by 0.14 mm, and roll under it by 160 N m on 3.6 MN m, over 1
    // m.
    assert!((aside - leaning).abs() < 1.5e-4, "{aside} {leaning}");
}

#[test]
fn a_curve_without_end_of_its_radius_is_straight_track() {
    let straight = full_scene(&[]);
    let curve = scene::Curve {
        radius: 1e12,
        cant: 0.0,
        ..gentle()
    };
    let ends: Vec<State> = [straight, curved(&curve)]
        .iter()
        .map(|scene| {
            let mut alone = full(scene, None);
            let mut state = rolling(&mut alone);
            for spin in &alone.vehicle.spins {
                state.v[spin.pose.translation + 1] = 1e-2; // something to sway about
            }
            let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 0.9, NewtonOptions::default());
            simulator
                .advance(0.0, 2.0, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.state().clone()
        })
        .collect();
    let [a, b] = [&ends[0], &ends[1]];
    let moved = a.q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let differ = (0..78).map(|i| (a.q[i] - b.q[i]).abs()).fold(0.0, f64::max);
    println!("{moved} {differ}");
    // v²/R = 3e-9 m/s² is what is left of the curve.
    assert!(moved > 1e-4 && differ < 1e-8, "{moved} {differ}");
}

#[test]
fn the_energy_of_a_run_into_a_curve_is_accounted_for() {
    let residual = |step: f64| {
        let mut alone = full(&curved(&gentle()), rough().as_ref());
        let state = rolling(&mut alone);
        let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 1.0, NewtonOptions::default());
        let mut balance = simulator.energy_balance();
        for i in 0..(2.5 / step).round() as usize {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.balance(&mut balance, step);
        }
        balance.worst_residual() / balance.exchanged()
    };
    let (coarse, fine) = (residual(1e-3), residual(5e-4));
    println!("{coarse} {fine}");
    assert!(coarse < 1e-4, "{coarse}");
    assert!(fine < 0.5 * coarse, "{fine} {coarse}");
}

#[test]
fn a_twisted_track_unloads_wheels_as_the_springs_between_them_yield() {
    // A long ramp, slowly: 1.6 mm per m between bogies that are 12.573 m apart.
    let curve = scene::Curve {
        radius: 3000.0,
        cant: 0.16,
        transition: 100.0,
        ..gentle()
    };
    let mut scene = curved(&curve);
    scene.run.speed = 10.0;
    // Half the vehicle before the middle of the ramp, half behind.
    let mut simulator = run(&scene, 7.0);
    let moments = moments_on_axles(&mut simulator);
    let (alone, motion) = simulator.parts();
    let travel = alone.vehicle.travel();
    let twist = travel.alignment().unwrap().bend(travel.place(motion.t)).cant[1];
    // Between the bogies: bolster springs and anti-roll bars in series with the equalizer springs.
    let bolster = 4.0 * 215e3 + 940e3;
    let equalizer = 4.0 * 1.22e6 * 1.0287_f64.powi(2);
    let between = 0.5 * 12.573 * twist / (1.0 / bolster + 1.0 / equalizer);
    // Within a bogie: the equalizers pitch against each other on their springs, and the bearings hold the axles from
    // rolling in them.
    let pitching = 2.0 * 2.0 * 1.22e6 * 0.6477_f64.powi(2) * 1.0287 * twist * 1.0287 / 2.5908;
    let within = pitching + 2.0 * 1e6 * 0.5 * 2.5908 * twist;
    let found = [
        0.5 * (moments[2][0] + moments[3][0] - moments[0][0] - moments[1][0]),
        0.5 * (moments[1][0] - moments[0][0]),
        0.5 * (moments[3][0] - moments[2][0]),
    ];
    println!("{moments:.0?} {found:.1?} of {between:.1} {within:.1}, twist {twist}");
    for (found, expected) in found.into_iter().zip([between, within, within]) {
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    }
}

/// Y outward on the rail and Q upward on each wheel, N, from its generalised forces on the axle alone: those of the
/// translations are the force in the axes of the vehicle's frame, which the track under the axle turns.
fn lateral_and_vertical(simulator: &mut Simulator<Alone>) -> Vec<[f64; 2]> {
    let (alone, motion) = simulator.parts();
    let travel = alone.vehicle.travel().clone();
    let origin = travel.place(motion.t);
    let poses: Vec<Pose> = alone.vehicle.spins.iter().map(|spin| spin.pose).collect();
    (alone.vehicle.wheels.iter_mut().enumerate())
        .map(|(wheel, contact)| {
            let mut generalised = vec![0.0; motion.q.len()];
            contact.contribution().add_force(&motion, &mut generalised);
            let pose = poses[wheel / 2];
            let force = Vector3::from_column_slice(&generalised[pose.translation..][..3]);
            let track = travel.alignment().unwrap().seen_from(origin + pose.reference.x, origin);
            let force = track.axes.transpose() * force;
            // The rail bears the opposite force; outward is to the left of the left wheel, which comes first.
            let outward = if wheel % 2 == 0 { -force.y } else { force.y };
            [outward, force.z]
        })
        .collect()
}

#[test]
fn derailment_quotients_in_an_arc_are_y_over_q_and_their_sum_holds_the_vehicle_in_it() {
    let curve = gentle();
    // Cant deficient, and in excess.
    for (speed, direction) in [(32.0, scene::Direction::Right), (18.0, scene::Direction::Left)] {
        let curve = scene::Curve { direction, ..curve };
        let mut scene = curved(&curve);
        scene.run.speed = speed;
        let mut simulator = run(&scene, 120.0 / speed + 9.0);
        let forces = lateral_and_vertical(&mut simulator);
        let (alone, motion) = simulator.parts();
        let quotients: Vec<f64> = (0..8)
            .map(|wheel| alone.vehicle.derailment_quotient(wheel, &motion))
            .collect();
        println!("{speed} m/s, {direction:?}: Y/Q {quotients:.4?}");
        for (quotient, [y, q]) in quotients.iter().zip(&forces) {
            // The wheels stand within a millimetre of their nominal positions along the track: turned by 1e-6 rad
            // against it.
            assert!((quotient - y / q).abs() < 1e-5, "{quotient} {y} {q}");
        }
        // The rails push the vehicle to the inside with the force that the cant lacks: the sum of all Y, counted
        // outward on the rails, is the mass times the cant deficiency to the outer side, which is the right one in a
        // curve to the left.
        let side = if direction == scene::Direction::Left { 1.0 } else { -1.0 };
        let found: f64 = (quotients.chunks(2).zip(forces.chunks(2)))
            .map(|(quotient, force)| side * (quotient[1] * force[1][1] - quotient[0] * force[0][1]))
            .sum();
        let expected = MASS * curve.uncompensated_acceleration(speed, 9.81, DISTANCE);
        println!("{found:.1} N of {expected:.1} N");
        assert!((found - expected).abs() < 1e-4 * MASS * 9.81, "{found} {expected}"); // as the equilibrium above
        // The leading axle of each bogie, the one with the larger x, runs outward and is turned outward against the
        // rails, on which the wheels slide: both wheels press the rails apart, the outer one with the flange the more.
        if expected > 0.0 {
            let outer = if direction == scene::Direction::Left { 1 } else { 0 };
            for bogie in quotients.chunks(4) {
                let [inner, outer, trailing] = [bogie[3 - outer], bogie[2 + outer], bogie[outer]];
                assert!(inner > 0.1 && outer > inner && outer > 2.0 * trailing, "{bogie:?}");
            }
        }
    }
}
