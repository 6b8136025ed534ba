//! The two FMUs in FMPy: packages them, writes down the core's results for the same inputs, and runs `tests/fmpy`.
use component::{Causality, Component};
use cosim::package::{Libraries, archives};
use integration_tests::fmus::{COARSE, DEFAULT, Packaged, THESIS, tree};
use integration_tests::python::{environment, run};
use integration_tests::runs::EN_250;
use scene::{PantographModel, Scene};
use simulation::Mode;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Value and three derivatives of an input at time `t` in s, from its start value.
type Stimulus = fn(name: &str, start: f64, t: f64) -> [f64; 4];

/// `a sin(w t)` and its derivatives.
fn sine(a: f64, w: f64, t: f64) -> [f64; 4] {
    let (sin, cos) = (w * t).sin_cos();
    [a * sin, a * w * cos, -a * w * w * sin, -a * w * w * w * cos]
}

/// A strip that travels at 60 m/s, presses by 2 mm more than at the start and moves up and down by 20 mm.
fn strip(name: &str, start: f64, t: f64) -> [f64; 4] {
    let heave = sine(0.08, 8.0, t);
    match name.rsplit('.').next() {
        Some("x") => [start + 60.0 * t, 60.0, 0.0, 0.0],
        Some("vx") => [60.0, 0.0, 0.0, 0.0],
        Some("z") => [
            start + 0.002 + 0.01 * (1.0 - (8.0 * t).cos()),
            heave[0],
            heave[1],
            heave[2],
        ],
        Some("vz") => heave,
        Some("y") => sine(0.1, 3.0, t),
        Some("vy") => [sine(0.1, 3.0, t)[1], sine(0.1, 3.0, t)[2], sine(0.1, 3.0, t)[3], 0.0],
        _ => sine(0.01, 5.0, t),
    }
}

/// A contact force around that of the start.
fn load(name: &str, start: f64, t: f64) -> [f64; 4] {
    let [value, rates @ ..] = match name {
        "contact[1].fx" => sine(5.0, 7.0, t),
        "contact[1].fz" => sine(-40.0, 8.0, t),
        "contact[1].y" => sine(0.2, 2.0, t),
        _ => [0.0; 4],
    };
    [start + value, rates[0], rates[1], rates[2]]
}

/// Plan of a trajectory.
#[derive(Clone, Copy)]
struct Plan {
    name: &'static str,
    step: f64,
    steps: usize,
    /// Number of input derivatives that are given.
    order: usize,
}

const PLANS: [Plan; 2] = [
    Plan {
        name: "plain",
        step: 1e-3,
        steps: 200,
        order: 0,
    },
    Plan {
        name: "derivatives",
        step: 4e-3,
        steps: 40,
        order: 3,
    },
];

/// Writes inputs and the outputs of the core, at the same times, as two tables.
fn write_trajectory<C: Component>(scene: &Scene, plan: Plan, stimulus: Stimulus, folder: &Path) {
    let signals = C::signals(scene);
    let of = |role: Causality| -> Vec<usize> { (0..signals.len()).filter(|&k| signals[k].causality == role).collect() };
    let (inputs, outputs) = (of(Causality::Input), of(Causality::Output));
    let mut component = C::build(scene).unwrap();
    let (mut given, mut expected) = (String::from("time"), String::from("time"));
    for &input in &inputs {
        write!(given, ",{}", signals[input].name).unwrap();
        for order in 1..=plan.order {
            write!(given, ",{}|{order}", signals[input].name).unwrap();
        }
    }
    for &output in &outputs {
        write!(expected, ",{}", signals[output].name).unwrap();
    }
    for n in 0..=plan.steps {
        let t = n as f64 * plan.step;
        let mut apply = |component: &mut C| {
            write!(given, "\n{t:?}").unwrap();
            for &input in &inputs {
                let values = stimulus(&signals[input].name, signals[input].start, t);
                component.set_input(input, values[0]);
                for (order, &value) in values.iter().enumerate().take(plan.order + 1) {
                    write!(given, ",{value:?}").unwrap();
                    if order > 0 {
                        component.set_input_derivative(input, order, value);
                    }
                }
            }
        };
        if n == 0 {
            // The first row holds the outputs with the first inputs, as they are at the end of the initialisation.
            apply(&mut component);
        }
        write!(expected, "\n{t:?}").unwrap();
        for &output in &outputs {
            write!(expected, ",{:?}", component.output(output)).unwrap();
        }
        if n > 0 {
            apply(&mut component);
        }
        if n < plan.steps {
            component.do_step(t, (n + 1) as f64 * plan.step - t).unwrap();
        }
    }
    let file = |what: &str| folder.join(format!("{}.{}.{what}.csv", C::IDENTIFIER, plan.name));
    fs::write(file("inputs"), given).unwrap();
    fs::write(file("outputs"), expected).unwrap();
}

/// Scenes for the parameter `scene`, and the parameters that do the same.
fn write_other_scenes(scene: &Scene, plain: &str, folder: &Path) {
    let mut other = scene.clone();
    other.contact.as_mut().unwrap().stiffness = 80_000.0;
    let (parameter, value) = match &mut other.pantographs[0].model {
        PantographModel::Lumped(lumped) => {
            lumped.masses[0] = 9.0;
            ("masses[1]", 9.0)
        }
        PantographModel::Linkage(linkage) => {
            linkage.uplift.force = 1480.0;
            ("uplift.force", 1480.0)
        }
        PantographModel::Supplied(_) => unreachable!("the shipped scenes have pantographs of their own"),
    };
    let same = serde_json::json!({ "Catenary": { "contact.stiffness": 80_000.0 }, "Pantograph": { parameter: value } });
    fs::write(folder.join("other.json"), same.to_string()).unwrap();
    fs::write(folder.join("other.toml"), other.to_toml()).unwrap();
    fs::write(folder.join("plain.toml"), plain).unwrap();
    let (line, _) = scene
        .modelled_line()
        .expect("the shipped scenes have lines of their own");
    let longer = match line.tension_lengths.as_slice() {
        [_] => {
            let overrides = [format!("catenary.spans={}", line.spans() + 2)];
            system::load(&scene.to_toml(), "longer.toml", &overrides).unwrap()
        }
        // Spans of several tension lengths have tables each: another line in their place.
        _ => system::load(TWIN, "longer.toml", &[]).unwrap(),
    };
    fs::write(folder.join("longer.toml"), longer.to_toml()).unwrap();
}

/// The pair as a system structure, and the contact force of the master where both sides step at once with held inputs.
fn write_system(text: &str, overrides: &[&str], name: &str, folder: &Path) {
    let plain = [
        "coupling.algorithm=jacobi",
        "coupling.extrapolation=0",
        "coupling.force=end",
        "coupling.macro_step=0.001",
        "run.duration=0.2",
        "run.evaluate={ time = [0.1, 0.2] }",
    ];
    let scene = integration_tests::runs::scene_with(text, &[overrides, &plain[..]].concat());
    let run = integration_tests::runs::run(scene.clone(), Mode::Cosimulation, &format!("ssp-{name}"));
    let mut table = String::from("time,force");
    for (time, force) in run.record.time.iter().zip(&run.record.pantographs[0].force) {
        write!(table, "\n{time:?},{force:?}").unwrap();
    }
    fs::write(folder.join("system.jacobi.csv"), table).unwrap();
    let scene = integration_tests::runs::prepared(scene, name).scene;
    let own = archives(&scene, &Libraries::find().unwrap()).unwrap();
    let path = folder.join("system.ssp");
    let exported = suppliers::ssp::export(&scene, name, &own, Path::new("."), &[], &path).unwrap();
    assert!(exported.notes.is_empty(), "{:?}", exported.notes);
    fs::write(path, exported.archive).unwrap();
}

/// A line with stitch wires, whose elements have coordinates that do not follow each other.
const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
/// Lines whose strips touch two contact wires.
const TWIN: &str = include_str!("../scenes/dc-twin-wire.toml");
const OVERLAP: &str = include_str!("../scenes/overlap.toml");
const IN_THE_OVERLAP: &[&str] = &[
    "catenary.mesh.elements_per_interval=1",
    "run.start_x=290",
    "run.duration=3",
    "run.evaluate={ time = [1, 2] }",
];
const SHORT_AND_COARSE: &[&str] = &[
    "catenary.mesh.elements_per_interval=1",
    "catenary.spans=8",
    "run.duration=3",
    "run.evaluate={ time = [1, 2] }",
];

#[test]
fn both_fmus_pass_the_checks_in_fmpy() {
    let interpreter = environment("fmpy", &tree().join("tests/fmpy/requirements.txt"));
    let data = tempfile::tempdir().unwrap();
    for (name, text, overrides) in [
        ("en50318", EN_250, COARSE),
        ("thesis", THESIS, &[]),
        ("stitched", STITCHED, SHORT_AND_COARSE),
        ("twin", TWIN, SHORT_AND_COARSE),
        ("overlap", OVERLAP, IN_THE_OVERLAP),
    ] {
        let folder = data.path().join(name);
        fs::create_dir(&folder).unwrap();
        let fmus = Packaged::new(text, overrides);
        for plan in PLANS {
            write_trajectory::<catenary::Subsystem>(&fmus.scene, plan, strip, &folder);
            write_trajectory::<vehicle::Subsystem>(&fmus.scene, plan, load, &folder);
        }
        let given = integration_tests::runs::scene_with(text, overrides);
        write_system(text, overrides, name, &folder);
        write_other_scenes(&fmus.scene, &given.to_toml(), &folder);
        for identifier in ["Catenary", "Pantograph"] {
            fs::copy(fmus.path(identifier), folder.join(format!("{identifier}.fmu"))).unwrap();
        }
    }
    // The side that carries vehicle and track; its line is that of the scene before.
    let folder = data.path().join("vehicle");
    fs::create_dir(&folder).unwrap();
    fs::copy(
        Packaged::new(DEFAULT, &[]).path("Pantograph"),
        folder.join("Pantograph.fmu"),
    )
    .unwrap();
    let text = run(
        Command::new(interpreter)
            .current_dir(data.path())
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .args([
                "-m",
                "pytest",
                "-q",
                "-p",
                "no:cacheprovider",
                "--durations=5",
                "--data",
            ])
            .arg(data.path())
            .arg(tree().join("tests/fmpy")),
        "tests/fmpy",
    );
    print!("{text}");
    assert!(text.contains(" passed") && !text.contains("skipped"), "{text}");
}
