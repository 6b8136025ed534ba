//! Writing an FMU: the same content gives the same bytes.

use super::{ArchiveError, DESCRIPTION_FILE, binary_entry};
use crate::Error;
use crate::model_description::{GUID_PLACEHOLDER, ModelDescription};
use crate::slave::GUID_FILE;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Content of an FMU.
#[derive(Clone, Debug, Default)]
pub struct Package {
    /// The model description with [`GUID_PLACEHOLDER`] as GUID.
    pub description: String,
    /// The shared library for this platform.
    pub library: Vec<u8>,
    /// Files below `resources/`: relative name with `/`, content.
    pub resources: BTreeMap<String, Vec<u8>>,
    /// Files below `documentation/`: relative name with `/`, content.
    pub documentation: BTreeMap<String, Vec<u8>>,
}

impl Package {
    /// The GUID: 128 bits of the SHA-256 of names and contents of all entries, in braces.
    ///
    /// # Errors
    ///
    /// A description that cannot be read; `path` is for the message.
    pub fn guid(&self, path: &Path) -> Result<String, Error> {
        Ok(guid(&self.entries(path)?))
    }

    /// Writes the FMU; an existing file is replaced when the new one is complete.
    ///
    /// # Errors
    ///
    /// A description that cannot be read or lacks the placeholder; a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let bytes = self.to_bytes(path)?;
        write(path, &bytes).map_err(|problem| Error::Archive {
            path: path.to_owned(),
            problem,
        })
    }

    /// The FMU as bytes; `path` is for messages.
    ///
    /// # Errors
    ///
    /// A description that cannot be read or lacks the placeholder.
    pub fn to_bytes(&self, path: &Path) -> Result<Vec<u8>, Error> {
        let refused = |problem| Error::Archive {
            path: path.to_owned(),
            problem,
        };
        let mut entries = self.entries(path)?;
        let guid = guid(&entries);
        if !self.description.contains(GUID_PLACEHOLDER) {
            return Err(refused(ArchiveError::NoPlaceholder {
                placeholder: GUID_PLACEHOLDER,
            }));
        }
        let description = self.description.replacen(GUID_PLACEHOLDER, &guid, 1);
        entries.insert(DESCRIPTION_FILE.to_owned(), description.into_bytes());
        entries.insert(format!("resources/{GUID_FILE}"), format!("{guid}\n").into_bytes());
        zipped(&entries).map_err(refused)
    }

    /// All entries but the resource with the GUID.
    fn entries(&self, path: &Path) -> Result<BTreeMap<String, Vec<u8>>, Error> {
        let description =
            ModelDescription::from_xml(self.description.as_bytes()).map_err(|problem| Error::Description {
                path: path.to_owned(),
                problem,
            })?;
        let mut entries = BTreeMap::new();
        entries.insert(DESCRIPTION_FILE.to_owned(), self.description.clone().into_bytes());
        let binary = binary_entry(&description.co_simulation.model_identifier);
        entries.insert(binary, self.library.clone());
        for (folder, files) in [("resources", &self.resources), ("documentation", &self.documentation)] {
            for (name, content) in files {
                entries.insert(format!("{folder}/{name}"), content.clone());
            }
        }
        for entry in entries.keys() {
            super::extract::checked(entry).map_err(|problem| Error::Archive {
                path: path.to_owned(),
                problem,
            })?;
        }
        Ok(entries)
    }
}

fn guid(entries: &BTreeMap<String, Vec<u8>>) -> String {
    let mut hash = Sha256::new();
    for (name, content) in entries {
        for piece in [name.as_bytes(), content] {
            hash.update((piece.len() as u64).to_le_bytes());
            hash.update(piece);
        }
    }
    let mut text = String::from("{");
    for (at, byte) in hash.finalize().iter().take(16).enumerate() {
        if [4, 6, 8, 10].contains(&at) {
            text.push('-');
        }
        let _ = write!(text, "{byte:02x}");
    }
    text.push('}');
    text
}

/// Writes the bytes of an archive; an existing file is replaced when the new one is complete.
///
/// # Errors
///
/// A file or folder that cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ArchiveError> {
    let unwritable = |problem| ArchiveError::Unwritable {
        target: path.to_owned(),
        problem,
    };
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(unwritable)?;
    let mut file = tempfile::Builder::new()
        .prefix(".archive-")
        .tempfile_in(folder)
        .map_err(unwritable)?;
    file.write_all(bytes).map_err(unwritable)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(mode).map_err(unwritable)?;
    }
    file.persist(path).map_err(|error| unwritable(error.error))?;
    Ok(())
}

/// The bytes of an archive: name and content of each entry; sorted, deflated, dated 1980-01-01, without extra fields.
///
/// # Errors
///
/// Errors of the zip writer.
pub fn zipped(entries: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, ArchiveError> {
    deflated(entries).map_err(|error| ArchiveError::NotZip {
        problem: error.to_string(),
    })
}

fn deflated(entries: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, zip::result::ZipError> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(mode);
        writer.start_file(name.as_str(), options)?;
        writer.write_all(content)?;
    }
    Ok(writer.finish()?.into_inner())
}
