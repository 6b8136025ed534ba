//! A supplied pantograph through the program's command line.

use std::process::Output;

use tempfile::TempDir;

use super::*;

fn master(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_master"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The scene with `table` for its pantograph, in a file, run by the program; its exit status and the notes.
fn run_file(folder: &TempDir, table: &str) -> (Option<i32>, String) {
    let file = folder.path().join("pasted.toml");
    std::fs::write(&file, replaced(&base(), "[[pantograph]]", table)).unwrap();
    let out = folder.path().join("out");
    let arguments = [
        "run",
        file.to_str().unwrap(),
        "--mode",
        "inprocess",
        "--json",
        "--out",
        out.to_str().unwrap(),
    ];
    let output = master(&arguments);
    (output.status.code(), text(&output.stdout) + &text(&output.stderr))
}

#[test]
fn the_table_that_inspect_prints_runs_when_it_is_pasted() {
    for manners in [
        Manners {
            defines: &["UNITS", "LIFTS"],
            units: true,
            ..Manners::default()
        },
        Manners {
            silent: true,
            ..Manners::default()
        },
    ] {
        let folder = tempfile::tempdir().unwrap();
        let fmu = made(folder.path(), manners);
        let output = master(&["inspect", fmu.to_str().unwrap()]);
        let said = text(&output.stdout);
        assert!(output.status.success(), "{said}");
        assert!(said.contains("the same three steps after going back"), "{said}");
        let table = &said[said.find("[[pantograph]]").unwrap()..];
        let (code, said) = run_file(&folder, table);
        assert_eq!(code, Some(0), "{table}\n{said}");
        let json = master(&["inspect", fmu.to_str().unwrap(), "--json"]);
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        assert_eq!(json["side"], "pantograph");
        assert_eq!(json["probe"]["rollback"], true);
        assert_eq!(json["probe"]["input_derivatives"], 1, "order 2 is refused");
        assert_eq!(json["wiring"]["outputs"]["height"], "Wippe.z1");
        assert_eq!(json["toml"].as_str().unwrap().trim(), table.trim());
    }
}

#[test]
fn an_fmu_that_crashes_or_hangs_while_it_is_tried_takes_nothing_down() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = made(
        folder.path(),
        Manners {
            defines: &["CRASHES"],
            ..Manners::default()
        },
    );
    let output = master(&["inspect", fmu.to_str().unwrap()]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0));
    let claim = |said: &str| {
        said.lines()
            .find(|line| line.contains("canGetAndSetFMUstate") && line.contains("does not hold"))
            .map(str::to_owned)
    };
    let found = claim(&said).unwrap_or_else(|| panic!("{said}"));
    assert!(found.contains("fmi2GetFMUstate") && found.contains("abort"), "{found}");
    assert!(
        said.contains("as 7.2"),
        "what comes after is tried all the same: {said}"
    );
    assert!(said.contains("[[pantograph]]"), "{said}");
    // A run goes without what was being tried.
    let (code, said) = run_file(&folder, WIRED);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("it claims canGetAndSetFMUstate, which does not hold"),
        "{said}"
    );

    let folder = tempfile::tempdir().unwrap();
    made(
        folder.path(),
        Manners {
            defines: &["HANGS"],
            ..Manners::default()
        },
    );
    let (code, said) = run_file(&folder, &format!("{WIRED}step_timeout = 0.5\n"));
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("it claims canGetAndSetFMUstate, which does not hold"),
        "{said}"
    );
    assert!(said.contains("0.5 s"), "{said}");
}
