//! The program as a user meets it: exit status, messages, files.

mod short;

use short::SHORT;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml")
}

fn master(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_master"))
        .args(arguments)
        .output()
        .unwrap()
}

fn run_short(mode: &str, out: &Path, more: &[&str]) -> Output {
    let (scene, out) = (scene(), out.display().to_string());
    let mut arguments = vec!["run", scene.to_str().unwrap(), "--mode", mode, "--out", &out];
    for key in SHORT {
        arguments.extend(["--set", key]);
    }
    arguments.extend(more);
    master(&arguments)
}

/// Names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_run_writes_all_its_files_and_prints_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_short("inprocess", folder.path(), &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("contact force [N]"));
    for file in ["scene.toml", "timeseries.csv", "summary.json", "report.html"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
}

#[test]
fn the_resolved_scene_gives_the_same_results_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    assert!(run_short("inprocess", &first, &["-q"]).status.success());
    let scene = first.join("scene.toml");
    let output = master(&[
        "run",
        scene.to_str().unwrap(),
        "--mode",
        "inprocess",
        "--out",
        second.to_str().unwrap(),
        "-q",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for file in ["scene.toml", "timeseries.csv"] {
        assert_eq!(
            std::fs::read(first.join(file)).unwrap(),
            std::fs::read(second.join(file)).unwrap(),
            "{file}"
        );
    }
}

#[test]
fn json_is_all_there_is_on_stdout() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_short("monolithic", folder.path(), &["--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&summary["mode"], &summary["complete"]),
        (&"monolithic".into(), &true.into())
    );
    let written = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&written).unwrap(), summary);
}

#[test]
fn wrong_scenes_end_with_two_and_leave_older_results_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("summary.json"), "precious").unwrap();
    for (key, words) in [
        ("run.speed_kmh=-250", ["speed_kmh", "-250"]),
        ("run.spede_kmh=250", ["spede_kmh", "speed_kmh"]),
        ("coupling.algorithm=\"jacobbi\"", ["jacobbi", "jacobi"]),
        ("run.speed_kmh=1000", ["speed_kmh", "allow_supercritical"]),
    ] {
        let output = run_short("inprocess", folder.path(), &["--set", key]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{key}: {message}");
        assert!(
            message.starts_with("error: ") && words.iter().all(|word| message.contains(word)),
            "{key}: {message}"
        );
        assert!(!message.contains("panicked"));
        assert_eq!(
            std::fs::read_to_string(folder.path().join("summary.json")).unwrap(),
            "precious",
            "{key}"
        );
    }
}

#[test]
fn wrong_usage_ends_with_two() {
    for arguments in [
        &["frobnicate"][..],
        &["run", "absent.toml"],
        &["inspect", "absent.fmu"],
        &["report", "absent"],
    ] {
        let output = master(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            text(&output.stderr).contains(arguments.last().unwrap()),
            "{arguments:?}: {}",
            text(&output.stderr)
        );
    }
}

#[test]
fn an_output_directory_that_is_a_file_is_refused_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    let output = run_short("inprocess", &file, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains(file.to_str().unwrap()));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn compare_runs_all_modes_and_algorithms_with_the_fmus_and_writes_its_table_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (scene(), folder.path().display().to_string());
    let mut arguments = vec![
        "compare",
        scene.to_str().unwrap(),
        "--macro-steps",
        "1,2000us",
        "--out",
        &out,
        "--json",
    ];
    for key in SHORT {
        arguments.extend(["--set", key]);
    }
    let output = master(&arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = printed["rows"].as_array().unwrap();
    assert_eq!(printed["complete"], true);
    let of = |mode: &str| rows.iter().filter(|row| row["mode"] == mode).count();
    let algorithms = experiments::compare::algorithms().len();
    assert_eq!(
        (of("monolithic"), of("inprocess"), of("cosimulation")),
        (1, 2, 2 * algorithms)
    );
    assert!(rows.iter().all(|row| !row["status"].is_null()));
    for row in rows.iter().filter(|row| row["mode"] == "inprocess") {
        assert!(
            row["reason"].as_str().unwrap().contains("the same bits as with FMUs"),
            "{row}"
        );
    }
    let table = std::fs::read_to_string(folder.path().join("compare.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + rows.len());
    let page = std::fs::read_to_string(folder.path().join("compare.html")).unwrap();
    assert!(page.contains("plot-error") && !page.contains("<script src"));
    assert_eq!(
        master(&["compare", scene.to_str().unwrap(), "--macro-steps", "0"])
            .status
            .code(),
        Some(2)
    );
}

#[test]
fn check_prints_statics_for_people_and_as_json() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let [for_people, for_tools] = ["people", "tools"].map(|name| folder.path().join(name).display().to_string());
    let mut arguments = vec!["check", scene.to_str().unwrap()];
    for key in SHORT {
        arguments.extend(["--set", key]);
    }
    let output = master(&[&arguments[..], &["--out", &for_people]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    for word in ["droppers", "supports", "elasticity", "scene has no [wind]"] {
        assert!(text(&output.stdout).contains(word), "{word}");
    }
    let files = ["check.html", "droppers.csv", "line.svg", "supports.csv"];
    assert_eq!(names(Path::new(&for_people)), files);
    arguments.push("--json");
    // Without a folder to write to, a tool gets its report only.
    let output = Command::new(env!("CARGO_BIN_EXE_master"))
        .args(&arguments)
        .current_dir(folder.path())
        .output();
    let report: serde_json::Value = serde_json::from_slice(&output.unwrap().stdout).unwrap();
    assert_eq!(names(folder.path()), ["people"]);
    let again = master(&[&arguments[..], &["--out", &for_tools]].concat()).stdout;
    assert_eq!(serde_json::from_slice::<serde_json::Value>(&again).unwrap(), report);
    assert_eq!(names(Path::new(&for_tools)), files);
    assert_eq!(report["limits"].as_array().unwrap().len(), 3);
    assert_eq!(report["statics"]["supports"].as_array().unwrap().len(), 4);
    assert!(report["statics"]["elasticity"][2]["m_per_N"].as_f64().unwrap() > 0.0);
    assert!((report["statics"]["tension"]["contact_wire_N"].as_f64().unwrap() / 20_000.0 - 1.0).abs() < 1e-6);
    assert!((report["waves"]["contact_wire_m_per_s"].as_f64().unwrap() - (20_000.0_f64 / 1.35).sqrt()).abs() < 1e-9);
}

#[cfg(unix)]
#[test]
fn ctrl_c_and_the_signals_of_a_shutdown_end_the_run_in_order() {
    ["INT", "TERM", "HUP"].into_iter().for_each(ends_in_order);
}

#[cfg(unix)]
fn ends_in_order(signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene();
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command
        .args(["run", scene.to_str().unwrap(), "--mode", "inprocess", "-q", "--out"])
        .arg(folder.path());
    command.stderr(std::process::Stdio::piped());
    let child = command.spawn().unwrap();
    // The scene is written when the time loop begins; the run itself takes seconds.
    while !folder.path().join("scene.toml").exists() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    std::thread::sleep(std::time::Duration::from_millis(100));
    // Terminals and `timeout` send theirs twice.
    for _ in 0..2 {
        let mut kill = Command::new("kill");
        let sent = kill.args([&format!("-{signal}"), &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["complete"], false);
    assert!(
        summary["incomplete_reason"]
            .as_str()
            .unwrap()
            .starts_with("interrupted at t = ")
    );
    assert!(folder.path().join("timeseries.csv").exists() && folder.path().join("report.html").exists());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_the_set_up_at_once() {
    use std::os::unix::process::ExitStatusExt;
    const INTERRUPT: i32 = 2;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command.args(["run", scene().to_str().unwrap(), "--mode", "monolithic", "-q"]);
    // Modes take seconds where none are kept.
    command.args(["--set", "model.reduce=modal", "--out"]).arg(&out);
    command.env("PANTOLINE_CACHE", "");
    let mut child = command.spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    let mut kill = Command::new("kill");
    assert!(kill.args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().signal(), Some(INTERRUPT));
    assert!(!out.exists());
}

#[test]
fn a_start_without_balance_names_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_short("inprocess", folder.path(), &["--set", "run.start_x=0"]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("run.start_x = 0 m: ") && said.contains("must be 0.01 m or more from the end of the line"),
        "{said}"
    );
}

#[test]
fn a_study_that_cannot_be_made_writes_nothing_over() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (scene(), folder.path().display().to_string());
    let csv = folder.path().join("study.csv");
    std::fs::write(&csv, "precious").unwrap();
    for (flags, words) in [
        (
            &["--sweeps", "spans"][..],
            &["--sweeps spans: --spans or --window-spans must say"][..],
        ),
        (
            &["--sweeps", "mesh", "--spans", "10"],
            &["--spans: --sweeps mesh leaves out", "--sweeps mesh,spans"],
        ),
        (
            &["--reductions", "foo"],
            &["'foo'", "none, auto, or one or more of planar"],
        ),
        (&["--elements", "500"], &["'500'", "from 1 to 200"]),
        (
            &["--sweeps", "vehicle"],
            &["nothing to be studied: sweep vehicle has no run: the scene has no [vehicle]"],
        ),
    ] {
        let mut arguments = vec!["study", scene.to_str().unwrap(), "--out", &out];
        for key in SHORT {
            arguments.extend(["--set", key]);
        }
        arguments.extend(flags);
        let output = master(&arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{flags:?}: {said}");
        assert_eq!(std::fs::read_to_string(&csv).unwrap(), "precious", "{flags:?}");
    }
}

#[test]
fn a_strip_beside_the_wire_is_told_by_run_and_check() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/thesis-pantograph.toml");
    let out = folder.path().display().to_string();
    let told = |command: &[&str]| {
        let mut arguments = command.to_vec();
        let scene = scene.to_str().unwrap();
        arguments.extend([
            scene,
            "--set",
            "run.duration=1.6",
            "--set",
            "run.evaluate={ time = [0.1, 1.6] }",
        ]);
        arguments.extend([
            "--set",
            "vehicle={ model = \"rigid_motion\", motion = { time = [0, 0.5, 1.5], y = [0, 3, 0] } }",
        ]);
        let output = master(&arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let run = told(&["run", "--mode", "monolithic", "--out", &out]);
    assert!(
        run.contains("pantograph 1: the wire passed beside its strip") && run.contains("half the width"),
        "{run}"
    );
    let check = told(&["check", "--out", &out]);
    let note = "pantograph 1: vehicle.motion is such that the wire passes beside its strip";
    assert!(check.contains(note) && check.contains("up to 3.306 m"), "{check}");
}

#[test]
fn files_of_another_kind_are_named_with_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let fmu = made("x.fmu", b"PK\x03\x04");
    let zip = made("x.toml", b"PK\x03\x04");
    let bytes = made("y.toml", &[0xff, 0xfe, 0x00]);
    let here = folder.path().to_str().unwrap();
    let usual = std::fs::read_to_string(scene()).unwrap();
    let (before, rest) = usual.split_once("[[pantograph]]").unwrap();
    let after = &rest[rest.find("\n[").unwrap()..];
    let theirs = |name: &str, fmu: &str| {
        made(
            name,
            format!("{before}[[pantograph]]\nfmu = \"{fmu}\"\n{after}").as_bytes(),
        )
    };
    let (missing, text_as_fmu) = (theirs("missing.toml", "none.fmu"), theirs("text.toml", "missing.toml"));
    for (arguments, said) in [
        (
            &["run", &fmu][..],
            "is an FMU; expected a scene (.toml) or a system (.ssp)",
        ),
        (&["compare", &zip], "is a zip archive; expected"),
        (&["check", &bytes], "is no text in UTF-8; expected"),
        (&["check", &missing], "missing.toml: pantograph[1].fmu: "),
        (
            &["check", &text_as_fmu],
            "it is a file of another kind, or damaged or cut off",
        ),
        (&["report", here], "holds no summary.json; expected"),
        (
            &["inspect", &fmu, "--set", "a=1"],
            "--set a=1: master inspect reads no scene",
        ),
        (&["compare", "--test-problem", "--set", "a=1"], "reads no scene"),
        (
            &["latency", &missing, "--out", "x"],
            "--out x: master latency writes no files",
        ),
        (
            &["compare", &fmu, "--macro-steps", "-1"],
            "must be a positive number in ms",
        ),
    ] {
        let output = master(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            text(&output.stderr).contains(said),
            "{arguments:?}: {}",
            text(&output.stderr)
        );
    }
}

/// The exit statuses and files of `run --fail-on-limits` are those of a complete run; the status alone says that a
/// limit fails.
#[test]
fn a_failed_limit_ends_with_three_after_the_results_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let (fails, holds) = (folder.path().join("fails"), folder.path().join("holds"));
    // Long enough for a verdict.
    let long = [
        "--set",
        "run.duration=0.8",
        "--set",
        "run.evaluate={ time = [0.2, 0.8] }",
    ];
    let heavy = ["--fail-on-limits", "-q", "--set", "pantograph[1].static_force=400"];
    let heavy = [&heavy[..], &long].concat();
    let output = run_short("monolithic", &fails, &heavy);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("--fail-on-limits: ") && said.contains("mean contact force"),
        "{said}"
    );
    assert!(fails.join("summary.json").exists() && fails.join("report.html").exists());
    let again = run_short("monolithic", &fails, &heavy[1..]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));

    // Slow: no limit fails, and some are not decided.
    let output = run_short(
        "monolithic",
        &holds,
        &[
            "--fail-on-limits",
            "--set",
            "run.speed_kmh=80",
            "--set",
            "pantograph[1].static_force=85",
            long[0],
            long[1],
            long[2],
            long[3],
        ],
    );
    let table = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{table}{}", text(&output.stderr));
    assert!(
        table.contains("not decided") && table.contains("\nVerdict: no limit fails, "),
        "{table}"
    );
}

#[test]
fn report_and_animation_can_be_left_out_and_older_ones_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let there = |name: &str| folder.path().join(name).exists();
    assert!(run_short("monolithic", folder.path(), &["-q"]).status.success());
    assert!(there("report.html") && there("animation.json"));
    assert!(
        run_short("monolithic", folder.path(), &["-q", "--no-animation"])
            .status
            .success()
    );
    assert!(there("report.html") && !there("animation.json"));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("plot-force") && !page.contains("id=\"player\""));
    assert!(
        run_short("monolithic", folder.path(), &["-q", "--no-report"])
            .status
            .success()
    );
    assert!(!there("report.html") && there("animation.json") && there("summary.json"));
}

#[test]
fn completions_are_made_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = master(&["completions", shell]);
        let script = text(&output.stdout);
        assert!(output.status.success(), "{shell}: {}", text(&output.stderr));
        assert!(
            script.contains("master") && script.contains("fail-on-limits"),
            "{shell}"
        );
    }
    assert_eq!(master(&["completions", "cmd"]).status.code(), Some(2));
}

#[test]
fn the_version_names_project_and_program() {
    let said = text(&master(&["--version"]).stdout);
    assert_eq!(said, format!("Pantoline {} (master)\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_rest_position_that_costs_static_force_is_told_by_check_and_run() {
    let folder = tempfile::tempdir().unwrap();
    let low = "pantograph[1].reference_height=5.0";
    let warning = "instead of its static force of 120.0 N; set pantograph[1].reference_height = ";
    let run = text(&run_short("monolithic", folder.path(), &["--set", low]).stdout);
    assert!(run.contains(warning), "{run}");
    let (scene, out) = (scene(), folder.path().join("check").display().to_string());
    let mut arguments = vec!["check", scene.to_str().unwrap(), "--set", low, "--out", &out];
    for key in SHORT {
        arguments.extend(["--set", key]);
    }
    let check = text(&master(&arguments).stdout);
    assert!(check.contains(warning), "{check}");
}

#[test]
fn overlaid_runs_are_named_by_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (name, speed) in [("first", "run.speed_kmh=200"), ("second", "run.speed_kmh=220")] {
        let output = run_short("monolithic", &at(name), &["-q", "--set", speed]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let [first, second, both] = ["first", "second", "both"].map(|name| at(name).display().to_string());
    let output = master(&["report", &first, &second, "--out", &both]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(at("both").join("report.html")).unwrap();
    for label in ["en50318-250 (200 km/h)", "en50318-250 (220 km/h)"] {
        assert!(page.contains(label) && text(&output.stdout).contains(label), "{label}");
    }
}
