//! Names and descriptions from files of others reach the terminal escaped.

use std::process::Command;

use fmi2::archive::Package;
use fmi2::model_description::{ModelDescription, Variable};

#[test]
fn control_characters_in_names_of_an_fmu_are_shown_and_not_obeyed() {
    let (bell, red) = ("m\u{7}", "Mass \u{1b}[31m of the head");
    let variables = vec![
        Variable::input("force", "N", 0.0, red),
        Variable::output(bell, "m", red),
        Variable::parameter("k\u{1b}]0;title", "N/m", 1.0, "Stiffness"),
    ];
    let package = Package {
        description: ModelDescription::of_slave("Side", variables).to_xml(),
        library: b"none".to_vec(),
        ..Package::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Side.fmu");
    package.write(&path).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_master"))
        .arg("inspect")
        .arg(&path)
        .output()
        .unwrap();
    let said = format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(said.contains("m\\u{7}"), "{said:?}");
    assert!(!said.contains(|c: char| c.is_control() && c != '\n'), "{said:?}");
}
