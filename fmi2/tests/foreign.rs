//! The importer against an FMU written in C that misbehaves as told.
#![cfg(all(unix, target_arch = "x86_64"))]

mod support;

use fmi2::archive::Package;
use fmi2::import::{Fmu, Instance, StepOutcome};
use fmi2::{Error, abi::Status};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The FMU, its description changed by `change`, with the folder it lies in.
fn foreign(define: &str, change: impl Fn(String) -> String) -> (TempDir, Fmu) {
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("foreign.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign.c");
    let mut cc = Command::new(std::env::var_os("CC").unwrap_or("cc".into()));
    let status = cc
        .args(["-shared", "-fPIC", define, "-o"])
        .arg(&library)
        .arg(source)
        .status();
    assert!(status.expect("a C compiler, which the crate needs as well").success());
    let package = Package {
        description: change(support::description().to_xml()),
        library: std::fs::read(library).unwrap(),
        ..Package::default()
    };
    let path = folder.path().join("Foreign.fmu");
    package.write(&path).unwrap();
    let fmu = Fmu::open(path).unwrap();
    (folder, fmu)
}

fn running(fmu: &Fmu) -> Instance {
    let mut instance = support::instance(fmu);
    support::initialise(&mut instance); // fmi2SetupExperiment returns a warning, which is fine
    instance
}

#[test]
fn messages_are_formatted_and_the_host_is_left_as_it_was() {
    let (_folder, fmu) = foreign("-DX", |xml| xml);
    let tiny = std::hint::black_box(f64::MIN_POSITIVE);
    let mut instance = running(&fmu);
    assert!(tiny / 2.0 > 0.0, "flush to zero is undone");
    let log = instance.take_log();
    assert_eq!(log[0].text, "the binary says version \"2.0.4\", expected \"2.0\"");
    assert_eq!(log[1].text, "made osc, 100% of force, 1.500");
    assert_eq!(instance.do_step(0.0, 2.0).unwrap(), StepOutcome::Discard);
    assert_eq!(instance.take_log()[0].text, "x".repeat(5000), "longer than any buffer");
}

#[test]
fn a_bad_status_is_named_with_the_messages_of_the_call() {
    let (_folder, fmu) = foreign("-DX", |xml| xml);
    let mut instance = running(&fmu);
    assert_eq!(instance.do_step(0.0, 0.0).unwrap(), StepOutcome::Ok);
    assert_eq!(
        instance.do_step(0.0, 1.0).unwrap(),
        StepOutcome::Ok,
        "a warning is fine"
    );
    let error = instance.do_step(0.0, 3.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "osc (Oscillator): fmi2DoStep returned fmi2Error: line 1 line 2"
    );
    instance.reset().unwrap();
    assert_eq!(
        instance.do_step(0.0, 5.0).unwrap(),
        StepOutcome::Discard,
        "what a pending step ends with"
    );
}

#[test]
fn after_a_fatal_status_nothing_is_called_any_more() {
    for step in [4.0, 42.0] {
        let (_folder, fmu) = foreign("-DX", |xml| xml);
        let (mut instance, mut other) = (running(&fmu), running(&fmu));
        let error = instance.do_step(0.0, step).unwrap_err();
        assert!(
            matches!(
                error,
                Error::Call {
                    status: Status::Fatal,
                    ..
                }
            ),
            "{error}"
        );
        for error in [
            other.reset().unwrap_err(),
            fmu.instantiate("new", false, false).unwrap_err(),
        ] {
            assert!(matches!(error, Error::AfterFatal { .. }), "{error}");
        }
        drop((instance, other)); // freeing either would abort
    }
}

#[test]
fn a_missing_function_is_named_and_a_missing_optional_one_disables_its_feature() {
    let (_folder, fmu) = foreign("-DX", |xml| xml);
    let mut instance = running(&fmu);
    let error = instance.save_state().unwrap_err();
    assert_eq!(error.to_string(), "osc (Oscillator): the FMU has no fmi2GetFMUstate");
    assert_eq!(instance.last_successful_time().unwrap(), None);
    assert!(!instance.wants_to_terminate().unwrap());
    let (_folder, fmu) = foreign("-DINCOMPLETE", |xml| xml);
    let error = fmu.instantiate("osc", false, false).unwrap_err().to_string();
    assert!(
        error.ends_with("Foreign.fmu: the binary does not export fmi2DoStep"),
        "{error}"
    );
}

#[test]
fn a_second_instance_is_refused_where_only_one_is_possible() {
    let once = "canBeInstantiatedOnlyOncePerProcess=\"true\" canInterpolateInputs";
    let (_folder, fmu) = foreign("-DX", |xml| xml.replacen("canInterpolateInputs", once, 1));
    let instance = support::instance(&fmu);
    let error = fmu.instantiate("second", false, false).unwrap_err();
    assert!(matches!(error, Error::OnlyOnce { .. }), "{error}");
    drop(instance);
    drop(support::instance(&fmu));
}
