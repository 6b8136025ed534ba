//! Errors of the importer.

use crate::abi::Status;
use crate::archive::ArchiveError;
use crate::model_description::DescriptionError;
use std::path::PathBuf;

/// Errors of reading, loading, writing or calling an FMU.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The archive is refused.
    #[error("{}: {problem}", path.display())]
    Archive {
        /// The FMU.
        path: PathBuf,
        /// Problem.
        problem: ArchiveError,
    },
    /// The model description is refused.
    #[error("{}: modelDescription.xml: {problem}", path.display())]
    Description {
        /// The FMU.
        path: PathBuf,
        /// Problem.
        problem: DescriptionError,
    },
    /// There is no binary for this platform.
    #[error(
        "{}: no binary for this platform, {expected}; the archive has {}",
        path.display(),
        if present.is_empty() { "none".to_owned() } else { present.join(", ") }
    )]
    NoBinary {
        /// The FMU.
        path: PathBuf,
        /// Expected path of the binary in the archive.
        expected: String,
        /// Platforms that have a binary.
        present: Vec<String>,
    },
    /// The shared library cannot be loaded.
    #[error("{}: the binary cannot be loaded: {problem}{hint}", path.display())]
    Load {
        /// The FMU.
        path: PathBuf,
        /// Message of the loader.
        problem: String,
        /// Advice, or empty.
        hint: &'static str,
    },
    /// The shared library lacks a function that every co-simulation FMU must have.
    #[error("{}: the binary does not export {function}", path.display())]
    MissingFunction {
        /// The FMU.
        path: PathBuf,
        /// Name of the function.
        function: &'static str,
    },
    /// The binary is of another version of the standard.
    #[error("{}: the binary is of FMI version {found}, expected 2.0", path.display())]
    WrongVersion {
        /// The FMU.
        path: PathBuf,
        /// Text returned by `fmi2GetVersion`.
        found: String,
    },
    /// The FMU allows one instance and has one.
    #[error("{}: only one instance per process is possible, and there is one already", path.display())]
    OnlyOnce {
        /// The FMU.
        path: PathBuf,
    },
    /// `fmi2Instantiate` returned null.
    #[error("{fmu}: fmi2Instantiate of \"{instance}\" failed{log}")]
    Instantiate {
        /// Name of the model.
        fmu: String,
        /// Name of the instance.
        instance: String,
        /// Last messages of the instance.
        log: Log,
    },
    /// A function returned a bad status.
    #[error("{instance} ({fmu}): {function} returned {status}{log}")]
    Call {
        /// Name of the model.
        fmu: String,
        /// Name of the instance.
        instance: String,
        /// Name of the function.
        function: &'static str,
        /// Returned status; an integer that is no status counts as fatal.
        status: Status,
        /// Messages during the call.
        log: Log,
    },
    /// A function that the FMU does not have.
    #[error("{instance} ({fmu}): the FMU has no {function}")]
    Unsupported {
        /// Name of the model.
        fmu: String,
        /// Name of the instance.
        instance: String,
        /// Name of the function.
        function: &'static str,
    },
    /// An earlier call returned `fmi2Fatal`: no instance of the FMU may be called again.
    #[error("{instance} ({fmu}): {function} is not called after fmi2Fatal")]
    AfterFatal {
        /// Name of the model.
        fmu: String,
        /// Name of the instance.
        instance: String,
        /// Name of the function.
        function: &'static str,
    },
    /// A text with a NUL character, or a name that is blank.
    #[error("{what} \"{text}\" cannot be passed to an FMU")]
    BadText {
        /// Meaning of the text.
        what: &'static str,
        /// The text.
        text: String,
    },
    /// A serialised state beyond what is taken.
    #[error("{instance}: the serialised state has {size} bytes, the limit is {limit}")]
    StateTooLarge {
        /// Name of the instance.
        instance: String,
        /// Bytes.
        size: usize,
        /// Bytes.
        limit: usize,
    },
}

/// Messages that belong to a failure; printed after a colon, or not at all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Log(pub Vec<String>);

impl std::fmt::Display for Log {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() {
            Ok(())
        } else {
            write!(f, ": {}", self.0.join("; "))
        }
    }
}
