//! Records of reference models, and uncertainty of later runs.

mod validate;

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn master(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command
        .args(arguments)
        .arg("-q")
        .arg("--out")
        .arg(folder)
        .output()
        .unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_record_holds_figures_of_every_mode_and_is_the_same_but_for_its_date() {
    let folder = tempfile::tempdir().unwrap();
    let model = validate::model(folder.path(), (50.0, 200.0));
    let [first, second] = ["first", "second"].map(|name| {
        let to = folder.path().join(name);
        let output = master(&["validate", &model], &to);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut record = json(&to.join("validation.json"));
        assert!(record["date"].as_str().unwrap().ends_with(" UTC"));
        record["date"] = Value::Null;
        record
    });
    assert_eq!(first, second);
    assert_eq!(first["pass"], true);
    let case = &first["cases"][0];
    let values = case["figures"][0]["values"].as_array().unwrap();
    let modes: Vec<&str> = values.iter().map(|value| value["mode"].as_str().unwrap()).collect();
    assert_eq!(modes, ["monolithic", "inprocess", "cosimulation"]);
    for other in case["coupling"].as_array().unwrap() {
        // Three modes of one model at one step.
        assert!(other["filtered_percent"].as_f64().unwrap() < 0.5, "{other}");
    }
    for hash in [&first["program"], &first["model"], &case["scene_hash"]] {
        assert_eq!(hash.as_str().unwrap().len(), 64);
    }
}

#[test]
fn a_figure_outside_of_its_range_is_exit_status_3_and_the_record_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let model = validate::model(folder.path(), (500.0, 600.0));
    let to = folder.path().join("out");
    let output = master(&["validate", &model], &to);
    assert_eq!(output.status.code(), Some(3));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("own: 1 of the figures"), "{said}");
    assert_eq!(json(&to.join("validation.json"))["pass"], false);
}

#[test]
fn a_model_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(
        &path,
        "standard = \"a\"\nsource = \"b\"\n[[case]]\nname = \"c\"\nscene = \"none.toml\"\n",
    )
    .unwrap();
    let output = master(&["validate", &path.display().to_string()], folder.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("ranges"));
}

#[test]
fn effects_are_differences_of_runs_and_later_runs_of_the_scene_know_them() {
    let folder = tempfile::tempdir().unwrap();
    validate::model(folder.path(), (0.0, 1.0));
    let scene = folder.path().join("short.toml").display().to_string();
    let runs = folder.path().join("runs");
    let range = ["--range", "pantograph[1].static_force=110:130"];
    let output = master(
        &["sensitivity", &scene, range[0], range[1]],
        &folder.path().join("runs-sensitivity"),
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&folder.path().join("runs-sensitivity/sensitivity.json"));
    let mean = &found["figures"][1];
    assert_eq!(mean["figure"], "mean");
    let force = mean["effects"].as_array().unwrap().iter();
    let force = force
        .clone()
        .find(|effect| effect["key"] == "pantograph[1].static_force")
        .unwrap();
    let direct = |key: &str| {
        let output = master(
            &["run", &scene, "--mode", "monolithic", "--no-report", "--set", key],
            &runs,
        );
        assert!(output.status.success());
        json(&runs.join("summary.json"))
    };
    let mean_of = |summary: &Value| {
        summary["pantographs"][0]["contact_force"]["filtered"]["mean"]
            .as_f64()
            .unwrap()
    };
    let known = direct("run.initialise=equilibrium");
    let change = mean_of(&direct("pantograph[1].static_force=130")) - mean_of(&known);
    assert!((force["at_high"].as_f64().unwrap() - change).abs() < 1e-9, "{change}");
    let (above, kept) = (mean["above"].as_f64().unwrap(), &known["uncertainty"][1]);
    assert_eq!(
        (kept["figure"].as_str(), kept["above"].as_f64()),
        (Some("mean"), Some(above))
    );
    // A scene at another speed is another scene.
    assert_eq!(
        direct("run.speed_kmh=240")["uncertainty"].as_array().map(Vec::len),
        Some(0)
    );
}

#[test]
fn a_measured_series_is_compared_with_the_run_and_a_figure_beyond_its_bound_is_exit_status_3() {
    let folder = tempfile::tempdir().unwrap();
    validate::model(folder.path(), (50.0, 200.0));
    let scene = folder.path().join("short.toml").display().to_string();
    let run = folder.path().join("run");
    let output = master(
        &["run", &scene, "--mode", "monolithic", "--no-report", "--no-animation"],
        &run,
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // The run's own force as the measurement: over the whole record, where the model evaluates 0.7 s of it.
    let series = std::fs::read_to_string(run.join("timeseries.csv")).unwrap();
    let mut lines = series.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|found| found.starts_with(name)).unwrap();
    let (time, force) = (column("time"), column("contact[1].force"));
    let rows = |scale: f64| {
        let row = |line: &str| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            format!("{},{}\n", cells[time], 100.0 + scale * (cells[force] - 100.0))
        };
        let rows = lines.clone().map(row);
        format!("time_s,force_N\n{}", rows.collect::<String>())
    };
    for (scale, status) in [(1.0, 0), (3.0, 3)] {
        std::fs::write(folder.path().join("measured.csv"), rows(scale)).unwrap();
        let model = "standard = \"own\"\nsource = \"a test\"\n[[case]]\nname = \"short\"\nscene = \"short.toml\"\n\
                     figures = [\"mean\"]\n[case.measured]\nsource = \"own run\"\nforce = \"measured.csv\"\n\
                     agreement_percent = { std = 60 }\n";
        let path = folder.path().join("measured.toml");
        std::fs::write(&path, model).unwrap();
        let to = folder.path().join(format!("to-{scale}"));
        let output = master(&["validate", &path.display().to_string()], &to);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{said}");
        let record = json(&to.join("validation.json"));
        assert_eq!(record["without_range"], 1);
        let figures = record["cases"][0]["measured"]["figures"].as_array().unwrap();
        assert_eq!(figures.len(), 6);
        let std = figures.iter().find(|figure| figure["quantity"] == "std").unwrap();
        assert_eq!(std["pass"], status == 0, "{std}");
        assert_eq!(record["pass"], status == 0);
        assert!(
            std::fs::read_to_string(to.join("validation.html"))
                .unwrap()
                .contains("plot-spectra-1")
        );
    }
}
