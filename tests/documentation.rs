//! Commands, scenes and scripts that the documents show, run as printed.
use integration_tests::documents::{block, text};
use integration_tests::fmus::{COARSE, Packaged, tree};
use integration_tests::python::{environment, run_apart};
use integration_tests::runs::{EN_300, Run, run, run_beside, scene_with};
use scene::Files;
use simulation::Mode;
use std::fs;
use std::process::Command;

/// Half a second on a coarse line: the point is that the examples run.
const SHORT: &[&str] = &["run.duration=0.5", "run.evaluate={ time = [0.0, 0.5] }"];

/// Page on the FMUs in other importers.
const IMPORTERS: &str = "docs/guide/fmpy.md";
/// Page on supplied FMUs.
const SUPPLIED: &str = "docs/guide/own-pantograph.md";

fn own_run(more: &[&str]) -> Run {
    run(
        scene_with(EN_300, &[COARSE, SHORT, more].concat()),
        Mode::Cosimulation,
        "documentation",
    )
}

#[test]
fn the_example_for_fmpy_runs_as_printed_and_does_what_the_program_does() {
    let interpreter = environment("importers", &tree().join("tests/importers/requirements.txt"));
    let fmus = Packaged::new(EN_300, &[COARSE, SHORT].concat());
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("fmus")).unwrap();
    for identifier in ["Catenary", "Pantograph"] {
        let target = folder.path().join(format!("fmus/{identifier}.fmu"));
        fs::copy(fmus.path(identifier), target).unwrap();
    }
    let script = folder.path().join("couple.py");
    fs::write(&script, block(IMPORTERS, "The pair in FMPy", "python")).unwrap();
    let (out, err) = run_apart(
        Command::new(interpreter).current_dir(folder.path()).arg(&script),
        "the example",
    );
    assert_eq!(err, "");
    let mut rows = out.lines().map(|line| line.split(' ').next().unwrap().parse::<f64>());
    let [mean, added, passed] = [(); 3].map(|()| rows.next().unwrap().unwrap());
    // Exchange of the example.
    let force = own_run(&["coupling.algorithm=gauss_seidel"]).record.pantographs[0].force[1..].to_vec();
    let expected = force.iter().sum::<f64>() / force.len() as f64;
    println!("{out}{expected} N in a run of the program");
    assert!((mean - expected).abs() < 1e-3, "{mean} {expected}");
    assert!(passed > 0.0 && added.abs() < 0.03 * passed, "{out}");
}

#[test]
fn the_line_from_a_table_runs_as_printed_and_refuses_a_cell_as_printed() {
    let [page, headline] = ["docs/guide/real-lines.md", "Your own line from a table"];
    let table = block(page, headline, "csv");
    let load = |table: &str| {
        let table = table.to_owned();
        let files = Files::new(move |path| match path {
            "my-line.csv" => Ok(table.clone()),
            path => Ok(text(path)),
        });
        let overrides: Vec<String> = [COARSE, SHORT].concat().iter().map(ToString::to_string).collect();
        system::load_with(&block(page, headline, "toml"), "my-line.toml", &overrides, &files)
    };
    let scene = load(&table).unwrap();
    let geometry = &scene.modelled_line().unwrap().0.tension_lengths[0];
    assert_eq!(
        (geometry.spans(), geometry.span_lengths[0], geometry.stagger[1]),
        (9, 54.0, -0.19)
    );
    let run = run(scene, Mode::Inprocess, "real-lines");
    assert!(run.record.pantographs[0].force.iter().all(|force| force.is_finite()));
    let refused = load(&table.replace("5.302", "53000")).unwrap_err().to_string();
    assert_eq!(refused, block(page, headline, "text").trim_end());
}

#[test]
fn the_table_for_another_pantograph_runs_as_printed() {
    let overrides = [COARSE, SHORT].concat();
    let fmus = Packaged::new(EN_300, &overrides);
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("fmus")).unwrap();
    fs::copy(fmus.path("Pantograph"), folder.path().join("fmus/Pantograph.fmu")).unwrap();
    let own = EN_300.find("[[pantograph]]").unwrap()..EN_300.find("[coupling]").unwrap();
    let mut text = EN_300.to_owned();
    text.replace_range(own, &format!("{}\n", block(SUPPLIED, "Wiring", "toml")));
    let swapped = run_beside(
        scene_with(&text, &overrides),
        Mode::Cosimulation,
        "documentation-swapped",
        folder.path(),
    );
    let own = own_run(&[]);
    let (own, swapped) = (&own.record.pantographs[0], &swapped.record.pantographs[0]);
    assert_eq!(own.force.len(), swapped.force.len());
    let mean = |series: &[f64]| series.iter().sum::<f64>() / series.len() as f64;
    let difference = integration_tests::runs::rms(&own.force, &swapped.force);
    let level = mean(&own.force);
    let sigma = integration_tests::runs::rms(&own.force, &vec![level; own.force.len()]);
    println!(
        "another pantograph that is the same one: {:.2e} of sigma, {sigma} N",
        difference / sigma
    );
    // The rest comes from the phase at rest before the start, which ends at 0.1 N/s.
    assert!(difference < 0.05 * sigma, "{difference} N, sigma {sigma} N");
}

/// Scheme for a head on a contact spring when both sides are stepped apart.
#[derive(Clone, Copy, PartialEq)]
enum Scheme {
    /// Each side from the last values, held.
    Jacobi,
    /// The force is read after the strip was set, both held.
    Propagated,
    /// The strip follows its velocity, both sides from the last values.
    JacobiFollowing,
    /// The line first; the force at the end of its step.
    End,
    /// The line first; the mean force of its step.
    Mean,
}

/// Damping in units of stiffness x step that a scheme adds to an undamped oscillator.
fn added_damping(scheme: Scheme) -> f64 {
    let (m, k, h, cycles) = (7.0, 50_000.0_f64, 2e-4, 20.0);
    let omega = (k / m).sqrt();
    let (mut z, mut v, mut last) = (1e-3, 0.0, k * 1e-3);
    let energy = |z: f64, v: f64| 0.5 * k * z * z + 0.5 * m * v * v;
    let start = energy(z, v);
    let steps = (cycles * std::f64::consts::TAU / omega / h).round() as usize;
    for _ in 0..steps {
        let end = k * (z + h * v);
        let force = match scheme {
            Scheme::Jacobi | Scheme::JacobiFollowing => last,
            Scheme::Propagated => k * z,
            Scheme::End => end,
            Scheme::Mean => 0.5 * (k * z + end),
        };
        last = if scheme == Scheme::JacobiFollowing { end } else { k * z };
        let a = -force / m;
        z += h * v + 0.5 * h * h * a;
        v += h * a;
    }
    // The energy of a damped oscillator decays with c/m.
    let growth = (energy(z, v) / start).ln() / (steps as f64 * h);
    -growth * m / (k * h)
}

/// Spectral radius of one step with the mean force: both eigenvalues have the product 1 and the sum 2 - (ωh)².
fn mean_force_amplification(omega_h: f64) -> f64 {
    let half = 1.0 - 0.5 * omega_h * omega_h;
    if half.abs() <= 1.0 {
        1.0
    } else {
        half.abs() + (half * half - 1.0).sqrt()
    }
}

#[test]
fn the_printed_damping_of_each_exchange_is_that_of_an_oscillator() {
    let section = text(IMPORTERS);
    for (name, scheme) in [
        ("all values held, force read before the strip is set", Scheme::Jacobi),
        ("all values held, force read after the strip is set", Scheme::Propagated),
        (
            "strip follows its velocity, end force of the last step",
            Scheme::JacobiFollowing,
        ),
        (
            "line first, strip follows its velocity, end force of this step",
            Scheme::End,
        ),
        (
            "line first, strip follows its velocity, mean force of this step",
            Scheme::Mean,
        ),
    ] {
        let row = section.lines().find(|line| line.starts_with(&format!("| {name} |")));
        let row = row.unwrap_or_else(|| panic!("no row: {name}"));
        let cell = row.split('|').nth(2).unwrap().trim();
        let printed = match cell.strip_suffix(" k h") {
            Some(factor) => factor.replace('−', "-").parse::<f64>().unwrap(),
            None => cell.parse().unwrap(),
        };
        let found = added_damping(scheme);
        assert!((found - printed).abs() < 0.05, "{name}: {found} k h, printed: {cell}");
    }
    assert!(section.contains("the last row neither adds nor takes up to ω h = 2"));
    assert!(mean_force_amplification(1.999) < 1.0 + 1e-9 && mean_force_amplification(2.001) > 1.01);
}
