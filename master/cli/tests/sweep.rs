//! `master sweep` as a user meets it: files, exit status, messages, going on after an end.

mod short;

use short::SHORT;
use std::path::Path;
use std::process::{Command, Output};

fn sweep(out: &Path, more: &[&str]) -> Output {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command.arg("sweep").arg(scene).arg("--out").arg(out);
    for key in SHORT {
        command.args(["--set", key]);
    }
    command.args(more).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_sweep_writes_its_tables_and_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let vary = [
        "--vary",
        "run.speed_kmh=200,900",
        "--vary",
        "pantograph[1].static_force=100:120:20",
    ];
    let output = sweep(folder.path(), &vary);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("4 of 4 cases finished, 2 stable, 2 refused"),
        "{}",
        text(&output.stdout)
    );
    let table = std::fs::read(folder.path().join("sweep.csv")).unwrap();
    let mut csv = csv::Reader::from_reader(&*table);
    let names: Vec<String> = csv.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        names[..5],
        [
            "case",
            "pantograph",
            "run.speed_kmh",
            "pantograph[1].static_force",
            "status"
        ]
    );
    let rows: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    let status: Vec<&str> = rows.iter().map(|row| &row[4]).collect();
    assert_eq!(status, ["stable", "stable", "refused", "refused"]);
    assert!(rows[2][5].contains("wave speed"), "{}", &rows[2][5]);
    for file in ["sweep.parquet", "sweep.html", "sweep-times.csv"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }

    // A kill in the middle of the last case.
    let journal = folder.path().join("sweep.journal");
    let lines = std::fs::read(&journal).unwrap();
    std::fs::write(&journal, &lines[..lines.len() - 9]).unwrap();
    let output = sweep(folder.path(), &[&vary[..], &["--jobs", "1", "--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&summary["made_earlier"], &summary["finished"]), (&3.into(), &4.into()));
    assert!(std::fs::read(folder.path().join("sweep.csv")).unwrap() == table);

    let output = sweep(folder.path(), &vary[..2]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("holds the results of another sweep (other plan)"));
    assert!(std::fs::read(folder.path().join("sweep.csv")).unwrap() == table);
}

#[test]
fn wrong_usage_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("none");
    for (more, parts) in [
        (
            &["--vary", "run.sped_kmh=200"][..],
            &["run.sped_kmh", "did you mean"][..],
        ),
        (
            &["--vary", "run.speed_kmh=200:300"],
            &["a distribution is sampled", "--sample"],
        ),
        (
            &["--vary", "run.speed_kmh=200:300", "--sample", "halton"],
            &["latin, sobol, random"],
        ),
        (&["--vary", "run.speed_kmh=200:300", "--sample", "latin"], &["--count"]),
        (&["--vary", "run.speed_kmh"], &["key=values"]),
        (
            &["--vary", "run.speed_kmh=200", "--where", "run.speed_kmh >"],
            &["--where", "must be an expression"],
        ),
        (
            &["--vary", "run.speed_kmh=200", "--set", "run.speed_kmh=250"],
            &["run.speed_kmh: is set for all cases too, by run.speed_kmh=250"],
        ),
        (
            &["--count", "-3"],
            &["'-3' for '--count", "must be a whole number from 0"],
        ),
        (
            &["--seed", "-1"],
            &["'-1' for '--seed", "must be a whole number from 0"],
        ),
        (&[], &["no key is varied"]),
    ] {
        let output = sweep(&out, more);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        assert!(!out.exists());
    }
}
