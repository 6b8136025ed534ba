//! A wheelset in a curve that its frame follows.
use super::force::assert_tangent;
use super::running::{WEIGHT, conical, rig, start};
use super::support::Design;
use crate::track::Alignment;
use crate::wheel_rail::CreepLaw;
use dynamics::StepHistory;
use std::sync::Arc;

/// A curve that is balanced at 5 m/s.
fn balanced(radius: f64, start: f64) -> scene::Curve {
    scene::Curve {
        radius,
        direction: scene::Direction::Left,
        cant: 1.5 * (25.0_f64 / (9.81 * radius)).atan().sin(),
        start,
        transition: 60.0,
        length: 500.0,
        rounding: 6.0,
    }
}

fn following(law: CreepLaw, speed: f64, curve: scene::Curve) -> Design {
    Design {
        speed,
        spin: speed / 0.46,
        alignment: Alignment::new(&[curve], 1.5).map(Arc::new),
        ..conical(law)
    }
}

#[test]
fn a_free_wheelset_rolls_on_the_line_where_its_radii_take_it_round_the_curve() {
    let radius = 600.0;
    let design = following(CreepLaw::Polach, 5.0, balanced(radius, 5.0));
    let set = design.build();
    let mut state = set.loaded(0, 0.5 * WEIGHT, 0.0, 0.0, 0.0);
    state.v[4] = design.speed / design.radius;
    let mut rig = rig(&design);
    rig.layout.fix(0); // a drive that holds the speed
    let step = 2e-3;
    let mut simulator = start(rig, state, step, 0.8);
    // The kinematic wave goes on about the rolling line: its mean over whole waves.
    let (cone, rail) = (0.05, 0.3);
    let half = design.rail_distance - rail * cone;
    let rolling = design.radius - cone * (half - design.distance);
    let wave = 2.0 * std::f64::consts::PI * (rolling * half / cone).sqrt() / (1.0 + rail * cone / half).sqrt();
    let count = |length: f64| (length / (design.speed * step)).round() as usize;
    let (arc, end) = (count(80.0), count(80.0 + 12.0 * wave));
    let mut sum = 0.0;
    for i in 0..end {
        simulator
            .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
            .unwrap();
        if i >= arc {
            sum += simulator.state().q[1];
        }
    }
    let mean = sum / (end - arc) as f64;
    // Pure rolling: r₁/r₂ = (R + e)/(R − e) with half the distance e of the contacts, y = r e/(γ R) [Wickens,
    // Fundamentals of Rail Vehicle Dynamics, 2003]. The radii differ by 2 γ y (e + R γ)/(e − r γ) for a displacement y
    // on round rails, see the test of Klingel's wave.
    let plain = -rolling * half / (cone * radius);
    let exact = plain * (half - rolling * cone) / (half + rail * cone);
    println!(
        "{:.4} mm, rolling line {:.4} mm, on round rails {:.4} mm",
        1e3 * mean,
        1e3 * plain,
        1e3 * exact
    );
    // The plain formula neglects the roll of the wheelset (r γ/e = 3 %) and the roundness of the rails (2 %).
    assert!((mean / plain - 1.0).abs() < 0.06, "{mean} {plain}");
    assert!((mean / exact - 1.0).abs() < 0.01, "{mean} {exact}");
}

#[test]
fn the_tangent_holds_where_the_frame_follows_the_curve() {
    let curve = scene::Curve {
        cant: 0.15,
        ..balanced(300.0, -10.0)
    };
    // At t = 0 on the ramp, at a speed at which the frame turns by 0.02 rad/s.
    let design = following(CreepLaw::Polach, 20.0, curve);
    for side in 0..2 {
        let mut set = design.build();
        let mut state = set.loaded(side, 40e3, 1e-3, 0.0, 2e-3);
        for (k, value) in [0.01, -0.006, 0.004, 0.002, 0.02, 0.003].into_iter().enumerate() {
            state.v[k] = value;
        }
        let wheel = &mut set.wheels[side];
        wheel.begin_step(&state.motion(&[]), 1e-3);
        assert_eq!(wheel.contacts(&state.motion(&[])).iter().flatten().count(), 1);
        // Loaded at rest and straight ahead: damping and the turn of the rail take no more than a part of it.
        let force = wheel.force(&state.motion(&[]));
        assert!((force.z / 40e3 - 1.0).abs() < 0.1, "{force:?}");
        assert_tangent(wheel, &set.layout, &state);
    }
}
