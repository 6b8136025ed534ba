//! A supplied pantograph, written in C, and our own FMUs as if they were supplied.
#![cfg(unix)]

#[path = "supplied/program.rs"]
mod program;
mod running;

use std::path::{Path, PathBuf};
use std::process::Command;

use cosim::chain;
use cosim::package::{self, Libraries};
use fmi2::archive::Package;
use fmi2::model_description::{
    BaseUnit, DefaultExperiment, EnumerationItem, Kind, ModelDescription, TypeDefinition, TypeShape, Unit, Variable,
};
use results::Record;
use scene::Scene;
use simulation::{Finished, Mode, SetupError, prepare};

/// Traits of an FMU: defines of the C file, and statements of its description.
#[derive(Clone, Copy, Default)]
struct Manners {
    defines: &'static [&'static str],
    /// The only step.
    step: Option<f64>,
    /// Claims that it cannot go back.
    modest: bool,
    units: bool,
    /// Without units or start values.
    silent: bool,
}

fn unit(name: &str, si: &str, factor: f64) -> Unit {
    let base = Unit::from_name(si).unwrap().base.unwrap();
    Unit {
        name: name.to_owned(),
        base: Some(BaseUnit { factor, ..base }),
        display_units: Vec::new(),
    }
}

fn description(manners: Manners) -> ModelDescription {
    let [force, length, speed] = if manners.units {
        ["kN", "mm", "km/h"]
    } else {
        ["N", "m", "m/s"]
    };
    let start = if manners.units { 0.12 } else { 120.0 };
    let start = if manners.defines.contains(&"LIFTS") {
        -start
    } else {
        start
    };
    let mut mode = Variable::integer_parameter("mode", 1, "How strong it is");
    mode.kind = Kind::Enumeration { start: Some(1) };
    mode.declared_type = Some("Mode".to_owned());
    let mut variables = vec![
        Variable::input("F_c", force, start, "Contact force"),
        Variable::output("Wippe.z1", length, "Height of the head above its start"),
        Variable::output("Wippe.v1", speed, "Velocity of the head"),
        Variable::parameter("F_rest", "N", 120.0, "Static force"),
        mode,
    ];
    if manners.silent {
        for variable in &mut variables[..3] {
            if let Kind::Real { attributes, .. } = &mut variable.kind {
                attributes.unit = None;
            }
        }
    }
    let mut description = ModelDescription::of_slave("Somebody", variables);
    description.units = vec![
        unit("N", "N", 1.0),
        unit("m", "m", 1.0),
        unit("m/s", "m/s", 1.0),
        unit("kN", "N", 1e3),
        unit("mm", "m", 1e-3),
        unit("km/h", "m/s", 1.0 / 3.6),
    ];
    let item = |name: &str, value| EnumerationItem {
        name: name.to_owned(),
        value,
    };
    description.types.push(TypeDefinition {
        name: "Mode".to_owned(),
        description: None,
        shape: TypeShape::Enumeration(vec![item("normal", 1), item("strong", 3)]),
    });
    let claims = &mut description.co_simulation;
    claims.can_get_and_set_fmu_state = !manners.modest;
    claims.can_serialize_fmu_state = false;
    claims.provides_directional_derivative = false;
    claims.can_handle_variable_communication_step_size = manners.step.is_none();
    description.default_experiment = manners.step.map(|step| DefaultExperiment {
        step_size: Some(step),
        ..DefaultExperiment::default()
    });
    description
}

/// `Somebody.fmu` in `folder`.
fn made(folder: &Path, manners: Manners) -> PathBuf {
    let library = folder.join("somebody.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/supplied.c");
    let mut cc = Command::new(std::env::var_os("CC").unwrap_or("cc".into()));
    cc.args(["-O2", "-shared", "-fPIC", "-o"]).arg(&library).arg(source);
    cc.args(manners.defines.iter().map(|define| format!("-D{define}")))
        .arg("-lm");
    assert!(cc.status().expect("a C compiler, which fmi2 needs as well").success());
    let package = Package {
        description: description(manners).to_xml(),
        library: std::fs::read(&library).unwrap(),
        ..Package::default()
    };
    let path = folder.join("Somebody.fmu");
    package.write(&path).unwrap();
    path
}

/// A line of three spans on a coarse mesh: what is tested here does not depend on its accuracy.
fn base() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let short = [
        "catenary.spans=3",
        "catenary.mesh.elements_per_interval=1",
        "run.duration=0.4",
        "run.evaluate={ time = [0.1, 0.4] }",
    ];
    system::load(&text, "en50318-250.toml", &short.map(str::to_owned)).unwrap()
}

/// The text of a scene with the table that begins with `header`, and its sub-tables, replaced.
fn replaced(scene: &Scene, header: &str, table: &str) -> String {
    let toml = scene.to_toml();
    let (mut text, mut skipping) = (String::new(), false);
    let name = header.trim_matches(['[', ']']);
    for line in toml.lines() {
        if line.starts_with('[') {
            let own = line.trim_matches(['[', ']']);
            skipping = own == name || own.starts_with(&format!("{name}."));
        }
        if !skipping {
            text.push_str(line);
            text.push('\n');
        }
    }
    format!("{text}\n{table}\n")
}

const WIRED: &str = "[[pantograph]]\nfmu = \"Somebody.fmu\"\n\
    inputs = { force = { variable = \"F_c\" } }\n\
    outputs = { height = { variable = \"Wippe.z1\", offset = \"align\" }, velocity = { variable = \"Wippe.v1\" } }\n";

fn scene(table: &str, overrides: &[&str]) -> Scene {
    let text = replaced(&base(), "[[pantograph]]", table);
    let overrides: Vec<String> = overrides.iter().map(|key| (*key).to_owned()).collect();
    system::load(&text, "scene.toml", &overrides).unwrap()
}

fn finished(folder: &Path, scene: Scene, mode: Mode) -> Result<Finished, String> {
    let said = |error: &SetupError| {
        assert!(error.is_input(), "the input is to blame: {error:?}");
        chain(error)
    };
    let prepared = prepare(scene, "test", folder, false).map_err(|error| said(&error))?;
    running::finished(prepared, folder, mode, |_| {}).map_err(|error| chain(&error))
}

/// The record of a run that came to its end, its notes and the reason of its algorithm.
fn run(folder: &Path, scene: Scene) -> (Record, String) {
    let finished = finished(folder, scene, Mode::Inprocess).unwrap();
    assert!(finished.info.complete, "{}", finished.info.incomplete_reason);
    let notes = format!("{}\n{}", finished.info.notes.join("\n"), finished.info.coupling.reason);
    (finished.record, notes)
}

fn with(manners: Manners, table: &str, overrides: &[&str]) -> (Record, String) {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), manners);
    run(folder.path(), scene(table, overrides))
}

fn refusal(manners: Manners, table: &str, overrides: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), manners);
    finished(folder.path(), scene(table, overrides), Mode::Inprocess)
        .err()
        .expect("it is refused")
}

fn rms(a: &Record, b: &Record) -> f64 {
    let (a, b) = (&a.pantographs[0].force, &b.pantographs[0].force);
    assert_eq!(a.len(), b.len());
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

fn spread(record: &Record) -> f64 {
    let force = &record.pantographs[0].force;
    force.iter().fold(0.0, |most: f64, f| most.max((f - force[0]).abs()))
}

#[test]
fn the_same_physics_from_somebody_else_gives_the_same_force() {
    let folder = tempfile::tempdir().unwrap();
    let mut own = base();
    let statics = catenary::static_line(&own).unwrap();
    let height = system::equilibrium::wire_height(&own, &statics, 0, 0.0).unwrap();
    system::equilibrium::resolve(&mut own, &statics).unwrap();
    let (own, _) = run(folder.path(), own);
    // The springs of both are unstretched at the height of the wire.
    let table = WIRED.replace("\"align\"", &height.to_string());
    let (other, notes) = with(Manners::default(), &table, &[]);
    assert!(spread(&own) > 10.0);
    // Ours steps internally by 1 ms with order 2 and numerical damping, this one by 0.1 ms with order 4.
    let difference = rms(&own, &other);
    assert!(difference < 0.3, "{difference} N");
    assert!(
        notes.contains("came to rest") && notes.contains("steps) while settling"),
        "{notes}"
    );
}

#[test]
fn units_are_converted_and_the_wiring_guessed() {
    let (si, _) = with(Manners::default(), WIRED, &[]);
    let other = Manners {
        defines: &["UNITS"],
        units: true,
        ..Manners::default()
    };
    let (converted, _) = with(other, WIRED, &[]);
    // Rounding, which droppers and contact enlarge.
    assert!(rms(&si, &converted) < 1e-4, "{} N", rms(&si, &converted));
    let guessed = "[[pantograph]]\nfmu = \"Somebody.fmu\"\n\
        outputs = { height = { variable = \"Wippe.z1\", offset = \"align\" }, velocity = { variable = \"Wippe.v1\" } \
        }\n";
    assert!(rms(&si, &with(other, guessed, &[]).0) < 1e-4);
    // Without units ours are meant.
    let silent = Manners {
        silent: true,
        ..Manners::default()
    };
    assert!(rms(&si, &with(silent, WIRED, &[]).0) < 1e-4);
}

#[test]
fn wirings_that_contradict_units_or_signs_are_refused() {
    let wire = |force: &str, height: &str| {
        format!(
            "[[pantograph]]\nfmu = \"Somebody.fmu\"\ninputs = {{ force = {force} }}\n\
             outputs = {{ height = {height} }}\n"
        )
    };
    let (force, height) = (
        "{ variable = \"F_c\" }",
        "{ variable = \"Wippe.z1\", offset = \"align\" }",
    );
    let text = refusal(Manners::default(), &wire(force, "{ variable = \"Wippe.v1\" }"), &[]);
    let expected = "Wippe.v1 [m/s] is wired to height [m]: these are different quantities";
    assert!(
        text.contains("pantograph[1].outputs.height") && text.contains(expected),
        "{text}"
    );
    let kn = Manners {
        defines: &["UNITS"],
        units: true,
        ..Manners::default()
    };
    let text = refusal(kn, &wire("{ variable = \"F_c\", factor = -1 }", height), &[]);
    assert!(
        text.contains("factor = -1 contradicts the units: must be -0.001, or left out"),
        "{text}"
    );
    let lifts = Manners {
        defines: &["LIFTS"],
        ..Manners::default()
    };
    let text = refusal(lifts, &wire(force, height), &[]);
    assert!(
        text.contains("inputs.force") && text.contains("must be factor = -1"),
        "{text}"
    );
    let turned = wire("{ variable = \"F_c\", factor = -1 }", height);
    let (record, _) = with(lifts, &turned, &[]);
    assert!(rms(&record, &with(Manners::default(), &wire(force, height), &[]).0) < 1e-4);
    let missing = wire("{ variable = \"F_k\" }", height);
    let text = refusal(Manners::default(), &missing, &[]);
    assert!(
        text.contains("inputs.force.variable") && text.contains("did you mean \"F_c\"?"),
        "{text}"
    );
}

#[test]
fn a_velocity_that_is_not_offered_is_derived_with_order_two() {
    let without = "[[pantograph]]\nfmu = \"Somebody.fmu\"\ninputs = { force = { variable = \"F_c\" } }\n\
        outputs = { height = { variable = \"Wippe.z1\", offset = \"align\" } }\n";
    let error = |macro_step: &str| {
        let keys = [macro_step, "catenary.mesh.corrections=none"];
        let (offered, _) = with(Manners::default(), WIRED, &keys);
        let (derived, notes) = with(Manners::default(), without, &keys);
        assert!(
            notes.contains("it offers no velocity: derived") && notes.contains("order 2"),
            "{notes}"
        );
        rms(&offered, &derived)
    };
    let (coarse, fine) = (error("coupling.macro_step=0.004"), error("coupling.macro_step=0.002"));
    assert!(coarse < 0.1, "{coarse} N");
    assert!(fine < coarse / 2.5, "{coarse} N at 4 ms, {fine} N at 2 ms");
}

#[test]
fn one_step_only_is_cut_into_or_refused_with_both_steps_named() {
    let fixed = Manners {
        defines: &["FIXED"],
        step: Some(2.5e-4),
        modest: true,
        ..Manners::default()
    };
    let (any, _) = with(Manners::default(), WIRED, &[]);
    let (cut, notes) = with(fixed, WIRED, &[]);
    assert!(
        notes.contains("it takes steps of 0.00025 s only, 4 of them per macro step"),
        "{notes}"
    );
    assert!(rms(&any, &cut) < 0.02, "{} N", rms(&any, &cut));
    // A duration that is no multiple: the last step is as long as the others, the record ends where it should.
    let (odd, _) = with(
        fixed,
        WIRED,
        &["run.duration=0.3006", "run.evaluate={ time = [0.1, 0.3] }"],
    );
    assert_eq!(odd.time.len(), 301);
    let text = refusal(fixed, WIRED, &["coupling.macro_step=0.0006"]);
    assert!(
        text.contains("coupling.macro_step = 0.0006 s") && text.contains("steps of 0.00025 s only"),
        "{text}"
    );
    // What the description says is not what it does: the first step tells.
    let liar = Manners {
        step: Some(1e-3),
        ..fixed
    };
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), liar);
    let text = finished(folder.path(), scene(WIRED, &[]), Mode::Inprocess)
        .err()
        .expect("it fails");
    assert!(
        text.contains("Somebody.fmu") && text.contains("over 0.001 s failed"),
        "{text}"
    );
}

#[test]
fn claims_that_do_not_hold_are_not_built_on() {
    let inexact = Manners {
        defines: &["INEXACT", "IGNORES"],
        ..Manners::default()
    };
    let linear = ["coupling.algorithm=gauss_seidel", "coupling.force=interpolated"];
    let (_, notes) = with(inexact, WIRED, &linear);
    assert!(
        notes.contains("it claims canGetAndSetFMUstate, which does not hold"),
        "{notes}"
    );
    assert!(
        notes.contains("it claims canInterpolateInputs, which does not hold"),
        "{notes}"
    );
    assert!(notes.contains("takes no input derivatives"), "{notes}");
    // An algorithm that repeats steps makes each of them once, and says so.
    let (_, notes) = with(inexact, WIRED, &["coupling.algorithm=\"iterated\""]);
    let said = "cannot go back to a saved state: one pass per step";
    assert!(notes.contains(said), "{notes}");
    let honest = Manners::default();
    let (_, notes) = with(honest, WIRED, &["coupling.algorithm=\"iterated\""]);
    assert!(!notes.contains("does not hold"), "{notes}");
}

#[test]
fn failures_name_the_fmu_the_variable_and_the_remedy() {
    for (define, expected) in [
        ("NOT_A_NUMBER", " = NaN at t = 0.1"),
        (
            "DISCARD",
            "fmi2DoStep returned fmi2Discard; it cannot go back to try a shorter step: use a smaller \
             coupling.macro_step",
        ),
    ] {
        let manners = Manners {
            defines: if define == "DISCARD" {
                &["DISCARD"]
            } else {
                &["NOT_A_NUMBER"]
            },
            modest: true,
            ..Manners::default()
        };
        let folder = tempfile::tempdir().unwrap();
        made(folder.path(), manners);
        let said = match finished(folder.path(), scene(WIRED, &[]), Mode::Inprocess) {
            Ok(finished) => {
                assert!(
                    !finished.info.complete && finished.record.time.len() > 50,
                    "results are kept"
                );
                finished.info.incomplete_reason
            }
            Err(said) => said,
        };
        assert!(
            said.contains("pantograph 1 (Somebody.fmu)") && said.contains(expected),
            "{said}"
        );
    }
}

#[test]
fn a_refused_stop_time_is_left_out_and_enumerations_are_set_by_name() {
    let manners = Manners {
        defines: &["NO_STOP"],
        ..Manners::default()
    };
    let (_, notes) = with(manners, WIRED, &[]);
    assert!(notes.contains("refuses the stop time"), "{notes}");
    let strong = format!("{WIRED}parameters = {{ mode = \"strong\" }}\n");
    let (record, _) = with(Manners::default(), &strong, &[]);
    let start = record.pantographs[0].force[0];
    assert!((start - 150.0).abs() < 5.0, "{start} N");
    let wrong = format!("{WIRED}parameters = {{ mode = \"weak\" }}\n");
    let text = refusal(Manners::default(), &wrong, &[]);
    assert!(
        text.contains("\"mode\" = \"weak\" must be one of \"normal\" (1), \"strong\" (3)"),
        "{text}"
    );
}

#[test]
fn our_own_line_as_somebody_elses_gives_the_same_force() {
    let folder = tempfile::tempdir().unwrap();
    let mut own = base();
    let statics = catenary::static_line(&own).unwrap();
    system::equilibrium::resolve(&mut own, &statics).unwrap();
    package::ensure(&own, &Libraries::find().unwrap(), folder.path()).unwrap();
    let (expected, _) = run(folder.path(), own.clone());
    let without_contact = |table: &str| {
        let text = replaced(&own, "[catenary]", table);
        let scene = system::load(&text.replace("[contact]", "[unused]"), "line.toml", &[]);
        assert!(scene.is_err(), "only to see that the table is there");
        let (mut kept, mut skipping) = (String::new(), false);
        for line in text.lines() {
            if line.starts_with('[') {
                skipping = line == "[contact]";
            }
            if !skipping {
                kept.push_str(line);
                kept.push('\n');
            }
        }
        system::load(&kept, "line.toml", &[]).unwrap()
    };
    // All that it offers, by the names that are guessed.
    let whole = without_contact("[catenary]\nfmu = \"Catenary.fmu\"\n");
    let (record, notes) = run(folder.path(), whole.clone());
    assert!(notes.contains("line: supplied FMU"), "{notes}");
    let difference = rms(&expected, &record);
    assert!(difference < 1e-3, "after half a second of settling: {difference} N");
    // The least that a line must offer: the mean is a trapezoid, the wire's way derived.
    let least = "[catenary]\nfmu = \"Catenary.fmu\"\n[catenary.inputs]\n\"strip[1].x\" = { variable = \"strip[1].x\" \
        }\n\
        \"strip[1].z\" = { variable = \"strip[1].z\" }\n\"strip[1].vz\" = { variable = \"strip[1].vz\" }\n\
        \"strip[1].vx\" = { variable = \"strip[1].vx\" }\n[catenary.outputs]\n\
        \"contact[1].force\" = { variable = \"contact[1].force\" }\n\
        \"support[2].uplift\" = { variable = \"support[2].uplift\" }\n";
    let (record, notes) = run(folder.path(), without_contact(least));
    assert!(notes.contains("it offers no mean force"), "{notes}");
    let difference = rms(&expected, &record);
    assert!(
        difference < 0.05 * spread(&expected),
        "{difference} N of {} N",
        spread(&expected)
    );
    assert_eq!(record.supports[0].number, 2);
    assert!(record.supports[0].uplift.iter().any(|uplift| *uplift > 1e-4));
    // As FMUs throughout, and what has no meaning without the line's geometry is refused by name.
    let finished_run = finished(folder.path(), whole.clone(), Mode::Cosimulation).unwrap();
    assert!(finished_run.info.complete, "{}", finished_run.info.incomplete_reason);
    let text = finished(folder.path(), whole.clone(), Mode::Monolithic).err().unwrap();
    assert!(text.contains("no equations"), "{text}");
    let mut spans = whole;
    spans.run.evaluate = scene::Evaluate::Spans { first: 1, last: 2 };
    let text = finished(folder.path(), spans, Mode::Inprocess).err().unwrap();
    assert!(
        text.contains("run.evaluate") && text.contains("time = [from, to]"),
        "{text}"
    );
}
