//! The oscillator as an FMU in a temporary folder.
#![allow(dead_code)] // each test file needs a part

#[path = "../../examples/oscillator/variables.rs"]
pub mod variables;

use fmi2::archive::Package;
use fmi2::import::{Fmu, Instance};
use fmi2::model_description::{DefaultExperiment, ModelDescription};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;
use std::time::SystemTime;
use tempfile::TempDir;
pub use variables::at;

/// The description of the oscillator with the GUID placeholder.
pub fn description() -> ModelDescription {
    let mut description = ModelDescription::of_slave("Oscillator", variables::table());
    description.description = Some("Driven oscillator, m a = F - k x - c v".into());
    description.version = Some("1".into());
    description.generation_tool = Some("fmi2 tests".into());
    description.co_simulation.max_output_derivative_order = 2;
    description.default_experiment = Some(DefaultExperiment {
        start_time: Some(0.0),
        stop_time: Some(1.0),
        tolerance: None,
        step_size: Some(1e-3),
    });
    description
}

/// Time at which the newest file below `folder` was changed.
fn newest(folder: &Path) -> SystemTime {
    let changed = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.unwrap();
        let metadata = entry.metadata().unwrap();
        if metadata.is_dir() {
            newest(&entry.path())
        } else {
            metadata.modified().unwrap()
        }
    };
    std::fs::read_dir(folder)
        .unwrap()
        .map(changed)
        .max()
        .unwrap_or(SystemTime::UNIX_EPOCH)
}

/// The shared library of the example; built if it is missing or older than its sources. (`cargo test` builds it
/// before the tests, `cargo test --test …` does not.)
pub fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let profile = test.parent().unwrap().parent().unwrap();
    let name = format!(
        "{}oscillator{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let path = profile.join("examples").join(name);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = newest(&root.join("src")).max(newest(&root.join("examples")));
    let built = std::fs::metadata(&path).and_then(|metadata| metadata.modified());
    if built.is_ok_and(|built| built >= sources) {
        return path;
    }
    static BUILD: Once = Once::new();
    BUILD.call_once(|| {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.args(["build", "--example", "oscillator", "--manifest-path"]);
        cargo.arg(root.join("Cargo.toml"));
        cargo.arg("--target-dir").arg(profile.parent().unwrap());
        if profile.ends_with("release") {
            cargo.arg("--release");
        }
        assert!(
            cargo.status().unwrap().success(),
            "the example oscillator does not build"
        );
    });
    path
}

/// Content of the FMU of the oscillator.
pub fn package() -> Package {
    Package {
        description: description().to_xml(),
        library: std::fs::read(library()).unwrap(),
        resources: [("note.txt".to_owned(), b"nothing\n".to_vec())].into(),
        documentation: [("index.html".to_owned(), b"<p>Oscillator</p>\n".to_vec())].into(),
    }
}

/// An FMU with the folder it lies in.
pub struct Example {
    pub folder: TempDir,
    pub fmu: Fmu,
}

/// The FMU of the oscillator, in a folder with a name that needs encoding.
pub fn example() -> Example {
    let folder = tempfile::Builder::new().prefix("fmi2 ü 100% ").tempdir().unwrap();
    let path = folder.path().join("Oscillator.fmu");
    package().write(&path).unwrap();
    let fmu = Fmu::open(&path).unwrap();
    Example { folder, fmu }
}

/// A new instance.
pub fn instance(fmu: &Fmu) -> Instance {
    fmu.instantiate("osc", false, false).unwrap()
}

/// An instance at t = 0 that is ready to step.
pub fn running(fmu: &Fmu) -> Instance {
    let mut instance = instance(fmu);
    initialise(&mut instance);
    instance
}

pub fn initialise(instance: &mut Instance) {
    instance.setup_experiment(0.0, Some(10.0), None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
}

pub fn real(instance: &mut Instance, position: usize) -> f64 {
    let mut value = [f64::NAN];
    instance.get_real(&[position as u32], &mut value).unwrap();
    value[0]
}

/// Steps of 1 ms from step `first`, each with a force that depends on its number; the positions afterwards.
pub fn steps(instance: &mut Instance, first: usize, count: usize) -> Vec<u64> {
    (first..first + count)
        .map(|n| {
            let force = 20.0 * (0.01 * n as f64).sin();
            instance.set_real(&[at::FORCE as u32], &[force]).unwrap();
            instance.do_step(n as f64 * 1e-3, 1e-3).unwrap();
            real(instance, at::X).to_bits()
        })
        .collect()
}
