//! Steps of the multiplier at the borders of elements.
use crate::slide::{Case, HANGING, Law, inverse_mass, seen, start, step};
use catenary::WireSection;

/// Value at `at` of the parabola through equally spaced values that is nearest to them; `at` in steps from the first.
fn extrapolated(values: &[f64], at: f64) -> f64 {
    let middle = 0.5 * (values.len() as f64 - 1.0);
    let scaled = |step: f64| (step - middle) / middle;
    let (mut normal, mut right) = (nalgebra::Matrix3::zeros(), nalgebra::Vector3::zeros());
    let row = |x: f64| nalgebra::Vector3::new(1.0, x, x * x);
    for (i, value) in values.iter().enumerate() {
        let row = row(scaled(i as f64));
        normal += row * row.transpose();
        right += row * *value;
    }
    let found = normal.lu().solve(&right).expect("three values or more");
    found.dot(&row(scaled(at)))
}

/// A border that was passed.
struct Border {
    /// Step of the multiplier, N.
    found: f64,
    /// `v²Δκ/(1/m + Y)`, and `m v²Δκ`, N.
    expected: [f64; 2],
}

/// Steps of the multiplier at consecutive borders, up to 0.5 m before the end of the wire. The step in which the border
/// is passed and the one after it are left out: the latter's reported value is the straight line through the means of
/// both.
fn borders(case: &Case, window: usize) -> Vec<Border> {
    let mut simulator = start(case, Law::Joint);
    let inverse = inverse_mass(&mut simulator.system);
    let element = case.length / case.elements as f64;
    let mut history = vec![seen(&mut simulator).1];
    let mut before = simulator.state().clone();
    // Number of the step, steps at the border itself, what is expected.
    let mut passed: Vec<(usize, f64, [f64; 2])> = Vec::new();
    let (mut here, mut n) = ((case.start / element) as usize, 0);
    let end = case.length - 0.5;
    while seen(&mut simulator).0 < end {
        before.copy_from(simulator.state());
        step(&mut simulator, n, case.h);
        n += 1;
        let (s, force) = seen(&mut simulator);
        history.push(force);
        let now = (s / element) as usize;
        if now != here {
            here = now;
            let speed = simulator.state().v[simulator.system.mass.first];
            let at = n as f64 - (s - here as f64 * element) / (speed * case.h);
            let share = at + 1.0 - n as f64;
            let expected =
                [&before, simulator.state()].map(|state| simulator.system.expected_step(here, state, &inverse));
            let expected = [0, 1].map(|i| expected[0][i] + share * (expected[1][i] - expected[0][i]));
            passed.push((n, at, expected));
        }
    }
    let border = |&(n, at, expected): &(usize, f64, [f64; 2])| {
        let (from, to) = (n + 2, n);
        let before = extrapolated(&history[to - window..to], at - (to - window) as f64);
        let after = extrapolated(&history[from..from + window], at - from as f64);
        Border {
            found: before - after,
            expected,
        }
    };
    let whole = passed.iter().filter(|(n, ..)| n + 2 + window <= history.len());
    whole.map(border).collect()
}

/// Largest step, how many are at least a tenth of it, and for both formulas the largest deviation of these by the step
/// itself and of the others by the largest step.
fn judge(case: &Case, borders: &[Border]) -> (f64, usize, [f64; 2]) {
    let size = borders.iter().fold(0.0_f64, |max, border| max.max(border.found.abs()));
    let (large, small): (Vec<&Border>, Vec<&Border>) =
        borders.iter().partition(|border| border.found.abs() > 0.1 * size);
    let worst = [0, 1].map(|i| {
        let by_itself = large
            .iter()
            .map(|border| (border.found / border.expected[i] - 1.0).abs());
        let by_largest = small
            .iter()
            .map(|border| (border.found - border.expected[i]).abs() / size);
        by_itself.chain(by_largest).fold(0.0, f64::max)
    });
    println!(
        "{} kg on elements of {} m, {} + {} borders, h = {} s, rho_inf = {}: steps of up to {:.4} mN; \
         each off by up to {:.2} % from v²Δκ/(1/m + Y), {:.2} % from m v²Δκ",
        case.mass,
        case.length / case.elements as f64,
        large.len(),
        small.len(),
        case.h,
        case.rho_inf,
        1e3 * size,
        100.0 * worst[0],
        100.0 * worst[1]
    );
    (size, large.len(), worst)
}

#[test]
fn the_multiplier_steps_at_20_borders_by_m_v2_dk_to_a_hundredth_and_less_with_shorter_elements() {
    let mut largest = Vec::new();
    for elements in [48, 96, 192] {
        // A heavy wire with a mass far lighter than its elements.
        let case = Case {
            section: WireSection {
                axial_stiffness: 1e7,
                bending_stiffness: 200.0,
                mass_per_length: 13.0,
                tension: 2e4,
            },
            length: 24.0,
            elements,
            load: -600.0,
            mass: 1e-3,
            lift: 0.0,
            speed: 20.0,
            start: 1.6,
            h: 2e-5,
            tolerance: 1e-7,
            ..HANGING
        };
        let borders = borders(&case, 30);
        let (size, count, worst) = judge(&case, &borders);
        assert!(
            count >= 20 && worst[0] < 0.01 && worst[1] < 0.01,
            "{count} borders: {worst:?}"
        );
        largest.push(size);
    }
    assert!(largest.windows(2).all(|pair| pair[1] < 0.6 * pair[0]), "{largest:?}");
}

#[test]
fn under_a_heavy_mass_the_wire_answers_and_the_multiplier_steps_by_as_much_less() {
    let case = Case { h: 1e-5, ..HANGING };
    // Waves of up to 3000 rad/s run off along elements of 1 m: the history is a parabola for 0.1 ms only.
    let borders = borders(&case, 10);
    let (_, count, worst) = judge(&case, &borders);
    assert!(count >= 15 && worst[0] < 0.01, "{count} borders: {worst:?}");
    // 1 kg on elements of 1.3 kg.
    assert!(worst[1] > 0.1, "{worst:?}: the wire answers");
}
