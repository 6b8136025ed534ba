//! Plans, and whole sweeps on a short line.

use std::fs::{self, File};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use experiments::engine::table::Status;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use results::report::{Progress, Show};
use simulation::Mode;

use crate::base::{Base, Numbers};
use crate::file::{Wishes, method};
use crate::journal::JOURNAL;
use crate::plan::{Case, Plan, PlanWishes};
use crate::run::{CSV, Options, PARQUET, Summary, Sweep, TIMES};
use crate::values::Value;

const EN_250: &str = include_str!("../../../scenes/en50318-250.toml");

/// A line of three spans on a coarse mesh, for a fraction of a second: tables do not depend on its accuracy.
const SHORT: [&str; 5] = [
    "catenary.spans=3",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.2",
    "run.evaluate={ time = [0.1, 0.2] }",
    "run.output_step=0.001",
];

fn base() -> Base {
    base_with(&[])
}

fn base_with(more: &[&str]) -> Base {
    let set = SHORT.iter().chain(more).map(|&set| set.to_owned()).collect();
    Base::new("short", "scene.toml", Path::new(""), EN_250.to_owned(), set)
}

/// Wishes of the command line: `vary`, `derive` and `where` behind each other.
fn wishes(vary: &[&str], derive: &[&str], constraints: &[&str]) -> Wishes {
    let mut wishes = Wishes::default();
    vary.iter().for_each(|text| wishes.vary(text).unwrap());
    derive.iter().for_each(|text| wishes.derive(text).unwrap());
    constraints.iter().for_each(|text| wishes.constrain(text));
    wishes
}

fn plan(vary: &[&str], derive: &[&str], constraints: &[&str]) -> Result<Plan, String> {
    let base = base();
    let numbers = Numbers::of(&base.read(&[]).unwrap());
    let wished = wishes(vary, derive, constraints)
        .plan()
        .map_err(|error| error.to_string())?;
    let plan = Plan::new(wished, &numbers).map_err(|error| error.to_string())?;
    plan.check(&base).map_err(|error| error.to_string())?;
    Ok(plan)
}

fn numbers(case: &Case) -> Vec<f64> {
    case.values
        .iter()
        .filter_map(Value::number)
        .chain(case.derived.iter().copied())
        .collect()
}

fn sweep(wishes: &Wishes, jobs: usize, series: bool) -> Sweep {
    sweep_over(base(), wishes, jobs, series)
}

fn sweep_over(base: Base, wishes: &Wishes, jobs: usize, series: bool) -> Sweep {
    let fmus = std::env::temp_dir();
    let options = Options {
        mode: Mode::Monolithic,
        jobs,
        series,
        logging: false,
        fmus,
    };
    Sweep::new(base, wishes.plan().unwrap(), options).unwrap()
}

fn run(sweep: &Sweep, folder: &Path) -> Summary {
    let progress = Progress::share("", Show::Never);
    sweep.run(folder, &AtomicBool::new(false), &progress).unwrap()
}

/// Speed and force, with one combination left out, and a derived value.
fn small() -> Wishes {
    let vary = ["run.speed_kmh=200:240:20", "pantograph[1].static_force=100,130"];
    let derive = ["v=run.speed_kmh/3.6", "pantograph[1].dampings[1]=v/5"];
    wishes(
        &vary,
        &derive,
        &["not(run.speed_kmh == 220 && pantograph[1].static_force > 120)"],
    )
}

#[test]
fn all_combinations_are_cases_and_the_last_key_changes_first() {
    let plan = plan(
        &["run.speed_kmh=200:320:10", "pantograph[1].static_force=100:140:20"],
        &[],
        &[],
    )
    .unwrap();
    let cases: Vec<Case> = plan.cases().collect();
    assert_eq!(cases.len(), 39);
    assert_eq!(numbers(&cases[0]), [200.0, 100.0]);
    assert_eq!(numbers(&cases[1]), [200.0, 120.0]);
    assert_eq!(numbers(&cases[38]), [320.0, 140.0]);
    assert!(
        cases
            .iter()
            .enumerate()
            .all(|(index, case)| case.number == index as u64 + 1)
    );
    assert_eq!(
        plan.overrides(&cases[1]),
        ["run.speed_kmh=200", "pantograph[1].static_force=120"]
    );
}

#[test]
fn rows_of_a_table_are_cases_in_their_order() {
    let column = |name: &str, values: &[f64]| (name.to_owned(), values.to_vec());
    let base = base();
    let of = |columns: Vec<(String, Vec<f64>)>| {
        let plan = Plan::new(PlanWishes::rows(columns), &Numbers::of(&base.read(&[]).unwrap()))?;
        plan.check(&base).map(|()| plan)
    };
    // The same value in several rows, as designs of samples have it.
    let speeds = column("run.speed_kmh", &[250.0, 200.0, 200.0]);
    let forces = column("pantograph[1].static_force", &[120.0, 120.0, 1.0 / 3.0]);
    let plan = of(vec![speeds.clone(), forces]).unwrap();
    let cases: Vec<Vec<f64>> = plan.cases().map(|case| numbers(&case)).collect();
    assert_eq!(cases, [[250.0, 120.0], [200.0, 120.0], [200.0, 1.0 / 3.0]]);
    assert_eq!(plan.points(), 3);
    let said = |columns| of(columns).unwrap_err().to_string();
    let short = column("pantograph[1].static_force", &[120.0, 130.0]);
    let found = said(vec![speeds.clone(), short]);
    assert!(found.contains("has 2 values, must have 3"), "{found}");
    // The ends of a column are tried before the first case.
    let wrong = column("catenary.damping.alpha", &[0.01, 0.02, -1.0]);
    let found = said(vec![speeds, wrong]);
    assert!(found.contains("catenary.damping.alpha"), "{found}");
}

#[test]
fn derived_values_follow_and_constraints_leave_out() {
    let vary = ["run.speed_kmh=180:360:90", "force=100,120"];
    // Out of order: `v` stands behind its use.
    let derive = [
        "run.duration=span/v",
        "v=run.speed_kmh/3.6",
        "span=2*catenary.span_length",
        "pantograph[1].static_force=force",
    ];
    let plan = plan(&vary, &derive, &["v < 90 || force > 110", "run.duration > 0"]).unwrap();
    let cases: Vec<Case> = plan.cases().collect();
    assert_eq!((plan.points(), cases.len()), (6, 5));
    // Speed of 50 m/s over two spans of 60 m.
    let set = [
        "run.speed_kmh=180",
        "pantograph[1].static_force=100",
        "run.duration=2.4",
    ];
    assert_eq!(plan.overrides(&cases[0]), set);
    assert_eq!(numbers(&cases[4])[..2], [360.0, 120.0]);
    assert_eq!(cases[4].number, 5);
}

#[test]
fn samples_follow_their_distributions() {
    let mut wishes = wishes(
        &["run.speed_kmh=200:300", "contact.stiffness=normal(5e4,5e3)"],
        &[],
        &[],
    );
    (wishes.method, wishes.count, wishes.seed) = (Some(method("latin").unwrap()), Some(200), Some(7));
    let sweep = sweep(&wishes, 1, false);
    let cases: Vec<Vec<f64>> = sweep.plan().cases().map(|case| numbers(&case)).collect();
    let mean = |key: usize| cases.iter().map(|case| case[key]).sum::<f64>() / 200.0;
    // One sample in each of 200 equally likely parts: means miss those of the distributions by a part at most.
    assert!((mean(0) - 250.0).abs() < 0.5, "{}", mean(0));
    assert!((mean(1) - 5e4).abs() < 5e3 / 100.0, "{}", mean(1));
    assert!(cases.iter().all(|case| (200.0..300.0).contains(&case[0])));
}

#[test]
fn wrong_wishes_are_refused_with_the_key_and_what_would_be_right() {
    for (vary, derive, constraints, parts) in [
        (
            &["run.sped_kmh=200"][..],
            &[][..],
            &[][..],
            &["run.sped_kmh", "did you mean \"speed_kmh\"?"][..],
        ),
        (
            &["run.speed_kmh=-200"],
            &[],
            &[],
            &["run.speed_kmh = -200 km/h: must be positive"],
        ),
        // A value behind the first one.
        (
            &["run.speed_kmh=200,abc"],
            &[],
            &[],
            &["--set run.speed_kmh=abc", "must be a"],
        ),
        (
            &["pantograph[2].static_force=1"],
            &[],
            &[],
            &["pantograph", "has 1 entry, [1], and no [2]"],
        ),
        (
            &["speed_kmh=200,250"],
            &[],
            &[],
            &["speed_kmh: is no key", "did you mean run.speed_kmh?"],
        ),
        (
            &["run.speed_kmh=200", "run.speed_kmh=210"],
            &[],
            &[],
            &["once, not twice"],
        ),
        (
            &["run.speed_kmh=200:300"],
            &[],
            &[],
            &["a distribution is sampled", "--sample"],
        ),
        (&["status=1,2"], &[], &[], &["is a column of the table"]),
        (
            &["run.speed_kmh=200"],
            &["run.duration=3*sped"],
            &[],
            &["--derive", "sped is no varied"],
        ),
        (
            &["run.speed_kmh=200"],
            &["a=b+1", "b=a+1"],
            &[],
            &["must not depend on itself"],
        ),
        (
            &["run.speed_kmh=200"],
            &["run.duraton=-1"],
            &[],
            &["run.duraton", "did you mean \"duration\"?"],
        ),
        (
            &["run.speed_kmh=200"],
            &[],
            &["run.speed_kmh > 300"],
            &["none of 1 combinations"],
        ),
        (
            &["run.speed_kmh=200"],
            &[],
            &["run.speed_kmh >"],
            &["--where", "must be an expression"],
        ),
        (
            &["run.speed_kmh=200"],
            &[],
            &["run.speed_kmh + 1"],
            &["--where: \"run.speed_kmh + 1\": must be a comparison"],
        ),
        (
            &["run.speed_kmh=250,200"],
            &[],
            &["1 / (run.speed_kmh - 200) > 3"],
            &["--where", "no finite number where run.speed_kmh = 200"],
        ),
        (&["title=a,b"], &[], &[], &["title: is text that changes no figure"]),
        (
            &["contact=1,2"],
            &[],
            &[],
            &["contact: is a table of the scene; must be a key in it, such as contact."],
        ),
        (
            &["pantograph=1,2"],
            &[],
            &[],
            &["pantograph: is a list of tables of the scene; must be a key in it, such as pantograph[1]."],
        ),
        (
            &["coupling.algorithm=jacobi,auto"],
            &["a=coupling.algorithm"],
            &[],
            &["values that are no numbers"],
        ),
        (&[], &[], &[], &["no key is varied"]),
    ] {
        let said = plan(vary, derive, constraints).unwrap_err();
        assert!(
            parts.iter().all(|part| said.contains(part)),
            "{vary:?} {derive:?}: {said}"
        );
    }
}

#[test]
fn tables_are_the_same_bytes_on_one_thread_and_on_two() {
    let folders = [1, 2].map(|jobs| {
        let folder = tempfile::tempdir().unwrap();
        let summary = run(&sweep(&small(), jobs, true), folder.path());
        assert!(
            summary.complete && summary.stable == 5 && summary.left_out == 1,
            "{summary:?}"
        );
        folder
    });
    for file in [CSV, PARQUET] {
        let [one, two] = [0, 1].map(|index: usize| fs::read(folders[index].path().join(file)).unwrap());
        assert!(one == two, "{file}");
    }
    let csv = fs::read_to_string(folders[0].path().join(CSV)).unwrap();
    let cases: Vec<&str> = csv
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap())
        .collect();
    assert_eq!(cases, ["1", "2", "3", "4", "5"]);
    assert_eq!(
        fs::read_to_string(folders[0].path().join(TIMES))
            .unwrap()
            .lines()
            .count(),
        6
    );
}

#[test]
fn a_sweep_that_was_ended_goes_on_and_repeats_no_finished_case() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = sweep(&small(), 1, false);
    let progress = Progress::share("", Show::Never);
    let ended = sweep.run(folder.path(), &AtomicBool::new(true), &progress).unwrap();
    assert!(!ended.complete && ended.finished == 0);
    let whole = run(&sweep, folder.path());
    assert!(whole.complete);
    let table = fs::read(folder.path().join(CSV)).unwrap();
    let journal = fs::read(folder.path().join(JOURNAL)).unwrap();
    // A kill in the middle of the fourth line behind the first one.
    let ends: Vec<usize> = journal
        .iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n')
        .map(|(at, _)| at + 1)
        .collect();
    fs::write(folder.path().join(JOURNAL), &journal[..ends[3] + 20]).unwrap();
    let again = run(&sweep, folder.path());
    assert_eq!((again.made_earlier, again.finished, again.complete), (3, 5, true));
    assert!(fs::read(folder.path().join(CSV)).unwrap() == table);
    let kept = fs::read(folder.path().join(JOURNAL)).unwrap();
    assert!(kept[..ends[3]] == journal[..ends[3]], "finished cases stay as they are");
    // Nothing is left to be made.
    assert_eq!(run(&sweep, folder.path()).made_earlier, 5);
    assert!(fs::read(folder.path().join(JOURNAL)).unwrap() == kept);
}

#[test]
fn a_request_for_an_end_between_two_cases_keeps_what_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = sweep(&small(), 1, false);
    let interrupted = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let ended = scope.spawn(|| {
            let progress = Progress::share("", Show::Never);
            sweep.run(folder.path(), &interrupted, &progress).unwrap()
        });
        let journal = folder.path().join(JOURNAL);
        let lines = || fs::read(&journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count());
        while lines() < 2 && !ended.is_finished() {
            std::thread::yield_now();
        }
        interrupted.store(true, Ordering::Relaxed);
        let ended = ended.join().unwrap();
        assert!(ended.finished >= 1);
        let rows = fs::read_to_string(folder.path().join(CSV)).unwrap().lines().count() as u64 - 1;
        assert_eq!(rows, ended.finished);
    });
    assert!(run(&sweep, folder.path()).complete);
}

#[test]
fn parquet_holds_what_the_csv_holds_and_the_filtered_forces() {
    let folder = tempfile::tempdir().unwrap();
    run(&sweep(&small(), 2, true), folder.path());
    let mut csv = csv::Reader::from_path(folder.path().join(CSV)).unwrap();
    let names: Vec<String> = csv.headers().unwrap().iter().map(str::to_owned).collect();
    let file = File::open(folder.path().join(PARQUET)).unwrap();
    let parquet = SerializedFileReader::new(file).unwrap();
    assert_eq!(parquet.metadata().file_metadata().num_rows(), 5);
    let std_at = names.iter().position(|name| name == "std_N").unwrap();
    for (row, line) in parquet.get_row_iter(None).unwrap().zip(csv.records()) {
        let (row, line) = (row.unwrap(), line.unwrap());
        let fields: Vec<(&String, &Field)> = row.get_column_iter().collect();
        for (index, name) in names.iter().enumerate() {
            let text = match fields[index].1 {
                Field::Null => String::new(),
                Field::Long(count) => count.to_string(),
                Field::Double(number) => crate::values::shown(*number),
                Field::Str(text) => text.clone(),
                other => panic!("{name}: {other:?}"),
            };
            assert_eq!((fields[index].0, &*text), (name, &line[index]));
        }
        let Field::ListInternal(list) = fields[names.len()].1 else {
            panic!("no list")
        };
        let forces: Vec<f64> = list
            .elements()
            .iter()
            .map(|field| match field {
                Field::Double(force) => *force,
                other => panic!("{other:?}"),
            })
            .collect();
        // Samples of 0.1 to 0.2 s in steps of 1 ms, both ends included.
        assert_eq!(forces.len(), 101);
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        let std = (forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / forces.len() as f64).sqrt();
        // Sums in another order than those of the statistics.
        assert!((std - line[std_at].parse::<f64>().unwrap()).abs() < 1e-9);
    }
}

#[test]
fn a_case_that_fails_is_a_row_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    // Above the wave speed of the contact wire, and a derived value that does not exist.
    let vary = ["run.speed_kmh=200,700", "run.low_pass_hz=20"];
    let sweep = sweep(
        &wishes(
            &vary,
            &["pantograph[1].static_force=100*sqrt(500-run.speed_kmh)/sqrt(300)"],
            &[],
        ),
        2,
        true,
    );
    let summary = run(&sweep, folder.path());
    assert!(summary.complete);
    assert_eq!((summary.stable, summary.refused, summary.rows), (1, 1, 2));
    let mut csv = csv::Reader::from_path(folder.path().join(CSV)).unwrap();
    let rows: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    assert!(rows[1].iter().any(|cell| cell == "refused"));
    assert!(
        rows[1].iter().any(|cell| cell.contains("must be a finite number")),
        "{:?}",
        rows[1]
    );

    let folder = tempfile::tempdir().unwrap();
    let summary = run(
        &self::sweep(&wishes(&["run.speed_kmh=200,700"], &[], &[]), 1, false),
        folder.path(),
    );
    assert_eq!((summary.stable, summary.refused), (1, 1));
    let csv = fs::read_to_string(folder.path().join(CSV)).unwrap();
    assert!(csv.contains("run.allow_supercritical") || csv.contains("wave"), "{csv}");
    let page = fs::read_to_string(folder.path().join("sweep.html")).unwrap();
    assert!(page.contains("Cases without figures") && page.contains("master run scene.toml --mode monolithic"));
}

#[test]
fn the_page_has_units_and_six_digits_and_the_table_all() {
    let folder = tempfile::tempdir().unwrap();
    run(&sweep(&small(), 2, false), folder.path());
    let [page, csv] = ["sweep.html", CSV].map(|file| fs::read_to_string(folder.path().join(file)).unwrap());
    // A speed of 200 km/h in m/s, derived.
    assert!(csv.contains(",55.55555555555"), "{csv}");
    for part in [
        "<td class=\"n\">55.5556</td>",
        "run.speed_kmh<br>km/h</th>",
        "aria-label=\"σ [N] over run.speed_kmh [km/h] and pantograph[1].static_force [N]\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_derived_value_out_of_range_is_a_row_with_its_expression() {
    let folder = tempfile::tempdir().unwrap();
    let derive = ["catenary.contact_wire.tension=20000*(310-run.speed_kmh)-1200000"];
    let wishes = wishes(&["run.speed_kmh=240,250"], &derive, &[]);
    let summary = run(&sweep(&wishes, 1, false), folder.path());
    assert_eq!((summary.complete, summary.stable, summary.refused), (true, 1, 1));
    let csv = fs::read_to_string(folder.path().join(CSV)).unwrap();
    let said = "--derive catenary.contact_wire.tension=20000*(310-run.speed_kmh)-1200000: \
                catenary.contact_wire.tension = 0 N: must be";
    assert!(csv.contains(said) && !csv.contains("--set"), "{csv}");
}

/// Droppers as they are, and some that creep.
#[test]
fn cases_of_a_modal_line_in_lockstep_have_the_bits_of_cases_by_themselves() {
    lockstep_has_the_bits_of_cases_by_themselves(&[]);
    lockstep_has_the_bits_of_cases_by_themselves(&["catenary.droppers.damping=1e4"]);
}

/// Two speeds, which have nothing in common, and forces up to some that leave droppers slack.
fn lockstep_has_the_bits_of_cases_by_themselves(droppers: &[&str]) {
    let vary = ["run.speed_kmh=200,230", "pantograph[1].static_force=90,120,200"];
    let base = base_with(&[&["model.reduce=[\"modal\"]"], droppers].concat());
    let sweep = sweep_over(base, &wishes(&vary, &[], &[]), 1, true);
    let made = |cases: &[u64]| {
        let cases = cases.iter().copied().collect();
        let mut batch = sweep.make_batch(&cases, &AtomicBool::new(false)).unwrap();
        for made in &mut batch {
            (made.record.wall, made.record.setup) = (None, None);
        }
        batch
    };
    let together = made(&[1, 2, 3, 4, 5, 6]);
    let alone: Vec<_> = (1..=6).flat_map(|case| made(&[case])).collect();
    assert!(together.iter().all(|made| made.record.status == Status::Stable));
    assert!(together == alone);
    let figures = |at: usize| &together[at].record.pantographs[0];
    assert!((1..6).all(|at| figures(at) != figures(0)));
}
