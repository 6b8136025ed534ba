//! Why results could not be written or read.

use std::path::PathBuf;

/// Why results could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The operating system refused a file or folder.
    #[error("{}: cannot {action}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// Attempt, as a verb: `write`, `read`, `create the folder`.
        action: &'static str,
        /// Reason of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// Another run writes to the same folder.
    #[error("{}: {holder} writes its results there; must be another folder, or wait for its end", folder.display())]
    Busy {
        /// Folder.
        folder: PathBuf,
        /// Words that name the other run.
        holder: String,
    },
    /// A column of the record has another length than its time.
    #[error("column {column} has {found} samples, time has {expected}")]
    Length {
        /// Name of the column.
        column: String,
        /// Samples in this column.
        found: usize,
        /// Samples of the time.
        expected: usize,
    },
    /// A cell of a table is not a number.
    #[error("{}: line {line}, column {column}: {value:?} is not a number", path.display())]
    Number {
        /// File.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// Content found.
        value: String,
    },
    /// A table does not have the columns of a time series.
    #[error("{}: column {position} is {found:?}, expected {expected:?}", path.display())]
    Column {
        /// File.
        path: PathBuf,
        /// Position of the column, from 1.
        position: usize,
        /// Header found.
        found: String,
        /// Header expected.
        expected: String,
    },
    /// A table is not CSV.
    #[error("{}: not a CSV table", path.display())]
    Csv {
        /// File.
        path: PathBuf,
        /// Reason, with the line.
        #[source]
        source: csv::Error,
    },
    /// A file is not the JSON that was expected.
    #[error("{}: not a file of this program", path.display())]
    Json {
        /// File.
        path: PathBuf,
        /// Reason, with line and column.
        #[source]
        source: serde_json::Error,
    },
}
