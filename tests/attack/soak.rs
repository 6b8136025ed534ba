//! Both FMUs over a long time: instances that come and go, processes that start and end, hours in one instance. Memory,
//! handles, threads and folders stay as they are, and the same input gives the same output in the last hour.
use super::{IDENTIFIERS, SMALL};
use fmi2::import::{Fmu, StepOutcome};
use fmi2::isolation::{self, Isolation};
use fmi2::model_description::Causality;
use integration_tests::fmus::{Packaged, initialise, reference};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::time::Duration;

/// Resources of this process.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    /// Resident memory, kB.
    memory: i64,
    handles: usize,
    threads: usize,
    children: usize,
}

impl Footprint {
    fn now() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let number = |key: &str| -> i64 {
            let line = status.lines().find_map(|line| line.strip_prefix(key)).unwrap();
            line.split_whitespace().next().unwrap().parse().unwrap()
        };
        let tasks = fs::read_dir("/proc/self/task")
            .unwrap()
            .map(|task| task.unwrap().path());
        let children = tasks.map(|task| fs::read_to_string(task.join("children")).unwrap_or_default());
        Self {
            memory: number("VmRSS:"),
            handles: fs::read_dir("/proc/self/fd").unwrap().count(),
            threads: usize::try_from(number("Threads:")).unwrap(),
            children: children.map(|list| list.split_whitespace().count()).sum(),
        }
    }
}

/// Runs `once` for a tenth of `count` times, then for the rest; says and returns by how many kB memory has grown.
fn grown(what: &str, count: usize, mut once: impl FnMut(usize)) -> i64 {
    let warm = (count / 10).max(1);
    (0..warm).for_each(&mut once);
    let before = Footprint::now();
    (warm..count).for_each(&mut once);
    let after = Footprint::now();
    println!("{what}, {count} times: {before:?}, then {after:?}");
    after.memory - before.memory
}

/// Instances that are made and freed in every phase, and archives that are unpacked and removed.
fn cycles(count: usize) {
    for identifier in IDENTIFIERS {
        let fmu = SMALL.open(identifier);
        let more = grown(&format!("instances of {identifier}"), count, |n| {
            let mut instance = fmu.instantiate("cycle", false, false).unwrap();
            if n % 4 > 0 {
                initialise(&mut instance);
            }
            if n % 4 > 1 {
                assert_eq!(instance.do_step(0.0, 1e-3).unwrap(), StepOutcome::Ok);
                let state = instance.save_state().unwrap();
                instance.free_state(state).unwrap();
            }
        });
        // Less than a hundred bytes for each instance, or what an allocator keeps.
        assert!(more < 2000 + count as i64 / 10, "{identifier}: {more} kB more");
        grown(&format!("archives of {identifier}"), count / 10, |_| {
            let folder = SMALL.open(identifier).folder().to_owned();
            assert!(!folder.exists(), "the unpacked archive is left");
        });
    }
}

/// Isolated instances that are started, stepped and ended.
fn starts(count: usize) {
    let isolation = Isolation {
        time_limit: Duration::from_secs(60),
        memory_limit: None,
        environment: BTreeMap::new(),
    };
    let fmu = SMALL.open("Pantograph");
    let before = Footprint::now();
    let grown = grown("isolated starts", count, |n| {
        let mut instance = isolation::start(&fmu, "start", false, &isolation).unwrap();
        instance.setup_experiment(0.0, None, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        if n % 2 == 0 {
            assert_eq!(instance.do_step(0.0, 1e-3).unwrap(), StepOutcome::Ok);
        }
    });
    let after = Footprint::now();
    let held = (before.handles, 0);
    assert_eq!((after.handles, after.children), held, "a handle or a process is left");
    assert!(after.threads <= before.threads, "a thread is left");
    assert!(grown < 2000 + count as i64 / 10, "{grown} kB more");
}

/// Communication step of the long run, s.
const STEP: f64 = 0.01;

/// Period of the input, steps.
const PERIOD: usize = 200;

/// Some hours of simulated time in one instance under a periodic input: `set` and `read` are variables, `input` the
/// value in the middle and its amplitude. Returns the largest difference of the output between a period at the end and
/// one after a tenth of the time.
fn long(fmu: &Fmu, (set, read): (&str, &str), input: (f64, f64), hours: f64) -> f64 {
    let (set, read) = (reference(fmu, set), reference(fmu, read));
    let mut instance = fmu.instantiate("long", false, false).unwrap();
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    // A strip that stands: at any other speed it would leave the line within hours.
    if let Some(speed) = fmu
        .description()
        .variables
        .iter()
        .find(|variable| variable.name == "strip[1].vx")
        && speed.causality == Causality::Input
    {
        instance.set_real(&[speed.value_reference], &[0.0]).unwrap();
    }
    let periods = (hours * 3600.0 / STEP / PERIOD as f64).round() as usize;
    let mut outputs = vec![0.0; PERIOD];
    let (mut early, mut n) = (Vec::new(), 0_u64);
    let grown = grown(
        &format!(
            "periods of {} s of {}",
            PERIOD as f64 * STEP,
            fmu.description().model_name
        ),
        periods,
        |period| {
            for (place, output) in outputs.iter_mut().enumerate() {
                let phase = TAU * place as f64 / PERIOD as f64;
                instance.set_real(&[set], &[input.0 + input.1 * phase.sin()]).unwrap();
                assert_eq!(instance.do_step(n as f64 * STEP, STEP).unwrap(), StepOutcome::Ok);
                n += 1;
                instance.get_real(&[read], std::slice::from_mut(output)).unwrap();
            }
            if period == periods / 10 {
                early.clone_from(&outputs);
            }
        },
    );
    assert!(grown < 500, "{grown} kB more in one instance");
    let time = instance.last_successful_time().unwrap().unwrap();
    assert!(
        (time / (n as f64 * STEP) - 1.0).abs() < 1e-12,
        "its clock says {time} s after {n} steps"
    );
    let spread = |values: &[f64]| {
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
        high - low
    };
    assert!(spread(&early) > 0.0, "the output moves");
    let drift = early
        .iter()
        .zip(&outputs)
        .map(|(early, late)| (early - late).abs())
        .fold(0.0, f64::max);
    println!(
        "largest difference of the output {drift:e}, of a movement of {:e}",
        spread(&early)
    );
    drift / spread(&early)
}

/// Both FMUs; the line in its own modes, whose steps are exact at any length, damped so that its start dies out.
fn hours(hours: f64) {
    let text = include_str!("../../scenes/tram-single-wire.toml");
    let (text, _) = text.split_once("[ranges]").unwrap();
    let modal = [
        "catenary.spans=2",
        "catenary.mesh={ elements_per_interval = 2 }",
        "run.start_x=5",
        "run.duration=1.0",
        "run.evaluate={ time = [0.0, 1.0] }",
        "run.speed_kmh=0.001",
        "solver.micro_step=0.01",
        "model.reduce=[\"modal\"]",
        "catenary.damping.alpha=1",
    ];
    let small = Packaged::new(text, &modal);
    let force = small.scene.pantographs[0].start.expect("resolved").force;
    let height = small.scene.pantographs[0].start.expect("resolved").height;
    let drift = long(
        &small.open("Pantograph"),
        ("contact[1].fz", "strip[1].z"),
        (-force, 5.0),
        hours,
    );
    assert!(drift < 1e-6, "Pantograph: {drift} of the movement");
    let drift = long(
        &small.open("Catenary"),
        ("strip[1].z", "contact[1].force"),
        (height, 2e-4),
        hours,
    );
    // Modes work in single precision.
    assert!(drift < 2e-3, "Catenary: {drift} of the movement");
}

#[test]
fn instances_processes_and_hours_leave_nothing_behind() {
    let _process = super::alone();
    cycles(200);
    starts(20);
    hours(0.1);
}

#[test]
#[ignore = "for many minutes: 10 000 cycles, 2 000 isolated starts, 8 hours of simulated time"]
fn attack_by_time() {
    let _process = super::alone();
    cycles(10_000);
    starts(2_000);
    hours(8.0);
}
