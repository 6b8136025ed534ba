//! The vehicle under each of the creep laws that a scene may choose.
use super::equilibrium::wheel_forces;
use super::full::{full, rolling};
use super::*;
use dynamics::{NewtonOptions, Simulator};

/// Response of a vehicle with wheelsets pushed aside.
struct WheelsetHistory {
    /// Lateral position of the foremost wheelset each millisecond, m.
    lateral: Vec<f64>,
    /// Largest force of a rail along the track at the end of a tenth of a second, N.
    along: f64,
}

fn history(law: &str) -> WheelsetHistory {
    let mut alone = full(&full_scene(&[&format!("vehicle.contact.creep={law}")]), None);
    let mut state = rolling(&mut alone);
    for spin in &alone.vehicle.spins {
        state.v[spin.pose.translation + 1] = 2e-3;
    }
    let foremost = alone.vehicle.spins[3].pose.translation + 1;
    let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 0.9, NewtonOptions::default());
    let (mut lateral, mut along) = (Vec::new(), 0.0_f64);
    for tenth in 0..10 {
        simulator
            .advance(0.1 * f64::from(tenth), 0.1, &mut |_, _| (), &mut |_, motion, _, _| {
                lateral.push(motion.q[foremost]);
            })
            .unwrap();
        let forces = wheel_forces(&mut simulator);
        along = forces.iter().fold(along, |most, force| most.max(force.x.abs()));
        for force in &forces {
            assert!((force.z - 52_793.0).abs() < 500.0, "{law}: {force:?}");
        }
    }
    WheelsetHistory { lateral, along }
}

#[test]
fn a_vehicle_rolls_under_every_creep_law_and_the_laws_agree_at_small_creepage() {
    let laws = ["frictionless", "saturated", "fastsim", "polach"];
    let [without, saturated, fastsim, polach] = laws.map(history);
    let size = |history: &WheelsetHistory| history.lateral.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
    let apart = |a: &WheelsetHistory, b: &WheelsetHistory| {
        let differences = a.lateral.iter().zip(&b.lateral).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max)
    };
    for (law, history) in laws.iter().zip([&without, &saturated, &fastsim, &polach]) {
        println!(
            "{law}: up to {:.3e} m aside, {:.3e} m from the saturated law; {:.1} N along the track",
            size(history),
            apart(history, &saturated),
            history.along
        );
    }
    // Only the normal forces drive or steer, and they have no component along the track but by the yaw of an axle.
    assert!(without.along < 0.1 && saturated.along > 2.0);
    assert!(size(&without) > 5.0 * size(&saturated));
    // Creepages of 1e-4 beside the spin of the treads, 0.055 1/m: FASTSIM is the linear theory but for its grid of 10 ×
    // 10, Polach's form approximates the force of the spin.
    for (other, most) in [(&fastsim, 0.12), (&polach, 0.25)] {
        let apart = apart(other, &saturated);
        assert!(apart > 0.0, "another law is at work");
        assert!(apart < most * size(&saturated), "{apart}");
    }
}
