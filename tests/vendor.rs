//! Pantographs and controllers of other suppliers, written in C, which the tests build, describe and pack as needed,
//! and the line that they run under: `tests/suppliers`.
use crate::fmus::tree;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A short line without a pantograph, as a scene.
pub const LINE: &str = include_str!("suppliers/line.toml");

/// The common pantograph, modelled here.
pub const OWN: &str = "
[[pantograph]]
model = \"lumped\"
strip = { width = 1.2 }
masses = [7.2, 15.0]
stiffnesses = [4200.0, 50.0]
dampings = [10.0, 90.0]
static_force = 120.0
reference_height = 5.28
";

/// The scene of the short line and an FMU, with more keys of its table.
#[must_use]
pub fn under_the_line(fmu: &Path, more: &str) -> String {
    format!(
        "{LINE}\n[[pantograph]]\nfmu = {:?}\n{more}\n",
        fmu.display().to_string()
    )
}

/// Name of the binary in the archive, without extension.
const IDENTIFIER: &str = "two_mass";

/// The pantograph, with a choice of behaviour and description.
#[derive(Clone)]
pub struct Pantograph {
    macros: Vec<String>,
    description: Vec<u8>,
    resources: Vec<(String, Vec<u8>)>,
}

impl Default for Pantograph {
    fn default() -> Self {
        Self::new()
    }
}

impl Pantograph {
    /// The pantograph as a good supplier delivers it.
    ///
    /// # Panics
    /// When its description is missing.
    #[must_use]
    pub fn new() -> Self {
        Self {
            macros: Vec::new(),
            description: fs::read(tree().join("tests/suppliers/modelDescription.xml")).unwrap(),
            resources: Vec::new(),
        }
    }

    /// Adds macros of `pantograph.c` to the build.
    #[must_use]
    pub fn built_with(mut self, macros: &[&str]) -> Self {
        self.macros.extend(macros.iter().map(ToString::to_string));
        self
    }

    /// Replaces words of the description, everywhere.
    ///
    /// # Panics
    /// When the words to replace are missing.
    #[must_use]
    pub fn saying(mut self, instead: &str, words: &str) -> Self {
        let description = String::from_utf8(self.description).unwrap();
        assert!(description.contains(instead), "nothing says {instead}");
        self.description = description.replace(instead, words).into_bytes();
        self
    }

    /// Removes one of the abilities, from behaviour and description.
    #[must_use]
    pub fn unable(self, flag: &str, switch: &str) -> Self {
        let switch = format!("{switch}=0");
        self.saying(&format!("{flag}=\"true\""), &format!("{flag}=\"false\""))
            .built_with(&[&switch])
    }

    /// Replaces the description by these bytes.
    #[must_use]
    pub fn described(mut self, change: impl FnOnce(Vec<u8>) -> Vec<u8>) -> Self {
        self.description = change(self.description);
        self
    }

    /// Adds a file to the resources.
    #[must_use]
    pub fn resource(mut self, name: &str, content: &[u8]) -> Self {
        self.resources.push((name.to_owned(), content.to_vec()));
        self
    }

    /// Builds the pantograph and writes the archive into a folder; returns the path.
    ///
    /// # Panics
    /// Without a C compiler, or when the compiler refuses.
    pub fn write(&self, folder: &Path, name: &str) -> PathBuf {
        let parts = Parts {
            source: "tests/suppliers/pantograph.c",
            identifier: IDENTIFIER,
            macros: &self.macros,
            description: &self.description,
            resources: &self.resources,
        };
        parts.write(folder, name)
    }
}

/// The controller of `examples/own-controller`, with a choice of description.
#[derive(Clone)]
pub struct Controller {
    description: String,
}

impl Default for Controller {
    fn default() -> Self {
        Self::new()
    }
}

impl Controller {
    /// The controller as the example delivers it.
    ///
    /// # Panics
    /// When its description is missing.
    #[must_use]
    pub fn new() -> Self {
        let description = tree().join("examples/own-controller/modelDescription.xml");
        Self {
            description: fs::read_to_string(description).unwrap(),
        }
    }

    /// Replaces words of the description, everywhere.
    ///
    /// # Panics
    /// When the words to replace are missing.
    #[must_use]
    pub fn saying(mut self, instead: &str, words: &str) -> Self {
        assert!(self.description.contains(instead), "nothing says {instead}");
        self.description = self.description.replace(instead, words);
        self
    }

    /// Builds the controller and writes the archive into a folder; returns the path.
    ///
    /// # Panics
    /// Without a C compiler, or when the compiler refuses.
    pub fn write(&self, folder: &Path, name: &str) -> PathBuf {
        let parts = Parts {
            source: "examples/own-controller/pid.c",
            identifier: "pid",
            macros: &[],
            description: self.description.as_bytes(),
            resources: &[],
        };
        parts.write(folder, name)
    }
}

/// Source and content of an FMU.
struct Parts<'a> {
    source: &'a str,
    /// Name of the binary in the archive, without extension.
    identifier: &'a str,
    macros: &'a [String],
    description: &'a [u8],
    resources: &'a [(String, Vec<u8>)],
}

impl Parts<'_> {
    fn write(&self, folder: &Path, name: &str) -> PathBuf {
        let library = folder.join(format!("{name}.{}", std::env::consts::DLL_EXTENSION));
        let mut command = Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()));
        command.args([
            "-std=c11",
            "-O2",
            "-Wall",
            "-Wextra",
            "-shared",
            "-fPIC",
            "-fvisibility=hidden",
        ]);
        command.args(self.macros.iter().map(|name| format!("-D{name}")));
        command.arg("-o").arg(&library).arg(tree().join(self.source));
        let output = command.args(["-lm", "-lpthread"]).output().unwrap_or_else(|error| {
            panic!(
                "the FMU of another supplier is written in C and needs a compiler: {command:?}: {error}. \
                 Install one (Debian, Ubuntu: apt-get install gcc), or name it in CC, and run the tests again"
            )
        });
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let path = folder.join(format!("{name}.fmu"));
        let mut archive = ZipWriter::new(File::create(&path).unwrap());
        let binary = fmi2::archive::binary_entry(self.identifier);
        let library = fs::read(&library).unwrap();
        let mut entry = |name: &str, content: &[u8]| {
            archive.start_file(name, SimpleFileOptions::default()).unwrap();
            archive.write_all(content).unwrap();
        };
        entry("modelDescription.xml", self.description);
        entry(&binary, &library);
        for (name, content) in self.resources {
            entry(&format!("resources/{name}"), content);
        }
        archive.finish().unwrap();
        path
    }
}
