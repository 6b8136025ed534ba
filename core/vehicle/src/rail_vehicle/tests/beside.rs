//! A pantograph beside the middle of the track.
use super::full::full;
use super::*;
use crate::Subsystem;
use nalgebra::Vector3;

/// Override that puts the pantograph's base `y` (m) to the left of the middle.
fn base_at(y: f64) -> String {
    format!("vehicle.pantograph_base=[11.95005378, {y:?}, 3.425]")
}

/// A vehicle bears 5 kN at the base of a pantograph, 0.3 m to the left. Moments about the direction of travel at the
/// top of rail:
///
/// ```text
/// (Q_l − Q_r) e/2 = P y_P + Σ m g y                                                                       derived here
/// ```
///
/// at the places that bodies and base have gone to, with `e` the distance of the nominal contact points.
#[test]
fn wheel_loads_shift_by_the_moment_of_what_stands_beside_the_middle() {
    const LOAD: f64 = 5000.0;
    let mut alone = full(&full_scene(&[&base_at(0.3)]), None);
    let mut state = alone.layout.state_at_rest();
    let point = alone.vehicle.base_frame(&state.motion(&[])).position;
    assert_eq!(point, Vector3::new(0.0, 0.3, 3.425));
    let load = Load { point, force: -LOAD };
    let rest = alone.vehicle.rest(&alone.layout, &mut state, &[load]).unwrap();
    alone.vehicle.set_rest(&rest, &mut state);
    let motion = state.motion(&[]);
    let loads: Vec<f64> = alone.vehicle.wheel_loads(&motion).collect();
    let [left, right] = [0, 1].map(|side| loads.iter().skip(side).step_by(2).sum::<f64>());
    let weight = 43_052.0 * 9.81 + LOAD;
    // Residuals of statics, 1e-5 N each.
    assert!((left + right - weight).abs() < 1e-2, "{left} {right} {weight}");
    let swayed: f64 = (alone.vehicle.bodies().iter())
        .map(|body| body.mass * body.gravity * body.pose.position(&motion).y)
        .sum();
    let (moment, found) = (LOAD * rest.base.position.y + swayed, 0.75 * (left - right));
    println!("{found} N m of {moment} N m, {swayed} N m by the bodies");
    // Contacts move across the profiles by some 0.02 mm as axles bend over, under 427 kN.
    assert!(
        moment > 1500.0 && (found - moment).abs() < 0.01 * moment,
        "{found} N m, {moment} N m"
    );
}

#[test]
fn a_mirrored_base_has_mirrored_wheel_loads() {
    let loads = |y: f64| -> Vec<f64> {
        let mut side = Subsystem::new(&full_scene(&[&base_at(y)]), 0).unwrap();
        (0..8).map(|wheel| side.wheel_load(wheel)).collect()
    };
    let (left, right) = (loads(0.4), loads(-0.4));
    for (wheel, load) in left.iter().enumerate() {
        // Residuals of statics of 1e-5 N.
        assert!((load - right[wheel ^ 1]).abs() < 1e-4, "{left:?} {right:?}");
        // The upward force under the thesis' pantograph takes load off that side, 739 N at 0.4 m over 1.5 m and four
        // wheels.
        assert!((40.0..70.0).contains(&((right[wheel] - load) * if wheel % 2 == 0 { 0.5 } else { -0.5 })));
    }
}

/// In the plane along the track no force has a moment about the direction of travel.
#[test]
fn a_strip_stands_over_its_base_on_every_vehicle() {
    for vehicle in ["full", "vertical"] {
        let keys = [base_at(0.3), format!("vehicle.model={vehicle}")];
        let mut side = Subsystem::new(&full_scene(&[&keys[0], &keys[1]]), 0).unwrap();
        let (strip, base) = (side.strip().position, side.base());
        assert!((base.position.y - 0.3).abs() < 1e-3, "{}", base.position);
        // 1.5 m above a base that leans by 0.1 mrad, on a suspension that bends by as much.
        assert!((strip.y - 0.3).abs() < 2e-3, "{strip}");
        // A contact in the middle of the strip keeps the strip centred.
        side.set_contact_input(3, strip.y);
        let start = (side.wheel_load(0), strip);
        for step in 0..500 {
            side.advance_to(f64::from(step) * 1e-3, 1e-3).unwrap();
        }
        let travelled = Vector3::new(0.5 * 200.0 / 3.6, 0.0, 0.0);
        let moved = (side.strip().position - start.1 - travelled).amax();
        println!("{vehicle}: {moved} m, {} N", side.wheel_load(0) - start.0);
        // Residuals of statics of 1e-5 N on stiffnesses of 1e4 N/m and more.
        assert!(moved < 1e-7, "{vehicle}: {moved} m");
        assert!((side.wheel_load(0) - start.0).abs() < 1e-2, "{vehicle}");
    }
}

#[test]
fn the_strip_of_a_lumped_pantograph_stands_over_its_base() {
    let text = include_str!("../../../../../scenes/en50318-250.toml");
    let lumped = Scene::from_toml(
        text,
        "en50318-250.toml",
        &["pantograph[1].reference_height=4.9".to_owned()],
    )
    .unwrap();
    let loads = |y: f64| {
        let mut scene = full_scene(&[&base_at(y)]);
        scene.pantographs = lumped.pantographs.clone();
        let mut side = Subsystem::new(&scene, 0).unwrap();
        assert_eq!(side.strip().position.y, y);
        side.wheel_load(0) - side.wheel_load(1)
    };
    // 120 N at 0.3 m, over 1.5 m and four wheels; a tenth more, as the vehicle gives way.
    let (shift, static_force) = (loads(0.3), 120.0);
    assert_eq!(shift.signum(), 1.0);
    assert!(
        (shift * 4.0 * 1.5 / 2.0 / (static_force * 0.3) - 1.1).abs() < 0.1,
        "{shift} N"
    );
    assert!((shift + loads(-0.3)).abs() < 1e-4);
}

/// Friction changes the tangent of the element that stands on the base by a low-rank term, whose direction turns with
/// the body below.
#[test]
fn a_rubbing_pantograph_on_a_turning_base_taken_back_repeats_bit_for_bit() {
    let text = include_str!("../../../../../scenes/en50318-250.toml");
    let keys = ["pantograph[1].reference_height=4.9", "pantograph[1].friction=[0, 8]"].map(str::to_owned);
    let lumped = Scene::from_toml(text, "en50318-250.toml", &keys).unwrap();
    let mut scene = full_scene(&[&base_at(0.3)]);
    scene.pantographs = lumped.pantographs.clone();
    let mut side = Subsystem::new(&scene, 0).unwrap();
    let history = |side: &mut Subsystem, steps: std::ops::Range<u32>| -> Vec<f64> {
        steps
            .flat_map(|step| {
                let t = f64::from(step) * 1e-3;
                side.set_contact_input(2, -120.0 - 80.0 * (40.0 * t).sin());
                side.set_contact_input(3, 0.3);
                side.advance_to(t, 1e-3).unwrap();
                let strip = side.strip();
                [strip.position.z, strip.velocity.z, side.base_roll()]
            })
            .collect()
    };
    history(&mut side, 0..100);
    let mut checkpoint = crate::Checkpoint::default();
    side.save_to(&mut checkpoint);
    let first = history(&mut side, 100..200);
    side.restore_from(&checkpoint).unwrap();
    assert_eq!(history(&mut side, 100..200), first);
    let (low, high) = (first.iter().step_by(3)).fold((f64::MAX, f64::MIN), |(low, high), &z| (low.min(z), high.max(z)));
    assert!(high - low > 5e-3, "{} m", high - low);
}
