//! The coupling test problem instead of a scene: every case at every macro step.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::engine::export::scrolled;
use crate::engine::table::{Columns, RunRow, Status, milliseconds, short};
use crate::engine::{Bench, Experiment, ExperimentError, Machine, Planned, Sheet, Table, Timing};
use cosim::test_problem::{self, Case};
use results::report::{Page, aligned, escape};
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
            leading: columns().text("case", |run| run.case.clone()).finish(),
            rows: self.runs.iter().map(|run| run.row.clone()).collect(),
            trailing: columns()
                .value("rms_error_N", |run| run.rms_error)
                .text("passes_per_step", |run| format!("{:?}", run.passes_per_step))
                .finish(),
        }
    }

    fn is_complete(&self) -> bool {
        self.complete
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
            self.macro_steps
                .iter()
                .map(move |&macro_step| (case.clone(), macro_step))
        };
        let planned = |job| Planned {
            job,
            work: 1.0,
            timing: Timing::Alone,
        };
        test_problem::cases()
            .into_iter()
            .flat_map(of_case)
            .map(planned)
            .collect()
    }

    fn make(&self, (case, macro_step): &(Case, f64), bench: &Bench<'_>) -> Result<Option<CaseRun>, ExperimentError> {
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
    let mut walls = Vec::new();
    let mut outcome = None;
    for _ in 0..repeats.max(1) {
        let begin = Instant::now();
        outcome = Some(test_problem::run(case, macro_step));
        walls.push(begin.elapsed().as_secs_f64());
    }
    let outcome = outcome.expect("at least one run");
    walls.sort_by(f64::total_cmp);
    let rms_error = Some(outcome.rms_error).filter(|error| error.is_finite());
    let status = match (outcome.stable, &outcome.failure) {
        (_, Some(_)) => Status::Diverged,
        (false, None) => Status::Limit,
        (true, None) => Status::Stable,
    };
    let (status, energy) = status.with_energy(outcome.energy_share);
    let wall = walls[(walls.len() - 1) / 2];
    let mut reason = outcome.failure.unwrap_or_default();
    if status == Status::Limit && !outcome.stable {
        reason = "contact is lost, which the truth never does".to_owned();
    }
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
        wall: Some(wall),
        repeats: Some(walls.len() as u64),
        real_time_factor: Some(wall / test_problem::DURATION),
        macro_steps: Some((test_problem::DURATION / macro_step).round() as u64),
        reason,
        ..RunRow::default()
    };
    row.remark(&energy);
    row.remark(&outcome.report.unwrap_or_default());
    CaseRun {
        case: case.name.clone(),
        rms_error,
        passes_per_step: outcome.passes_per_step,
        row,
    }
}

/// A figure of another master as a cell.
fn other(error: f64) -> String {
    if error.is_nan() {
        "–".to_owned()
    } else if error.is_infinite() {
        "lost".to_owned()
    } else {
        format!("{error}")
    }
}

/// The table on the terminal.
fn text(table: &TestProblemTable) -> String {
    let mut text = String::from("coupling test problem: rms error of the raw contact force over 10 s\n");
    if !table.complete {
        text.push_str("INCOMPLETE\n");
    }
    let cells = |cells: &[&str]| cells.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>();
    let mut rows = vec![
        cells(&["", "macro", "rms", "passes", "energy", "", "wall"]),
        cells(&["", "ms", "N", "per step", "J", "status", "s"]),
    ];
    let mut case = "";
    for run in &table.runs {
        let name = if run.case == case { "" } else { run.case.as_str() };
        case = &run.case;
        rows.push(vec![
            name.to_owned(),
            milliseconds(run.row.macro_step),
            short(run.rms_error),
            format!("{:.2}", run.passes_per_step),
            short(run.row.energy_residual),
            run.row.status.map_or("", Status::name).to_owned(),
            short(run.row.wall),
        ]);
    }
    text.push('\n');
    text.push_str(&aligned(&rows));
    let mut rows = vec![cells(&[
        "other masters, rms N (lost: contact is)",
        "0.2 ms",
        "1 ms",
        "2 ms",
        "5 ms",
    ])];
    for (name, errors) in OTHERS {
        let errors = errors.into_iter().map(other);
        rows.push(std::iter::once(name.to_owned()).chain(errors).collect());
    }
    text.push('\n');
    text.push_str(&aligned(&rows));
    text
}

/// The page.
fn page(table: &TestProblemTable) -> Page {
    let mut steps: Vec<f64> = table.runs.iter().filter_map(|run| run.row.macro_step).collect();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    let mut names: Vec<&str> = table.runs.iter().map(|run| run.case.as_str()).collect();
    names.dedup();
    let matrix = |heading: &str, cell: &dyn Fn(&CaseRun) -> String| {
        let head: String = steps
            .iter()
            .map(|step| format!("<th class=\"n\">{} ms</th>", milliseconds(Some(*step))))
            .collect();
        let mut body = String::new();
        for name in &names {
            body.push_str(&format!("<tr><td>{}</td>", escape(name)));
            for step in &steps {
                let found = table
                    .runs
                    .iter()
                    .find(|run| run.case == *name && run.row.macro_step == Some(*step));
                let text = found.map_or_else(String::new, |run| match run.row.status {
                    Some(Status::Stable) => cell(run),
                    Some(status) => format!("<span class=\"bad\">{}</span>", status.name()),
                    None => String::new(),
                });
                body.push_str(&format!("<td class=\"n\">{text}</td>"));
            }
            body.push_str("</tr>\n");
        }
        scrolled(&format!("<th>{heading}</th>{head}"), &body)
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
        &matrix("rms error of the raw force, N", &|run| short(run.rms_error)),
    );
    let others: String = OTHERS
        .iter()
        .map(|(name, errors)| {
            let cells = errors
                .map(|error| format!("<td class=\"n\">{}</td>", other(error)))
                .concat();
            format!("<tr><td>{}</td>{cells}</tr>\n", escape(name))
        })
        .collect();
    page.section(
        "Other masters",
        &scrolled(
            "<th>rms error of the raw force, N</th><th class=\"n\">0.2 ms</th><th class=\"n\">1 ms</th><th \
             class=\"n\">2 ms</th>\
             <th class=\"n\">5 ms</th>",
            &others,
        ),
    );
    page.section(
        "Cost",
        &matrix("passes per macro step", &|run| format!("{:.2}", run.passes_per_step)),
    );
    page.section(
        "Energy",
        &matrix("energy added by the coupling, J", &|run| short(run.row.energy_residual)),
    );
    page
}
