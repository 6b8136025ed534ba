//! The packaged FMUs through their C interface: wrong calls, failed steps, many instances, small stacks.
#[path = "fmu_abi/host.rs"]
mod host;
#[path = "fmu_abi/raw.rs"]
mod raw;

use fmi2::Error;
use fmi2::abi::Status;
use fmi2::archive::binary_entry;
use fmi2::import::{Fmu, Instance, StepOutcome};
use fmi2::model_description::Causality;
use integration_tests::fmus::{COARSE, DEFAULT, Packaged, THESIS, initialise, read, reals, reference, started};
use integration_tests::runs::{EN_250, prepared, scene_with};
use std::sync::LazyLock;

const H: f64 = 1e-3;
const IDENTIFIERS: [&str; 2] = ["Catenary", "Pantograph"];

static EN: LazyLock<Packaged> = LazyLock::new(|| Packaged::new(EN_250, COARSE));
static KULKARNI: LazyLock<Packaged> = LazyLock::new(|| Packaged::new(THESIS, &[]));
/// A single Newton iteration is enough for a tiny step only.
static IMPATIENT: LazyLock<Packaged> = LazyLock::new(|| {
    let short = ["catenary.spans=3", "run.duration=1.0", "run.evaluate={time=[0.0,1.0]}"];
    let impatient = ["solver.max_iterations=1", "solver.newton_tolerance=1e-6"];
    Packaged::new(THESIS, &[&short[..], &impatient].concat())
});

/// Takes `steps` steps under a strip that presses and heaves, or a force that pulsates; returns all real outputs.
fn run(fmu: &Fmu, instance: &mut Instance, from: usize, steps: usize) -> Vec<f64> {
    let line = fmu.description().model_name == "Catenary";
    let name = if line { "strip[1].z" } else { "contact[1].fz" };
    let input = reference(fmu, name);
    let start = fmu.description().variable(name).unwrap().real_start().unwrap();
    for n in from..from + steps {
        let t = n as f64 * H;
        let value = if line {
            start + 0.005 * (1.0 + (8.0 * t).sin())
        } else {
            start - 40.0 * (8.0 * t).sin()
        };
        instance.set_real(&[input], &[value]).unwrap();
        assert_eq!(instance.do_step(t, H).unwrap(), StepOutcome::Ok);
    }
    read(instance, &reals(fmu, Causality::Output))
}

/// An input that the model cannot follow in one iteration.
fn jump(fmu: &Fmu, instance: &mut Instance) {
    let (name, by) = if fmu.description().model_name == "Catenary" {
        ("strip[1].z", 0.3)
    } else {
        ("contact[1].fz", -2e5)
    };
    let input = [reference(fmu, name)];
    let value = read(instance, &input)[0];
    instance.set_real(&input, &[value + by]).unwrap();
}

/// The phases of the table in FMI 2.0, 4.2.4.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Instantiated,
    Initialization,
    Step,
    StepFailed,
    Failed,
    Terminated,
}

const PHASES: [Phase; 6] = [
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Step,
    Phase::StepFailed,
    Phase::Failed,
    Phase::Terminated,
];

fn in_phase(fmu: &Fmu, phase: Phase) -> Instance {
    let mut instance = fmu.instantiate("phase", false, false).unwrap();
    if phase == Phase::Instantiated {
        return instance;
    }
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    if phase == Phase::Initialization {
        return instance;
    }
    instance.exit_initialization_mode().unwrap();
    match phase {
        Phase::StepFailed => {
            jump(fmu, &mut instance);
            assert_eq!(instance.do_step(0.0, H).unwrap(), StepOutcome::Discard);
        }
        Phase::Failed => assert!(instance.do_step(0.0, -H).is_err()),
        Phase::Terminated => instance.terminate().unwrap(),
        _ => {}
    }
    instance
}

type Call = fn(&Fmu, &mut Instance) -> Result<(), Error>;

/// The calls with the phases in which they are legal; [`Phase::Failed`] for questions, as a help to find the reason.
fn calls() -> Vec<(&'static str, Call, Vec<Phase>)> {
    use Phase::{Failed, Initialization, Instantiated, Step, StepFailed, Terminated};
    let asked = vec![Initialization, Step, StepFailed, Failed, Terminated];
    vec![
        ("setup", |_, i| i.setup_experiment(0.0, None, None), vec![Instantiated]),
        ("enter", |_, i| i.enter_initialization_mode(), vec![Instantiated]),
        ("exit", |_, i| i.exit_initialization_mode(), vec![Initialization]),
        ("terminate", |_, i| i.terminate(), vec![Step, StepFailed]),
        ("reset", |_, i| i.reset(), PHASES.to_vec()),
        (
            "get",
            |f, i| i.get_real(&reals(f, Causality::Output)[..1], &mut [0.0]),
            asked.clone(),
        ),
        (
            "set an input",
            |f, i| i.set_real(&reals(f, Causality::Input)[2..3], &[0.0]),
            vec![Instantiated, Initialization, Step],
        ),
        (
            "set a parameter",
            |f, i| i.set_real(&[reference(f, "solver.rho_inf")], &[0.8]),
            vec![Instantiated, Initialization],
        ),
        (
            "set an output",
            |f, i| i.set_real(&reals(f, Causality::Output)[..1], &[0.0]),
            vec![],
        ),
        (
            "input derivatives",
            |f, i| i.set_real_input_derivatives(&reals(f, Causality::Input)[..1], &[1], &[0.0]),
            vec![Instantiated, Initialization, Step],
        ),
        (
            "output derivatives",
            |f, i| i.get_real_output_derivatives(&reals(f, Causality::Output)[..1], &[1], &mut [0.0]),
            vec![Step, StepFailed, Failed, Terminated],
        ),
        (
            "directional derivative",
            |f, i| {
                let (unknowns, knowns) = (reals(f, Causality::Output), reals(f, Causality::Input));
                i.directional_derivative(&unknowns[..1], &knowns[..1], &[1.0], &mut [0.0])
            },
            asked,
        ),
        ("step", |_, i| i.do_step(0.0, H).map(|_| ()), vec![Step]),
        (
            "save, store, restore",
            |_, i| {
                let state = i.save_state()?;
                let bytes = i.serialize_state(&state)?;
                i.restore_state(&state)?;
                i.free_state(state)?;
                let state = i.deserialize_state(&bytes)?;
                i.free_state(state)
            },
            PHASES.to_vec(),
        ),
    ]
}

#[test]
fn every_call_is_legal_in_its_phases_and_an_error_in_the_others() {
    for identifier in IDENTIFIERS {
        let fmu = IMPATIENT.open(identifier);
        for (name, call, legal) in calls() {
            for phase in PHASES {
                let mut instance = in_phase(&fmu, phase);
                let result = call(&fmu, &mut instance);
                let is_legal = legal.contains(&phase);
                assert_eq!(
                    result.is_ok(),
                    is_legal,
                    "{identifier}: {name} in {phase:?}: {result:?}"
                );
                if !is_legal {
                    assert!(
                        matches!(
                            result,
                            Err(Error::Call {
                                status: Status::Error,
                                ..
                            })
                        ),
                        "{result:?}"
                    );
                }
                instance.reset().unwrap();
                initialise(&mut instance);
                assert_eq!(
                    instance.do_step(0.0, 1e-9).unwrap(),
                    StepOutcome::Ok,
                    "{identifier}: {name} in {phase:?}"
                );
            }
        }
    }
}

#[test]
fn a_discarded_step_leaves_the_state_as_before_and_says_where_it_began() {
    for identifier in IDENTIFIERS {
        let fmu = IMPATIENT.open(identifier);
        let outputs = reals(&fmu, Causality::Output);
        let mut instance = started(&fmu, "impatient");
        for n in 0..3 {
            assert_eq!(instance.do_step(f64::from(n) * 1e-9, 1e-9).unwrap(), StepOutcome::Ok);
        }
        let saved = instance.save_state().unwrap();
        jump(&fmu, &mut instance);
        let before = read(&mut instance, &outputs);
        assert_eq!(
            instance.do_step(3.0 * 1e-9, H).unwrap(),
            StepOutcome::Discard,
            "{identifier}"
        );
        assert_eq!(instance.last_successful_time().unwrap(), Some(3.0 * 1e-9));
        assert!(!instance.wants_to_terminate().unwrap());
        assert_eq!(
            read(&mut instance, &outputs),
            before,
            "{identifier}: the state is the one before the step"
        );
        let log = instance.take_log();
        assert!(
            log.iter().all(|message| message.category != "logStatusError"),
            "{log:?}"
        );
        // Back at the saved state, a smaller step without the jump is possible.
        instance.restore_state(&saved).unwrap();
        assert_eq!(instance.do_step(3.0 * 1e-9, 1e-9).unwrap(), StepOutcome::Ok);
        instance.free_state(saved).unwrap();
    }
}

#[test]
fn absurd_inputs_end_in_a_status_and_not_in_a_crash() {
    for packaged in [&EN, &KULKARNI] {
        for identifier in IDENTIFIERS {
            let fmu = packaged.open(identifier);
            let mut instance = started(&fmu, "absurd");
            let start = instance.save_state().unwrap();
            let expected = run(&fmu, &mut instance, 0, 1);
            for input in reals(&fmu, Causality::Input) {
                for value in [1e4, -1e4, 1e12, -1e300, f64::MAX, f64::MIN_POSITIVE] {
                    instance.restore_state(&start).unwrap();
                    instance.set_real(&[input], &[value]).unwrap();
                    let mut outcome = instance.do_step(0.0, H);
                    if matches!(outcome, Ok(StepOutcome::Ok)) {
                        outcome = instance.do_step(H, H);
                    }
                    let mut values = vec![0.0; reals(&fmu, Causality::Output).len()];
                    let read = instance.get_real(&reals(&fmu, Causality::Output), &mut values);
                    assert!(
                        read.is_err() || values.iter().all(|value| value.is_finite()),
                        "{identifier}: input {input} = {value:e}: {outcome:?}, then {values:?}"
                    );
                    instance.restore_state(&start).unwrap();
                    assert_eq!(
                        run(&fmu, &mut instance, 0, 1),
                        expected,
                        "{identifier}: after input {input} = {value:e}"
                    );
                }
            }
            instance.free_state(start).unwrap();
        }
    }
}

#[test]
fn nan_is_refused_with_variable_and_value_and_nothing_is_half_set() {
    for identifier in IDENTIFIERS {
        let fmu = EN.open(identifier);
        let inputs = reals(&fmu, Causality::Input);
        let mut instance = started(&fmu, "nan");
        let before = read(&mut instance, &inputs);
        let name = fmu.description().variables[inputs[1] as usize].name.clone();
        let message = instance
            .set_real(&inputs[..2], &[1.25, f64::NAN])
            .unwrap_err()
            .to_string();
        assert!(message.contains(&name) && message.contains("NaN"), "{message}");
        assert_eq!(read(&mut instance, &inputs), before);
        assert!(
            instance.do_step(0.0, H).is_err(),
            "after an error only reset and restore help"
        );
        instance.reset().unwrap();
        initialise(&mut instance);
        assert!(
            instance
                .set_real_input_derivatives(&inputs[..1], &[1], &[f64::INFINITY])
                .is_err()
        );
    }
}

#[test]
fn input_derivatives_outlast_a_parameter_that_is_set_after_them() {
    let fmu = EN.open("Pantograph");
    let (force, parameter) = ([reference(&fmu, "contact[1].fz")], [reference(&fmu, "static_force")]);
    let value = fmu
        .description()
        .variable("static_force")
        .unwrap()
        .real_start()
        .unwrap();
    let height = [reference(&fmu, "strip[1].z")];
    let course = |derivative_first: bool| {
        let mut instance = fmu.instantiate("early derivative", false, false).unwrap();
        instance.setup_experiment(0.0, None, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        for derivative in [derivative_first, !derivative_first] {
            if derivative {
                instance.set_real_input_derivatives(&force, &[1], &[-1e5]).unwrap();
            } else {
                instance.set_real(&parameter, &[value + 5.0]).unwrap();
            }
        }
        instance.exit_initialization_mode().unwrap();
        assert_eq!(instance.do_step(0.0, H).unwrap(), StepOutcome::Ok);
        read(&mut instance, &[force, height].concat())
    };
    assert_eq!(course(true), course(false));
}

#[test]
fn a_scene_of_another_make_is_refused_and_so_is_a_parameter_it_has_no_place_for() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let variable = |fmu: &Fmu, name: &str| [fmu.description().variable(name).unwrap().value_reference];
    let of_vehicle = Packaged::new(DEFAULT, &[]).open("Pantograph");
    let mut instance = of_vehicle.instantiate("another make", false, false).unwrap();
    let scene = [write("linkage.toml", &KULKARNI.scene.to_toml())];
    let set = instance.set_string(&variable(&of_vehicle, "scene"), &[&scene[0]]);
    let message = set.unwrap_err().to_string();
    assert!(
        message.contains("linkage.toml") && message.contains("has no variable base.x"),
        "{message}"
    );

    let of_three = EN.open("Pantograph");
    let mut instance = of_three.instantiate("fewer masses", false, false).unwrap();
    let lumped = ["masses=[20.0]", "stiffnesses=[60.0]", "dampings=[40.0]"];
    let lumped = lumped.map(|key| format!("pantograph[1].{key}"));
    let one = prepared(
        scene_with(EN_250, &[COARSE, &lumped.each_ref().map(String::as_str)].concat()),
        "one mass",
    );
    let scene = write("one.toml", &one.scene.to_toml());
    instance.set_string(&variable(&of_three, "scene"), &[&scene]).unwrap();
    instance.set_real(&variable(&of_three, "masses[2]"), &[25.0]).unwrap();
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    let message = instance.exit_initialization_mode().unwrap_err().to_string();
    assert!(
        message.contains("masses[2] = 25 kg") && message.contains("one.toml"),
        "{message}"
    );
}

#[test]
fn a_scene_that_leaves_a_table_to_a_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("moved.toml");
    let rest = "vehicle={model=\"rigid_motion\",motion={time=[0],z=[0]}}";
    let fmu = Packaged::new(EN_250, &[COARSE, &[rest]].concat()).open("Pantograph");
    let scene = scene_with(EN_250, COARSE).to_toml();
    let scene = format!("{scene}\n[vehicle]\nmodel = \"rigid_motion\"\nmotion = {{ file = \"motion.csv\" }}\n");
    std::fs::write(&path, scene).unwrap();
    let mut instance = fmu.instantiate("a file", false, false).unwrap();
    let reference = [fmu.description().variable("scene").unwrap().value_reference];
    let set = instance.set_string(&reference, &[&path.display().to_string()]);
    let message = set.and_then(|()| {
        instance.setup_experiment(0.0, None, None)?;
        instance.enter_initialization_mode()?;
        instance.exit_initialization_mode()
    });
    let message = message.unwrap_err().to_string();
    assert!(
        message.contains("vehicle.motion.file = \"motion.csv\": an FMU reads no file"),
        "{message}"
    );
}

#[test]
fn no_step_goes_past_a_stop_time_that_was_given() {
    for identifier in IDENTIFIERS {
        let fmu = EN.open(identifier);
        let mut instance = fmu.instantiate("stop", false, false).unwrap();
        instance.setup_experiment(0.0, Some(2.0 * H), None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        assert_eq!(instance.do_step(0.0, H).unwrap(), StepOutcome::Ok);
        assert_eq!(
            instance.do_step(H, H * (1.0 + 1e-12)).unwrap(),
            StepOutcome::Ok,
            "rounding is tolerated"
        );
        assert!(
            instance.do_step(2.0 * H, H).is_err(),
            "{identifier} steps past its stop time"
        );
        // Another start time, no stop time.
        instance.reset().unwrap();
        instance.setup_experiment(-5.0, None, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        assert_eq!(instance.do_step(-5.0, H).unwrap(), StepOutcome::Ok);
    }
}

#[test]
fn states_belong_to_their_instance_and_restore_it_after_an_error() {
    for identifier in IDENTIFIERS {
        let fmu = KULKARNI.open(identifier);
        let (mut one, mut two) = (started(&fmu, "same name"), started(&fmu, "same name"));
        run(&fmu, &mut one, 0, 10);
        let saved = one.save_state().unwrap();
        let expected = run(&fmu, &mut one, 10, 10);
        let other = run(&fmu, &mut two, 0, 25);
        assert_ne!(expected, other);
        assert!(one.do_step(99.0, H).is_err());
        one.restore_state(&saved).unwrap();
        assert_eq!(run(&fmu, &mut one, 10, 10), expected, "{identifier}");
        // The other instance has not noticed.
        assert_eq!(read(&mut two, &reals(&fmu, Causality::Output)), other);
        // The saved state goes on in the other instance, in a reused handle.
        let bytes = one.serialize_state(&saved).unwrap();
        let moved = two.deserialize_state(&bytes).unwrap();
        two.restore_state(&moved).unwrap();
        assert_eq!(run(&fmu, &mut two, 10, 10), expected, "{identifier}");
        two.save_state_again(&moved).unwrap();
        assert_eq!(run(&fmu, &mut two, 20, 5), run(&fmu, &mut one, 20, 5));
        two.restore_state(&moved).unwrap();
        two.free_state(moved).unwrap();
        one.free_state(saved).unwrap();
    }
}

#[test]
fn damaged_and_foreign_states_are_refused() {
    let fmu = EN.open("Pantograph");
    let mut instance = started(&fmu, "damaged");
    let saved = instance.save_state().unwrap();
    let bytes = instance.serialize_state(&saved).unwrap();
    for length in [0, 1, 20, bytes.len() / 2, bytes.len() - 1] {
        assert!(instance.deserialize_state(&bytes[..length]).is_err(), "{length} bytes");
    }
    for at in (0..bytes.len()).step_by(97) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        assert!(instance.deserialize_state(&damaged).is_err(), "byte {at}");
    }
    let mut other = started(&KULKARNI.open("Pantograph"), "foreign");
    assert!(other.deserialize_state(&bytes).is_err());
    run(&fmu, &mut instance, 0, 2); // a refused state has no consequence
    instance.free_state(saved).unwrap();
}

/// Resident memory of this process, bytes, where the system tells it.
fn resident() -> Option<usize> {
    let statistics = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: usize = statistics.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096)
}

#[test]
fn two_hundred_instances_come_and_go() {
    for identifier in IDENTIFIERS {
        let fmu = EN.open(identifier);
        let life = |n: usize| {
            let mut instance = fmu.instantiate(&format!("instance {n}"), false, false).unwrap();
            // Ends in every phase; a line is built for some of them only, which takes its time.
            if identifier == "Pantograph" || n.is_multiple_of(10) {
                initialise(&mut instance);
                run(&fmu, &mut instance, 0, n % 3);
                let state = instance.save_state().unwrap();
                if n.is_multiple_of(2) {
                    instance.terminate().unwrap();
                }
                instance.free_state(state).unwrap();
            }
        };
        (0..20).for_each(life);
        // Other tests of this process take memory too, but not in every round.
        let mut rounds = (0..3).map(|_| {
            let before = resident();
            (0..200).for_each(life);
            resident()
                .zip(before)
                .map_or(0, |(after, before)| after.saturating_sub(before))
        });
        // A line with its states takes some 10 MB; 20 lost ones would be far above.
        assert!(
            rounds.any(|grown| grown < 40_000_000),
            "{identifier}: 200 instances leave more than 40 MB behind, each time"
        );
    }
}

#[test]
fn a_thread_with_a_small_stack_can_initialise_and_step() {
    const STACK: usize = 256 * 1024;
    for packaged in [&EN, &KULKARNI] {
        for identifier in IDENTIFIERS {
            let fmu = packaged.open(identifier);
            let expected = run(&fmu, &mut started(&fmu, "large stack"), 0, 5);
            let thread = std::thread::Builder::new().stack_size(STACK);
            let small = thread.spawn(move || {
                let mut instance = started(&fmu, "small stack");
                let outputs = run(&fmu, &mut instance, 0, 5);
                let state = instance.save_state().unwrap();
                let bytes = instance.serialize_state(&state).unwrap();
                let copy = instance.deserialize_state(&bytes).unwrap();
                instance.restore_state(&copy).unwrap();
                instance.free_state(copy).unwrap();
                instance.free_state(state).unwrap();
                outputs
            });
            assert_eq!(small.unwrap().join().unwrap(), expected, "{identifier}");
        }
    }
}

#[test]
fn an_instance_may_move_to_another_thread() {
    let fmu = KULKARNI.open("Catenary");
    let expected = run(&fmu, &mut started(&fmu, "stays"), 0, 10);
    let mut instance = started(&fmu, "moves");
    run(&fmu, &mut instance, 0, 5);
    let moved = std::thread::scope(|scope| scope.spawn(|| run(&fmu, &mut instance, 5, 5)).join().unwrap());
    assert_eq!(moved, expected);
}

#[test]
fn exactly_the_functions_of_the_standard_are_exported() {
    for identifier in IDENTIFIERS {
        let fmu = KULKARNI.open(identifier);
        let nm = std::process::Command::new("nm")
            .args(["-D", "--defined-only"])
            .arg(fmu.folder().join(binary_entry(identifier)))
            .output()
            .unwrap();
        assert!(nm.status.success(), "{}", String::from_utf8_lossy(&nm.stderr));
        let listing = String::from_utf8(nm.stdout).unwrap();
        let names: Vec<_> = listing
            .lines()
            .filter_map(|line| line.split_whitespace().last())
            .collect();
        assert!(names.iter().all(|name| name.starts_with("fmi2")), "{names:?}");
        assert_eq!(
            names.len(),
            34,
            "common functions and those of co-simulation [FMI 2.0, 2.1 and 4.2]"
        );
    }
}

#[test]
fn archives_of_the_same_scene_are_the_same_to_the_last_byte() {
    let again = Packaged::new(THESIS, &[]);
    for identifier in IDENTIFIERS {
        let files = [&*KULKARNI, &again].map(|packaged| std::fs::read(packaged.path(identifier)).unwrap());
        assert!(files[0] == files[1], "{identifier}");
        assert_ne!(
            KULKARNI.open(identifier).description().guid,
            EN.open(identifier).description().guid
        );
    }
}

#[test]
fn no_folder_or_name_of_this_computer_is_in_an_archive() {
    let tree = integration_tests::fmus::tree().display().to_string();
    for identifier in IDENTIFIERS {
        let fmu = KULKARNI.open(identifier);
        for name in [
            "modelDescription.xml",
            "resources/scene.toml",
            "documentation/index.html",
            "documentation/licenses/license.txt",
            "documentation/sbom.cdx.json",
            "documentation/externalDependencies.txt",
        ] {
            let text = std::fs::read_to_string(fmu.folder().join(name)).unwrap();
            assert!(!text.contains(&tree), "{identifier}: {name}");
        }
    }
}
