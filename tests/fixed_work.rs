//! Steps of bounded work: as many corrections in each, one factorisation ahead of the first, and how well that does.
use integration_tests::runs::{EN_300, Run, THREE_SPANS, run, scene_with};
use simulation::Mode;

const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");

/// Equal steps of both sides.
const STEPS: [&str; 2] = ["solver.micro_step=1e-3", "coupling.macro_step=1e-3"];

fn of(text: &str, mode: Mode, more: &[&str]) -> Run {
    run(
        scene_with(text, &[&THREE_SPANS, &STEPS[..], more].concat()),
        mode,
        "fixed-work",
    )
}

#[test]
fn three_corrections_in_every_step_give_the_force_of_as_many_as_it_takes() {
    let lines = [
        (EN_300, "auto"),
        (EN_300, "[\"modal\"]"),
        (EN_300, "[\"planar\",\"linearised\"]"),
        (STITCHED, "auto"),
    ];
    for (text, reduce) in lines {
        let reduce = format!("model.reduce={reduce}");
        let converged = of(text, Mode::Monolithic, &[&reduce, "solver.newton_tolerance=1e-6"]);
        let fixed = of(text, Mode::Monolithic, &[&reduce, "solver.fixed_work=true"]);
        let error = 100.0 * fixed.filtered_difference(&converged) / converged.sigma();
        let cost = &fixed.summary.cost;
        println!(
            "{}: {error:.3} % of sigma, {:?}",
            fixed.summary.title, fixed.summary.notes
        );
        assert_eq!((cost.newton_iterations, cost.factorizations), (3 * cost.micro_steps, 1));
        assert!(error < 0.1, "{reduce}: {error} %");
        let said = fixed
            .summary
            .notes
            .iter()
            .any(|note| note.contains("solver.fixed_work"));
        assert!(said, "{:?}", fixed.summary.notes);
    }
}

#[test]
fn both_sides_of_a_coupled_run_have_steps_of_bounded_work() {
    let coupled = of(EN_300, Mode::Inprocess, &["solver.fixed_work=true"]);
    let whole = of(EN_300, Mode::Monolithic, &[]);
    let cost = &coupled.summary.cost;
    assert_eq!(cost.factorizations, 2, "one of each side");
    assert_eq!(cost.newton_iterations, 3 * cost.micro_steps);
    let error = 100.0 * coupled.filtered_difference(&whole) / whole.sigma();
    assert!(error < 0.2, "{error} %");
}
