//! Grounds of the automatic choice.

use super::*;

/// The automatic choice without repeated steps, told a circular frequency of 1 rad/s, at the start.
fn chosen_in_one_pass(sides: &mut Sides<'_>) -> (Box<dyn Algorithm>, Exchange) {
    let asked = Coupling {
        max_iterations: 1,
        ..coupling(scene::Algorithm::Auto, Order::PantographFirst, Force::Interpolated, 2)
    };
    let (mut algorithm, _) = build(&asked, sides);
    algorithm.know(1.0);
    let exchange = Exchange::start(sides, 0.0, line_output_count(1, 0)).unwrap();
    (algorithm, exchange)
}

#[test]
fn a_step_that_is_too_long_is_done_in_parts_or_called_too_long() {
    for (variable, h) in [(true, 2.5), (false, 2.5), (true, 0.5)] {
        let (mut line, mut head) = oscillator::closed(1.0, 10.0);
        head.variable_step = variable;
        let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let (mut algorithm, mut exchange) = chosen_in_one_pass(&mut sides);
        let parts = algorithm.parts(&exchange, h);
        assert_eq!(parts, if variable && h > 2.0 { 2 } else { 1 });
        algorithm.step(&mut sides, &mut exchange, h / parts as f64).unwrap();
        exchange.accept(h / parts as f64);
        let warning = algorithm.warning();
        assert_eq!(warning.is_some(), !variable, "{warning:?}");
        if let Some(warning) = warning {
            assert!(
                warning.contains("head takes steps of one length only") && warning.contains("1.8e0"),
                "{warning}"
            );
        }
        let report = algorithm.report().unwrap();
        let scheme = if h > 2.0 {
            "gauss_seidel in all 1 steps"
        } else {
            "interface_jacobian in all 1 steps"
        };
        assert!(report.contains(scheme), "{report}");
    }
}

/// A figure between the two bounds keeps what runs.
#[test]
fn the_choice_does_not_chatter() {
    let (mut line, head) = oscillator::closed(1.0, 10.0);
    let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let (mut algorithm, mut exchange) = chosen_in_one_pass(&mut sides);
    let mut t = 0.0;
    // Up and down between the bounds, once above, up and down between them again.
    for h in [0.62, 0.68, 0.62, 0.68, 0.75, 0.68, 0.62, 0.68] {
        algorithm.step(&mut sides, &mut exchange, h).unwrap();
        t += h;
        exchange.accept(t);
    }
    let report = algorithm.report().unwrap();
    assert!(
        report.contains("interface_jacobian in 4 steps, gauss_seidel in 4; omega h 0.62 to 0.75"),
        "{report}"
    );
}
