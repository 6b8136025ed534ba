//! Energy of a mass on a hanging wire.
use crate::slide::{Case, HANGING, Law, seen, start, step};

#[test]
fn a_mass_that_slides_over_20_borders_of_a_hanging_wire_keeps_its_energy_to_a_millionth_without_dissipation() {
    let errors = [1e-4, 5e-5].map(|h| {
        let case = Case { h, ..HANGING };
        let mut simulator = start(&case, Law::Joint);
        let mut balance = simulator.energy_balance();
        let kinetic = 0.5 * case.mass * case.speed * case.speed;
        let (mut worst, mut exchanged, mut n) = (0.0_f64, 0.0_f64, 0);
        let first = simulator.system.mass.first;
        while seen(&mut simulator).0 < 25.0 {
            step(&mut simulator, n, h);
            simulator.balance(&mut balance, h);
            worst = worst.max(balance.gained().abs());
            let state = simulator.state();
            let speed = state.v[first].hypot(state.v[first + 1]);
            exchanged = exchanged.max((0.5 * case.mass * speed * speed - kinetic).abs());
            n += 1;
        }
        let [gap, rate] = balance.drift();
        println!(
            "h = {h} s, rho_inf = {}, {n} steps, 20 borders: energy off by {worst:.2e} J, {:.2e} of the {kinetic} J \
             of the mass, {:.2e} of the {exchanged:.2} J that it exchanged; work of the joint {:.1e} J; \
             constraint {gap:.1e} m, its rate {rate:.1e} m/s",
            case.rho_inf,
            worst / kinetic,
            worst / exchanged,
            balance.driven(),
        );
        assert!(exchanged > 0.05 * kinetic, "{exchanged} J: the wire moves");
        // The drift of the constraint is of the order of the error of the positions, h², and its work of the order of λ
        // g.
        assert!(gap < 1e-8 * (h / 1e-4).powi(2), "{gap} m");
        assert!(balance.driven().abs() < 1e-7 * exchanged, "{} J", balance.driven());
        worst / exchanged
    });
    assert!(errors[0] < 1e-6, "{errors:?}");
    let order = (errors[0] / errors[1]).log2();
    assert!((order - 2.0).abs() < 0.2, "order {order}");
}
