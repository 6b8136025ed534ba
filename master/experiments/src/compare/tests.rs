use std::sync::atomic::{AtomicBool, Ordering};

use scene::Scene;

use super::page::page;
use super::plan::{groups, plan};
use super::text::text;
use super::*;
use crate::engine::table::{AUTO, Keys, RunRow, Status};
use crate::engine::tests::executed_in;
use crate::engine::{Stage, Store, Table as _};
use results::Machine;
use simulation::{Mode, SETTLE};

#[test]
fn short_macro_steps_do_not_make_the_long_ones_dear() {
    let default = groups(&MACRO_STEPS, 1e-3);
    let expected = [
        StepGroup {
            micro_step: 5e-4,
            macro_steps: vec![5e-4, 1e-3, 2e-3, 5e-3, 1e-2],
        },
        StepGroup {
            micro_step: 1e-4,
            macro_steps: vec![1e-4, 2e-4],
        },
    ];
    assert_eq!(default, expected);
    // Where the scene's own micro step is short enough, there is one group.
    let fine = groups(&MACRO_STEPS, 1e-4);
    assert_eq!((fine.len(), fine[0].micro_step), (1, 1e-4));
    // Five times the smallest begins another group.
    let micro: Vec<f64> = groups(&[5e-3, 1e-5, 5e-5, 1e-5, 4e-5], 1e-3)
        .iter()
        .map(|group| group.micro_step)
        .collect();
    assert_eq!(micro, [1e-3, 5e-5, 1e-5]);
}

#[test]
fn no_micro_step_is_longer_than_a_macro_step_compared_at_it() {
    for scene in [3e-3, 1e-3, 7e-4, 1e-4] {
        let groups = groups(&[1e-4, 1.5e-4, 3e-4, 7e-4, 2e-3, 3e-3, 2e-2], scene);
        assert_eq!(groups.iter().map(|group| group.macro_steps.len()).sum::<usize>(), 7);
        for group in groups {
            assert!(group.micro_step <= scene && group.macro_steps.iter().all(|step| *step >= group.micro_step));
        }
    }
}

#[test]
fn every_algorithm_runs_at_every_macro_step_and_every_group_has_a_reference() {
    let plan = plan(&groups(&MACRO_STEPS, 1e-3), 2.0, &Keys::default());
    let count = |mode: Mode| plan.iter().filter(|run| run.variant.mode == mode).count();
    assert_eq!(count(Mode::Cosimulation), 7 * algorithms().len());
    assert_eq!((count(Mode::Monolithic), count(Mode::Inprocess)), (2, 5));
    for group in 0..2 {
        let mut ranks: Vec<u8> = plan
            .iter()
            .filter(|run| run.group == group)
            .filter_map(|run| run.reference)
            .collect();
        ranks.sort_unstable();
        assert_eq!(ranks, [0, 1, 2]);
    }
    assert_eq!(algorithms()[0], AUTO);
    assert!(
        ["jacobi", "gauss_seidel", "iterated"]
            .iter()
            .all(|name| algorithms().contains(name))
    );
}

#[test]
fn the_keys_of_a_scene_belong_to_the_algorithm_that_it_names() {
    let typed = [
        "coupling.extrapolation=2".to_owned(),
        "coupling.macro_step=0.01".to_owned(),
        "run.duration=1".to_owned(),
    ];
    let keys = Keys::of(
        &short(&["coupling.algorithm=jacobi", "coupling.force=end"]),
        &typed[..1],
    );
    let plan = plan(&groups(&[1e-3], 1e-3), 1.0, &keys);
    for run in plan {
        let scene = system::load(
            &short(&["coupling.algorithm=jacobi", "coupling.force=end"]).to_toml(),
            "",
            &run.variant.overrides,
        );
        let coupling = scene.unwrap().coupling;
        let kept = run.variant.algorithm == "jacobi" || run.variant.mode == Mode::Monolithic;
        assert_eq!(coupling.force == scene::Force::End, kept, "{run:?}");
        assert_eq!((coupling.extrapolation, coupling.macro_step), (2, 1e-3), "{run:?}");
    }
    assert_eq!(Keys::of(&short(&[]), &typed).typed, typed[..1]);
}

/// A line of three spans on a coarse mesh under the standard's pantograph.
fn short(overrides: &[&str]) -> Scene {
    let text = include_str!("../../../../scenes/en50318-250.toml");
    let mut keys = vec![
        "catenary.spans=3",
        "catenary.mesh.elements_per_interval=1",
        "run.duration=1.2",
        "run.evaluate={ time = [0.2, 0.9] }",
        "run.low_pass_hz=40",
    ];
    keys.extend(overrides);
    let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
    system::load(text, "scene.toml", &keys).unwrap()
}

/// Compares in this process alone: what is tested here does not depend on the FMUs, and the comparison with them is an
/// integration test.
fn compared(scene: Scene, steps: &[f64], interrupted: bool) -> (Comparison, usize) {
    let mut compare = planned(scene, steps);
    for run in &mut compare.runs {
        if run.variant.mode == Mode::Cosimulation {
            run.variant.mode = Mode::Inprocess;
        }
    }
    let mut kept = 0;
    let comparison = crate::engine::tests::executed(&compare, 1, &AtomicBool::new(interrupted), &mut |table| {
        assert_eq!(table.rows.len(), compare.runs.len());
        kept += 1;
    });
    (comparison, kept)
}

fn planned(scene: Scene, steps: &[f64]) -> Compare {
    let stage = Stage {
        name: "short".to_owned(),
        base: ".".into(),
        ..Stage::default()
    };
    Compare::new(scene, stage, steps, &[], 1).unwrap()
}

fn find<'a>(comparison: &'a Comparison, algorithm: &str, step: f64) -> &'a RunRow {
    let found = |row: &&RunRow| row.algorithm == algorithm && row.macro_step == Some(step);
    comparison.rows.iter().find(found).unwrap()
}

#[test]
fn all_algorithms_are_compared_with_the_run_as_one_system() {
    let (comparison, kept) = compared(short(&[]), &[1e-3, 2e-3], false);
    assert!(comparison.complete);
    // Before the first run, after each, and at the end.
    assert_eq!(kept, comparison.rows.len() + 2);
    let whole = &comparison.rows[0];
    assert_eq!(
        (whole.mode.as_str(), whole.status),
        ("monolithic", Some(Status::Stable))
    );
    assert!(whole.macro_step.is_none() && whole.energy_residual.is_none() && whole.filtered_error.is_none());
    for row in &comparison.rows[1..] {
        assert_eq!(row.status, Some(Status::Stable), "{row:?}");
        assert_eq!(row.reference, "monolithic, micro step 0.001 s");
        assert_eq!(row.micro_step, Some(1e-3));
        assert!(row.filtered_error.unwrap() > 0.0 && row.filtered_error.unwrap() < 10.0);
        // An error of the force bounds that of its spread.
        assert!(row.std_error.unwrap().abs() <= row.filtered_error.unwrap() * (1.0 + 1e-6));
        assert!(row.energy_residual.unwrap().is_finite() && row.wall.unwrap() > 0.0);
    }
    let error = |algorithm: &str, step: f64| find(&comparison, algorithm, step).filtered_error.unwrap();
    for step in [1e-3, 2e-3] {
        assert!(error("gauss_seidel", step) < error("jacobi", step));
    }
    let order = |algorithm: &str| find(&comparison, algorithm, 2e-3).order.unwrap();
    assert!(find(&comparison, "jacobi", 1e-3).order.is_none());
    assert!((1.0..4.0).contains(&order("jacobi")), "{}", order("jacobi"));
    let text = text(&comparison);
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    // The page draws the rows with FMUs.
    let mut with_fmus = comparison.clone();
    for row in with_fmus
        .rows
        .iter_mut()
        .filter(|row| row.mode == Mode::Inprocess.name())
    {
        row.mode = Mode::Cosimulation.name().to_owned();
    }
    let page = page(&with_fmus).finish();
    for id in ["plot-error", "plot-cost", "plot-energy", "plot-force"] {
        assert!(page.contains(id));
    }
    assert!(!page.contains("<script src") && !page.contains("Incomplete:"));
    // Good news stands in no warning.
    let same = Comparison {
        same_bits: Some(true),
        notes: vec!["the same bits".to_owned()],
        ..comparison.clone()
    };
    let page = super::page::page(&same).finish();
    assert!(page.contains("<p class=\"good\">the same bits</p>") && !page.contains("<div class=\"notes\">"));
}

#[test]
fn a_comparison_that_was_ended_goes_on_with_the_missing_runs() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), &Machine::this()).unwrap();
    let mut compare = planned(short(&[]), &[2e-3]);
    compare.runs.retain(|run| run.variant.mode != Mode::Cosimulation);
    let interrupted = AtomicBool::new(false);
    let first = executed_in(&store, &compare, 1, &interrupted, &mut |table| {
        interrupted.store(table.made().0 > 0, Ordering::Relaxed);
    });
    assert!(!first.complete && first.made().0 < compare.runs.len());
    let go_on = || executed_in(&store, &compare, 1, &AtomicBool::new(false), &mut |_| {});
    let second = go_on();
    assert!(second.complete);
    // The time of the first run is the one that was taken before.
    let wall = |table: &Comparison| table.rows.iter().find(|row| row.mode == "monolithic").unwrap().wall;
    assert_eq!(wall(&first), wall(&second));
    assert_eq!(go_on().rows, second.rows);
}

#[test]
fn a_run_ends_when_the_filter_has_settled_behind_the_evaluation_range() {
    let compare = planned(short(&[]), &[1e-3]);
    assert!((compare.scene.run.duration - (0.9 + SETTLE / 40.0)).abs() < 1e-12);
}

#[test]
fn an_interrupted_comparison_keeps_its_table_and_says_so() {
    let (comparison, _) = compared(short(&[]), &[1e-3], true);
    assert!(!comparison.complete);
    assert!(comparison.rows.iter().all(|row| row.status.is_none()));
    assert!(text(&comparison).contains(&format!("INCOMPLETE: 0 of {} runs", comparison.rows.len())));
    assert!(page(&comparison).finish().contains("Incomplete: 0 of"));
}
