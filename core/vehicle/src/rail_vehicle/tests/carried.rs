//! Pantographs on moving bases: given motion and vehicle.
use super::*;
use crate::Subsystem;

/// The pantograph of the thesis on its vehicle, vertical and full.
fn subsystems(overrides: &[&str]) -> [Subsystem; 2] {
    [scene(overrides), full_scene(overrides)].map(|scene| Subsystem::new(&scene, 0).unwrap())
}

#[test]
fn on_smooth_track_a_pantograph_moves_as_on_a_straight_base() {
    let start = "pantograph[1].start={ height = 4.945, force = 107.0 }";
    let text = include_str!("../../../../../scenes/thesis-pantograph.toml");
    let plain = Scene::from_toml(
        text,
        "thesis-pantograph.toml",
        &[start.to_owned(), "model.reduce=none".to_owned()],
    );
    let plain = plain.unwrap();
    for mut carried in subsystems(&[start]) {
        let mut straight = Subsystem::new(&plain, 0).unwrap();
        let (mut largest, mut travel) = (0.0_f64, 0.0_f64);
        let rest = straight.strip().position.z;
        for step in 0..1000 {
            let t = f64::from(step) * 1e-3;
            for side in [&mut straight, &mut carried] {
                side.set_contact_input(2, -107.0 - 30.0 * (6.0 * t).sin());
                side.advance_to(t, 1e-3).unwrap();
            }
            let (a, b) = (straight.strip().position, carried.strip().position);
            largest = largest.max((a.z - b.z).abs());
            travel = travel.max((a.z - rest).abs());
        }
        assert!(travel > 0.01, "{travel}");
        // The vehicle gives way by some 60 N over its 1.7 MN/m, 0.04 mm, in bounce and pitch.
        assert!(largest < 5e-3 * travel, "{largest} of {travel}");
        assert!(largest > 0.0);
    }
}

#[test]
fn on_smooth_track_under_a_constant_contact_force_nothing_moves() {
    for mut side in subsystems(&[]) {
        let seen = |side: &mut Subsystem| {
            let mut loads = [0.0; 8];
            loads
                .iter_mut()
                .enumerate()
                .for_each(|(wheel, load)| *load = side.wheel_load(wheel));
            (loads, side.base().position.z, side.strip().position.z)
        };
        let start = seen(&mut side);
        let (mut load, mut base, mut strip) = (0.0_f64, 0.0_f64, 0.0_f64);
        for step in 0..1000 {
            side.advance_to(f64::from(step) * 1e-3, 1e-3).unwrap();
            let now = seen(&mut side);
            for (now, start) in now.0.iter().zip(start.0) {
                load = load.max((now - start).abs());
            }
            base = base.max((now.1 - start.1).abs());
            strip = strip.max((now.2 - start.2).abs());
        }
        println!("wheel loads {load} N, base {base} m, strip {strip} m");
        // Residuals of statics of 1e-5 N, on stiffnesses of 1e4 N/m and more. Creep forces that the start leaves out
        // change loads by 30 N.
        assert!(load < 1e-3, "{load} N");
        assert!(base < 1e-9 && strip < 1e-9, "{base} m, {strip} m");
    }
}

#[test]
fn a_saved_vehicle_continues_bit_for_bit() {
    let run = |side: &mut Subsystem, from: usize, to: usize| {
        for step in from..to {
            side.advance_to(step as f64 * 1e-3, 1e-3).unwrap();
        }
        let strip = side.strip();
        (
            strip.position,
            strip.velocity,
            side.wheel_load(5),
            side.derailment_quotient(5),
        )
    };
    // On straight track, and from the transition into a curve on.
    let curve = ARC.replace("start = 80.0", "start = 65.0");
    let in_curve = || Subsystem::new(&full_scene(&[ROUGH, &curve]), 0).unwrap();
    let sides = || subsystems(&[ROUGH]).into_iter().chain([in_curve()]);
    for (mut first, mut other) in sides().zip(sides()) {
        let mut kept = crate::Checkpoint::default();
        run(&mut first, 0, 400);
        first.save_to(&mut kept);
        let straight_on = run(&mut first, 400, 600);
        first.restore_from(&kept).unwrap();
        assert_eq!(run(&mut first, 400, 600), straight_on);
        other.restore_from(&kept).unwrap();
        assert_eq!(run(&mut other, 400, 600), straight_on);
    }
}

#[test]
fn the_strip_of_a_lumped_pantograph_answers_a_sinus_of_its_base_as_its_transfer_function_says() {
    let text = include_str!("../../../../../scenes/en50318-250.toml");
    let (amplitude, omega) = (0.01, std::f64::consts::TAU * 1.5);
    let times: Vec<f64> = (0..3000).map(|i| f64::from(i) * 5e-3).collect();
    let rise: Vec<f64> = times.iter().map(|t| amplitude * (1.0 - (omega * t).cos())).collect();
    let motion = format!("vehicle={{ model = \"rigid_motion\", motion = {{ time = {times:?}, z = {rise:?} }} }}");
    let overrides = [
        motion,
        "pantograph[1].reference_height=5.3".to_owned(),
        "pantograph[1].stiffnesses=[4200.0, 2000.0]".to_owned(),
        "pantograph[1].dampings=[200.0, 400.0]".to_owned(),
    ];
    let scene = Scene::from_toml(text, "en50318-250.toml", &overrides).unwrap();
    let scene::PantographModel::Lumped(lumped) = &scene.pantographs[0].model else {
        panic!("a lumped pantograph");
    };
    // (K + iωC − ω²M) q = (0, k₂ + iωc₂)
    let complex = nalgebra::Complex::new;
    let element = |i: usize| complex(lumped.stiffnesses[i], omega * lumped.dampings[i]);
    let (upper, lower) = (element(0), element(1));
    let inertia = |i: usize| complex(-omega * omega * lumped.masses[i], 0.0);
    let (a, b, d) = (upper + inertia(0), -upper, upper + lower + inertia(1));
    let transfer = -b * lower / (a * d - b * b);
    let mut side = Subsystem::new(&scene, 0).unwrap();
    let rest = side.strip().position.z;
    for step in 0..12_000 {
        let t = f64::from(step) * 1e-3;
        side.advance_to(t, 1e-3).unwrap();
        if step > 10_000 {
            let phase = omega * (t + 1e-3);
            let expected = amplitude * (1.0 - (transfer * complex(phase.cos(), phase.sin())).re);
            let error = side.strip().position.z - rest - expected;
            // (ωh)²/12 of the integrator and its damping, and what is left of the beginning after 10 s.
            assert!(error.abs() < 2e-4 * amplitude, "{error} at {t} s");
        }
    }
}

/// 1.9 s on straight track and in the transition, then in the arc.
const ARC: &str = "track.curve={ radius = 1200.0, direction = \"left\", cant = 0.15, start = 80.0, \
    transition = 80.0, length = 400.0, \
                   rounding = 6.0 }";

#[test]
fn in_a_canted_curve_the_strip_goes_aside_as_the_vehicle_under_it_leans() {
    let start = "pantograph[1].start={ height = 4.945, force = 107.0 }";
    let mut carried = Subsystem::new(&full_scene(&[start, ARC]), 0).unwrap();
    let mut straight = Subsystem::new(&full_scene(&[start]), 0).unwrap();
    let mut y = 0.0;
    for step in 0..6000 {
        for side in [&mut straight, &mut carried] {
            // A wire that stays over the middle of the track.
            let strip = side.strip();
            side.set_contact_input(2, -107.0 - 500.0 * (strip.position.z - 4.945) - 50.0 * strip.velocity.z);
            side.set_contact_input(3, 0.0);
            side.advance_to(f64::from(step) * 1e-3, 1e-3).unwrap();
        }
        y = carried.strip().position.y;
    }
    let (strip, base, roll) = (carried.strip(), carried.base().position, carried.base_roll());
    println!("{strip:?} {base:?} {roll}, {:?}", straight.strip());
    // 200 km/h: 2.57 m/s² of which the cant takes 0.98 m/s².
    let outward = 55.555_f64.powi(2) / 1200.0 * 0.995 - 9.81 * 0.1;
    // Roll of the vehicle by its springs about the plane of the rails, outward in a curve to the left: clockwise.
    assert!(roll > 0.0 && outward > 0.0, "{roll}");
    let lean = base.y - roll * (strip.position.z - base.z);
    assert!(
        (strip.position.y - lean).abs() < 0.05 * lean.abs(),
        "{} {lean}",
        strip.position.y
    );
    assert!(y < -0.05, "{y}");
}

#[test]
fn an_importer_may_set_what_a_curve_is_like() {
    use component::Component;
    let mut scene = full_scene(&[ARC]);
    let parameters = Subsystem::parameters(&scene);
    let ours: Vec<_> = (parameters.iter())
        .filter(|parameter| parameter.name.starts_with("track.curve."))
        .collect();
    let values: Vec<f64> = ours.iter().map(|parameter| parameter.value(&scene)).collect();
    assert_eq!(values, [1200.0, 0.15, 80.0, 80.0, 400.0, 6.0]);
    let radius = ours
        .iter()
        .find(|parameter| parameter.name == "track.curve.radius")
        .unwrap();
    radius.set(&mut scene, 900.0);
    assert_eq!(scene.track.as_deref().unwrap().curves[0].radius, 900.0);
    let none = Subsystem::parameters(&full_scene(&[]));
    assert!(none.iter().all(|parameter| !parameter.name.starts_with("track.")));
}

#[test]
fn a_linkage_on_a_given_motion_moves_as_on_the_vehicle_that_heaves_so() {
    // Waves as long as the distance of the bogies, which rise and fall together, under a car body that does not pitch:
    // a given motion has no pitch.
    let upright = "vehicle.bodies[1].inertia=[1e9, 1e9, 1e9]";
    let length = 13.8684 - 1.2954;
    let x: Vec<f64> = (0..400).map(|i| 60.0 + 0.5 * f64::from(i)).collect();
    let rise = |x: &f64| 1e-3 * (1.0 - (std::f64::consts::TAU * (x - 60.0) / length).cos());
    let z: Vec<f64> = x.iter().map(rise).collect();
    let track = format!("track.irregularities={{ model = \"points\", x = {x:?}, z_left = {z:?}, z_right = {z:?} }}");
    let mut heaving = Subsystem::new(&scene(&[&track, upright]), 0).unwrap();
    let height = heaving.pantograph().0.base_z();
    let (mut time, mut given, mut strip, mut pitch) = (Vec::new(), Vec::new(), Vec::new(), 0.0_f64);
    for step in 0..2100 {
        let t = f64::from(step) * 1e-3;
        if step % 5 == 0 {
            time.push(t);
            given.push(heaving.base().position.z - height);
        }
        strip.push(heaving.strip().position.z);
        pitch = pitch.max(heaving.base().axes[(2, 0)].abs());
        heaving.advance_to(t, 1e-3).unwrap();
    }
    let motion = format!("vehicle={{ model = \"rigid_motion\", motion = {{ time = {time:?}, z = {given:?} }} }}");
    let text = THESIS.split("[track]").next().unwrap();
    let rest = THESIS.split("[coupling]").nth(1).unwrap();
    let text = format!("{text}[coupling]{rest}");
    let scene = Scene::from_toml(&text, "thesis-own-mesh.toml", &[motion, "model.reduce=none".to_owned()]).unwrap();
    let mut side = Subsystem::new(&scene, 0).unwrap();
    let (mut largest, mut travel) = (0.0_f64, 0.0_f64);
    for (step, expected) in strip.iter().enumerate().take(2000) {
        largest = largest.max((side.strip().position.z - expected).abs());
        travel = travel.max((expected - strip[0]).abs());
        side.advance_to(step as f64 * 1e-3, 1e-3).unwrap();
    }
    let base = given.iter().fold(0.0_f64, |most, z| most.max((z - given[0]).abs()));
    println!("strip {travel} m, base {base} m, pitch {pitch}, difference {largest} m");
    // Remaining pitch, 0.04 mrad on the 0.55 m from base to strip and more by inertia.
    assert!(travel > 1e-3 && largest < 0.02 * travel, "{largest} of {travel}");
}
