//! A mass that slides along a wire: energy, steps of the multiplier at element borders, the limit of the penalty law.
//!
//! All with `rho_inf` = 1, where nothing of the integrator damps.
mod energy;
mod limits;
mod multiplier;
mod slide;

use dynamics::{Checkpoint, Jacobian};
use slide::{Case, HANGING, Law, seen, start, step};

#[test]
fn full_newton_and_one_direction_per_step_give_the_same_motion() {
    let case = Case { h: 1e-3, ..HANGING };
    let run = |jacobian: Jacobian| {
        let mut simulator = start(&Case { jacobian, ..case }, Law::Joint);
        (0..1000).for_each(|n| step(&mut simulator, n, case.h));
        let most = simulator.counters().most_iterations;
        (simulator.state().clone(), most, simulator.counters())
    };
    let (exact, most_exact, _) = run(Jacobian::Full);
    let (modified, most, counters) = run(Jacobian::Modified);
    println!("most iterations: {most_exact} full, {most} modified; {counters:?}");
    let apart = exact
        .q
        .iter()
        .zip(&modified.q)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    // Newton's tolerance of 1e-6 N over 1000 steps on 2 kN of tension.
    assert!(apart < 1e-7, "{apart} m");
    assert!(most_exact <= 4, "{most_exact}");
    assert!(
        counters.factorizations < 20 && counters.newton_iterations < 6 * counters.micro_steps,
        "{counters:?}"
    );
}

#[test]
fn a_restored_slide_repeats_bit_for_bit() {
    let case = Case { h: 1e-3, ..HANGING };
    let mut simulator = start(&case, Law::Joint);
    let mut checkpoint = Checkpoint::default();
    (0..300).for_each(|n| step(&mut simulator, n, case.h));
    simulator.save(&mut checkpoint);
    (300..500).for_each(|n| step(&mut simulator, n, case.h));
    let end = simulator.state().clone();
    simulator.restore(&checkpoint).expect("a saved state");
    (300..500).for_each(|n| step(&mut simulator, n, case.h));
    assert_eq!(*simulator.state(), end);
    let mut other = start(&case, Law::Joint);
    other.restore(&checkpoint).expect("a saved state");
    (300..500).for_each(|n| step(&mut other, n, case.h));
    assert_eq!(*other.state(), end, "in another instance");
}

#[test]
fn a_mass_put_on_a_sloping_wire_across_it_starts_with_the_wire_moving_along() {
    let case = HANGING;
    let mut simulator = start(&case, Law::Joint);
    let first = simulator.system.mass.first;
    let mut state = simulator.state().clone();
    // Level instead of along the wire.
    (state.v[first], state.v[first + 1]) = (case.speed, 0.0);
    simulator.set_state(state);
    simulator.start_accelerations().expect("the mass is on the wire");
    let mut balance = simulator.energy_balance();
    assert!(balance.drift()[1] < 1e-12, "{} m/s", balance.drift()[1]);
    let vertical = simulator.state().v[first + 1];
    assert!(
        vertical < -0.01 && vertical > -case.speed,
        "{vertical} m/s: the wire slopes down"
    );
    // Consistent: the first multipliers are near the one at the start.
    let force = seen(&mut simulator).1;
    step(&mut simulator, 0, 1e-5);
    simulator.balance(&mut balance, 1e-5);
    let next = seen(&mut simulator).1;
    assert!(
        (next - force).abs() < 0.05 * force.abs().max(1.0),
        "{force} N, then {next} N"
    );
    assert!(balance.drift()[1] < 1e-6, "{} m/s", balance.drift()[1]);
}
