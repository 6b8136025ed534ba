//! Controllers that are FMUs: against the controllers of the program, between the modes, and refused where they do not
//! fit.
use component::Component;
use control::{Asked, Reading, Rule};
use cosim::slave::SlaveError;
use dynamics::OutsideError;
use fmi2::instance::InstanceError;
use fmi2::isolation::IsolationError;
use integration_tests::fmus::tree;
use integration_tests::installed::Program;
use integration_tests::python::{self, environment};
use integration_tests::runs::{EN_250, Run, run, scene_with};
use integration_tests::vendor::{Controller, Pantograph};
use scene::Scene;
use simulation::check::Report;
use simulation::{Mode, prepare};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use system::one_system::stepped::{SteppedState, SteppedSystem};
use vehicle::Subsystem;

/// Three spans of the reference model on a coarse mesh.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=1.6",
    "run.evaluate={time=[0.2,1.5]}",
    "run.start_x=20",
];

/// Gains of a PID; those of the FMU stand below.
const GAINS: &str = "kp=0.7, ki=1, kd=0.002, derivative_lag=0.01";

/// Drive and sensors: a command acts 3 ms after its sample.
const DRIVE: &str = "actuator={ lag=0.01, delay=0.002, limit=60 }, sensors={ delay=0.001, force_noise=1 }";

/// Overrides for a pantograph whose commands come from an FMU.
fn commanded(fmu: &Path, sample: f64, more: &str) -> [String; 2] {
    let fmu = fmu.display().to_string();
    [
        format!("pantograph[1].control={{ law=\"given\", sample_time={sample}, {DRIVE} }}"),
        format!("controller=[{{ fmu={fmu:?}, parameters={{ {GAINS}, limit=60 }}{more} }}]"),
    ]
}

/// Overrides for the same controller in the program.
fn inside(sample: f64) -> [String; 1] {
    [format!(
        "pantograph[1].control={{ law=\"pid\", sample_time={sample}, {GAINS}, {DRIVE} }}"
    )]
}

fn short(keys: &[String]) -> Scene {
    let keys: Vec<&str> = SHORT.into_iter().chain(keys.iter().map(String::as_str)).collect();
    scene_with(EN_250, &keys)
}

/// Contact force and force of the drive, N.
fn values(run: &Run) -> Vec<f64> {
    let own = &run.record.pantographs[0];
    own.force.iter().chain(own.control.as_ref().unwrap()).copied().collect()
}

/// Their bits.
fn bits(run: &Run) -> Vec<u64> {
    values(run).into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_controller_in_c_gives_the_bits_of_the_one_inside_in_every_mode() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new().write(folder.path(), "pid");
    for mode in [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation] {
        let expected = run(short(&inside(0.005)), mode, "controller-inside");
        let found = run(short(&commanded(&fmu, 0.005, "")), mode, "controller-fmu");
        let drive = expected.record.pantographs[0].control.as_ref().unwrap();
        assert!(drive.iter().any(|force| force.abs() > 5.0), "the drive acts");
        assert!(bits(&found) == bits(&expected), "{mode:?}");
    }
}

#[test]
fn every_coupling_asks_once_per_sample() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new()
        .saying("canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"false\"")
        .write(folder.path(), "pid");
    for algorithm in ["jacobi", "gauss_seidel", "iterated", "interface_jacobian"] {
        let with = |keys: &[String]| {
            let algorithm = format!("coupling.algorithm=\"{algorithm}\"");
            let keys: Vec<String> = keys.iter().cloned().chain([algorithm]).collect();
            run(short(&keys), Mode::Inprocess, "controller-algorithm")
        };
        let (expected, found) = (with(&inside(0.005)), with(&commanded(&fmu, 0.005, "")));
        assert!(bits(&found) == bits(&expected), "{algorithm}");
    }
}

#[test]
fn samples_within_macro_steps_cost_rounding_and_a_step_that_is_divided() {
    let folder = tempfile::tempdir().unwrap();
    let (able, unable) = (
        Controller::new().write(folder.path(), "able"),
        Controller::new()
            .saying("canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"false\"")
            .write(folder.path(), "unable"),
    );
    let sample = 0.0035;
    let whole = run(short(&inside(sample)), Mode::Monolithic, "controller-inside");
    let one = run(short(&commanded(&able, sample, "")), Mode::Monolithic, "controller-fmu");
    assert!(
        bits(&one) == bits(&whole),
        "one system divides its steps in the same way"
    );
    let coupled = run(short(&inside(sample)), Mode::Inprocess, "controller-inside");
    for fmu in [&able, &unable] {
        let found = run(short(&commanded(fmu, sample, "")), Mode::Inprocess, "controller-fmu");
        let difference = (found.sigma() / coupled.sigma() - 1.0).abs();
        // Inputs of a divided step are polynomials about another time; a step that stands is not corrected.
        assert!(difference < 0.005, "{}: {difference}", fmu.display());
        let rollbacks = found.summary.cost.rollbacks;
        assert!(fmu == &able || rollbacks == 0, "what cannot go back is not taken back");
    }
    // On communication points nothing is asked twice.
    let expected = run(short(&inside(0.005)), Mode::Inprocess, "controller-inside");
    let found = run(short(&commanded(&unable, 0.005, "")), Mode::Inprocess, "controller-fmu");
    assert!(bits(&found) == bits(&expected));
}

#[test]
fn the_wiring_makes_a_skyhook_of_a_proportional_controller() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new().write(folder.path(), "pid").display().to_string();
    let inside = ["pantograph[1].control={ law=\"skyhook\", sample_time=0.004, damping=256 }".to_owned()];
    // u = kp (0 − 256 v)
    let wired = [
        "pantograph[1].control={ law=\"given\", sample_time=0.004 }".to_owned(),
        format!(
            "controller=[{{ fmu={fmu:?}, parameters={{ kp=1, limit=1e9 }}, \
             inputs={{ velocity={{ variable=\"F\", factor=256 }} }}, outputs={{ command={{ variable=\"u\" }} }} }}]"
        ),
    ];
    for mode in [Mode::Monolithic, Mode::Inprocess] {
        let [expected, found] = [&inside[..], &wired[..]].map(|keys| run(short(keys), mode, "skyhook"));
        // But for the sign of a zero.
        assert!(values(&found) == values(&expected), "{mode:?}");
    }
}

/// The scene of a call of the program.
fn written(keys: &[String]) -> String {
    short(keys).to_toml()
}

#[test]
fn a_controller_in_a_process_of_its_own_gives_the_same_bits() {
    let program = Program::new();
    let fmu = Controller::new().write(program.folder(), "pid");
    let run = |name: &str, more: &str| {
        let scene = program.scene(name, &written(&commanded(&fmu, 0.005, more)));
        program.run(&scene, &["--no-report"]).done()
    };
    let (here, apart) = (run("here", ""), run("apart", ", isolate=true, step_timeout=30"));
    assert_eq!(apart.force(), here.force());
    assert_eq!(
        apart.series("pantograph[1].control.force"),
        here.series("pantograph[1].control.force")
    );
}

#[test]
fn a_controller_from_pythonfmu_agrees_with_the_one_inside_to_rounding() {
    let program = Program::new();
    let interpreter = environment("suppliers", &tree().join("tests/suppliers/requirements.txt"));
    python::run(
        Command::new(&interpreter)
            .args(["-m", "pythonfmu", "build", "-f"])
            .arg(tree().join("tests/suppliers/pid.py"))
            .arg("-d")
            .arg(program.folder()),
        "exporting a controller with PythonFMU",
    );
    let library = python::library(&interpreter);
    let more = format!(", isolate=true, environment={{ LD_PRELOAD={library:?} }}");
    let fmu = program.folder().join("Pid.fmu");
    let run = |name: &str, keys: &[String], mode: &str| {
        let scene = program.scene(name, &written(keys));
        program.run(&scene, &["--no-report", "--mode", mode]).done().force()
    };
    for mode in ["monolithic", "cosimulation"] {
        let expected = run("inside", &inside(0.005), mode);
        let found = run("python", &commanded(&fmu, 0.005, &more), mode);
        let differences = expected.iter().zip(&found).map(|(a, b)| (a - b).abs());
        let largest = differences.fold(0.0, f64::max);
        // Rounding in a loop that keeps it small.
        assert!(largest < 1e-6, "{mode}: {largest} N");
    }
}

#[test]
fn a_system_with_a_controller_runs_as_the_scene_it_was_made_of() {
    let program = Program::new();
    let fmu = Controller::new().write(program.folder(), "pid");
    let scene = program.scene("commanded", &written(&commanded(&fmu, 0.005, "")));
    let here = program.run(&scene, &[]).done();
    let told = program
        .call(&["export", scene.to_str().unwrap(), "--out", "systems"])
        .done();
    assert!(told.stderr.contains("communication point"), "{}", told.stderr);
    let system = program.folder().join("systems").join("commanded.ssp");
    // The controller is in the archive.
    std::fs::remove_file(&fmu).unwrap();
    let again = program.run(&system, &[]).done();
    assert_eq!(again.force(), here.force());
    let drive = "pantograph[1].control.force";
    assert_eq!(again.series(drive), here.series(drive));
    let limits = fmi2::archive::Limits::default();
    let folder = fmi2::archive::extract(&system, "SystemStructure.ssd", &limits).unwrap();
    let text = std::fs::read_to_string(folder.path().join("SystemStructure.ssd")).unwrap();
    for connected in [
        "startElement=\"Pantograph\" startConnector=\"control.measured.force\" endElement=\"Controller\" \
         endConnector=\"F\"",
        "startElement=\"Controller\" startConnector=\"u\" endElement=\"Pantograph\" \
         endConnector=\"control.force\"",
    ] {
        assert!(text.contains(connected), "{connected}: {text}");
    }
}

#[test]
fn check_names_the_controller_and_its_wiring() {
    let program = Program::new();
    let fmu = Controller::new().write(program.folder(), "pid");
    let scene = program.scene("checked", &written(&commanded(&fmu, 0.005, "")));
    let told = program.call(&["check", scene.to_str().unwrap()]).done().stdout;
    for said in [
        "controller 1 of pantograph 1: ",
        "F [N] = force [N]",
        "F_desired [N] = desired_force [N]",
        "command [N] = u [N]",
        "pantograph 1: commands from FMU",
        // The run is too short for a trial.
        "linear theory does not know the rule of controller[1]",
        "where the run has 450 samples or more",
    ] {
        assert!(told.contains(said), "nothing about {said:?}:\n{told}");
    }
    let told = program.call(&["inspect", fmu.to_str().unwrap()]).done().stdout;
    assert!(
        told.contains("wiring as a controller") && told.contains("[[controller]]"),
        "{told}"
    );
}

/// Delay in ms that `check` finds in its remark on the loop.
fn told_delay(keys: &[String]) -> f64 {
    let long = [
        "catenary.spans=8",
        "catenary.mesh.elements_per_interval=2",
        "run.duration=4.6",
        "run.evaluate={time=[1,4.5]}",
    ];
    let keys: Vec<&str> = long.into_iter().chain(keys.iter().map(String::as_str)).collect();
    let prepared = prepare(scene_with(EN_250, &keys), "told", Path::new("."), false).unwrap();
    let notes = Report::of(&prepared).unwrap().notes;
    let note = notes
        .iter()
        .find(|note| note.contains("pantograph[1].control: "))
        .unwrap();
    let (_, behind) = note.split_once("a delay of ").unwrap_or_else(|| panic!("{note}"));
    behind.split_once(' ').unwrap().0.parse().unwrap()
}

#[test]
fn check_finds_by_trials_the_delay_that_linear_theory_gives_the_same_rule() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new().write(folder.path(), "pid").display().to_string();
    let drive = "actuator={ lag=0.01, limit=60 }";
    for (gains, sample) in [("kp=1, ki=0", 0.01), ("kp=1.5, ki=2", 0.01), ("kp=0.8, ki=1", 0.005)] {
        let theory = told_delay(&[format!(
            "pantograph[1].control={{ law=\"pid\", sample_time={sample}, {gains}, {drive} }}"
        )]);
        let tried = told_delay(&[
            format!("pantograph[1].control={{ law=\"given\", sample_time={sample}, {drive} }}"),
            format!("controller=[{{ fmu={fmu:?}, parameters={{ {gains}, limit=60 }} }}]"),
        ]);
        println!("{gains}: {tried} ms, {theory} ms");
        // Both are told in tenths of a millisecond.
        assert!(
            (tried - theory).abs() <= 0.03 * theory + 0.1,
            "{gains}: {tried} ms, {theory} ms"
        );
    }
}

/// Refusal of a scene before its run, with all causes.
fn refusal(keys: &[String]) -> String {
    let keys: Vec<String> = SHORT
        .iter()
        .map(ToString::to_string)
        .chain(keys.iter().cloned())
        .collect();
    let scene = match system::load(EN_250, "scene.toml", &keys) {
        Ok(scene) => scene,
        Err(error) => return error.to_string(),
    };
    let Err(error) = prepare(scene, "refused", Path::new("."), false) else {
        panic!("{keys:?} is not refused");
    };
    assert!(error.is_input(), "{error}");
    let mut text = error.to_string();
    let mut cause = std::error::Error::source(&error);
    while let Some(error) = cause {
        write!(text, ": {error}").unwrap();
        cause = error.source();
    }
    text
}

#[test]
fn what_is_no_controller_is_refused_with_key_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let pid = Controller::new().write(folder.path(), "pid");
    let pantograph = Pantograph::new().write(folder.path(), "two_mass");
    let fixed = Controller::new()
        .saying(
            "canHandleVariableCommunicationStepSize=\"true\"",
            "canHandleVariableCommunicationStepSize=\"false\"",
        )
        .saying("stepSize=\"0.005\"", "stepSize=\"0.002\"")
        .write(folder.path(), "fixed");
    let given = |sample: f64| format!("pantograph[1].control={{ law=\"given\", sample_time={sample} }}");
    let fmu = |fmu: &Path, more: &str| {
        let fmu = fmu.display().to_string();
        format!("controller=[{{ fmu={fmu:?}{more} }}]")
    };
    for (keys, said) in [
        (
            vec![given(0.005), fmu(&pantograph, "")],
            vec!["controller[1].outputs", "command", "master inspect"],
        ),
        (
            vec![
                given(0.005),
                fmu(&pantograph, ", outputs={ command={ variable=\"z1\" } }"),
            ],
            vec!["controller[1].outputs.command", "z1 [m]", "[N]", "different quantities"],
        ),
        (
            vec![given(0.005), fmu(&pid, ", outputs={ command={ variable=\"uu\" } }")],
            vec![
                "controller[1].outputs.command.variable",
                "\"uu\"",
                "did you mean \"u\"?",
            ],
        ),
        (
            vec![
                given(0.005),
                fmu(&pid, ", inputs={ force={ variable=\"F_measured\" } }"),
            ],
            vec!["controller[1].inputs.force.variable", "\"F_measured\""],
        ),
        (
            vec![
                given(0.005),
                fmu(&pid, ", inputs={ time={ variable=\"F\", factor=2 } }"),
            ],
            vec!["controller[1].inputs", "force, as measured"],
        ),
        (
            vec![given(0.005), fmu(&pid, ", parameters={ kq=1 }")],
            vec!["controller[1].parameters", "\"kq\""],
        ),
        (
            vec![given(0.005), fmu(&pid, ", inputs={ height={ variable=\"F\" } }")],
            vec!["controller[1].inputs", "height"],
        ),
        (
            vec![given(0.005), fmu(&fixed, "")],
            vec!["pantograph[1].control.sample_time = 0.005 s", "multiple", "0.006"],
        ),
        (
            vec![fmu(&pid, "")],
            vec!["controller[1].pantograph", "law = \"given\"", "has no control"],
        ),
        (
            vec![
                "pantograph[1].control={ law=\"pid\", sample_time=0.005, kp=1 }".to_owned(),
                fmu(&pid, ""),
            ],
            vec!["controller[1].pantograph", "law = \"given\"", "has law = \"pid\""],
        ),
        (
            vec![given(0.005), fmu(&pid, ", pantograph=2")],
            vec!["controller[1].pantograph", "2", "at most 1, the number of pantographs"],
        ),
        (
            vec![
                given(0.005),
                "controller=[{ fmu=\"a.fmu\" }, { fmu=\"b.fmu\" }]".to_owned(),
            ],
            vec!["controller[2].pantograph", "controller[1] commands this one"],
        ),
        (
            vec![
                "pantograph[1].control={ law=\"given\", sample_time=0.005, actuator={ delay=0.006 } }".to_owned(),
                fmu(&pid, ""),
            ],
            vec!["pantograph[1].control.actuator.delay", "sample_time = 0.005 s"],
        ),
        (
            vec![given(0.005), fmu(&pid, ", memory_limit=1e9")],
            vec!["controller[1].memory_limit", "isolate = true"],
        ),
        (
            vec![given(0.005), fmu(Path::new("nowhere.fmu"), "")],
            vec!["controller[1].fmu", "nowhere.fmu"],
        ),
    ] {
        let text = refusal(&keys);
        for said in said {
            assert!(text.contains(said), "nothing about {said:?}: {text}");
        }
    }
}

/// The scene step by step.
fn stepped(keys: &[String]) -> SteppedSystem {
    let prepared = prepare(short(keys), "stepped", Path::new("."), false).unwrap();
    prepared.stepped().unwrap()
}

/// Advances by `count` steps; the force of the contact and the command at their ends.
fn advanced(system: &mut SteppedSystem, count: usize) -> Vec<[u64; 2]> {
    let place = |name: &str| system.signals().iter().position(|signal| signal.name == name).unwrap();
    let [force, command] = ["contact[1].force", "pantograph[1].control.force"].map(place);
    let mut seen = Vec::new();
    for _ in 0..count {
        system.advance().unwrap();
        seen.push([force, command].map(|signal| system.value(signal).to_bits()));
    }
    seen
}

#[test]
fn a_stepped_simulation_asks_the_controller_as_a_run_does_and_goes_back_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new().write(folder.path(), "pid");
    for more in ["", ", isolate=true, step_timeout=30"] {
        let keys = commanded(&fmu, 0.005, more);
        let mut system = stepped(&keys);
        let all = advanced(&mut system, 400);
        if more.is_empty() {
            let expected = run(short(&keys), Mode::Monolithic, "controller-stepped");
            let step = (expected.record.time[1] - expected.record.time[0]) / system.macro_step();
            let step = step.round() as usize;
            let recorded: Vec<u64> = expected.record.pantographs[0]
                .force
                .iter()
                .map(|f| f.to_bits())
                .collect();
            let found: Vec<u64> = all.iter().skip(step - 1).step_by(step).map(|seen| seen[0]).collect();
            assert!(recorded[1..].starts_with(&found), "the bits of the run");
        }
        // To a kept state of this system and of another one in place of this, which stands elsewhere.
        system.reset().unwrap();
        assert!(advanced(&mut system, 123) == all[..123]);
        let mut kept = SteppedState::default();
        system.save(&mut kept);
        assert!(advanced(&mut system, 100) == all[123..223]);
        system.restore(&kept).unwrap();
        assert!(advanced(&mut system, 100) == all[123..223]);
        let mut other = stepped(&keys);
        advanced(&mut other, 7);
        other.restore(&kept).unwrap();
        assert!(advanced(&mut other, 100) == all[123..223]);
        let given = system
            .signals()
            .iter()
            .find(|signal| signal.name == "pantograph[1].control.force");
        assert!(!given.unwrap().settable, "commands are those of the FMU");
    }
}

#[test]
fn a_stepped_simulation_goes_on_but_not_back_with_a_controller_that_keeps_no_state() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new()
        .saying("canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"false\"")
        .write(folder.path(), "pid");
    let keys = commanded(&fmu, 0.005, "");
    let mut system = stepped(&keys);
    system.reset().unwrap();
    let all = advanced(&mut system, 30);
    let mut kept = SteppedState::default();
    system.save(&mut kept);
    let error = system.reset().unwrap_err();
    let text = cosim::chain(&error);
    assert!(
        text.contains("pantograph[1]") && text.contains("canGetAndSetFMUstate"),
        "{text}"
    );
    // Another one goes on to where this one was.
    let mut other = stepped(&keys);
    assert!(advanced(&mut other, 11) == all[..11]);
    other.restore(&kept).unwrap();
    let more = advanced(&mut other, 20);
    let mut whole = stepped(&keys);
    assert!(advanced(&mut whole, 50)[30..] == more);
}

#[test]
fn a_controller_that_lost_its_process_is_told_as_that_in_one_system() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Controller::new().write(folder.path(), "pid");
    let lost = || {
        let gone = IsolationError::Gone {
            instance: "controller 1".to_owned(),
        };
        let source = Box::new(InstanceError::Isolation(gone));
        OutsideError::new(SlaveError::Step {
            slave: "controller 1".to_owned(),
            t: 0.1,
            h: 0.005,
            retryable: false,
            source,
        })
    };
    struct Dying<F>(F);
    impl<F: Fn() -> OutsideError + Send> Rule for Dying<F> {
        fn command(&mut self, _: i64, _: &Reading, _: f64) -> Result<f64, OutsideError> {
            Err((self.0)())
        }
        fn asked(&self) -> Asked {
            Asked::default()
        }
        fn ask_again(&mut self, _: &Asked) -> Result<(), OutsideError> {
            Ok(())
        }
    }
    let mut system = stepped(&commanded(&fmu, 0.005, ""));
    system.command_by(0, Box::new(Dying(lost)));
    let error = system.advance().unwrap_err();
    let text = cosim::chain(&error);
    assert!(
        text.contains("no command of the controller at t = 0 s") && text.contains("controller 1"),
        "{text}"
    );
    assert!(simulation::lost_a_process(&error), "{text}");
}

#[test]
fn instruments_show_the_motion_of_the_head() {
    let keys = [
        "pantograph[1].reference_height=5.3",
        "pantograph[1].control={ law=\"given\", sample_time=0.001 }",
    ];
    let scene = scene_with(EN_250, &keys);
    let mut side = Subsystem::build(&scene).unwrap();
    let signals = Subsystem::signals(&scene);
    let place = |name: &str| signals.iter().position(|signal| signal.name == name).unwrap();
    let load = place("contact[1].fz");
    let start = side.input(load);
    let h = 1e-4;
    let mut seen = Vec::new();
    for n in 0..200 {
        let t = h * f64::from(n);
        side.set_input(load, start - 20.0 * (40.0 * t).sin());
        side.do_step(t, h).unwrap();
        seen.push(
            [
                "control.measured.force",
                "control.measured.head_height",
                "control.measured.head_velocity",
                "control.measured.head_acceleration",
                "strip[1].z",
            ]
            .map(|name| side.output(place(name))),
        );
        assert_eq!(seen[n as usize][0], -side.input(load));
    }
    for three in seen.windows(3) {
        let [before, now, after] = three else { unreachable!() };
        assert_eq!(now[1], now[4]);
        for (value, rate, scale) in [(1, 2, 0.01), (2, 3, 1.0)] {
            // Central differences, of order 2 in the step.
            let expected = (after[value] - before[value]) / (2.0 * h);
            assert!(
                (now[rate] - expected).abs() < 0.05 * scale,
                "{value}: {} {expected}",
                now[rate]
            );
        }
    }
}
