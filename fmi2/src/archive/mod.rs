//! The `.fmu` archive [FMI 2.0, 2.3]: written reproducibly, read with suspicion. Other packages that are zip archives
//! are written and read by the same functions.

mod extract;
mod package;

pub use extract::{Limits, checked, extract};
pub use package::{Package, write, zipped};

use std::path::PathBuf;

/// Name of the model description at the root.
pub const DESCRIPTION_FILE: &str = "modelDescription.xml";

/// Folder of binaries for this platform [FMI 2.0, 2.3; beyond x86 the tuples of FMI 3.0].
pub const PLATFORM: &str = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    "linux64"
} else if cfg!(all(target_os = "linux", target_arch = "x86")) {
    "linux32"
} else if cfg!(all(target_os = "linux", target_arch = "aarch64")) {
    "aarch64-linux"
} else if cfg!(all(target_os = "windows", target_arch = "x86_64")) {
    "win64"
} else if cfg!(all(target_os = "windows", target_arch = "x86")) {
    "win32"
} else if cfg!(all(target_os = "macos", target_arch = "x86_64")) {
    "darwin64"
} else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
    "aarch64-darwin"
} else {
    "unknown"
};

/// Extension of shared libraries on this platform.
pub const LIBRARY_EXTENSION: &str = if cfg!(target_os = "windows") {
    "dll"
} else if cfg!(target_os = "macos") {
    "dylib"
} else {
    "so"
};

/// Path of the binary of a model for this platform in the archive.
#[must_use]
pub fn binary_entry(model_identifier: &str) -> String {
    format!("binaries/{PLATFORM}/{model_identifier}.{LIBRARY_EXTENSION}")
}

/// Errors of archives.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The file cannot be read.
    #[error("cannot be read: {problem}")]
    Unreadable {
        /// Message of the system.
        problem: std::io::Error,
    },
    /// No bytes.
    #[error("is empty (0 bytes); a zip archive is expected")]
    Empty,
    /// Not a zip archive, or a damaged one.
    #[error("is no intact zip archive: {problem}")]
    NotZip {
        /// Message of the reader.
        problem: String,
    },
    /// More entries than are unpacked.
    #[error("has {count} entries, the limit is {limit}")]
    TooManyEntries {
        /// Entries.
        count: usize,
        /// Entries.
        limit: usize,
    },
    /// More bytes than are unpacked, found while inflating.
    #[error("entry {entry}: the archive inflates to more than {limit} bytes")]
    TooLarge {
        /// The entry at which the limit was passed.
        entry: String,
        /// Bytes.
        limit: u64,
    },
    /// An entry that inflates too much, found while inflating.
    #[error("entry {entry}: inflates from {compressed} to more than {limit} times as many bytes")]
    Ratio {
        /// The entry.
        entry: String,
        /// Bytes in the archive.
        compressed: u64,
        /// Ratio.
        limit: u64,
    },
    /// A name that leads out of the folder or means different things on different systems.
    #[error("entry {entry}: the name is refused: {reason}")]
    Name {
        /// The entry.
        entry: String,
        /// Reason.
        reason: &'static str,
    },
    /// Two entries with one name.
    #[error("entry {entry}: the name is used twice (upper and lower case count as the same)")]
    Duplicate {
        /// The entry.
        entry: String,
    },
    /// Two entries share bytes of the archive.
    #[error("entries overlap in the file")]
    Overlap,
    /// A link or a special file.
    #[error("entry {entry}: is a link or a special file")]
    Special {
        /// The entry.
        entry: String,
    },
    /// A password would be needed.
    #[error("entry {entry}: is encrypted")]
    Encrypted {
        /// The entry.
        entry: String,
    },
    /// Neither stored nor deflated.
    #[error("entry {entry}: the compression method {method} is refused; FMI allows store and deflate")]
    Method {
        /// The entry.
        entry: String,
        /// Name of the method.
        method: String,
    },
    /// The content is damaged.
    #[error("entry {entry}: cannot be inflated: {problem}")]
    Damaged {
        /// The entry.
        entry: String,
        /// Message of the reader.
        problem: String,
    },
    /// The file that makes it an archive of its kind is missing.
    #[error("has no {root} at its root")]
    NoRoot {
        /// Name of the file.
        root: &'static str,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {problem}", target.display())]
    Unwritable {
        /// The file.
        target: PathBuf,
        /// Message of the system.
        problem: std::io::Error,
    },
    /// The model description of a package has no GUID to fill in.
    #[error("the model description does not hold the GUID placeholder {placeholder}")]
    NoPlaceholder {
        /// Placeholder that is searched.
        placeholder: &'static str,
    },
}
