//! The coupling test problem instead of a scene: every case at every macro step.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::engine::export::{over_steps, status_span};
use crate::engine::table::{Columns, RunRow, Status};
use crate::engine::{Bench, Experiment, Planned, Sheet, Table, Unmade};
use cosim::test_problem::{self, Case};
use results::Machine;
use results::report::format::{milliseconds, short};
use results::report::{Page, TextColumn, aligned, cell, escape, heading, text_cells};
use results::statistics::ForceStatistics;
use simulation::Mode;

/// Macro steps when nothing is said, s: those that other masters have been measured at.
pub const TEST_PROBLEM_STEPS: [f64; 4] = [2e-4, 1e-3, 2e-3, 5e-3];

/// Results of other masters on the same problem: rms error of the raw force at [`TEST_PROBLEM_STEPS`], N; infinite
/// where they lose a contact that is never lost, NaN where it has not been measured.
const OTHERS: [(&str, [f64; 4]); 6] = [
    (
        "held inputs, side by side (FMPy, libcosim, ecos, PyFMI)",
        [0.43, f64::INFINITY, f64::INFINITY, f64::INFINITY],
    ),
    ("held inputs, Gauss-Seidel", [0.40, 2.1, 4.8, f64::INFINITY]),
    ("OMSimulator ma", [0.34, 1.8, f64::INFINITY, f64::INFINITY]),
    (
        "PyFMI, extrapolation 1, linear correction",
        [0.0003, 0.0049, 0.020, 0.124],
    ),
    (
        "OMSimulator ma, input extrapolation (2 passes, rollback)",
        [0.0001, 0.0024, 0.0097, 0.060],
    ),
    ("MasterSim, Gauss-Seidel iterated", [f64::NAN, 2.0, 4.4, 15.0]),
];

/// A case at a macro step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CaseRun {
    /// Case, for people.
    pub case: String,
    /// rms error of the raw force at the communication points, N; `null` where the run has diverged.
    #[serde(rename = "rms_error_N")]
    pub rms_error: Option<f64>,
    /// Steps of the pantograph per macro step, –.
    pub passes_per_step: f64,
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: RunRow,
}

/// The test problem's table, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TestProblemTable {
    /// `true` where every run was made.
    pub complete: bool,
    /// One per case and macro step that was run.
    pub runs: Vec<CaseRun>,
    /// Number of all cases and macro steps.
    #[serde(skip)]
    pub planned: usize,
}

impl Table for TestProblemTable {
    fn sheet(&self) -> Sheet {
        let columns = || Columns::of(&self.runs);
        Sheet {
            leading: columns().column("case", |run| run.case.clone()).finish(),
            rows: self.runs.iter().map(|run| run.row.clone()).collect(),
            trailing: columns()
                .column("rms_error_N", |run| run.rms_error)
                .column("passes_per_step", |run| format!("{:?}", run.passes_per_step))
                .finish(),
        }
    }

    fn made(&self) -> (usize, usize) {
        (self.runs.len(), self.planned)
    }

    fn text(&self) -> String {
        text(self)
    }

    fn sections(&self) -> Page {
        page(self)
    }
}

/// Every case at every macro step, timed one at a time.
#[derive(Clone, Debug)]
pub struct TestProblem {
    /// Macro steps, s.
    pub macro_steps: Vec<f64>,
    /// Times that every run is timed.
    pub repeats: usize,
}

impl Experiment for TestProblem {
    type Job = (Case, f64);
    type Found = CaseRun;
    type Table = TestProblemTable;

    fn plan(&self) -> Vec<Planned<(Case, f64)>> {
        let of_case = |case: Case| {
            let steps = self.macro_steps.iter();
            steps.map(move |&macro_step| Planned::alone((case.clone(), macro_step), 1.0))
        };
        test_problem::cases().into_iter().flat_map(of_case).collect()
    }

    fn make(&self, (case, macro_step): &(Case, f64), bench: &Bench<'_>) -> Result<CaseRun, Unmade> {
        let of = format!("{case:?} {macro_step:?} {} {:?}", self.repeats, Machine::this());
        bench.value(&of, || run(case, *macro_step, self.repeats))
    }

    fn label(&self, (case, _): &(Case, f64)) -> String {
        case.name.clone()
    }

    fn judge(&self, found: &[Option<CaseRun>]) -> TestProblemTable {
        TestProblemTable {
            complete: found.iter().all(Option::is_some),
            runs: found.iter().flatten().cloned().collect(),
            planned: found.len(),
        }
    }
}

fn run(case: &Case, macro_step: f64, repeats: usize) -> CaseRun {
    let sigma = ForceStatistics::of(test_problem::truth(&case.parameters).forces()).map(|force| force.std);
    let timed = || {
        let begin = Instant::now();
        let outcome = test_problem::run(case, macro_step);
        (outcome, begin.elapsed().as_secs_f64())
    };
    let (outcome, first) = timed();
    let walls: Vec<f64> = std::iter::once(first).chain((1..repeats).map(|_| timed().1)).collect();
    let rms_error = Some(outcome.rms_error).filter(|error| error.is_finite());
    let (status, reason) = match (outcome.failure, outcome.stable) {
        (Some(failure), _) => (Status::Diverged, failure),
        (None, false) => (Status::Limit, "contact is lost, which the truth never does".to_owned()),
        (None, true) => (Status::Stable, String::new()),
    };
    let (status, energy) = status.with_energy(outcome.energy_share);
    let mut row = RunRow {
        scene: "test-problem".to_owned(),
        mode: Mode::Inprocess.name().to_owned(),
        algorithm: case.coupling.algorithm.name().to_owned(),
        extrapolation: Some(case.coupling.extrapolation as u64),
        macro_step: Some(macro_step),
        reduction: "none".to_owned(),
        status: Some(status),
        reference: "one system, Runge-Kutta, 10 µs".to_owned(),
        raw_error: rms_error.zip(sigma).map(|(error, sigma)| 100.0 * error / sigma),
        energy_residual: Some(outcome.energy_residual),
        macro_steps: Some((test_problem::DURATION / macro_step).round() as u64),
        reason,
        ..RunRow::default()
    };
    row.timed(&walls);
    row.real_time_factor = row.wall.map(|wall| wall / test_problem::DURATION);
    row.remark(&energy);
    row.remark(&outcome.report.unwrap_or_default());
    CaseRun {
        case: case.name.clone(),
        rms_error,
        passes_per_step: outcome.passes_per_step,
        row,
    }
}

/// An error of another master, in words.
fn other(error: f64) -> String {
    match error {
        error if error.is_nan() => "–".to_owned(),
        error if error.is_infinite() => "lost".to_owned(),
        error => format!("{error}"),
    }
}

/// Columns of the table on the terminal behind the case.
const COLUMNS: &[TextColumn<CaseRun, 2>] = &[
    (["macro", "ms"], |run| milliseconds(run.row.macro_step)),
    (["rms", "N"], |run| short(run.rms_error)),
    (["passes", "per step"], |run| format!("{:.2}", run.passes_per_step)),
    (["energy", "J"], |run| short(run.row.energy_residual)),
    (["", "status"], |run| run.row.status.map_or("", Status::name).to_owned()),
    (["wall", "s"], |run| short(run.row.wall)),
];

/// The table on the terminal.
fn text(table: &TestProblemTable) -> String {
    let state = if table.complete { "" } else { "INCOMPLETE\n" };
    let behind = |name: &str, cells: Vec<String>| [vec![name.to_owned()], cells].concat();
    let mut rows: Vec<Vec<String>> = heading(COLUMNS).into_iter().map(|cells| behind("", cells)).collect();
    for runs in table.runs.chunk_by(|a, b| a.case == b.case) {
        let line = |(index, run): (usize, &CaseRun)| {
            let name = if index == 0 { run.case.as_str() } else { "" };
            behind(name, text_cells(COLUMNS, run))
        };
        rows.extend(runs.iter().enumerate().map(line));
    }
    let steps = TEST_PROBLEM_STEPS.map(|step| format!("{} ms", milliseconds(Some(step))));
    let mut other_rows = vec![behind("other masters, rms N (lost: contact is)", steps.to_vec())];
    other_rows.extend(OTHERS.map(|(name, errors)| behind(name, errors.map(other).to_vec())));
    format!(
        "coupling test problem: rms error of the raw contact force over 10 s\n{state}\n{}\n{}",
        aligned(&rows),
        aligned(&other_rows)
    )
}

/// The page.
fn page(table: &TestProblemTable) -> Page {
    let mut steps: Vec<f64> = table.runs.iter().filter_map(|run| run.row.macro_step).collect();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    let matrix = |heading: &str, shown: fn(&CaseRun) -> String| {
        let line = |runs: &[CaseRun]| {
            let at = |step: &f64| {
                let run = runs.iter().find(|run| run.row.macro_step == Some(*step));
                run.map_or_else(String::new, |run| match run.row.trouble() {
                    Some(status) => status_span(Some(status)),
                    None => shown(run),
                })
            };
            (cell("", &escape(&runs[0].case)), steps.iter().map(at).collect())
        };
        over_steps(heading, &steps, table.runs.chunk_by(|a, b| a.case == b.case).map(line))
    };
    let mut page = Page::new("Coupling test problem");
    let state = if table.complete {
        ""
    } else {
        "<p class=\"warning\">Incomplete.</p>\n"
    };
    page.lead(&format!(
        "<p>Two masses of a pantograph under one mode of a wire whose stiffness changes in time, penalty contact, 10 \
         s. The truth is the same as one system. Limit: contact is lost, which the truth never does.</p>\n{state}"
    ));
    page.section(
        "Error",
        &matrix("rms error of the raw force, N", |run| short(run.rms_error)),
    );
    let others = OTHERS.map(|(name, errors)| (cell("", &escape(name)), errors.map(other).to_vec()));
    let others = over_steps("rms error of the raw force, N", &TEST_PROBLEM_STEPS, others);
    page.section("Other masters", &others);
    page.section(
        "Cost",
        &matrix("passes per macro step", |run| format!("{:.2}", run.passes_per_step)),
    );
    page.section(
        "Energy",
        &matrix("energy added by the coupling, J", |run| short(run.row.energy_residual)),
    );
    page
}
