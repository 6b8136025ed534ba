use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::figures::Judged;
use super::*;
use crate::engine::Table as _;
use crate::engine::table::Status;
use crate::engine::tests::executed;
use results::report::{Progress, Show};
use simulation::Mode;
use system::run::Watch;

/// The table of the cases that are named, without FMUs, made by so many workers.
fn table(names: &[&str], boundaries: bool, workers: usize) -> StabilityTable {
    let cases: Vec<Case> = cases(true)
        .into_iter()
        .filter(|case| names.contains(&case.name.as_str()))
        .collect();
    assert_eq!(cases.len(), names.len(), "{names:?}");
    let stability = Stability::new(cases, false, boundaries, 0).unwrap();
    let table = executed(&stability, workers, &AtomicBool::new(false), &mut |_| {});
    assert!(table.complete);
    table
}

fn cells(table: &StabilityTable) -> Vec<String> {
    let sheet = table.sheet();
    let more = sheet.leading.into_iter().chain(sheet.trailing);
    let more = more.flat_map(|(_, cells)| cells);
    sheet.rows.iter().flat_map(|row| row.cells()).chain(more).collect()
}

#[test]
fn names_of_cases_differ_and_their_scenes_are_read_or_refused_for_a_reason_of_their_own() {
    let cases = cases(false);
    assert!(cases.len() >= 40, "{}", cases.len());
    for (index, case) in cases.iter().enumerate() {
        assert!(
            cases[..index].iter().all(|other| other.name != case.name),
            "{}",
            case.name
        );
        let refused = ["speed_1.05_c", "presag_5.4_m", "linkage_stops", "one_element_per_span"];
        let refused = refused.contains(&case.name.as_str());
        let scene = case.run(&Way::ONE, &[]).scene();
        assert_eq!(scene.is_err(), refused, "{}: {:?}", case.name, scene.err());
    }
}

#[test]
fn hard_cases_end_with_a_status_and_figures_that_prove_it() {
    let names = [
        "lowered_and_raised",
        "wire_step_up_50_mm",
        "restart_in_impacts",
        "discards_in_impacts",
        "rho_inf_1",
        "head_0.5_kg",
        "sliding_joint",
        "speed_1.05_c",
    ];
    let table = table(&names, false, 2);
    for line in &table.lines {
        let run = format!(
            "{} {} {}: {}",
            line.case, line.row.mode, line.row.algorithm, line.row.reason
        );
        // A joint cannot be taken apart.
        let apart = line.case == "sliding_joint" && line.row.mode != Mode::Monolithic.name();
        let refused = apart || line.case == "speed_1.05_c";
        assert_eq!(line.row.status == Some(Status::Refused), refused, "{run}");
        if refused {
            assert!(!line.row.reason.is_empty(), "{run}");
            continue;
        }
        let figures = &line.figures;
        let strong = ["", "iterated", "interface_jacobian", "auto"].contains(&line.row.algorithm.as_str());
        if strong {
            assert_eq!(line.row.status, Some(Status::Stable), "{run}");
        }
        assert!(figures.energy_growth.is_some_and(f64::is_finite), "{run}");
        assert!(figures.largest_force.is_some_and(|force| force > 100.0), "{run}");
        assert!(
            figures.most_iterations.is_some_and(|count| (1..=30).contains(&count)),
            "{run}"
        );
        assert!(line.row.std.is_some_and(|std| std > 0.0), "{run}");
        if line.row.mode == Mode::Inprocess.name() {
            assert!(figures.amplification.is_some_and(|growth| growth > 0.5), "{run}");
        }
        if line.case.contains("discards") && line.row.mode != Mode::Monolithic.name() {
            assert!(line.row.rollbacks.is_some_and(|count| count > 100), "{run}");
        }
        if line.case.contains("lowered") || line.case.contains("impacts") {
            assert!(
                line.row.loss.is_some_and(|loss| loss > 5.0),
                "{run}: {:?}",
                line.row.loss
            );
        }
    }
}

#[test]
fn the_table_is_the_same_for_any_number_of_workers() {
    let names = ["plain", "two_pantographs_15_m", "discards", "contact_1e7"];
    assert_eq!(cells(&table(&names, false, 1)), cells(&table(&names, false, 4)));
}

#[test]
fn a_limit_names_its_boundary() {
    let table = table(&["contact_1e7"], true, 2);
    let one = &table.lines[0];
    assert_eq!(one.row.status, Some(Status::Limit), "{}", one.row.reason);
    let boundary = &one.figures.boundary;
    assert!(
        boundary.starts_with("stable at a contact stiffness of") && boundary.contains("not at"),
        "{boundary}"
    );
}

#[test]
fn a_panic_becomes_a_row() {
    let run = Case::plain().run(&Way::ONE, &[]);
    let made = Judged::of(&run, Arc::new(run.caught(|| panic!("index 7 of 6")).unwrap()), None);
    assert_eq!(made.row.status, Some(Status::Diverged));
    assert_eq!(made.row.reason, "panicked: index 7 of 6");
}

#[test]
fn slaves_on_threads_of_their_own_compute_the_same_bits() {
    let cases = cases(true);
    let case = cases.iter().find(|case| case.name == "two_pantographs_15_m").unwrap();
    for algorithm in ALGORITHMS {
        let way = Way {
            mode: Mode::Inprocess,
            algorithm,
        };
        let run = |parallel: &str| {
            let keys = [format!("coupling.parallel=\"{parallel}\"")];
            let run = case.run(&way, &keys);
            let progress = Progress::share("", Show::Never);
            let made = run.attempt(&Watch::new(&AtomicBool::new(false), &progress)).unwrap();
            let made = Judged::of(&run, Arc::new(made), None);
            assert_eq!(
                made.row.status,
                Some(Status::Stable),
                "{algorithm}: {}",
                made.row.reason
            );
            assert_eq!(made.made.curves.len(), 2);
            made.made.curves.clone()
        };
        assert_eq!(run("always"), run("never"), "{algorithm}");
    }
}
