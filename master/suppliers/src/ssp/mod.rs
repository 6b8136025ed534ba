//! System Structure and Parameterization 1.0: a co-simulation as an `.ssp` that other tools open, and scenes made of
//! a supplied `.ssp`.
//!
//! ```text
//! document    what a system structure says, as far as it is used here
//! write       documents to XML
//! read        XML to documents, names and lines kept for messages
//! export      a scene to an archive
//! problem     why parts of a structure are refused
//! unpacked    files of an archive
//! digest      what a system means, as one number
//! import      an archive to a scene
//! flows       its connections with their directions known, and which component is the line
//! foreign     a system of supplied FMUs as a line and pantographs
//! to_scene    these as a scene
//! signals     which quantity a connection carries
//! parameters  values of parameter sets, mapped and converted
//! ```
//!
//! Sections are those of the SSP 1.0 specification (Modelica Association, 2019).

mod digest;
mod document;
mod export;
mod flows;
mod foreign;
mod import;
mod parameters;
mod problem;
mod read;
mod signals;
mod to_scene;
mod unpacked;
mod write;

use std::path::PathBuf;

pub use export::{Exported, export};
pub use import::{Imported, import};

/// Name of the system structure at the root of an archive [SSP 1.0, 3.1].
pub const STRUCTURE_FILE: &str = "SystemStructure.ssd";

/// Type of the annotation that holds what SSP 1.0 has no words for.
pub const ANNOTATION: &str = "io.github.pantograph-catenary.master";

/// Namespace of that annotation's content.
const OWN: &str = "https://pantograph-catenary.github.io/ssp/1";

/// Namespaces of SSP 1.0, by the prefixes that the specification uses.
const NAMESPACES: [(&str, &str); 4] = [
    ("ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription"),
    ("ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"),
    ("ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"),
    ("ssm", "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"),
];

/// Reason why an `.ssp` cannot be made or run.
#[derive(Debug, thiserror::Error)]
pub enum SspError {
    /// The archive is refused or cannot be written.
    #[error("{}: {problem}", path.display())]
    Archive {
        /// The archive.
        path: PathBuf,
        /// Problem.
        problem: fmi2::archive::ArchiveError,
    },
    /// A file of the archive is no XML that can be read.
    #[error("{}: {file}: {problem}", path.display())]
    Xml {
        /// The archive.
        path: PathBuf,
        /// File in it.
        file: String,
        /// Problem.
        problem: Box<fmi2::model_description::DescriptionError>,
    },
    /// An element of a file is refused.
    #[error("{}: {file}: line {line}: {problem}", path.display())]
    Element {
        /// The archive.
        path: PathBuf,
        /// File in it.
        file: String,
        /// Line of the element, from 1.
        line: usize,
        /// The element, what is wrong with it, and what would be right.
        problem: String,
    },
    /// The system is none that this program runs.
    #[error("{}: {problem}", path.display())]
    Shape {
        /// The archive.
        path: PathBuf,
        /// Problem and remedy.
        problem: String,
    },
    /// The scene that the system stands for.
    #[error(transparent)]
    Scene(#[from] scene::SceneError),
    /// An FMU of the archive cannot be used.
    #[error("{}: component \"{component}\"", path.display())]
    Fmu {
        /// The archive.
        path: PathBuf,
        /// Name of the component.
        component: String,
        /// Why.
        #[source]
        source: Box<fmi2::Error>,
    },
}

#[cfg(test)]
mod tests;
