//! The two FMUs, coupled, in independent importers: the same trajectory as a run of this program in the same exchange.
#[path = "importers/replay.rs"]
mod replay;

use integration_tests::fmus::{Packaged, THESIS, tree};
use integration_tests::python::{environment, python, run_apart};
use integration_tests::runs::{Run, prepared, rms, run, scene_with};
use scene::Scene;
use serde_json::{Value, json};
use simulation::Mode;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Step of the exchange, ns: libcosim counts in these.
const NANOSECONDS: u64 = 500_000;
const STEPS: usize = 1000;
/// rms difference that is allowed, in standard deviations of the force.
const ALLOWED: f64 = 1e-6;

/// Common settings of the runs: half a second of held values on both sides, of the force at the end of a step.
const EXCHANGE: &[&str] = &[
    "coupling.algorithm=jacobi",
    "coupling.extrapolation=0",
    "coupling.force=end",
    "coupling.macro_step=0.0005",
    "run.output_step=0.0005",
    "run.duration=0.5",
    "run.evaluate={ time = [0.0, 0.5] }",
    "solver.micro_step=0.0005",
];

/// Start of the compared run; the FMUs are packaged for another place, so that importers have to set all start
/// parameters.
const START: &str = "run.start_x=60.0";

/// Order in which an importer passes values on.
#[derive(Clone, Copy, PartialEq)]
enum Exchange {
    /// All outputs of a communication point are read before inputs are set: `coupling.algorithm = "jacobi"`.
    Jacobi,
    /// Outputs that depend on inputs are read after these have been set.
    Propagated,
}

/// An importer and the script that runs the pair in it.
struct Importer {
    script: &'static str,
    arguments: &'static [&'static str],
    exchange: Exchange,
    /// Module that must be there; `None` for what the pinned requirements install.
    optional: Option<&'static str>,
}

const IMPORTERS: [Importer; 7] = [
    Importer {
        script: "run_fmpy.py",
        arguments: &[],
        exchange: Exchange::Jacobi,
        optional: None,
    },
    Importer {
        script: "run_container.py",
        arguments: &[],
        exchange: Exchange::Jacobi,
        optional: None,
    },
    Importer {
        script: "run_libcosim.py",
        arguments: &[],
        exchange: Exchange::Jacobi,
        optional: None,
    },
    Importer {
        script: "run_ecos.py",
        arguments: &[],
        exchange: Exchange::Jacobi,
        optional: None,
    },
    Importer {
        script: "run_pyfmi.py",
        arguments: &[],
        exchange: Exchange::Jacobi,
        optional: Some("pyfmi"),
    },
    // The reference of the next one; its distance from the run says what the other exchange does.
    Importer {
        script: "run_fmpy.py",
        arguments: &["--propagate"],
        exchange: Exchange::Propagated,
        optional: None,
    },
    Importer {
        script: "run_omsimulator.py",
        arguments: &[],
        exchange: Exchange::Propagated,
        optional: Some("OMSimulator"),
    },
];

/// Force in N and height in m at the end of each step.
struct Series {
    force: Vec<f64>,
    height: Vec<f64>,
}

impl Series {
    fn of(run: &Run) -> Self {
        let strip = &run.record.pantographs[0];
        Self {
            force: strip.force[1..].to_vec(),
            height: strip.strip_z[1..].to_vec(),
        }
    }

    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("force,z"));
        let rows = lines.map(|line| line.split_once(',').unwrap());
        let (force, height) = rows
            .map(|(force, z)| (force.parse::<f64>().unwrap(), z.parse::<f64>().unwrap()))
            .unzip();
        Self { force, height }
    }

    /// Standard deviation of the force, N.
    fn sigma(&self) -> f64 {
        let mean = self.force.iter().sum::<f64>() / self.force.len() as f64;
        rms(&self.force, &vec![mean; self.force.len()])
    }
}

fn exchange_with(more: &[&str]) -> Scene {
    scene_with(THESIS, &[EXCHANGE, more].concat())
}

/// The file that the scripts read, see `tests/importers/exchange.py`.
fn plan(fmus: &Packaged, scene: &Scene) -> Value {
    let start = scene.pantographs[0].start.expect("a prepared scene has its start");
    let values = |prefix: &str| {
        let named = [
            ("start.height", start.height),
            ("start.force", start.force),
            ("start.x", scene.strip_start_x(0)),
            ("speed", scene.run.speed),
        ];
        let named = named.map(|(name, value)| (format!("{prefix}{name}"), json!(value)));
        serde_json::Map::from_iter(named)
    };
    let mut line = values("strip[1].");
    // Without input derivatives a held strip is one that does not follow its velocity either.
    line.insert("inputs.follow_velocity".into(), json!(false));
    json!({
        "fmus": { "Catenary": fmus.path("Catenary"), "Pantograph": fmus.path("Pantograph") },
        "nanoseconds": NANOSECONDS,
        "steps": STEPS,
        "parameters": { "Catenary": line, "Pantograph": values("") },
    })
}

/// An interpreter with a module that no pinned requirement installs, if the user has one.
fn having(module: &str) -> Option<String> {
    let chosen = std::env::var("IMPORTERS_PYTHON").unwrap_or_else(|_| python());
    let check = Command::new(&chosen).args(["-c", &format!("import {module}")]).output();
    check.is_ok_and(|output| output.status.success()).then_some(chosen)
}

#[test]
fn importers_that_install_reproduce_a_run_of_the_program() {
    let interpreter = environment("importers", &tree().join("tests/importers/requirements.txt"));
    let fmus = Packaged::new(THESIS, EXCHANGE);
    let run = run(exchange_with(&[START]), Mode::Cosimulation, "importers");
    let reference = Series::of(&run);
    assert_eq!(reference.force.len(), STEPS);
    let sigma = reference.sigma();
    assert!(sigma > 10.0, "the force has to move to compare it: {sigma} N");
    let data = tempfile::Builder::new()
        .prefix("importers ü 100%41 ")
        .tempdir()
        .unwrap();
    let plan_file = data.path().join("plan.json");
    let scene = prepared(exchange_with(&[START]), "importers").scene;
    fs::write(&plan_file, plan(&fmus, &scene).to_string()).unwrap();

    let mut propagated: Option<Series> = None;
    let mut table = format!(
        "{STEPS} steps of 0.5 ms, standard deviation of the force {sigma:.2} N\n\
         {:<20} {:<10} {:<11} {:>22} {:>9}\n",
        "importer", "version", "exchange", "rms difference / sigma", "wall [s]"
    );
    let mut failures = Vec::new();
    for importer in &IMPORTERS {
        let program = match importer.optional {
            None => interpreter.display().to_string(),
            Some(module) => match having(module) {
                Some(program) => program,
                None => {
                    writeln!(
                        table,
                        "{module:<20} not installed: its calls are replayed by the other tests of this file"
                    )
                    .unwrap();
                    continue;
                }
            },
        };
        let output = data.path().join("series.csv");
        let (out, err) = run_apart(
            Command::new(program)
                .current_dir(data.path())
                .env("PYTHONDONTWRITEBYTECODE", "1")
                .arg(tree().join("tests/importers").join(importer.script))
                .args([&plan_file, &output])
                .args(importer.arguments),
            importer.script,
        );
        let said: Value = serde_json::from_str(out.lines().last().unwrap_or_default()).unwrap();
        let name = said["importer"].as_str().unwrap();
        if importer.optional.is_none() {
            assert_eq!(
                (out.lines().count(), err.as_str()),
                (1, ""),
                "{name} has something to say:\n{out}{err}"
            );
        }
        let series = Series::read(&output);
        let (exchange, against) = match (importer.exchange, &propagated) {
            (Exchange::Propagated, Some(series)) => ("propagated", series),
            (Exchange::Propagated, None) => ("propagated", &reference),
            (Exchange::Jacobi, _) => ("jacobi", &reference),
        };
        let difference = rms(&series.force, &against.force) / sigma;
        let version = said["version"].as_str().unwrap();
        let wall = said["wall"].as_f64().unwrap();
        writeln!(
            table,
            "{name:<20} {version:<10} {exchange:<11} {difference:>22.1e} {wall:>9.2}"
        )
        .unwrap();
        if importer.exchange == Exchange::Propagated && propagated.is_none() {
            // Not the same exchange, so not the same trajectory.
            assert!(difference > 1e3 * ALLOWED && difference < 1.0, "{difference}");
            propagated = Some(series);
            continue;
        }
        let heights = rms(&series.height, &against.height);
        if difference > ALLOWED || heights > 1e-9 {
            failures.push(format!("{name}: {difference:.1e} of sigma, {heights:.1e} m"));
        }
    }
    print!("{table}");
    assert!(failures.is_empty(), "{failures:?}\n{table}");
}
