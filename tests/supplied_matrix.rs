//! Pantograph FMUs that are awkward or broken, tried with `master run` and `master inspect`. Each gives a right result,
//! or a message with the FMU, the problem and the remedy; the program itself neither crashes nor hangs.
//!
//! | class | the FMU |
//! | --- | --- |
//! | D1 | accepts one communication step only |
//! | D2 | cannot go back to a saved state |
//! | D3 | claims abilities that it lacks: states come back wrong or not at all, wrong derivatives or dependencies |
//! | D4 | says nothing about dependencies, units and start values |
//! | D5 | uses all that the schema allows: odd names, annotations, a byte order mark, aliases, enumerations |
//! | D6 | starts at a height that does not fit the line |
//! | D7 | refuses a start time that is negative, or not zero |
//! | D8 | reads its resources, changes the current directory, or depends on it |
//! | D9 | logs through the variable arguments, without category, from another thread |
//! | D10 | returns Warning, Discard, Error or Fatal from a step |
//! | D11 | returns values that are not numbers |
//! | D12 | crashes, aborts, exits or never returns |
//!
//! The FMU is `tests/suppliers/pantograph.c`, whose macros choose its behaviour. Its good form gives the reference.
use integration_tests::installed::{Ended, Program};
use integration_tests::runs::rms;
use integration_tests::vendor::{Pantograph, under_the_line};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Name of the FMU in messages, at least: its file is `two_mass.fmu`.
const NAME: &str = "two_mass";

/// Start of all these pantographs: contact closed, nearly in balance.
const PARAMETERS: &str = "parameters = { start_height = 5.345 }\n";

/// Reason of the coupling when a side cannot be taken back.
const ONE_PASS: &str = "cannot go back to a saved state: one pass per step";

/// Without the FMI layer on our side: faster, and the other side is the same.
const HERE: [&str; 2] = ["--mode", "inprocess"];

/// Pantograph beside the program.
struct Tried {
    program: Program,
    fmu: PathBuf,
}

impl Tried {
    fn new(pantograph: &Pantograph) -> Self {
        let program = Program::new();
        let fmu = pantograph.write(program.folder(), "two_mass");
        Self { program, fmu }
    }

    fn run_with(&self, table: &str, sets: &[&str]) -> Ended {
        let scene = self
            .program
            .scene("tried", &under_the_line(Path::new("two_mass.fmu"), table));
        let mut arguments = HERE.to_vec();
        for set in sets {
            arguments.extend(["--set", set]);
        }
        self.program.run(&scene, &arguments)
    }

    fn run(&self) -> Ended {
        self.run_with(PARAMETERS, &[])
    }

    /// `inspect` as text and as JSON, with the wiring that it guesses.
    fn inspect(&self) -> (String, serde_json::Value) {
        let path = self.fmu.to_str().unwrap();
        let text = self.program.call(&["inspect", path]).done().stdout;
        let json = self.program.call(&["inspect", path, "--json"]).done().stdout;
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert!(
            text.contains("[[pantograph]]") || text.contains("no variable is recognised"),
            "{text}"
        );
        (text, json)
    }
}

/// Contact force with the pantograph as it should be, N.
fn good_force(sets: &[&str]) -> Vec<f64> {
    static KNOWN: Mutex<BTreeMap<String, Vec<f64>>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let force = known
        .entry(sets.join(" "))
        .or_insert_with(|| Tried::new(&Pantograph::new()).run_with(PARAMETERS, sets).done().force());
    force.clone()
}

/// The results up to a failure are there: rows before `t` s, none after it, marked incomplete.
fn keeps_results(ended: &Ended, t: f64) {
    let summary = ended.summary();
    assert_eq!(summary["complete"], false, "{ended}");
    let time = ended.series("time");
    let last = *time.last().expect("rows before the failure");
    assert!(
        (last - t).abs() < 0.0021,
        "the last row is at {last} s, the failure at {t} s\n{ended}"
    );
    let good = good_force(&[]);
    for (t, (kept, good)) in time.iter().zip(ended.force().iter().zip(&good)) {
        assert!(
            (kept - good).abs() < 1e-9,
            "{kept} N at {t} s, {good} N with a pantograph that does not fail"
        );
    }
}

// D1 ------------------------------------------------------------------------------------------------------------------

/// 1 ms, and nothing else.
fn of_one_step() -> Pantograph {
    Pantograph::new()
        .saying(
            "canHandleVariableCommunicationStepSize=\"true\"",
            "canHandleVariableCommunicationStepSize=\"false\"",
        )
        .built_with(&["ONLY_STEP=1e-3"])
}

#[test]
fn d1_a_pantograph_of_one_step_runs_with_that_step_to_the_end() {
    let tried = Tried::new(&of_one_step());
    assert_eq!(tried.run().done().force(), good_force(&[]));
    // A duration that is no multiple of the step is no reason for another step.
    let longer = tried.run_with(PARAMETERS, &["run.duration=0.3005"]).done();
    assert!(rms(&longer.force()[..300], &good_force(&[])[..300]) < 1e-9);
    // The phase at rest is no reason either.
    let _ = tried.run_with(PARAMETERS, &["run.initialise=\"equilibrium\""]).done();
    let (text, json) = tried.inspect();
    assert!(text.contains("canHandleVariableCommunicationStepSize false"), "{text}");
    assert_eq!(json["capabilities"]["canHandleVariableCommunicationStepSize"], "false");
}

#[test]
fn d1_a_longer_macro_step_is_cut_into_that_step_and_a_shorter_one_is_refused() {
    let tried = Tried::new(&of_one_step());
    let longer = ["coupling.macro_step=0.002"];
    let force = tried.run_with(PARAMETERS, &longer).done().force();
    // Short steps follow the input that one long step holds: an error of second order in the macro step, on a force of
    // 200 N.
    let difference = rms(&force, &good_force(&longer));
    assert!(difference < 2.0, "{difference} N");
    let ended = tried.run_with(PARAMETERS, &["coupling.macro_step=0.0005"]);
    let _ = ended.refused(2, &[NAME, "macro_step", "0.001"]);
}

// D2 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d2_a_pantograph_without_rollback_is_never_taken_back() {
    let tried = Tried::new(&Pantograph::new().unable("canGetAndSetFMUstate", "ROLLBACK"));
    for algorithm in ["jacobi", "gauss_seidel"] {
        let set = format!("coupling.algorithm=\"{algorithm}\"");
        assert_eq!(tried.run_with(PARAMETERS, &[&set]).done().force(), good_force(&[&set]));
    }
    let summary = tried
        .run_with(PARAMETERS, &["coupling.algorithm=\"auto\""])
        .done()
        .summary();
    let reason = summary["coupling"]["reason"].as_str().unwrap();
    assert!(!reason.is_empty(), "{summary}");
    // A repeating algorithm makes each step once and says so: the rest is Gauss-Seidel.
    let iterated = tried.run_with(PARAMETERS, &["coupling.algorithm=\"iterated\""]).done();
    let summary = iterated.summary();
    let reason = summary["coupling"]["reason"].as_str().unwrap();
    assert!(reason.contains(ONE_PASS) && reason.contains("two_mass.fmu"), "{reason}");
    assert_eq!(summary["coupling"]["algorithm"], "gauss_seidel", "{summary}");
    assert_eq!(summary["cost"]["rollbacks"], 0);
    assert_eq!(iterated.force(), good_force(&["coupling.algorithm=\"gauss_seidel\""]));
    let (_, json) = tried.inspect();
    assert_eq!(json["capabilities"]["canGetAndSetFMUstate"], "false");
}

// D3 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d3_states_that_come_back_wrong_or_not_at_all_are_noticed() {
    for rollback in ["ROLLBACK=0", "ROLLBACK=2"] {
        let tried = Tried::new(&Pantograph::new().built_with(&[rollback]));
        let ended = tried.run_with(PARAMETERS, &["coupling.algorithm=\"iterated\""]);
        // The ability is not used: each step is made once, and the reason says so.
        let summary = ended.done().summary();
        let reason = summary["coupling"]["reason"].as_str().unwrap();
        assert!(reason.contains(ONE_PASS), "{reason}");
        assert_eq!(summary["cost"]["rollbacks"], 0);
        // Couplings without rollback are as good as ever.
        assert_eq!(tried.run().done().force(), good_force(&[]));
        let _ = tried.run_with(PARAMETERS, &["coupling.algorithm=\"auto\""]).done();
        let (text, _) = tried.inspect();
        assert!(text.contains("does not hold"), "{text}");
    }
}

#[test]
fn d3_wrong_derivatives_and_dependencies_change_nothing() {
    let lie = Pantograph::new().built_with(&["DERIVATIVES=2"]).saying(
        "<Unknown index=\"11\" dependencies=\"\"/>",
        "<Unknown index=\"11\" dependencies=\"1 2\" dependenciesKind=\"constant fixed\"/>",
    );
    for algorithm in ["gauss_seidel", "iterated", "auto"] {
        let set = format!("coupling.algorithm=\"{algorithm}\"");
        let force = Tried::new(&lie).run_with(PARAMETERS, &[&set]).done().force();
        let difference = rms(&force, &good_force(&[&set]));
        assert!(difference < 1e-3, "{algorithm}: {difference} N");
    }
    let _ = Tried::new(&lie).inspect();
}

#[test]
fn d3_input_derivatives_that_are_refused_against_the_flag_are_named_or_done_without() {
    let tried = Tried::new(&Pantograph::new().built_with(&["INTERPOLATE=0"]));
    let ended = tried.run_with(PARAMETERS, &["coupling.force=\"interpolated\""]);
    if ended.code != Some(0) {
        let _ = ended.failed(&[NAME, "fmi2SetRealInputDerivatives"]);
    }
}

// D4 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d4_a_description_without_dependencies_units_and_start_values_does() {
    let bare = Pantograph::new().described(|description| {
        let text = String::from_utf8(description).unwrap();
        let cut = |text: &str, from: &str, to: &str| {
            let (a, b) = (text.find(from).unwrap(), text.find(to).unwrap() + to.len());
            format!("{}{}", &text[..a], &text[b..])
        };
        let text = cut(&text, "<UnitDefinitions>", "</UnitDefinitions>");
        let text = cut(&text, "<InitialUnknowns>", "</InitialUnknowns>");
        let mut text = text.replace(" dependencies=\"\"", "");
        for unit in ["kg", "N/m", "N.s/m", "N", "m/s", "m"] {
            text = text.replace(&format!(" unit=\"{unit}\""), "");
        }
        for start in ["7.2", "15.0", "4200.0", "50.0", "10.0", "90.0", "120.0", "5.3"] {
            text = text.replace(&format!(" start=\"{start}\""), "");
        }
        assert!(!text.contains("unit=") && !text.contains("start="), "{text}");
        text.into_bytes()
    });
    let tried = Tried::new(&bare);
    let difference = rms(&tried.run().done().force(), &good_force(&[]));
    assert!(difference < 1e-9, "{difference} N");
    let _ = tried.run_with(PARAMETERS, &["run.initialise=\"equilibrium\""]).done();
    let (_, json) = tried.inspect();
    assert_eq!(json["wiring"]["inputs"]["force"], "F_c");
}

// D5 ------------------------------------------------------------------------------------------------------------------

/// A description with all that a tool may write.
fn ornate() -> Pantograph {
    Pantograph::new()
        .saying(
            "variableNamingConvention=\"structured\"",
            "variableNamingConvention=\"flat\"",
        )
        .saying(
            "name=\"F_c\"",
            "name=\"Kraft &lt;F&gt; [N], &quot;Schleifleiste&quot;\"",
        )
        .saying("name=\"z1\"", "name=\"'Höhe 高さ'.z[1]\"")
        .saying("name=\"v1\"", "name=\"der('Höhe 高さ'.z[1])\"")
        .saying("name=\"static.force\"", "name=\"statische Kraft\"")
        .saying(
            "<BaseUnit m=\"1\"/>",
            "<BaseUnit m=\"1\"/><DisplayUnit name=\"mm\" factor=\"1000\"/>",
        )
        .saying(
            "<DefaultExperiment",
            "<TypeDefinitions>
    <SimpleType name=\"Length\" description=\"a length\"><Real quantity=\"Length\" unit=\"m\" displayUnit=\"mm\" \
              min=\"0\"/></SimpleType>
    <SimpleType name=\"Kind\"><Enumeration><Item name=\"single\" value=\"1\"/><Item name=\"double\" value=\"2\" \
              description=\"two arms\"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name=\"logEvents\"/><Category name=\"logStatusError\" \
              description=\"errors\"/></LogCategories>
  <DefaultExperiment",
        )
        .saying(
            "<ModelVariables>",
            "<VendorAnnotations><Tool name=\"Vendor\"><v:data xmlns:v=\"urn:vendor\"><![CDATA[<not> & \
              xml]]></v:data></Tool></VendorAnnotations>
  <!-- a comment -->
  <ModelVariables>",
        )
        .saying(
            "causality=\"output\" description=\"Height of the strip above rail\"><Real unit=\"m\"/>",
            "causality=\"output\" description=\"Height of the strip above rail\"><Real declaredType=\"Length\" \
              nominal=\"5\"/><Annotations><Tool name=\"Vendor\"><x/></Tool></Annotations>",
        )
        .saying(
            "  </ModelVariables>",
            "    <ScalarVariable name=\"z1, alias\" valueReference=\"20\" causality=\"local\"><Real \
              declaredType=\"Length\"/></ScalarVariable>
    <ScalarVariable name=\"raised\" valueReference=\"30\" causality=\"input\" variability=\"discrete\"><Boolean \
              start=\"true\"/></ScalarVariable>
    <ScalarVariable name=\"kind\" valueReference=\"40\" causality=\"parameter\" variability=\"fixed\"><Enumeration \
              declaredType=\"Kind\" start=\"1\"/></ScalarVariable>
    <ScalarVariable name=\"serial number\" valueReference=\"50\" causality=\"parameter\" \
              variability=\"fixed\"><String start=\"\"/></ScalarVariable>
    <ScalarVariable name=\"g\" valueReference=\"1\" causality=\"local\" variability=\"constant\" \
              initial=\"exact\"><Real start=\"9.81\"/></ScalarVariable>
    <ScalarVariable name=\"time\" valueReference=\"4294967295\" causality=\"independent\" \
              variability=\"continuous\"><Real/></ScalarVariable>
  </ModelVariables>",
        )
        .described(|description| [b"\xef\xbb\xbf".as_slice(), &description].concat())
}

const ORNATE: &str =
    "parameters = { start_height = 5.345, \"statische Kraft\" = 120, kind = 2, \"serial number\" = \"№ 7\" }
inputs = { force = { variable = 'Kraft <F> [N], \"Schleifleiste\"' } }
outputs = { height = { variable = \"'Höhe 高さ'.z[1]\" }, velocity = { variable = \"der('Höhe 高さ'.z[1])\" } }
";

#[test]
fn d5_names_types_and_annotations_of_any_kind_are_read() {
    let tried = Tried::new(&ornate());
    // The wiring is written out here and guessed there, which decides whether the line has lateral coordinates:
    // rounding.
    let difference = |ended: Ended| rms(&ended.done().force(), &good_force(&[]));
    assert!(difference(tried.run_with(ORNATE, &[])) < 1e-6);
    let (text, json) = tried.inspect();
    assert!(text.contains("'Höhe 高さ'.z[1]"), "{text}");
    let variables = json["variables"].as_array().unwrap();
    let height = variables
        .iter()
        .find(|variable| variable["name"] == "'Höhe 高さ'.z[1]")
        .unwrap();
    assert_eq!(height["unit"], "m", "of its declared type: {height}");
    // An alias and the enumeration's number are as good as any other variable; a wrong type is named.
    let alias = ORNATE.replace("{ variable = \"'Höhe 高さ'.z[1]\" }", "{ variable = \"z1, alias\" }");
    assert!(difference(tried.run_with(&alias, &[])) < 1e-6);
    let wrong = ORNATE.replace("kind = 2", "kind = \"double arm\"");
    let ended = tried.run_with(&wrong, &[]);
    let _ = ended.refused(2, &["kind", "parameters"]);
}

// D6 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d6_a_pantograph_that_starts_elsewhere_is_aligned_with_the_wire() {
    let tried = Tried::new(&Pantograph::new());
    let align = "outputs = { height = { variable = \"z1\", offset = \"align\" }, velocity = { variable = \"v1\" } }\n";
    for height in ["0.0", "1.0", "9.0"] {
        let low = format!("parameters = {{ reference_height = {height}, start_height = {height} }}\n{align}");
        for set in ["run.initialise=\"as_given\"", "run.initialise=\"equilibrium\""] {
            let force = tried.run_with(&low, &[set]).done().force();
            assert!((80.0..160.0).contains(&force[0]), "starts with {} N", force[0]);
        }
    }
}

#[test]
fn d6_a_pantograph_that_starts_elsewhere_gives_a_result_or_says_that_its_height_does_not_fit() {
    let tried = Tried::new(&Pantograph::new());
    for height in ["0.0", "1.0", "9.0"] {
        let table = format!("parameters = {{ reference_height = {height}, start_height = {height} }}\n");
        for set in ["run.initialise=\"as_given\"", "run.initialise=\"equilibrium\""] {
            let ended = tried.run_with(&table, &[set]);
            if ended.code == Some(0) {
                // Below the wire it never touches it.
                assert!(
                    height != "9.0" && ended.force().iter().all(|&force| force == 0.0),
                    "{height} {set}"
                );
            } else {
                let _ = ended.failed(&["pantograph", "height", "align"]);
            }
        }
    }
    let _ = tried.inspect();
}

// D7 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d7_a_start_time_that_is_refused_is_not_needed() {
    let balanced = ["run.initialise=\"equilibrium\""];
    let good = good_force(&balanced);
    for refusal in ["REFUSE_NEGATIVE_START", "REFUSE_NONZERO_START"] {
        let tried = Tried::new(&Pantograph::new().built_with(&[refusal]));
        assert!(
            rms(&tried.run_with(PARAMETERS, &balanced).done().force(), &good) < 1e-9,
            "{refusal}"
        );
        assert_eq!(tried.run().done().force(), good_force(&[]), "{refusal}");
        let _ = tried.inspect();
    }
}

// D8 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d8_resources_are_found_and_the_current_directory_is_put_back() {
    for need in ["NEED_RESOURCES", "NEED_DIRECTORY"] {
        let pantograph = Pantograph::new()
            .built_with(&[need])
            .resource("pantograph.txt", b"7.2 15.0\n");
        let tried = Tried::new(&pantograph);
        for isolate in ["", "isolate = true\n"] {
            // Paths on the command line are relative: results end up where they belong.
            let table = format!("{PARAMETERS}{isolate}");
            assert_eq!(
                tried.run_with(&table, &[]).done().force(),
                good_force(&[]),
                "{need} {isolate}"
            );
        }
        let _ = tried.inspect();
    }
}

#[test]
fn d8_a_missing_resource_is_named() {
    let tried = Tried::new(&Pantograph::new().built_with(&["NEED_RESOURCES"]));
    let ended = tried.run();
    let _ = ended.failed(&[NAME, "pantograph.txt"]);
}

#[test]
fn d8_a_pantograph_that_must_be_in_its_folder_runs_in_a_process_there() {
    let pantograph = Pantograph::new()
        .built_with(&["NEED_CURRENT_DIRECTORY"])
        .resource("pantograph.txt", b"7.2 15.0\n");
    let tried = Tried::new(&pantograph);
    let ended = tried.run();
    let _ = ended.failed(&[NAME, "pantograph.txt"]);
    let isolated = format!("{PARAMETERS}isolate = true\n");
    assert_eq!(tried.run_with(&isolated, &[]).done().force(), good_force(&[]));
}

// D9 ------------------------------------------------------------------------------------------------------------------

#[test]
fn d9_messages_of_any_form_are_taken() {
    let chatty = [
        "LOG_ARGUMENTS",
        "LOG_NULL_CATEGORY",
        "LOG_FROM_THREAD",
        "LOG_EVERY_STEP",
    ];
    let tried = Tried::new(&Pantograph::new().built_with(&chatty));
    for isolate in ["", "isolate = true\n"] {
        let table = format!("{PARAMETERS}{isolate}");
        assert_eq!(tried.run_with(&table, &[]).done().force(), good_force(&[]));
    }
    let _ = tried.inspect();
}

#[test]
fn d9_what_it_prints_does_not_spoil_what_other_programs_read() {
    let tried = Tried::new(&Pantograph::new().built_with(&["PRINT"]));
    let scene = (tried.program).scene("tried", &under_the_line(Path::new("two_mass.fmu"), PARAMETERS));
    let ended = tried.program.run(&scene, &[&HERE[..], &["--json"]].concat()).done();
    let summary: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!(summary, ended.summary());
    assert!(ended.stderr.contains("at your service"), "{ended}");
}

#[test]
fn d9_what_was_logged_is_in_the_message_of_a_failure() {
    let chatty = [
        "LOG_ARGUMENTS",
        "LOG_NULL_CATEGORY",
        "LOG_FROM_THREAD",
        "NEED_RESOURCES",
    ];
    let tried = Tried::new(&Pantograph::new().built_with(&chatty));
    for isolate in ["", "isolate = true\n"] {
        let ended = tried.run_with(&format!("{PARAMETERS}{isolate}"), &[]);
        let said = [
            "initialise: 2 masses",
            "F = 120.0",
            "100 % of F_c",
            "no category but two lines",
            "another thread",
        ];
        let _ = ended.failed(&said);
    }
}

// D10 -----------------------------------------------------------------------------------------------------------------

#[test]
fn d10_a_warning_does_not_end_a_run() {
    let tried = Tried::new(&Pantograph::new().built_with(&["STEP_STATUS=fmi2Warning"]));
    assert!(rms(&tried.run().done().force(), &good_force(&[])) < 1e-6);
    let _ = tried.inspect();
}

#[test]
fn d10_a_step_that_fails_ends_the_run_with_its_results_kept() {
    for status in ["fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending", "17"] {
        let status_here = format!("STEP_STATUS={status}");
        let tried = Tried::new(&Pantograph::new().built_with(&[&status_here, "STEP_STATUS_AT=0.1"]));
        for isolate in ["", "isolate = true\n"] {
            let ended = tried.run_with(&format!("{PARAMETERS}{isolate}"), &[]);
            let mut said = vec!["pantograph 1", "fmi2"];
            if status != "fmi2Pending" {
                said.push("the air spring is at its stop");
            }
            let ended = ended.refused(1, &said);
            keeps_results(&ended, 0.1);
        }
    }
}

#[test]
fn d10_a_discarded_step_is_shortened_where_both_sides_can_go_back() {
    let tried = Tried::new(&Pantograph::new().built_with(&["DISCARD_LONGER_THAN=6e-4"]));
    let ended = tried.run().done();
    let summary = ended.summary();
    assert!(summary["cost"]["rollbacks"].as_u64().unwrap() >= 300, "{summary}");
    assert!(rms(&ended.force(), &good_force(&["coupling.macro_step=0.0005"])) < 1.0);
    let unable = Pantograph::new()
        .built_with(&["DISCARD_LONGER_THAN=6e-4"])
        .unable("canGetAndSetFMUstate", "ROLLBACK");
    let tried = Tried::new(&unable);
    let ended = tried.run().refused(1, &["pantograph 1", "fmi2Discard", "macro_step"]);
    let summary = ended.summary();
    assert_eq!(summary["complete"], false);
}

// D11 -----------------------------------------------------------------------------------------------------------------

#[test]
fn d11_a_value_that_is_no_number_is_named_with_variable_and_time() {
    let tried = Tried::new(&Pantograph::new().built_with(&["NAN_AT=0.1"]));
    for isolate in ["", "isolate = true\n"] {
        let ended = tried
            .run_with(&format!("{PARAMETERS}{isolate}"), &[])
            .refused(1, &["pantograph 1", "z1", "NaN", "t = 0.1"]);
        keeps_results(&ended, 0.1);
    }
    let tried = Tried::new(&Pantograph::new().built_with(&["NAN_AT=0.0"]));
    let ended = tried.run();
    let _ = ended.failed(&["pantograph", "z1", "NaN"]);
    let (text, _) = tried.inspect();
    assert!(text.contains("z1 = NaN"), "{text}");
}

// D12 -----------------------------------------------------------------------------------------------------------------

const FAULTS: [&str; 4] = ["SEGV", "ABORT", "EXIT", "LOOP"];
const ISOLATED: &str = "parameters = { start_height = 5.345 }\nisolate = true\nstep_timeout = 1\n";

#[test]
fn d12_a_crash_or_endless_loop_in_a_step_ends_the_run_with_its_results_kept() {
    for fault in FAULTS {
        let fault_here = format!("FAULT={fault}");
        let tried = Tried::new(&Pantograph::new().built_with(&[&fault_here, "FAULT_IN=STEP", "FAULT_AT=0.1"]));
        let ended = tried
            .run_with(ISOLATED, &[])
            .refused(1, &["pantograph 1", "fmi2DoStep", "two_mass"]);
        keeps_results(&ended, 0.1);
        // `inspect` does not execute the FMU.
        let _ = tried.inspect();
    }
}

#[test]
fn d12_a_crash_or_endless_loop_before_the_first_step_is_named() {
    for (place, function) in [
        ("INSTANTIATE", "fmi2Instantiate"),
        ("INITIALISE", "fmi2EnterInitializationMode"),
    ] {
        for fault in FAULTS {
            let faults = [format!("FAULT={fault}"), format!("FAULT_IN={place}")];
            let tried = Tried::new(&Pantograph::new().built_with(&faults.each_ref().map(String::as_str)));
            let ended = tried.run_with(ISOLATED, &[]);
            let _ = ended.failed(&["two_mass", function]);
            let (text, _) = tried.inspect();
            assert!(text.contains(function), "{text}");
        }
    }
}

#[test]
fn d12_without_isolation_a_crash_says_what_would_help() {
    for fault in ["SEGV", "ABORT", "EXIT"] {
        let fault_here = format!("FAULT={fault}");
        let tried = Tried::new(&Pantograph::new().built_with(&[&fault_here, "FAULT_IN=STEP", "FAULT_AT=0.1"]));
        let ended = tried.run();
        assert_ne!(ended.code, Some(0), "{ended}");
        assert!(ended.stderr.contains("isolate = true"), "{ended}");
    }
}

#[test]
fn d12_a_crash_at_the_end_of_a_run_loses_nothing_of_it() {
    for fault in FAULTS {
        for (table, isolated) in [(PARAMETERS, false), (ISOLATED, true)] {
            if fault == "LOOP" && !isolated {
                continue;
            }
            let faults = [&format!("FAULT={fault}"), "FAULT_IN=TERMINATE", "FAULT_AT=0.1"];
            let tried = Tried::new(&Pantograph::new().built_with(&faults));
            let ended = tried.run_with(table, &[]);
            assert_eq!(ended.code == Some(0), isolated, "{fault}: {ended}");
            assert_eq!(ended.summary()["complete"], true, "{fault}: {ended}");
            assert_eq!(ended.force(), good_force(&[]), "{fault}: {ended}");
            assert!(isolated || ended.stderr.contains("isolate = true"), "{fault}: {ended}");
        }
    }
}
