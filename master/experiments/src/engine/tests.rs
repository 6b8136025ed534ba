use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use serde::Serialize;

use super::table::{Columns, RunRow, Status};
use super::*;
use results::Machine;
use results::report::{Page, Progress, Show};

/// Carries out an experiment in a store of its own.
pub(crate) fn executed<E: Experiment>(
    experiment: &E,
    workers: usize,
    interrupted: &AtomicBool,
    keep: &mut dyn FnMut(&E::Table),
) -> E::Table {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), &Machine::default()).unwrap();
    executed_in(&store, experiment, workers, interrupted, keep)
}

/// Carries out an experiment with a store that may hold runs.
pub(crate) fn executed_in<E: Experiment>(
    store: &Store,
    experiment: &E,
    workers: usize,
    interrupted: &AtomicBool,
    keep: &mut dyn FnMut(&E::Table),
) -> E::Table {
    let progress = Progress::share("", Show::Never);
    let site = Site {
        store,
        interrupted,
        progress: &progress,
        workers,
    };
    execute(experiment, site, &mut |table| {
        keep(table);
        Ok(())
    })
    .unwrap()
}

/// Squares of numbers, of which each costs some milliseconds; counts the squares that are made.
struct Squares {
    count: u32,
    timing: Timing,
    made: AtomicUsize,
    /// Number whose square asks for an end.
    last: Option<u32>,
    interrupted: AtomicBool,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct SquareTable {
    squares: Vec<Option<u32>>,
}

impl Table for SquareTable {
    fn sheet(&self) -> Sheet {
        let row = |square: &Option<u32>| RunRow {
            status: square.map(|_| Status::Stable),
            mean: square.map(f64::from),
            ..RunRow::default()
        };
        Sheet {
            leading: Columns::of(&self.squares)
                .indexed("number", |index, _| index.to_string())
                .finish(),
            rows: self.squares.iter().map(row).collect(),
            trailing: Vec::new(),
        }
    }

    fn is_complete(&self) -> bool {
        self.squares.iter().all(Option::is_some)
    }

    fn text(&self) -> String {
        format!("{:?}\n", self.squares)
    }

    fn sections(&self) -> Page {
        let mut page = Page::new("Squares");
        page.lead("");
        page.section("All", "<p>squares</p>");
        page
    }
}

impl Squares {
    fn new(timing: Timing, last: Option<u32>) -> Self {
        Self {
            count: 12,
            timing,
            made: AtomicUsize::new(0),
            last,
            interrupted: AtomicBool::new(false),
        }
    }
}

impl Experiment for Squares {
    type Job = u32;
    type Found = u32;
    type Table = SquareTable;

    fn plan(&self) -> Vec<Planned<u32>> {
        let planned = |number| Planned {
            job: number,
            work: f64::from(number),
            timing: self.timing,
        };
        (0..self.count).map(planned).collect()
    }

    fn make(&self, number: &u32, bench: &Bench<'_>) -> Result<u32, Unmade> {
        bench.value(&format!("square of {number}"), || {
            std::thread::sleep(Duration::from_millis(2));
            self.made.fetch_add(1, Ordering::Relaxed);
            if self.last == Some(*number) {
                self.interrupted.store(true, Ordering::Relaxed);
            }
            number * number
        })
    }

    /// One more, where all others are there.
    fn further(&self, found: &[Option<u32>]) -> Vec<Planned<u32>> {
        let all = found.iter().all(Option::is_some);
        let planned = Planned {
            job: 100,
            work: 1.0,
            timing: Timing::Alone,
        };
        all.then_some(planned).into_iter().collect()
    }

    fn judge(&self, found: &[Option<u32>]) -> SquareTable {
        SquareTable {
            squares: found.to_vec(),
        }
    }
}

#[test]
fn an_experiment_that_was_ended_makes_only_the_missing_runs_the_next_time() {
    for timing in [Timing::Beside, Timing::Alone] {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), &Machine::default()).unwrap();
        let made = |experiment: &Squares| experiment.made.load(Ordering::Relaxed);
        let first = Squares::new(timing, Some(6));
        let table = executed_in(&store, &first, 2, &first.interrupted, &mut |_| {});
        assert!(!table.is_complete() && (1..12).contains(&made(&first)), "{table:?}");
        let second = Squares::new(timing, None);
        let table = executed_in(&store, &second, 2, &second.interrupted, &mut |_| {});
        assert!(table.is_complete());
        assert_eq!(made(&first) + made(&second), 13);
        let third = Squares::new(timing, None);
        let again = executed_in(&store, &third, 2, &third.interrupted, &mut |_| {});
        assert_eq!((made(&third), again), (0, table));
    }
}

#[test]
fn results_stand_in_the_order_of_the_plan_for_any_number_of_workers() {
    let of = |workers: usize| {
        let experiment = Squares::new(Timing::Beside, None);
        executed(&experiment, workers, &experiment.interrupted, &mut |_| {})
    };
    let expected: Vec<Option<u32>> = (0..12).chain([100]).map(|number| Some(number * number)).collect();
    assert_eq!(of(1).squares, expected);
    assert_eq!(of(4).squares, expected);
}

#[test]
fn a_table_is_kept_before_the_first_run_after_each_and_at_the_end() {
    let experiment = Squares::new(Timing::Alone, None);
    let mut known = Vec::new();
    executed(&experiment, 1, &experiment.interrupted, &mut |table| {
        known.push(table.made().0)
    });
    assert_eq!(known, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 13]);
}

#[test]
fn an_error_of_keeping_ends_the_experiment() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), &Machine::default()).unwrap();
    let experiment = Squares::new(Timing::Alone, None);
    let progress = Progress::share("", Show::Never);
    let site = Site {
        store: &store,
        interrupted: &experiment.interrupted,
        progress: &progress,
        workers: 2,
    };
    let full = || results::io(folder.path(), "write")(std::io::Error::other("no space left"));
    let mut count = 0;
    let ended = execute(&experiment, site, &mut |_| {
        count += 1;
        if count > 3 { Err(full().into()) } else { Ok(()) }
    });
    assert!(matches!(ended, Err(ExperimentError::Results(_))));
    assert!(experiment.made.load(Ordering::Relaxed) < 12);
}

#[test]
fn a_table_is_exported_in_every_format() {
    let table = SquareTable {
        squares: vec![Some(4), None],
    };
    let csv = export::Csv.string(&table).unwrap();
    assert!(
        csv.starts_with("number,scene,mode,") && csv.lines().count() == 3,
        "{csv}"
    );
    assert_eq!(
        export::Json.string(&table).unwrap(),
        "{\n  \"squares\": [\n    4,\n    null\n  ]\n}\n"
    );
    assert_eq!(export::Text.string(&table).unwrap(), "[Some(4), None]\n");
    let page = export::Html.string(&table).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<p>squares</p>"));
    let folder = tempfile::tempdir().unwrap();
    let output = results::OutputDirectory::open(folder.path()).unwrap();
    export::Csv.replace(&table, &output, "squares.csv").unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("squares.csv")).unwrap(), csv);
}
