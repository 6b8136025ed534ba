//! Variants of the vehicle in a study, and the motion of a base that is handed over.
use component::{Component as _, of_pantograph};
use scene::GivenMotion;
use simulation::prepare;
use vehicle::{Displaced, Subsystem};

use super::*;

/// The scene of the thesis on a short line.
fn thesis(overrides: &[&str]) -> Scene {
    let text = include_str!("../../../../../scenes/thesis-own-mesh.toml");
    let mut keys = vec![
        "catenary.spans=6",
        "run.duration=2.0",
        "run.evaluate={ time = [0.5, 2.0] }",
    ];
    keys.extend(overrides);
    let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
    system::load(text, "thesis-own-mesh.toml", &keys).unwrap()
}

fn names(vehicle_variants: &[VehicleVariant]) -> Vec<(&'static str, &'static str)> {
    let name = |vehicle_variant: &VehicleVariant| (vehicle_variant.name.track, vehicle_variant.name.vehicle);
    vehicle_variants.iter().map(name).collect()
}

#[test]
fn a_scene_is_studied_on_every_vehicle_that_it_has_what_it_needs_for() {
    let all = ["full", "vertical", "rigid_motion", NONE];
    let both = [OWN, IRREGULAR]
        .into_iter()
        .flat_map(|track| all.map(|vehicle| (track, vehicle)));
    let found = vehicle_variants(&thesis(&[]), 2e-3);
    assert_eq!(names(&found.all), both.collect::<Vec<_>>());
    assert_eq!(found.left_out, [""; 0]);
    // A track of its own is the only one.
    let rough =
        thesis(&["track.irregularities={ model = \"points\", x = [90.0, 110.0, 130.0], z_left = [0.0, 1e-3, 0.0] }"]);
    assert_eq!(
        names(&vehicle_variants(&rough, 2e-3).all),
        all.map(|vehicle| (OWN, vehicle))
    );
    let mut bumpy = thesis(&[]);
    bumpy.track = None;
    bumpy.vehicle = Some(Arc::new(Vehicle::RigidMotion(GivenMotion {
        time: vec![0.0, 1.0],
        x: vec![0.0; 2],
        y: vec![0.0; 2],
        z: vec![0.0, 1e-3],
        roll: vec![0.0; 2],
        pitch: vec![0.0; 2],
        yaw: vec![0.0; 2],
        file: None,
    })));
    assert_eq!(
        names(&vehicle_variants(&bumpy, 2e-3).all),
        [(OWN, "rigid_motion"), (OWN, NONE)]
    );
    let (mut bare, mut plain) = (thesis(&[]), thesis(&[]));
    (bare.vehicle, bare.track) = (None, None);
    assert!(vehicle_variants(&bare, 2e-3).all.is_empty());
    // Without a profile no wheel can roll.
    let Some(Vehicle::Full(mut train)) = plain.vehicle.as_deref().cloned() else {
        panic!("a full vehicle");
    };
    train.wheels.profile = None;
    plain.vehicle = Some(Arc::new(Vehicle::Vertical(train)));
    assert_eq!(
        names(&vehicle_variants(&plain, 2e-3).all)[..2],
        [(OWN, "vertical"), (OWN, "rigid_motion")]
    );
}

/// The scene of one that is studied, ready to run in steps of a millisecond.
fn made(found: &VehicleVariants, track: &str, vehicle: &str) -> Scene {
    let mut all = found.all.iter();
    let vehicle_variant = all.find(|found| found.name.track == track && found.name.vehicle == vehicle);
    let keys = ["model.reduce=auto".to_owned(), "solver.micro_step=0.001".to_owned()];
    let scene = system::load(&vehicle_variant.unwrap().text, vehicle, &keys).unwrap();
    prepare(scene, vehicle, std::path::Path::new(""), false).unwrap().scene
}

fn motion_of(scene: &Scene) -> GivenMotion {
    match scene.vehicle.as_deref() {
        Some(Vehicle::RigidMotion(motion)) => motion.clone(),
        other => panic!("a given motion, not {other:?}"),
    }
}

/// Largest distance of both bases (m), and largest difference of their angles (rad), in a run of two seconds under the
/// constant force of the start; with the largest displacement of each of the six from the start.
fn apart(full: &Scene, given: &Scene) -> ([f64; 2], [f64; 6]) {
    let [mut full, mut given] = [full, given].map(|scene| Subsystem::build(&of_pantograph(scene, 0)).unwrap());
    let (mut farthest, mut travel) = ([0.0_f64; 2], [0.0_f64; 6]);
    let six = |of: Displaced| -> Vec<f64> { of.displacement.into_iter().chain(of.angles).collect() };
    let start = six(full.base_displaced());
    for step in 0..2000 {
        let time = f64::from(step) * 1e-3;
        for side in [&mut full, &mut given] {
            side.do_step(time, 1e-3).unwrap();
        }
        let distance = (full.base().position - given.base().position).amax();
        let (expected, found) = (full.base_angles(), given.base_angles());
        let turned = expected.iter().zip(found).map(|(a, b)| (a - b).abs());
        farthest = [farthest[0].max(distance), turned.fold(farthest[1], f64::max)];
        for (most, (now, start)) in travel.iter_mut().zip(six(full.base_displaced()).iter().zip(&start)) {
            *most = most.max((now - start).abs());
        }
    }
    (farthest, travel)
}

#[test]
fn a_given_motion_is_that_of_the_base_on_the_vehicle_it_stands_for() {
    let all = vehicle_variants(&thesis(&[]), 1e-3);
    let ([distance, angle], travel) = apart(&made(&all, IRREGULAR, "full"), &made(&all, IRREGULAR, "rigid_motion"));
    println!("{distance:e} m, {angle:e} rad of {travel:?}");
    assert!(travel[1..3].iter().all(|moved| *moved > 2e-4), "{travel:?}");
    assert!(travel[3..].iter().all(|turned| *turned > 1e-4), "{travel:?}");
    // Between samples the spline is off by some 1e-4 of the shortest waves; the end of the record is where it comes to
    // rest.
    assert!(distance < 2e-6 && angle < 2e-6, "{distance} m, {angle} rad");
}

#[test]
fn the_given_motion_of_a_base_beside_the_middle_of_the_track_is_there_too() {
    let all = vehicle_variants(
        &thesis(&["vehicle.pantograph_base=[11.95005378, 0.3, 3.425]", "model.reduce=none"]),
        1e-3,
    );
    let (full, given) = (made(&all, OWN, "full"), made(&all, OWN, "rigid_motion"));
    assert!((given.strip_start_y() - 0.3).abs() < 0.01, "{}", given.strip_start_y());
    assert_eq!(full.strip_start_y(), 0.3);
    let ([distance, angle], _) = apart(&full, &given);
    // As in the middle of the track.
    assert!(distance < 2e-6 && angle < 2e-6, "{distance} m, {angle} rad");
}

#[test]
fn on_smooth_track_a_given_motion_stays_where_the_vehicle_bears_the_base() {
    let all = vehicle_variants(&thesis(&[]), 1e-3);
    let motion = motion_of(&made(&all, OWN, "rigid_motion"));
    let mut full = Subsystem::build(&of_pantograph(&made(&all, OWN, "full"), 0)).unwrap();
    let Displaced {
        displacement: [x, _, z],
        angles: [_, pitch, _],
    } = full.base_displaced();
    // Wheels do not stand on their nominal radius exactly, and the pantograph stands before the middle.
    assert!(z.abs() > 1e-5 && pitch.abs() > 1e-6, "{z} m, {pitch} rad");
    for (values, start) in [(&motion.x, x), (&motion.z, z), (&motion.pitch, pitch)] {
        // Residuals of statics of 1e-5 N on stiffnesses of 1e4 N/m.
        assert!(values.iter().all(|value| (value - start).abs() < 1e-9), "{start}");
    }
    // The line is planar and stays so.
    let aside = [&motion.y, &motion.roll, &motion.yaw];
    assert!(aside.into_iter().flatten().all(|value| *value == 0.0));
}

/// Entered after 0.4 s; in its arc from 1.6 s on.
const CURVE: &str = "track.curve={ radius = 1400.0, direction = \"left\", cant = 0.1, start = 75.0, transition = 67.0, \
    length = 100.0, rounding = 6.0 }";

#[test]
fn in_a_curve_a_given_motion_sways_and_rolls_with_the_vehicle() {
    let all = vehicle_variants(&thesis(&[CURVE]), 1e-3);
    // In the plane along the track there is no curve.
    let expected = ["full", "rigid_motion", NONE];
    let both = [OWN, IRREGULAR]
        .into_iter()
        .flat_map(|track| expected.map(|vehicle| (track, vehicle)));
    assert_eq!(names(&all.all), both.collect::<Vec<_>>());
    assert_eq!(all.left_out, [""; 0]);
    let given = made(&all, OWN, "rigid_motion");
    let ([distance, angle], travel) = apart(&made(&all, OWN, "full"), &given);
    println!("{distance:e} m, {angle:e} rad of {travel:?}");
    // Outward of 2.2 m/s² that the cant takes 0.7 m/s² of: centimetres and some 10 mrad, and it yaws into the arc.
    assert!(travel[3] > 5e-3 && travel[5] > 1e-4, "{travel:?}");
    assert!(distance < 2e-6 && angle < 2e-6, "{distance} m, {angle} rad");
    // Left curve: it leans to the right.
    assert!(motion_of(&given).roll.iter().any(|roll| *roll > 5e-3));
}

#[test]
fn what_is_left_out_is_said_with_its_reason() {
    let mut two = thesis(&[]);
    two.pantographs.push(two.pantographs[0].clone());
    two.pantographs[1].offset_x = -20.0;
    let found = vehicle_variants(&two, 2e-3);
    assert!(names(&found.all).iter().all(|(_, vehicle)| *vehicle != "rigid_motion"));
    let expected = [OWN, IRREGULAR].map(|track| {
        format!(
            "vehicle rigid_motion, track {track}, is left out: each of 2 pantographs has a motion of the base of its \
             own"
        )
    });
    assert_eq!(found.left_out, expected);
    // A step of a metre throws the vehicle off its rails.
    let thrown = thesis(&[
        "track.irregularities={ model = \"points\", x = [90.0, 90.2, 130.0], z_left = [0.0, 1.0, 0.0], y_left = [0.0, \
         2.0, 0.0] }",
    ]);
    let found = vehicle_variants(&thrown, 2e-3);
    assert_eq!(found.left_out.len(), 1, "{:?}", found.left_out);
    println!("{}", found.left_out[0]);
    let start = "vehicle rigid_motion, track scene, is left out: the run that gives its motion ends at ";
    assert!(found.left_out[0].starts_with(start), "{}", found.left_out[0]);
}
