//! The example of an experiment of one's own, as a user runs it.

use std::collections::BTreeMap;
use std::process::Command;

type Line = BTreeMap<String, String>;

#[test]
fn the_table_of_sigma_against_static_force_is_made_once_and_known_the_next_time() {
    let test = std::env::current_exe().unwrap();
    let built = test.ancestors().nth(2).unwrap();
    // A test that is named alone does not build the examples.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--workspace", "--example", "sigma_against_static_force"]);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    assert!(build.status().unwrap().success());
    let program = built.join("examples/sigma_against_static_force");
    let folder = tempfile::tempdir().unwrap();
    let run = || -> Vec<Line> {
        let output = Command::new(&program).arg(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains("static force [N]"));
        let mut reader = csv::Reader::from_path(folder.path().join("sigma.csv")).unwrap();
        reader.deserialize().map(Result::unwrap).collect()
    };
    let lines = run();
    let number = |line: &Line, name: &str| -> f64 { line[name].parse().unwrap() };
    assert_eq!(lines.len(), 5);
    for two in lines.windows(2) {
        assert!(two[1]["status"] == "stable" && number(&two[1], "std_N") > 0.0);
        // More static force is more mean force.
        assert!(number(&two[0], "mean_N") < number(&two[1], "mean_N"), "{two:?}");
    }
    // Wall times included: nothing was made again.
    assert_eq!(run(), lines);
}
