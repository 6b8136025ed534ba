//! The files of an archive.

use std::path::{Path, PathBuf};

use fmi2::archive::checked;

use super::problem::FileProblem;
use super::read::File;
use super::{STRUCTURE_FILE, SspError};

/// An archive that is unpacked.
#[derive(Clone, Copy)]
pub(super) struct Unpacked<'a> {
    pub archive: &'a Path,
    pub folder: &'a Path,
}

impl<'a> Unpacked<'a> {
    /// The description, for messages.
    pub fn structure(self) -> File<'a> {
        File {
            archive: self.archive,
            name: STRUCTURE_FILE,
        }
    }

    /// File that a relative URI leads to.
    ///
    /// # Errors
    /// [`FileProblem`].
    pub fn file(self, uri: &str) -> Result<PathBuf, FileProblem> {
        let named = || uri.to_owned();
        let decoded = percent_encoding::percent_decode_str(uri)
            .decode_utf8()
            .map_err(|_| FileProblem::Encoding { uri: named() })?;
        let name = decoded.strip_prefix("./").unwrap_or(&decoded);
        checked(name).map_err(|problem| FileProblem::Outside { uri: named(), problem })?;
        let path = self.folder.join(name);
        if path.is_file() {
            return Ok(path);
        }
        Err(FileProblem::Missing { uri: named() })
    }

    /// Content of such a file; `line` of the structure names it.
    ///
    /// # Errors
    /// [`SspError::Element`].
    pub fn content(self, uri: &str, line: usize) -> Result<Vec<u8>, SspError> {
        let refuse = |problem| self.structure().refuse(line, problem);
        let path = self.file(uri).map_err(refuse)?;
        let unreadable = |source| FileProblem::Unreadable {
            uri: uri.to_owned(),
            source,
        };
        std::fs::read(path).map_err(|source| refuse(unreadable(source)))
    }
}
