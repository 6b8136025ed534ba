//! FMUs made from a scene: `Catenary.fmu`, and `Pantograph.fmu`, `Pantograph2.fmu`, … one per pantograph modelled here.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use component::{Component, Role};
use fmi2::archive::{LIBRARY_EXTENSION, Package, binary_entry};
use fmi2::import::Fmu;
use scene::{Line, PantographModel, Scene};

use crate::inprocess::of_pantograph;
use crate::report::escape;

mod needs;

pub use needs::Needs;

/// Of what is inside: this program's own, and those of the libraries it is made of.
const LICENSES: [&str; 2] = [include_str!("../../LICENSE"), include_str!("../../fmu/licenses.txt")];

/// The libraries of the shells.
const SHELLS: [&str; 2] = ["catenary_fmu", "pantograph_fmu"];

/// Why the FMUs cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// Neither a source tree nor the libraries are there.
    #[error(
        "{missing} is not beside this program ({folder}): run `cargo build --release` in the \
         source tree and copy the library there, or run the program from the source tree"
    )]
    NoLibrary {
        /// File name.
        missing: String,
        /// Folder looked into.
        folder: String,
    },
    /// Cargo cannot be started.
    #[error("cannot run `{command}`")]
    NoCargo {
        /// What was to run.
        command: String,
        /// Reason of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// Cargo failed.
    #[error("`{command}` failed ({status}):\n{output}")]
    Build {
        /// What was run.
        command: String,
        /// How it ended.
        status: std::process::ExitStatus,
        /// What it printed.
        output: String,
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
    let program = std::env::current_exe().ok()?;
    let around = program
        .ancestors()
        .find(|folder| folder.join("fmu-catenary/Cargo.toml").exists() && folder.join("Cargo.toml").exists());
    around.map(Path::to_owned)
}

/// Folder that packages of scenes go to.
#[must_use]
pub fn folder(scene: &str) -> PathBuf {
    source_tree().unwrap_or_default().join("target/fmu").join(scene)
}

impl Libraries {
    /// Builds the libraries where there is a source tree, else takes those beside the program; once per process.
    ///
    /// # Errors
    /// [`PackageError`]; `say` is given what takes long.
    pub fn find(say: &dyn Fn(&str)) -> Result<Self, PackageError> {
        static FOUND: OnceLock<Libraries> = OnceLock::new();
        if let Some(found) = FOUND.get() {
            return Ok(found.clone());
        }
        let found = Self::look(say)?;
        Ok(FOUND.get_or_init(|| found).clone())
    }

    fn look(say: &dyn Fn(&str)) -> Result<Self, PackageError> {
        if let Some(tree) = source_tree() {
            return Self::build(&tree, say);
        }
        let program = std::env::current_exe().unwrap_or_default();
        let folder = program.parent().unwrap_or(Path::new("."));
        let [catenary, pantograph] = SHELLS.map(|library| {
            let name = format!("{}{library}.{LIBRARY_EXTENSION}", std::env::consts::DLL_PREFIX);
            let path = folder.join(&name);
            if path.exists() {
                Ok(path)
            } else {
                Err(PackageError::NoLibrary {
                    missing: name,
                    folder: folder.display().to_string(),
                })
            }
        });
        Ok(Self {
            catenary: catenary?,
            pantograph: pantograph?,
        })
    }

    fn build(tree: &Path, say: &dyn Fn(&str)) -> Result<Self, PackageError> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        // The whole workspace, as `cargo run` selects it: a selection of packages unifies other features, so that all they
        // depend on would be compiled a second time, and each call would undo the other's libraries.
        command
            .current_dir(tree)
            .args(["build", "--release", "--message-format=json-render-diagnostics"]);
        let shown = "cargo build --release".to_owned();
        if !SHELLS
            .iter()
            .all(|library| tree.join(format!("target/release/{}", library_file(library))).exists())
        {
            say(&format!("building the FMUs: {shown}"));
        }
        let output = command.output().map_err(|source| PackageError::NoCargo {
            command: shown.clone(),
            source,
        })?;
        if !output.status.success() {
            let output_text = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(PackageError::Build {
                command: shown,
                status: output.status,
                output: output_text,
            });
        }
        let messages = String::from_utf8_lossy(&output.stdout);
        let [catenary, pantograph] = SHELLS.map(|library| {
            artifact(&messages, library).ok_or_else(|| PackageError::NoLibrary {
                missing: library_file(library),
                folder: tree.join("target/release").display().to_string(),
            })
        });
        Ok(Self {
            catenary: catenary?,
            pantograph: pantograph?,
        })
    }
}

fn library_file(library: &str) -> String {
    format!("{}{library}.{LIBRARY_EXTENSION}", std::env::consts::DLL_PREFIX)
}

/// The shared library of a target among cargo's messages.
fn artifact(messages: &str, target: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .find_map(|message| {
            if message["reason"] != "compiler-artifact" || message["target"]["name"] != target {
                return None;
            }
            let files = message["filenames"].as_array()?.iter().filter_map(|file| file.as_str());
            files
                .map(PathBuf::from)
                .find(|file| file.extension().is_some_and(|extension| extension == LIBRARY_EXTENSION))
        })
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
        archives.push((
            "Catenary.fmu".to_owned(),
            archive::<catenary::Subsystem>(scene, library),
        ));
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

/// What the system has to bring along [FMI 2.0, 2.3].
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
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title></head><body>\n<h1>{0}</h1>\n\
         <p>{1}</p>\n<p>Scene: {2}</p>\n<p>x runs along the track in the direction of travel, 0 at the first support, y to the \
         left, z up from the top of rail; SI units. <i>contact.force</i> is positive in compression, <i>fx, fy, fz</i> act on \
         the strip.</p>\n\
         <p>Inside a step an input follows the derivatives given with fmi2SetRealInputDerivatives (orders 1 to 3, at the start of \
         the step). Without them a strip position follows its velocity input while inputs.follow_velocity is true, and \
         everything else is held. After the step the input keeps the value it has reached, and its derivatives are 0.</p>\n\
         <p>fmi2GetDirectionalDerivative gives partial derivatives of outputs with respect to inputs at the communication \
         point, states frozen; it is not what a change of the input does over a step.</p>\n\
         <table border=\"1\" cellspacing=\"0\" cellpadding=\"3\"><tr><th>name</th><th></th><th>meaning</th></tr>\n",
        C::IDENTIFIER,
        escape(C::DESCRIPTION),
        escape(&scene.title),
    );
    let role = |role: Role| match role {
        Role::Input => "input",
        Role::Output => "output",
        Role::Setting => "parameter",
    };
    let signals = C::signals(scene);
    let parameters = C::parameters(scene);
    let signals = signals
        .iter()
        .map(|signal| (signal.name.as_str(), role(signal.role), signal.description.as_str()));
    let parameters = parameters
        .iter()
        .map(|parameter| (parameter.name.as_str(), "parameter", parameter.description.as_str()));
    for (name, role, text) in signals.chain(parameters) {
        page.push_str(&format!(
            "<tr><td>{}</td><td>{role}</td><td>{}</td></tr>\n",
            escape(name),
            escape(text)
        ));
    }
    page.push_str(
        "</table>\n<p><a href=\"licenses/license.txt\">Licences</a> of what is inside.</p>\n</body></html>\n",
    );
    page
}

/// Makes sure that `folder` holds the FMUs of a resolved scene, and opens them: file name and FMU.
///
/// An FMU whose GUID says that it is made of the same description, scene and library is left as it is.
///
/// # Errors
/// See [`PackageError`].
pub fn ensure(scene: &Scene, libraries: &Libraries, folder: &Path) -> Result<Vec<(String, Fmu)>, PackageError> {
    let mut fmus = Vec::new();
    for (name, package) in archives(scene, libraries)? {
        let path = folder.join(&name);
        let guid = package.guid(&path)?;
        let present = if path.exists() { Fmu::open(&path).ok() } else { None };
        let fmu = match present {
            Some(fmu) if fmu.description().guid == guid => fmu,
            _ => {
                package.write(&path)?;
                let fmu = Fmu::open(&path)?;
                if fmu.description().guid == guid {
                    fmu
                } else {
                    privately(&package, &name)?
                }
            }
        };
        fmus.push((name, fmu));
    }
    Ok(fmus)
}

/// Another run has just written its own FMU to the same place: ours is read from a folder of its own.
fn privately(package: &Package, name: &str) -> Result<Fmu, PackageError> {
    let folder = tempfile::tempdir().map_err(|source| PackageError::Read {
        path: std::env::temp_dir(),
        source,
    })?;
    let path = folder.path().join(name);
    package.write(&path)?;
    Ok(Fmu::open(&path)?)
}
