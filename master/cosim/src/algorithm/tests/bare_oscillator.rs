//! Algorithms on the bare oscillator: growth, limits, estimated frequency, no allocation.

use super::*;

/// The standard set: every algorithm as it is commonly used and at its best.
fn standard_set() -> Vec<Coupling> {
    use Force::{End, Interpolated, Mean};
    use Order::{CatenaryFirst, PantographFirst};
    use scene::Algorithm::{Auto, GaussSeidel, InterfaceJacobian, Iterated, Jacobi};
    let mut set = Vec::new();
    for (algorithm, order, force, p, passes) in [
        (Jacobi, CatenaryFirst, End, 0, 1),
        (Jacobi, CatenaryFirst, Mean, 1, 1),
        (Jacobi, CatenaryFirst, Interpolated, 1, 1),
        (Jacobi, CatenaryFirst, Interpolated, 2, 1),
        (GaussSeidel, CatenaryFirst, End, 0, 1),
        (GaussSeidel, CatenaryFirst, End, 1, 1),
        (GaussSeidel, CatenaryFirst, Mean, 1, 1),
        (GaussSeidel, CatenaryFirst, Mean, 2, 1),
        (GaussSeidel, CatenaryFirst, Interpolated, 1, 1),
        (GaussSeidel, CatenaryFirst, Interpolated, 2, 1),
        (GaussSeidel, PantographFirst, Mean, 1, 1),
        (GaussSeidel, PantographFirst, Interpolated, 2, 1),
        (Iterated, CatenaryFirst, Mean, 1, 50),
        (Iterated, CatenaryFirst, Interpolated, 1, 50),
        (Iterated, PantographFirst, Interpolated, 2, 50),
        (InterfaceJacobian, PantographFirst, Mean, 1, 1),
        (InterfaceJacobian, PantographFirst, End, 1, 1),
        (InterfaceJacobian, PantographFirst, Interpolated, 1, 1),
        (InterfaceJacobian, PantographFirst, Interpolated, 2, 1),
        (InterfaceJacobian, PantographFirst, Mean, 1, 50),
        (InterfaceJacobian, PantographFirst, End, 1, 50),
        (InterfaceJacobian, PantographFirst, Interpolated, 2, 50),
        (Auto, PantographFirst, Interpolated, 2, 1),
        (Auto, PantographFirst, Interpolated, 2, 50),
    ] {
        let mut asked = coupling(algorithm, order, force, p);
        asked.max_iterations = passes;
        set.push(asked);
    }
    set
}

/// The matrix of the recurrence says what a run of many steps shows.
#[test]
fn the_predicted_growth_is_the_observed_one() {
    let mut wrong = Vec::new();
    for asked in standard_set() {
        for number in [0.2, 0.417] {
            let predicted = stability::spectral_radius(&asked, number).unwrap();
            let observed = amplification(&asked, number);
            if (predicted - observed).abs() >= 2e-4 {
                wrong.push(format!(
                    "{} {} {} p = {}, {} passes, ωh = {number}: predicted {predicted:.5}, observed {observed:.5}",
                    asked.algorithm, asked.order, asked.force, asked.extrapolation, asked.max_iterations
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_stability_limits_are_those_of_the_table() {
    use Force::{End, Interpolated, Mean};
    use Order::{CatenaryFirst, PantographFirst};
    use scene::Algorithm::{Auto, GaussSeidel, InterfaceJacobian, Iterated};
    let mut wrong = false;
    // Derived: Gauss-Seidel with z + v τ and the mean force is the Verlet scheme, v₊ = v − h (z + h v/2), z₊ = z + h v
    // − h² (z + h v/2)/2, of determinant 1 and trace 2 − h²: |trace| ≤ 2 up to h = 2. Repeated with the mean force, z̄
    // = (z + z₊)/2 + h (v − v₊)/12 and F = −z̄: determinant 1, trace (2 − 2h²/3)/(1 + h²/6) ≥ −2 up to h² = 12: h =
    // 2√3.
    for (algorithm, order, force, p, passes, expected) in [
        (GaussSeidel, CatenaryFirst, Mean, 1, 50, 2.0),
        (GaussSeidel, CatenaryFirst, Interpolated, 2, 50, 1.54),
        (GaussSeidel, PantographFirst, Interpolated, 2, 50, 0.96),
        (Iterated, CatenaryFirst, Mean, 1, 50, 12.0_f64.sqrt()),
        (InterfaceJacobian, PantographFirst, Mean, 1, 1, 1.22),
        (InterfaceJacobian, PantographFirst, End, 1, 1, 0.08),
        (InterfaceJacobian, PantographFirst, Interpolated, 1, 1, 1.25),
        (InterfaceJacobian, PantographFirst, Interpolated, 2, 1, 1.33),
        (InterfaceJacobian, PantographFirst, Interpolated, 2, 50, 2.88),
        (Auto, PantographFirst, Interpolated, 2, 1, 2.0),
    ] {
        let mut asked = coupling(algorithm, order, force, p);
        asked.max_iterations = passes;
        let found = stability::stability_limit(&asked, 4.0);
        println!("{algorithm} {order} {force} p = {p}, {passes} passes: {found}, expected {expected}");
        wrong |= (found - expected).abs() >= 0.05;
    }
    assert!(!wrong, "see above");
}

/// The frequency may be wrong by 30 %.
#[test]
fn one_pass_stays_stable_where_the_frequency_is_known_badly() {
    let mut asked = coupling(
        scene::Algorithm::InterfaceJacobian,
        Order::PantographFirst,
        Force::Interpolated,
        2,
    );
    asked.max_iterations = 1;
    for wrong in [0.7, 1.3] {
        for number in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let radius = stability::spectral_radius_known_as(&asked, number, wrong).unwrap();
            assert!(radius < 1.0 + 2e-5, "{wrong}, ωh = {number}: {radius}");
        }
    }
}

/// Frequency of the contact as estimated in a run: that of the bare oscillator, ω = 1.
#[test]
fn the_frequency_is_found_from_the_run() {
    for passes in [1, 50] {
        let asked = Coupling {
            max_iterations: passes,
            ..coupling(
                scene::Algorithm::InterfaceJacobian,
                Order::PantographFirst,
                Force::Interpolated,
                2,
            )
        };
        let (mut line, head) = oscillator::closed(2.0, 10.0);
        let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let mut algorithm = InterfaceJacobian::new(&asked, 1, passes > 1);
        let mut exchange = Exchange::start(&mut sides, 0.0, line_output_count(1, 0)).unwrap();
        for n in 1..=50 {
            algorithm.step(&mut sides, &mut exchange, 0.4).unwrap();
            exchange.accept(0.4 * f64::from(n));
        }
        let found = algorithm.stiffness(0.4).expect("known after 50 steps");
        assert!((found - 0.4).abs() < 0.02, "{passes} passes: ωh = {found}");
    }
}

/// Steps of every algorithm once it has settled.
#[test]
fn a_coupled_step_allocates_nothing() {
    for asked in standard_set() {
        let (mut line, head) = oscillator::closed(1.0, 10.0);
        let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let (mut algorithm, _) = build(&asked, &sides);
        let mut exchange = Exchange::start(&mut sides, 0.0, line_output_count(1, 0)).unwrap();
        let mut steps = |from: u32, to: u32| {
            for n in from..to {
                let parts = algorithm.parts(&exchange, 0.1);
                assert_eq!(parts, 1);
                algorithm.step(&mut sides, &mut exchange, 0.1).unwrap();
                exchange.accept(0.1 * f64::from(n));
            }
        };
        steps(1, 20);
        let count = allocation_counter::measure(|| steps(20, 120)).count_total;
        assert_eq!(count, 0, "{} {} in 100 steps", asked.algorithm, asked.force);
    }
}
