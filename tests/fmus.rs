//! FMUs of scenes, packaged as the program does it.
use crate::runs::{prepared, scene_with};
use cosim::package::{Libraries, archives};
use fmi2::import::{Fmu, Instance};
use fmi2::model_description::Causality;
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;

/// The scene that runs without arguments: the thesis with its vehicle, on a corrected mesh.
pub const SHIPPED: &str = include_str!("../scenes/thesis.toml");
/// The thesis with its vehicle, on its own mesh.
pub const DEFAULT: &str = include_str!("../scenes/thesis-own-mesh.toml");
/// The thesis without its vehicle, on its own mesh.
pub const THESIS: &str = include_str!("../scenes/thesis-pantograph.toml");

/// Keeps the line of EN 50318 small: these tests are about the protocol.
pub const COARSE: &[&str] = &["catenary.mesh.elements_per_interval=1"];

/// Root of the source tree.
#[must_use]
pub fn tree() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests are a folder of the source tree")
}

/// A resolved scene and the folder with its FMUs.
pub struct Packaged {
    /// Scene as in the FMUs.
    pub scene: Scene,
    folder: TempDir,
}

impl Packaged {
    /// Packages a scene; `overrides` as on the command line.
    ///
    /// # Panics
    /// When packaging fails.
    #[must_use]
    pub fn new(text: &str, overrides: &[&str]) -> Self {
        static LIBRARIES: OnceLock<Libraries> = OnceLock::new();
        let libraries = LIBRARIES.get_or_init(|| Libraries::find().unwrap());
        let scene = prepared(scene_with(text, overrides), "scene.toml").scene;
        // A name that has to be encoded in a URI.
        let folder = tempfile::Builder::new().prefix("fmus ü 100%41 ").tempdir().unwrap();
        for (name, archive) in archives(&scene, libraries).unwrap() {
            archive.write(&folder.path().join(name)).unwrap();
        }
        Self { scene, folder }
    }

    /// Path of one of the two FMUs.
    #[must_use]
    pub fn path(&self, identifier: &str) -> PathBuf {
        self.folder.path().join(format!("{identifier}.fmu"))
    }

    /// Opens one of the two.
    ///
    /// # Panics
    /// When it is refused.
    #[must_use]
    pub fn open(&self, identifier: &str) -> Fmu {
        Fmu::open(self.path(identifier)).unwrap()
    }
}

/// Value reference of a variable.
///
/// # Panics
/// When there is none of that name.
#[must_use]
pub fn reference(fmu: &Fmu, name: &str) -> u32 {
    let variable = fmu
        .description()
        .variables
        .iter()
        .find(|variable| variable.name == name);
    variable.unwrap_or_else(|| panic!("no variable {name}")).value_reference
}

/// References of all real variables of a causality.
#[must_use]
pub fn reals(fmu: &Fmu, causality: Causality) -> Vec<u32> {
    let variables = fmu.description().variables.iter();
    let real = fmi2::model_description::BaseType::Real;
    let chosen = variables.filter(|variable| variable.causality == causality && variable.base_type() == real);
    chosen.map(|variable| variable.value_reference).collect()
}

/// Brings a new instance to its first communication point at t = 0.
///
/// # Panics
/// When a call fails.
pub fn initialise(instance: &mut Instance) {
    instance.setup_experiment(0.0, Some(2.0), None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
}

/// A new instance at its first communication point.
///
/// # Panics
/// When a call fails.
#[must_use]
pub fn started(fmu: &Fmu, name: &str) -> Instance {
    let mut instance = fmu.instantiate(name, false, false).unwrap();
    initialise(&mut instance);
    instance
}

/// Values of real variables.
///
/// # Panics
/// When they cannot be read.
pub fn read(instance: &mut Instance, references: &[u32]) -> Vec<f64> {
    let mut values = vec![0.0; references.len()];
    instance.get_real(references, &mut values).unwrap();
    values
}
