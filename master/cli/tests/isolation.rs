//! supplied FMUs that crash, hang or end the process, in a process of their own and in this one.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use fmi2::archive::Package;
use fmi2::model_description::{ModelDescription, Variable};
use tempfile::TempDir;

/// Bytes of `Head.fmu`, the FMU of `isolation/head.c`.
fn head() -> &'static [u8] {
    static HEAD: OnceLock<Vec<u8>> = OnceLock::new();
    HEAD.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("head.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/isolation/head.c");
        let mut cc = Command::new(std::env::var_os("CC").unwrap_or("cc".into()));
        cc.args(["-O1", "-shared", "-fPIC", "-pthread", "-o"])
            .arg(&library)
            .arg(source);
        assert!(
            cc.status()
                .expect("a C compiler, which crate fmi2 needs as well")
                .success()
        );
        let variables = vec![
            Variable::input("F", "N", 0.0, "Contact force"),
            Variable::output("z", "m", "Height"),
            Variable::output("v", "m/s", "Its rate"),
            Variable::parameter("at", "s", 1e9, "Time of the fault"),
            Variable::string_parameter("fault", "", "What happens then"),
            Variable::parameter("S", "N", 120.0, "Static force"),
        ];
        let mut description = ModelDescription::of_slave("Head", variables);
        description.generation_tool = Some("a text editor".to_owned());
        let xml = description.to_xml();
        let xml = [
            "canInterpolateInputs",
            "canGetAndSetFMUstate",
            "canSerializeFMUstate",
            "providesDirectionalDerivative",
        ]
        .iter()
        .fold(xml, |xml, flag| {
            xml.replace(&format!("{flag}=\"true\""), &format!("{flag}=\"false\""))
        });
        let path = folder.path().join("Head.fmu");
        Package {
            description: xml,
            library: std::fs::read(library).unwrap(),
            resources: BTreeMap::from([("beside.txt".to_owned(), b"here".to_vec())]),
            ..Package::default()
        }
        .write(&path)
        .unwrap();
        std::fs::read(path).unwrap()
    })
}

/// A scene with the head on a short line, 0.1 s in steps of 1 ms, in a folder of its own.
struct Case {
    folder: TempDir,
    /// Distinguishes its processes from all others on the machine.
    tag: String,
}

/// How a run ended.
struct Ended {
    output: Output,
    wall: Duration,
}

impl Ended {
    fn said(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }
}

impl Case {
    fn new(keys: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let tag = folder.path().file_name().unwrap().to_string_lossy().into_owned();
        std::fs::write(folder.path().join("Head.fmu"), head()).unwrap();
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
        let scene = std::fs::read_to_string(scene).unwrap();
        let (before, rest) = scene.split_once("[[pantograph]]").unwrap();
        let after = &rest[rest.find("[coupling]").unwrap()..];
        let pantograph = format!(
            "[[pantograph]]\nfmu = \"Head.fmu\"\n\
             inputs = {{ force = {{ variable = \"F\" }} }}\n\
             outputs = {{ height = {{ variable = \"z\", offset = \"align\" }}, velocity = {{ variable = \"v\" }} \
             }}\n{keys}\n\n"
        );
        std::fs::write(folder.path().join("scene.toml"), format!("{before}{pantograph}{after}")).unwrap();
        Self { folder, tag }
    }

    fn isolated(fault: &str, at: f64) -> Self {
        Self::new(&format!(
            "isolate = true\nstep_timeout = 1\nparameters = {{ fault = \"{fault}\", at = {at} }}"
        ))
    }

    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
        command
            .arg("run")
            .arg(self.folder.path().join("scene.toml"))
            .args(["--mode", "inprocess", "--out", out])
            .current_dir(self.folder.path());
        for key in [
            "catenary.spans=3",
            "catenary.mesh.elements_per_interval=1",
            "run.duration=0.1",
            "run.evaluate={ time = [0.01, 0.1] }",
            "run.output_step=0.001",
            "run.initialise=\"as_given\"",
            "coupling.macro_step=0.001",
        ] {
            command.args(["--set", key]);
        }
        command
            .args(more)
            .env("HEAD_TAG", &self.tag)
            .env("TMPDIR", self.folder.path());
        command
    }

    fn results(&self, out: &str) -> PathBuf {
        self.folder.path().join(out)
    }

    fn run_with(&self, out: &str, more: &[&str]) -> Ended {
        let begin = Instant::now();
        let output = self.command(out, more).output().unwrap();
        let wall = begin.elapsed();
        assert_eq!(self.processes(), 0, "no process is left");
        Ended { output, wall }
    }

    fn run(&self) -> Ended {
        self.run_with("out", &[])
    }

    /// Folders of unpacked archives.
    fn unpacked(&self) -> usize {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name());
        names
            .filter(|name| name.to_string_lossy().starts_with("pantoline-"))
            .count()
    }

    /// Processes of this case that run.
    fn processes(&self) -> usize {
        let tag = format!("HEAD_TAG={}", self.tag);
        let of_ours = |entry: std::io::Result<std::fs::DirEntry>| {
            let environment = std::fs::read(entry.unwrap().path().join("environ")).unwrap_or_default();
            environment
                .split(|byte| *byte == 0)
                .any(|variable| variable == tag.as_bytes())
        };
        std::fs::read_dir("/proc")
            .unwrap()
            .map(of_ours)
            .filter(|ours| *ours)
            .count()
    }

    /// Rows of the time series that was kept.
    fn rows(&self, out: &str) -> usize {
        let series = std::fs::read_to_string(self.results(out).join("timeseries.csv")).unwrap();
        series.lines().count() - 1
    }

    fn summary(&self, out: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.results(out).join("summary.json")).unwrap()).unwrap()
    }
}

/// This repository's own Pantograph.fmu, for a scene like that of [`Case`].
fn own_pantograph() -> Vec<u8> {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
    let text = std::fs::read_to_string(scene).unwrap();
    let keys = [
        "catenary.spans=3",
        "catenary.mesh.elements_per_interval=1",
        "run.duration=0.1",
    ];
    let mut scene = system::load(
        &text,
        "en50318-250.toml",
        &keys
            .into_iter()
            .chain(["run.evaluate={ time = [0.01, 0.1] }"])
            .map(String::from)
            .collect::<Vec<_>>(),
    )
    .unwrap();
    let statics = catenary::static_line(&scene).unwrap();
    system::equilibrium::resolve(&mut scene, &statics).unwrap();
    let libraries = cosim::package::Libraries::find().unwrap();
    let archives = cosim::package::archives(&scene, &libraries).unwrap();
    let (_, archive) = archives.into_iter().find(|(name, _)| name == "Pantograph.fmu").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Pantograph.fmu");
    archive.write(&path).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn rollback_and_input_derivatives_work_across_processes_bit_for_bit() {
    let pantograph = own_pantograph();
    for algorithm in ["iterated", "gauss_seidel", "jacobi"] {
        let [here, there] = ["", "isolate = true"].map(|keys| {
            let case = Case::new(keys);
            // no wiring: it is guessed from the names of our own FMUs
            let scene = std::fs::read_to_string(case.results("scene.toml")).unwrap();
            let scene: Vec<&str> = scene
                .lines()
                .filter(|line| !line.starts_with("inputs = {") && !line.starts_with("outputs = {"))
                .collect();
            std::fs::write(case.results("scene.toml"), scene.join("\n")).unwrap();
            std::fs::write(case.results("Head.fmu"), &pantograph).unwrap();
            let algorithm = format!("coupling.algorithm=\"{algorithm}\"");
            let ended = case.run_with("out", &["--set", &algorithm]);
            assert!(ended.output.status.success(), "{}", ended.said());
            let summary = case.summary("out");
            (
                std::fs::read_to_string(case.results("out/timeseries.csv")).unwrap(),
                summary["cost"]["rollbacks"].as_u64().unwrap(),
                summary["cost"]["micro_steps"].as_u64().unwrap(),
            )
        });
        assert_eq!(here, there, "{algorithm}");
        assert_eq!(here.1 > 0, algorithm == "iterated", "{algorithm}: {} rollbacks", here.1);
        let forces: Vec<&str> = here.0.lines().skip(1).filter_map(|row| row.split(',').nth(1)).collect();
        assert!(
            forces.iter().any(|force| *force != forces[0]),
            "{algorithm}: the strip moves"
        );
    }
}

/// Runs the head isolated with a fault in the step to t = 0.05 s: exit status 1, the words, and the rows up to there.
fn ends_with_results(fault: &str, words: &[&str]) -> Ended {
    let case = Case::isolated(fault, 0.05);
    let ended = case.run();
    let said = ended.said();
    assert_eq!(ended.output.status.code(), Some(1), "{fault}: {said}");
    for word in words.iter().chain(&["pantograph 1"]) {
        assert!(said.contains(word), "{fault}: \"{word}\" is missing in\n{said}");
    }
    assert_eq!(case.rows("out"), 50, "{fault}: t = 0 … 0.049 s");
    let summary = case.summary("out");
    assert_eq!(summary["complete"], false);
    let leftovers = std::fs::read_dir(case.folder.path()).unwrap().count();
    assert_eq!(
        leftovers, 3,
        "{fault}: scene, FMU and results; the unpacked archive is gone"
    );
    ended
}

#[test]
fn an_isolated_fmu_that_crashes_in_a_step_ends_the_run_with_its_results() {
    ends_with_results(
        "abort",
        &[
            "Head.fmu",
            "(Head): fmi2DoStep at t = 0.049 s crashed with SIGABRT",
            "head: assertion failed",
            "a text editor",
        ],
    );
    ends_with_results(
        "segv",
        &["fmi2DoStep at t = 0.049 s crashed with SIGSEGV (invalid memory access)"],
    );
}

#[test]
fn an_isolated_fmu_that_ends_its_process_ends_the_run_with_its_results() {
    ends_with_results("exit", &["fmi2DoStep at t = 0.049 s ended its process by exit(3)"]);
    ends_with_results(
        "_exit",
        &["fmi2DoStep at t = 0.049 s ended its process with exit status 4"],
    );
    ends_with_results("kill", &["crashed with SIGKILL (killed from outside"]);
}

#[test]
fn an_isolated_fmu_that_never_returns_is_killed_after_its_time() {
    let ended = ends_with_results(
        "loop",
        &[
            "fmi2DoStep at t = 0.049 s took longer than step_timeout = 1 s",
            "raise step_timeout",
        ],
    );
    assert!(ended.wall > Duration::from_secs(1), "it is given its time");
}

#[test]
fn a_process_that_is_stopped_or_sends_nonsense_is_given_up_after_its_time() {
    for (fault, words) in [
        ("stop", "fmi2DoStep at t = 0.049 s took longer than step_timeout = 3 s"),
        ("corrupt", "pantograph 1"),
    ] {
        let case = Case::new(&format!(
            "isolate = true\nstep_timeout = 3\nparameters = {{ fault = \"{fault}\", at = 0.05 }}"
        ));
        let ended = case.run();
        let said = ended.said();
        assert_eq!(ended.output.status.code(), Some(1), "{fault}: {said}");
        assert!(said.contains(words), "{fault}: {said}");
        assert_eq!(case.rows("out"), 50, "{fault}");
        // The limit, 2 s that the parent allows beyond it, and the run itself; not the limit for each call of a step.
        assert!(ended.wall < Duration::from_secs(12), "{fault}: {:?}", ended.wall);
    }
}

#[test]
fn an_isolated_fmu_that_takes_too_much_memory_ends_the_run_with_its_results() {
    let case = Case::new(
        "isolate = true\nmemory_limit = 3e8\nstep_timeout = 60\nparameters = { fault = \"hoard\", at = 0.05 }",
    );
    let ended = case.run();
    let said = ended.said();
    assert_eq!(ended.output.status.code(), Some(1), "{said}");
    for words in ["crashed with SIGABRT", "memory_limit = 300000000 B may be too little"] {
        assert!(said.contains(words), "{said}");
    }
    assert_eq!(case.rows("out"), 50);
    let said = Case::new("memory_limit = 3e8").run().said();
    assert!(
        said.contains("pantograph[1].memory_limit") && said.contains("isolate = true given"),
        "{said}"
    );
}

#[test]
fn one_process_answers_for_an_fmu_that_makes_copies_of_its_own() {
    let series = |fault: &str| {
        let case = Case::isolated(fault, 0.05);
        let ended = case.run();
        assert!(ended.output.status.success(), "{fault}: {}", ended.said());
        std::fs::read_to_string(case.results("out").join("timeseries.csv")).unwrap()
    };
    let plain = series("");
    // `run` has seen that none of their processes is left.
    for fault in ["fork", "helper", "daemon"] {
        assert!(series(fault) == plain, "{fault}: the results are others");
    }
}

#[test]
fn bad_statuses_of_an_isolated_fmu_are_told_as_those_of_any_other() {
    ends_with_results("fatal", &["pantograph 1 (Head): fmi2DoStep returned fmi2Fatal"]);
    ends_with_results("error", &["fmi2DoStep returned fmi2Error: the head is lost at 5."]);
    ends_with_results("discard", &["fmi2DoStep returned fmi2Discard"]);
}

#[test]
fn crashes_in_other_calls_name_the_call() {
    for (fault, words) in [
        ("set", "fmi2SetReal at t = 0.05 s crashed with SIGABRT"),
        ("get", "fmi2GetReal at t = 0.05 s crashed with SIGSEGV"),
    ] {
        let case = Case::isolated(fault, 0.05);
        let ended = case.run();
        assert_eq!(ended.output.status.code(), Some(1), "{}", ended.said());
        assert!(ended.said().contains(words), "{}", ended.said());
        assert!([50, 51].contains(&case.rows("out")), "{}", case.rows("out"));
    }
    let case = Case::isolated("initialise", 0.0);
    let ended = case.run();
    assert_eq!(ended.output.status.code(), Some(1), "{}", ended.said());
    assert!(ended.said().contains("fmi2ExitInitializationMode"), "{}", ended.said());
    assert!(
        !case.results("out").exists(),
        "nothing is written before the input is known to be good"
    );
}

#[test]
fn the_environment_of_a_scene_reaches_the_isolated_fmu_alone() {
    for (fault, words) in [
        ("segv", "fmi2Instantiate crashed with SIGSEGV"),
        ("loop", "fmi2Instantiate took longer than step_timeout = 0.5 s"),
        ("exit", "fmi2Instantiate ended its process by exit(3)"),
    ] {
        let case = Case::new(&format!(
            "isolate = true\nstep_timeout = 0.5\nenvironment = {{ HEAD_FAULT = \"{fault}\" }}"
        ));
        let ended = case.run();
        assert_eq!(ended.output.status.code(), Some(1), "{}", ended.said());
        assert!(ended.said().contains(words), "{}", ended.said());
    }
}

#[test]
fn what_an_isolated_fmu_prints_and_logs_disturbs_nobody() {
    let case = Case::isolated("print", 0.09);
    let ended = case.run_with("out", &["--json"]);
    assert!(ended.output.status.success(), "{}", ended.said());
    assert!(
        ended.said().contains("pantograph 1: PFMU nonsense on stdout"),
        "{}",
        ended.said()
    );
    let summary: serde_json::Value = serde_json::from_slice(&ended.output.stdout).expect("JSON and nothing else");
    assert_eq!(summary["complete"], true);

    let case = Case::isolated("thread", 0.09);
    let ended = case.run_with("out", &["-vv"]);
    assert!(ended.output.status.success(), "{}", ended.said());
    assert!(ended.said().contains("from another thread, 42"), "{}", ended.said());
    assert!(
        ended.said().contains("resources are the current directory"),
        "{}",
        ended.said()
    );
}

#[test]
fn an_isolated_fmu_gives_the_same_results_bit_for_bit() {
    let series = |keys: &str| {
        let case = Case::new(keys);
        let ended = case.run();
        assert!(ended.output.status.success(), "{}", ended.said());
        std::fs::read_to_string(case.results("out").join("timeseries.csv")).unwrap()
    };
    let here = series("parameters = { S = 130.0 }");
    assert_eq!(here, series("isolate = true\nparameters = { S = 130.0 }"));
    assert_ne!(here, series("isolate = true"), "the parameter arrives");
}

#[test]
fn an_fmu_in_this_process_that_ends_it_is_named_with_the_remedy() {
    for (fault, words) in [
        (
            "segv",
            "pantograph 1 (Head, Head.fmu): fmi2DoStep at t = 0.049 s crashed with SIGSEGV",
        ),
        ("abort", "crashed with SIGABRT (abort() or a failed assertion)"),
        (
            "loop",
            "fmi2DoStep at t = 0.049 s took longer than 1 s of wall time (step_timeout)",
        ),
        ("exit", "fmi2DoStep at t = 0.049 s ended the program by exit(3)"),
    ] {
        let case = Case::new(&format!(
            "step_timeout = 1\nparameters = {{ fault = \"{fault}\", at = 0.05 }}"
        ));
        let ended = case.run();
        let said = ended.said();
        assert_eq!(ended.output.status.code(), Some(1), "{fault}: {said}");
        assert!(
            said.contains(words) && said.contains("isolate = true"),
            "{fault}: {said}"
        );
        assert_eq!(case.unpacked(), 0, "{fault}: an unpacked archive is left");
    }
}

/// `_exit(0)` ended the program with status 0 and without results.
#[test]
fn regress_35_an_fmu_in_this_process_that_ends_it_without_a_word_is_noticed_by_the_next_process() {
    let case = Case::new("parameters = { fault = \"_exit0\", at = 0.05 }");
    let ended = case.run();
    let said = ended.said();
    assert_eq!(ended.output.status.code(), Some(1), "{said}");
    for words in [
        "ended with exit status 0 before it came to its end",
        "Head.fmu",
        "isolate = true",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let left = case.results("out");
    assert!(left.join("scene.toml").exists() && !left.join("summary.json").exists());
    // The next run says so, and is complete.
    let scene = std::fs::read_to_string(case.results("scene.toml")).unwrap();
    std::fs::write(case.results("scene.toml"), scene.replace("_exit0", "")).unwrap();
    let ended = case.run();
    let said = ended.said();
    assert!(ended.output.status.success(), "{said}");
    assert!(
        said.contains("an earlier run did not come to its end") && said.contains("`master run` of"),
        "{said}"
    );
    assert_eq!(case.summary("out")["complete"], true);
    let said = case.run().said();
    assert!(!said.contains("an earlier run"), "{said}");
}

/// A thread that an FMU leaves behind crashes when the library is unloaded, with results complete.
#[test]
fn regress_35_a_thread_that_an_fmu_leaves_behind_is_told_and_costs_no_results() {
    let case = Case::new("parameters = { fault = \"haunt\", at = 0.05 }");
    let ended = case.run();
    let said = ended.said();
    assert_eq!(ended.output.status.code(), Some(1), "{said}");
    for words in [
        "was ended by SIGSEGV",
        "has left a thread",
        "what is written stays",
        "Head.fmu",
    ] {
        assert!(said.contains(words), "{said}");
    }
    assert_eq!(case.summary("out")["complete"], true);
    assert_eq!(case.rows("out"), 101);
}

/// Statuses, signals and standard output go through the process that watches.
#[test]
fn a_run_that_is_watched_is_like_any_other() {
    let case = Case::new("");
    let ended = case.run_with("out", &["--json"]);
    assert!(ended.output.status.success(), "{}", ended.said());
    let summary: serde_json::Value = serde_json::from_slice(&ended.output.stdout).expect("JSON and nothing else");
    assert_eq!(summary["complete"], true);
    let ended = case.run_with("none", &["--set", "run.speed_kmh=-1"]);
    assert_eq!(ended.output.status.code(), Some(2), "{}", ended.said());
    // An end in order where the process that watches is asked alone, and where it is killed.
    for (signal, status) in [("TERM", Some(1)), ("KILL", None)] {
        let long = ["--set", "run.duration=600", "--set", "run.speed_kmh=0.5", "-q"];
        let mut command = case.command(signal, &long);
        let mut master = command.stderr(Stdio::piped()).spawn().unwrap();
        let begin = Instant::now();
        while !case.results(signal).join("scene.toml").exists() {
            assert!(begin.elapsed() < Duration::from_secs(60) && master.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(200));
        assert_eq!(case.processes(), 2, "one of them watches");
        let mut kill = Command::new("kill");
        let sent = kill.args([&format!("-{signal}"), &master.id().to_string()]).status();
        assert!(sent.unwrap().success());
        assert_eq!(master.wait().unwrap().code(), status);
        let begin = Instant::now();
        while case.processes() > 0 {
            assert!(begin.elapsed() < Duration::from_secs(20), "a process is left");
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_eq!(case.results(signal).join("summary.json").exists(), signal == "TERM");
    }
}

#[test]
fn regress_35_an_fmu_that_ends_what_loads_it_is_met_in_the_trial_and_not_in_this_process() {
    for (variable, fault, words) in [
        ("HEAD_LOAD", "segv", "loading its binary crashed with SIGSEGV"),
        ("HEAD_LOAD", "_exit", "ended its process with exit status 4"),
        ("HEAD_LOAD", "loop", "took longer than step_timeout = 1 s"),
        ("HEAD_FAULT", "abort", "fmi2Instantiate crashed with SIGABRT"),
        ("HEAD_FAULT", "exit", "fmi2Instantiate ended its process by exit(3)"),
    ] {
        let case = Case::new("step_timeout = 1");
        let mut command = case.command("out", &[]);
        let output = command.env(variable, fault).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{fault}: {said}");
        for words in [
            "pantograph[1].fmu (",
            "Head.fmu): it is not loaded into this program: the trial ended while initialising an instance: ",
            words,
        ] {
            assert!(said.contains(words), "{fault}: \"{words}\" is missing in\n{said}");
        }
        assert_eq!(case.processes(), 0, "{fault}: no process is left");
        let leftovers = std::fs::read_dir(case.folder.path()).unwrap().count();
        assert_eq!(
            leftovers, 2,
            "{fault}: scene and FMU; neither results nor the unpacked archive"
        );
    }
}

#[test]
fn directory_and_locale_that_an_fmu_changes_in_this_process_are_put_back() {
    let case = Case::new("parameters = { fault = \"home\", at = 0.05 }");
    let mut command = case.command("relative", &[]);
    let output = command.env("HEAD_FAULT", "wander").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(case.rows("relative"), 101);
}

#[test]
fn an_isolated_fmu_that_hangs_at_its_end_does_not_keep_the_program() {
    let case = Case::isolated("terminate", 1e9);
    let ended = case.run();
    assert!(ended.output.status.success(), "{}", ended.said());
    assert!(
        ended.said().contains("pantograph 1: it failed at its end"),
        "{}",
        ended.said()
    );
    assert_eq!(case.rows("out"), 101);
}

#[test]
fn ctrl_c_keeps_the_results_of_an_isolated_run_and_leaves_no_child() {
    let case = Case::isolated("", 1e9);
    // Far longer than the test: slow enough to stay under the line.
    let long = ["--set", "run.duration=60", "--set", "run.speed_kmh=5", "-q"];
    let mut command = case.command("out", &long);
    let mut master = command.stderr(Stdio::piped()).process_group(0).spawn().unwrap();
    // The scene is written when the time loop begins.
    let begin = Instant::now();
    while !case.results("out").join("scene.toml").exists() {
        let ended = master.try_wait().unwrap();
        let waits = ended.is_none() && begin.elapsed() < Duration::from_secs(60);
        assert!(waits, "the run does not begin: {ended:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(case.processes(), 2, "the FMU has a process of its own");
    // As a terminal does: to the whole foreground group, which the child does not belong to.
    let group = format!("-{}", master.id());
    let sent = Command::new("kill").args(["-INT", "--", &group]).status().unwrap();
    assert!(sent.success());
    let output = master.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("interrupted at t = "), "{said}");
    assert_eq!(case.processes(), 0, "no process is left");
    let summary = case.summary("out");
    assert_eq!(summary["complete"], false);
    let reason = summary["incomplete_reason"].as_str().unwrap();
    assert!(reason.starts_with("interrupted at t = "), "{reason}");
    assert!(case.rows("out") > 10, "{} rows", case.rows("out"));
    assert!(case.results("out").join("report.html").exists());
}

#[test]
fn a_child_does_not_outlive_a_killed_master() {
    let case = Case::new("isolate = true\nparameters = { fault = \"loop\", at = 0.05 }");
    let mut master = case.command("out", &["-q"]).stderr(Stdio::null()).spawn().unwrap();
    let eventually = |wanted: usize| {
        let begin = Instant::now();
        while case.processes() != wanted {
            assert!(
                begin.elapsed() < Duration::from_secs(30),
                "{} processes, not {wanted}",
                case.processes()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    eventually(2);
    std::thread::sleep(Duration::from_millis(300));
    master.kill().unwrap();
    master.wait().unwrap();
    eventually(0);
}
