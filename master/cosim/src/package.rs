//! FMUs made from a scene: `Catenary.fmu`, and `Pantograph.fmu`, `Pantograph2.fmu`, … one per pantograph modelled here.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use component::{Causality, Component};
use fmi2::archive::{LIBRARY_EXTENSION, Package, binary_entry};
use scene::{Line, PantographModel, Scene};

use component::of_pantograph;
use quick_xml::escape::escape;

mod cache;
mod needs;

pub use cache::{ensure, folder, output};
pub use needs::Needs;

/// Licences of the content: this program's own, and those of the libraries it is made of.
const LICENSES: [&str; 2] = [
    include_str!("../../../LICENSE"),
    include_str!("../../../fmu/licenses.txt"),
];

/// Parts of the libraries with versions, licences and hashes, in CycloneDX.
const PARTS: &str = include_str!("../../../fmu/sbom.cdx.json");

/// The libraries of the shells.
const SHELLS: [&str; 2] = ["catenary_fmu", "pantograph_fmu"];

/// Reason why the FMUs cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// A library is not there.
    #[error(
        "{missing} is not beside this program ({folder}): run `cargo build --release` in the source tree, which \
         builds program and libraries, and copy the library beside a program that is installed elsewhere"
    )]
    NoLibrary {
        /// File name.
        missing: String,
        /// Folder looked into.
        folder: String,
    },
    /// A file cannot be read.
    #[error("{}: cannot be read", path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// Reason of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// The archive cannot be written or read back.
    #[error(transparent)]
    Fmi(#[from] fmi2::Error),
}

/// The shared libraries of both shells.
#[derive(Clone, Debug)]
pub struct Libraries {
    catenary: PathBuf,
    pantograph: PathBuf,
}

/// The source tree that this program was built in, where it still stands around it.
#[must_use]
pub fn source_tree() -> Option<PathBuf> {
    let program = fmi2::program::file().ok()?;
    let around = program
        .ancestors()
        .find(|folder| folder.join("fmu-catenary/Cargo.toml").exists() && folder.join("Cargo.toml").exists());
    around.map(Path::to_owned)
}

impl Libraries {
    /// Their files, catenary first.
    #[must_use]
    pub fn paths(&self) -> [&Path; 2] {
        [&self.catenary, &self.pantograph]
    }

    /// The libraries beside the program, where `cargo build --release`, `cargo test --release` and an installation put
    /// them; looked for once per process.
    ///
    /// # Errors
    /// [`PackageError::NoLibrary`].
    pub fn find() -> Result<Self, PackageError> {
        static FOUND: OnceLock<Libraries> = OnceLock::new();
        if let Some(found) = FOUND.get() {
            return Ok(found.clone());
        }
        let program = fmi2::program::file().unwrap_or_default();
        let folder = program.parent().unwrap_or(Path::new("."));
        let [catenary, pantograph] = SHELLS.map(|library| newest(folder, &library_file(library)));
        let found = Self {
            catenary: catenary?,
            pantograph: pantograph?,
        };
        Ok(FOUND.get_or_init(|| found).clone())
    }
}

/// The newest file `name` beside the program, or in the folders where cargo leaves libraries that were not asked for by
/// name.
fn newest(folder: &Path, name: &str) -> Result<PathBuf, PackageError> {
    let mut folders = vec![folder.to_owned(), folder.join("deps")];
    if folder.ends_with("deps") {
        folders.extend(folder.parent().map(Path::to_owned));
    }
    let built = |path: &PathBuf| std::fs::metadata(path).and_then(|file| file.modified()).ok();
    let files = folders.into_iter().map(|folder| folder.join(name));
    let found = files.filter_map(|path| Some((built(&path)?, path)));
    // Of equal times the first: beside the program.
    let newest = found.reduce(|best, next| if next.0 > best.0 { next } else { best });
    newest.map(|(_, path)| path).ok_or_else(|| PackageError::NoLibrary {
        missing: name.to_owned(),
        folder: folder.display().to_string(),
    })
}

fn library_file(library: &str) -> String {
    format!("{}{library}.{LIBRARY_EXTENSION}", std::env::consts::DLL_PREFIX)
}

fn read(path: &Path) -> Result<Vec<u8>, PackageError> {
    std::fs::read(path).map_err(|source| PackageError::Read {
        path: path.to_owned(),
        source,
    })
}

/// The archives of a resolved scene: file name and content.
///
/// # Errors
/// A library that cannot be read.
pub fn archives(scene: &Scene, libraries: &Libraries) -> Result<Vec<(String, Package)>, PackageError> {
    let mut archives = Vec::new();
    if let Line::Modelled(_) = scene.catenary {
        let library = read(&libraries.catenary)?;
        let mut own = scene.clone();
        // The line knows nothing of who commands drives.
        own.controllers.clear();
        archives.push(("Catenary.fmu".to_owned(), archive::<catenary::Subsystem>(&own, library)));
    }
    let mut library = None;
    for (index, pantograph) in scene.pantographs.iter().enumerate() {
        if let PantographModel::Supplied(_) = pantograph.model {
            continue;
        }
        let bytes = match &library {
            Some(bytes) => Vec::clone(bytes),
            None => library.insert(read(&libraries.pantograph)?).clone(),
        };
        archives.push((
            pantograph_file(index),
            archive::<vehicle::Subsystem>(&of_pantograph(scene, index), bytes),
        ));
    }
    Ok(archives)
}

/// File name of the FMU of pantograph `index` (from 0).
#[must_use]
pub fn pantograph_file(index: usize) -> String {
    if index == 0 {
        "Pantograph.fmu".to_owned()
    } else {
        format!("Pantograph{}.fmu", index + 1)
    }
}

fn archive<C: Component>(scene: &Scene, library: Vec<u8>) -> Package {
    let text = scene.to_toml().into_bytes();
    let mut documents = BTreeMap::from([
        ("index.html".to_owned(), documentation::<C>(scene).into_bytes()),
        ("licenses/license.txt".to_owned(), LICENSES.join("\n").into_bytes()),
        ("sbom.cdx.json".to_owned(), PARTS.as_bytes().to_vec()),
    ]);
    if let Some(needs) = Needs::of(&library) {
        documents.insert(
            "externalDependencies.txt".to_owned(),
            dependencies(C::IDENTIFIER, &needs).into_bytes(),
        );
    }
    Package {
        description: fmu::description::<C>(scene).to_xml(),
        library,
        resources: BTreeMap::from([(fmu::SCENE_RESOURCE.to_owned(), text)]),
        documentation: documents,
    }
}

/// Needs from the system [FMI 2.0, 2.3].
fn dependencies(identifier: &str, needs: &Needs) -> String {
    let mut text = format!("{} needs from the system", binary_entry(identifier));
    if let Some((major, minor)) = needs.glibc() {
        text.push_str(&format!(
            " the GNU C library {major}.{minor} or later (`ldd --version` prints what there is), and"
        ));
    }
    text.push_str(" these shared libraries:\n\n");
    for library in &needs.libraries {
        text.push_str(&format!("    {library}\n"));
    }
    text.push_str("\nNothing else: no environment variable, no file but its own resources, no other program.\n");
    text
}

/// The page that importers show.
fn documentation<C: Component>(scene: &Scene) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta \
         charset=\"utf-8\"><title>{0}, Pantoline</title></head><body>\n<h1>{0}</h1>\n\
         <p>An FMU of Pantoline. {1}</p>\n<p>Scene: {2}</p>\n<p>x runs \
         along the track in the direction of travel, 0 at the first support, y to the left, z up from the top of \
         rail; SI units. <i>contact.force</i> is positive in compression, <i>fx, fy, fz</i> act on the strip.</p>\n\
         <p>Inside a step an input follows the derivatives given with fmi2SetRealInputDerivatives (orders 1 to 3, at \
         the start of the step). Without them a strip position follows its velocity input while \
         inputs.follow_velocity is true, and everything else is held. After the step the input keeps the value it has \
         reached, and its derivatives are 0.</p>\n<p>fmi2GetDirectionalDerivative gives partial derivatives of \
         outputs with respect to inputs at the communication point, states frozen; it is not what a change of the \
         input does over a step.</p>\n<table border=\"1\" cellspacing=\"0\" \
         cellpadding=\"3\"><tr><th>name</th><th></th><th>meaning</th></tr>\n",
        C::IDENTIFIER,
        escape(C::DESCRIPTION),
        escape(&scene.title),
    );
    let causality = |causality: Causality| match causality {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Parameter => "parameter",
    };
    let signals = C::signals(scene);
    let parameters = C::parameters(scene);
    let signals = signals.iter().map(|signal| {
        (
            signal.name.as_str(),
            causality(signal.causality),
            signal.description.as_str(),
        )
    });
    let parameters = parameters
        .iter()
        .map(|parameter| (parameter.name.as_str(), "parameter", parameter.description.as_str()));
    for (name, causality, text) in signals.chain(parameters) {
        page.push_str(&format!(
            "<tr><td>{}</td><td>{causality}</td><td>{}</td></tr>\n",
            escape(name),
            escape(text)
        ));
    }
    page.push_str(
        "</table>\n<p><a href=\"licenses/license.txt\">Licences</a> and <a \
         href=\"sbom.cdx.json\">list</a> of what is inside.</p>\n</body></html>\n",
    );
    page
}
