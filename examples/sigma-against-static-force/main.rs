//! A table of σ against static force: an experiment of its own on the engine of the others.
//!
//! ```text
//! cargo run --release --example sigma_against_static_force [OUTPUT]
//! ```

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use experiments::engine::export::{Csv, Exporter, Html, Text};
use experiments::engine::table::{Columns, RunRow, Status};
use experiments::engine::{
    Attempt, Bench, Experiment, Planned, Run, Sheet, Site, Stage, Store, Table, Timing, Unmade, Variant, execute,
};
use results::Machine;
use results::OutputDirectory;
use results::report::{Page, Progress, Show, aligned, escape};
use serde::Serialize;
use simulation::Mode;

/// Line and pantograph of EN 50318 at 250 km/h.
const SCENE: &str = include_str!("../../scenes/en50318-250.toml");

/// Keys that make it short: four spans, one second to be evaluated.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=1.8",
    "run.evaluate={ time = [0.4, 1.4] }",
    "solver.micro_step=0.002",
];

/// The plan: one run per static force, N.
struct SigmaAgainstForce {
    forces: Vec<f64>,
    stage: Arc<Stage>,
}

/// The table.
#[derive(Serialize)]
struct SigmaTable {
    lines: Vec<Line>,
}

/// One run.
#[derive(Serialize)]
struct Line {
    /// N.
    #[serde(rename = "static_force_N")]
    static_force: f64,
    #[serde(flatten)]
    row: RunRow,
}

impl SigmaAgainstForce {
    fn new(forces: &[f64]) -> Self {
        let stage = Stage {
            name: "short line".to_owned(),
            scene: SCENE.to_owned(),
            ..Stage::default()
        };
        Self {
            forces: forces.to_vec(),
            stage: Arc::new(stage),
        }
    }

    fn run(&self, force: f64) -> Run {
        let mut overrides: Vec<String> = SHORT.iter().map(ToString::to_string).collect();
        overrides.push(format!("pantograph[1].static_force={force:?}"));
        let variant = Variant {
            mode: Mode::Monolithic,
            algorithm: String::new(),
            overrides,
        };
        Run::of(&self.stage, variant)
    }
}

impl Experiment for SigmaAgainstForce {
    type Job = Run;
    type Found = Arc<Attempt>;
    type Table = SigmaTable;

    fn plan(&self) -> Vec<Planned<Run>> {
        let planned = |force: &f64| Planned {
            job: self.run(*force),
            work: 1.0,
            timing: Timing::Beside,
        };
        self.forces.iter().map(planned).collect()
    }

    fn make(&self, run: &Run, bench: &Bench<'_>) -> Result<Arc<Attempt>, Unmade> {
        bench.run(run)
    }

    fn judge(&self, found: &[Option<Arc<Attempt>>]) -> SigmaTable {
        let line = |(&static_force, made): (&f64, &Option<Arc<Attempt>>)| Line {
            static_force,
            row: match made {
                Some(made) => made.judged(None),
                None => self.run(static_force).planned(),
            },
        };
        SigmaTable {
            lines: self.forces.iter().zip(found).map(line).collect(),
        }
    }
}

impl SigmaTable {
    /// Static force, mean and σ in N, loss of contact in %.
    fn cells(&self) -> Vec<Vec<String>> {
        let mut cells = vec![
            ["static force [N]", "mean [N]", "σ [N]", "loss [%]", "status"]
                .map(str::to_owned)
                .to_vec(),
        ];
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"));
        cells.extend(self.lines.iter().map(|Line { static_force, row }| {
            let status = row.status.map_or("not run", Status::name).to_owned();
            vec![
                static_force.to_string(),
                number(row.mean),
                number(row.std),
                number(row.loss),
                status,
            ]
        }));
        cells
    }
}

impl Table for SigmaTable {
    fn sheet(&self) -> Sheet {
        let force = Columns::of(&self.lines).column("static_force_N", |line| Some(line.static_force));
        Sheet {
            leading: force.finish(),
            rows: self.lines.iter().map(|line| line.row.clone()).collect(),
            trailing: Vec::new(),
        }
    }

    fn is_complete(&self) -> bool {
        self.lines.iter().all(|line| line.row.status.is_some())
    }

    fn text(&self) -> String {
        aligned(&self.cells())
    }

    fn sections(&self) -> Page {
        let row = |cells: &Vec<String>| -> String {
            let cells: String = cells.iter().map(|cell| format!("<td>{}</td>", escape(cell))).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = self.cells().iter().map(row).collect();
        let mut page = Page::new("σ against static force");
        page.lead("<p>Line and pantograph of EN 50318, four spans.</p>\n");
        page.section("", &format!("<table>{rows}</table>\n"));
        page
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "results/sigma-against-static-force".to_owned());
    let output = OutputDirectory::open(&folder)?;
    let machine = Machine::this();
    let store = Store::open(&output.path().join("runs"), &machine)?;
    let (interrupted, progress) = (
        AtomicBool::new(false),
        Progress::share("static force", Show::OnTerminal),
    );
    let site = Site {
        store: &store,
        interrupted: &interrupted,
        progress: &progress,
        workers: machine.cores,
    };
    let experiment = SigmaAgainstForce::new(&[60.0, 90.0, 120.0, 150.0, 180.0]);
    let table = execute(&experiment, site, &mut |table| {
        Ok(Csv.replace(table, &output, "sigma.csv")?)
    })?;
    progress.finish();
    Html.replace(&table, &output, "sigma.html")?;
    print!("{}\n  sigma.csv and sigma.html in {folder}\n", Text.string(&table)?);
    Ok(())
}
