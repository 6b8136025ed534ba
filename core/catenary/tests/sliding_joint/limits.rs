//! Limits of the joint: stiff penalty contact, and small steps.
use crate::slide::{Case, HANGING, Law, seen, start, step};

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    f64::sqrt(sum / count)
}

#[test]
fn the_penalty_law_goes_over_into_the_joint_with_its_stiffness() {
    let case = Case { lift: 100.0, ..HANGING };
    let history = |law: Law| {
        let mut simulator = start(&case, law);
        let first = simulator.system.mass.first;
        let heights = (0..10_000).map(|n| {
            step(&mut simulator, n, case.h);
            simulator.state().q[first + 1]
        });
        heights.collect::<Vec<f64>>()
    };
    let joint = history(Law::Joint);
    let errors = [1e5, 1e6, 1e7].map(|stiffness| {
        let spring = history(Law::Spring(stiffness));
        rms(spring.iter().zip(&joint).map(|(a, b)| a - b))
    });
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log10()).collect();
    println!("rms distance of the mass' height for 1e5, 1e6, 1e7 N/m: {errors:?} m, order in 1/k {orders:.3?}");
    // A spring yields by F/k.
    assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.1), "{orders:?}");
}

#[test]
fn position_and_multiplier_are_of_second_order_in_the_step() {
    const EVERY: f64 = 4e-3;
    for rho_inf in [1.0, 0.8] {
        // Height of the mass and multiplier at the same times, and whether the mass is away from borders for all steps.
        let history = |h: f64| {
            let case = Case {
                h,
                rho_inf,
                tolerance: 1e-8,
                ..HANGING
            };
            let mut simulator = start(&case, Law::Joint);
            let first = simulator.system.mass.first;
            let count = (EVERY / h).round() as usize;
            let samples = (0..100).map(|sample| {
                (0..count).for_each(|i| step(&mut simulator, sample * count + i, h));
                let (s, force) = seen(&mut simulator);
                (
                    simulator.state().q[first + 1],
                    force,
                    (s.fract() - 0.05).rem_euclid(1.0),
                )
            });
            samples.collect::<Vec<_>>()
        };
        let finest = history(6.25e-6);
        let errors = [2e-4, 1e-4, 5e-5].map(|h| {
            let found = history(h);
            let pairs = || found.iter().zip(&finest);
            // The means before and after a border belong to other curvatures: 3 steps of 3 mm.
            let within = |at: f64| at < 0.94;
            let forces = pairs().filter(|(_, exact)| within(exact.2)).map(|(a, b)| a.1 - b.1);
            [rms(pairs().map(|(a, b)| a.0 - b.0)), rms(forces)]
        });
        let size = rms(finest.iter().map(|sample| sample.1));
        let orders = [0, 1].map(|i| {
            let order = |pair: &[[f64; 2]]| (pair[0][i] / pair[1][i]).log2();
            errors.windows(2).map(order).collect::<Vec<f64>>()
        });
        println!(
            "rho_inf = {rho_inf}, h = 0.2, 0.1, 0.05 ms: rms errors of height (m) and multiplier (N) of {size:.1} N \
             {errors:?}; orders {orders:.2?}"
        );
        for order in orders.iter().flatten() {
            assert!((order - 2.0).abs() < 0.4, "{orders:?}");
        }
    }
}
