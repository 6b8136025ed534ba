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
        zipped(&self.complete(path)?).map_err(|problem| Error::Archive {
            path: path.to_owned(),
            problem,
        })
    }

    /// `true` where `folder`, an unpacked archive, holds the entries of this package, all of them and no other, byte
    /// for byte; `path` is for messages.
    ///
    /// # Errors
    ///
    /// A description that cannot be read or lacks the placeholder; a folder that cannot be read.
    pub fn is_content_of(&self, folder: &Path, path: &Path) -> Result<bool, Error> {
        let entries = self.complete(path)?;
        let files = files_below(folder).map_err(|problem| Error::Archive {
            path: path.to_owned(),
            problem: ArchiveError::Unreadable { problem },
        })?;
        let same = |(name, content): (&String, &Vec<u8>)| {
            std::fs::read(folder.join(name)).is_ok_and(|found| found == *content)
        };
        Ok(files == entries.len() && entries.iter().all(same))
    }

    /// All entries, with the GUID in its places.
    fn complete(&self, path: &Path) -> Result<BTreeMap<String, Vec<u8>>, Error> {
        let mut entries = self.entries(path)?;
        let guid = guid(&entries);
        if !self.description.contains(GUID_PLACEHOLDER) {
            return Err(Error::Archive {
                path: path.to_owned(),
                problem: ArchiveError::NoPlaceholder {
                    placeholder: GUID_PLACEHOLDER,
                },
            });
        }
        let description = self.description.replacen(GUID_PLACEHOLDER, &guid, 1);
        entries.insert(DESCRIPTION_FILE.to_owned(), description.into_bytes());
        entries.insert(format!("resources/{GUID_FILE}"), format!("{guid}\n").into_bytes());
        Ok(entries)
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

/// Number of files in a folder and in all folders below; a link counts as a file.
fn files_below(folder: &Path) -> std::io::Result<usize> {
    let mut count = 0;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        count += if entry.file_type()?.is_dir() {
            files_below(&entry.path())?
        } else {
            1
        };
    }
    Ok(count)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::Fmu;
    use crate::model_description::Variable;

    #[test]
    fn an_archive_with_the_right_guid_and_one_other_byte_anywhere_is_no_content_of_the_package() {
        let package = Package {
            description: ModelDescription::of_slave("Model", vec![Variable::output("z", "m", "Height")]).to_xml(),
            library: b"library".to_vec(),
            resources: BTreeMap::from([("scene.toml".to_owned(), b"[run]".to_vec())]),
            documentation: BTreeMap::from([("index.html".to_owned(), b"<html>".to_vec())]),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Model.fmu");
        let same = |entries: &BTreeMap<String, Vec<u8>>| {
            write(&path, &zipped(entries).unwrap()).unwrap();
            package
                .is_content_of(Fmu::open(&path).unwrap().folder(), &path)
                .unwrap()
        };
        let entries = package.complete(&path).unwrap();
        assert!(same(&entries));
        for name in entries.keys() {
            let mut altered = entries.clone();
            altered.get_mut(name).unwrap().push(b'\n');
            assert!(!same(&altered), "{name} is longer");
            if name != DESCRIPTION_FILE {
                let mut without = entries.clone();
                without.remove(name);
                assert!(!same(&without), "{name} is missing");
            }
        }
        let mut more = entries;
        more.insert("binaries/linux64/other.so".to_owned(), b"other".to_vec());
        assert!(!same(&more), "a library more");
    }
}
