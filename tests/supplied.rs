//! Pantographs of suppliers, swapped in through the command line: one in C, one from PythonFMU, one in FMPy's
//! container. All have the equations of our `lumped` and the same data, so the contact force must be that of our own
//! pantograph, but for the difference of the inner integration: Runge-Kutta of order 4 with steps of 0.1 ms (C, and
//! inside the container) or 0.5 ms (Python) there, which is exact to 1e-6 N here, and generalised-α with
//! `solver.micro_step` in ours, which is of order 2. The line integrates in the same way in all runs.
use integration_tests::fmus::tree;
use integration_tests::installed::{Ended, Program};
use integration_tests::python::{environment, library, run};
use integration_tests::runs::rms;
use integration_tests::vendor::{LINE, OWN, Pantograph, under_the_line};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Start height of the pantograph under [`OWN`], and of the supplied ones unless they come to rest by themselves:
/// contact closed, out of balance, so that the pantograph moves.
const START: &str = "start = { height = 5.347, force = 115.88 }\n";
const PARAMETERS: &str = "parameters = { reference_height = 5.28, start_height = 5.347 }\n";

/// Start in the container, which has names of its own.
const CONTAINED: &str = "parameters = { \"pantograph.reference_height\" = 5.28, \"pantograph.start_height\" = 5.347 }
inputs = { force = { variable = \"pantograph.contact_force\" } }
outputs = { height = { variable = \"pantograph.height\" }, velocity = { variable = \"pantograph.velocity\" } }
";

fn python() -> PathBuf {
    environment("suppliers", &tree().join("tests/suppliers/requirements.txt"))
}

/// Runs the short line with a pantograph; `scene` is complete.
fn contact_force(program: &Program, name: &str, scene: &str, more: &[&str]) -> Vec<f64> {
    let scene = program.scene(name, scene);
    let ended: Ended = program.run(&scene, more).done();
    ended.force()
}

fn own(program: &Program, more: &[&str]) -> Vec<f64> {
    contact_force(program, "own", &format!("{LINE}{OWN}{START}"), more)
}

fn theirs(program: &Program, fmu: &Path, more: &[&str]) -> Vec<f64> {
    contact_force(program, "theirs", &under_the_line(fmu, PARAMETERS), more)
}

#[test]
fn a_pantograph_in_c_has_the_force_of_ours_to_second_order_in_our_own_step() {
    let program = Program::new();
    let fmu = Pantograph::new().write(program.folder(), "two_mass");
    let mut differences = Vec::new();
    for step in ["1e-3", "5e-4", "2.5e-4"] {
        let more = ["--set", &format!("solver.micro_step={step}")];
        let (own, theirs) = (own(&program, &more), theirs(&program, &fmu, &more));
        // 0 to 210 N: the strip bounces once at the start
        assert!(own.iter().copied().fold(0.0, f64::max) > 200.0 && own.contains(&0.0));
        differences.push(rms(&own, &theirs));
    }
    println!("rms differences in N: {differences:?}");
    assert!(differences[0] < 0.03, "{differences:?}");
    for pair in differences.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.15, "order {order}: {differences:?}");
    }
}

/// A strip that the wire leaves to both sides, with horns that carry it.
#[test]
fn a_wire_rests_on_the_strip_and_the_horns_that_the_scene_gives_a_supplied_pantograph() {
    const HORNED: &str = "strip = { width = 0.4, horns = { y = [0.25, 0.35, 0.5], z = [-0.005, -0.03, -0.12] } }\n";
    let program = Program::new();
    let fmu = Pantograph::new().write(program.folder(), "two_mass");
    let more = [
        "--set",
        "catenary.stagger=[0.3, -0.3]",
        "--set",
        "solver.micro_step=2.5e-4",
        "--set",
        "coupling.macro_step=2.5e-4",
    ];
    let modelled = OWN.replace("strip = { width = 1.2 }\n", HORNED);
    let own = contact_force(&program, "own", &format!("{LINE}{modelled}{START}"), &more);
    let theirs = |strip: &str| {
        let scene = under_the_line(&fmu, &format!("{PARAMETERS}{strip}"));
        contact_force(&program, "theirs", &scene, &more)
    };
    let (horned, endless) = (theirs(HORNED), theirs(""));
    let (close, apart) = (rms(&own, &horned), rms(&own, &endless));
    println!("rms differences in N: {close} with horns, {apart} on a strip without ends");
    assert!(close < 0.05, "{close}");
    assert!(apart > 0.5, "{apart}");
    let bare = program.scene(
        "bare",
        &under_the_line(&fmu, &format!("{PARAMETERS}strip = {{ width = 0.4 }}\n")),
    );
    let said = [
        "catenary.stagger[2] = -0.3 m",
        "half the width of the strip of pantograph[1]",
    ];
    let _ = program.run(&bare, &more).refused(2, &said);
}

#[test]
fn a_pantograph_in_c_comes_to_rest_where_ours_does() {
    let program = Program::new();
    let fmu = Pantograph::new().write(program.folder(), "two_mass");
    let balanced = ["--set", "run.initialise=\"equilibrium\""];
    let own = contact_force(&program, "own", &format!("{LINE}{OWN}"), &balanced);
    let theirs = theirs(&program, &fmu, &balanced);
    let difference = rms(&own, &theirs);
    println!("start {} and {} N, rms difference {difference} N", own[0], theirs[0]);
    // The phase at rest ends when the force changes by less than 0.1 N/s.
    assert!((own[0] - theirs[0]).abs() < 0.2 && difference < 0.2);
}

#[test]
fn a_pantograph_in_fmpys_container_has_the_force_of_the_one_inside() {
    let program = Program::new();
    let inside = Pantograph::new().write(program.folder(), "two_mass");
    let container = program.folder().join("container.fmu");
    run(
        Command::new(python())
            .arg(tree().join("tests/suppliers/container.py"))
            .args([&inside, &container])
            .arg("0.00025"),
        "packing a pantograph into FMPy's container",
    );
    // The container steps four times in a macro step, under the same force.
    let contained = contact_force(&program, "contained", &under_the_line(&container, CONTAINED), &[]);
    let bare = theirs(&program, &inside, &[]);
    let ours = own(&program, &[]);
    println!(
        "rms differences in N: {} {}",
        rms(&contained, &bare),
        rms(&contained, &ours)
    );
    assert!(rms(&contained, &bare) < 1e-6, "{}", rms(&contained, &bare));
    assert!(rms(&contained, &ours) < 0.03, "{}", rms(&contained, &ours));
}

#[test]
fn a_pantograph_from_pythonfmu_runs_in_a_process_with_its_python() {
    let program = Program::new();
    let interpreter = python();
    run(
        Command::new(&interpreter)
            .args(["-m", "pythonfmu", "build", "-f"])
            .arg(tree().join("tests/suppliers/two_mass.py"))
            .arg("-d")
            .arg(program.folder()),
        "exporting a pantograph with PythonFMU",
    );
    let fmu = program.folder().join("TwoMass.fmu");
    let library = library(&interpreter);
    let isolated = format!("{PARAMETERS}isolate = true\nenvironment = {{ LD_PRELOAD = {library:?} }}\n");
    let python = contact_force(&program, "python", &under_the_line(&fmu, &isolated), &[]);
    let in_c = theirs(&program, &Pantograph::new().write(program.folder(), "two_mass"), &[]);
    let ours = own(&program, &[]);
    println!("rms differences in N: {} {}", rms(&python, &in_c), rms(&python, &ours));
    assert!(rms(&python, &in_c) < 1e-5, "{}", rms(&python, &in_c));
    assert!(rms(&python, &ours) < 0.03, "{}", rms(&python, &ours));
}

#[test]
fn a_pantograph_that_needs_python_says_what_it_needs() {
    let program = Program::new();
    run(
        Command::new(python())
            .args(["-m", "pythonfmu", "build", "-f"])
            .arg(tree().join("tests/suppliers/two_mass.py"))
            .arg("-d")
            .arg(program.folder()),
        "exporting a pantograph with PythonFMU",
    );
    let scene = under_the_line(Path::new("TwoMass.fmu"), PARAMETERS);
    let ended = program.run(&program.scene("python", &scene), &[]);
    let _ = ended.failed(&["TwoMass.fmu", "Python", "LD_PRELOAD", "environment"]);
}
