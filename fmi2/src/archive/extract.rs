//! Unpacking an archive that is not trusted.

use super::ArchiveError;
use crate::scratch::Scratch;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{BufReader, Read, Write};
use std::path::Path;
use zip::CompressionMethod;
use zip::read::ZipArchive;
use zip::result::ZipError;

/// Limits of an archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most entries.
    pub entries: usize,
    /// Most bytes of all entries together, inflated.
    pub bytes: u64,
    /// Most inflated bytes per byte in the archive, for entries above a mebibyte.
    pub ratio: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            entries: 10_000,
            bytes: 2 << 30,
            ratio: 1000,
        }
    }
}

/// Entries below this size, bytes, may have any ratio.
const RATIO_FREE: u64 = 1 << 20;

/// Unpacks the archive into a new private folder, which is removed when the result is dropped. All names are checked
/// before the first byte is written; sizes are counted while inflating, because headers may lie. `root` is the file
/// that every archive of its kind has at its root, such as [`DESCRIPTION_FILE`](super::DESCRIPTION_FILE).
///
/// # Errors
///
/// A refused archive; the error names the entry and the limit.
pub fn extract(path: &Path, root: &'static str, limits: &Limits) -> Result<Scratch, ArchiveError> {
    let unreadable = |problem| ArchiveError::Unreadable { problem };
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(ArchiveError::NotZip {
            problem: "it is a folder".into(),
        });
    }
    if metadata.len() == 0 {
        return Err(ArchiveError::Empty);
    }
    let not_zip = |problem: ZipError| ArchiveError::NotZip {
        problem: problem.to_string(),
    };
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|problem| match problem {
        // The reader's own wording does not help somebody who named the wrong file.
        ZipError::InvalidArchive(_) => ArchiveError::NotZip {
            problem: format!("it is a file of another kind, or damaged or cut off ({problem})"),
        },
        problem => not_zip(problem),
    })?;
    let count = archive.len();
    if count > limits.entries {
        return Err(ArchiveError::TooManyEntries {
            count,
            limit: limits.entries,
        });
    }
    let names = inspected(&mut archive)?;
    if !names.iter().any(|name| name == root) {
        return Err(ArchiveError::NoRoot { root });
    }
    if archive.has_overlapping_entries().map_err(not_zip)? {
        return Err(ArchiveError::Overlap);
    }
    let folder = Scratch::new().map_err(|problem| ArchiveError::Unwritable {
        target: std::env::temp_dir(),
        problem,
    })?;
    let mut left = limits.bytes;
    for (index, name) in names.iter().enumerate() {
        let target = folder.path().join(name);
        let unwritable = |problem| ArchiveError::Unwritable {
            target: target.clone(),
            problem,
        };
        if name.ends_with('/') {
            fs::create_dir_all(&target).map_err(unwritable)?;
            continue;
        }
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(unwritable)?;
        }
        let mut output = File::create_new(&target).map_err(unwritable)?;
        inflate(&mut archive, index, name, &mut left, limits, |bytes| {
            output.write_all(bytes).map_err(unwritable)
        })?;
        #[cfg(unix)]
        if name.starts_with("binaries/") {
            use std::os::unix::fs::PermissionsExt;
            output
                .set_permissions(fs::Permissions::from_mode(0o755))
                .map_err(unwritable)?;
        }
    }
    Ok(folder)
}

/// Names of all entries in the order of the archive, after checking what can be known before inflating.
fn inspected(archive: &mut ZipArchive<BufReader<File>>) -> Result<Vec<String>, ArchiveError> {
    let mut seen = BTreeSet::new();
    let mut names = Vec::with_capacity(archive.len());
    let duplicates = archive.has_duplicate_names();
    for index in 0..archive.len() {
        let damaged = |problem: zip::result::ZipError| ArchiveError::Damaged {
            entry: format!("number {}", index + 1),
            problem: problem.to_string(),
        };
        let entry = archive.by_index_raw(index).map_err(damaged)?;
        let name = entry.name().map_err(damaged)?.into_owned();
        checked(&name)?;
        if !seen.insert(name.trim_end_matches('/').to_lowercase()) {
            return Err(ArchiveError::Duplicate { entry: name });
        }
        if entry.encrypted() {
            return Err(ArchiveError::Encrypted { entry: name });
        }
        let kind = entry.unix_mode().unwrap_or(0) & 0o170_000;
        if !matches!(kind, 0 | 0o100_000 | 0o040_000) {
            return Err(ArchiveError::Special { entry: name });
        }
        match entry.compression() {
            CompressionMethod::Stored | CompressionMethod::Deflated => {}
            method => {
                return Err(ArchiveError::Method {
                    entry: name,
                    method: method.to_string(),
                });
            }
        }
        names.push(name);
    }
    if duplicates {
        return Err(ArchiveError::Duplicate {
            entry: "(exactly the same name)".into(),
        });
    }
    Ok(names)
}

/// Refuses names of entries that leave the folder or are read differently elsewhere.
///
/// # Errors
///
/// [`ArchiveError::Name`].
pub fn checked(name: &str) -> Result<(), ArchiveError> {
    let refuse = |reason| {
        Err(ArchiveError::Name {
            entry: name.to_owned(),
            reason,
        })
    };
    if name.is_empty() || name.len() > 4096 {
        return refuse("it must have 1 to 4096 bytes");
    }
    if name.starts_with('/') {
        return refuse("it is absolute");
    }
    if name.contains('\\') {
        return refuse("it holds a backslash; the separator is /");
    }
    if name.contains(':') {
        return refuse("it holds a colon, as drives do");
    }
    if name.chars().any(char::is_control) {
        return refuse("it holds a control character");
    }
    let parts = name.strip_suffix('/').unwrap_or(name);
    match parts.split('/').find(|part| matches!(*part, "" | "." | "..")) {
        Some("..") => refuse("it leads out of the folder (..)"),
        Some(_) => refuse("it has an empty part or the part ."),
        None => Ok(()),
    }
}

fn inflate(
    archive: &mut ZipArchive<BufReader<File>>,
    index: usize,
    name: &str,
    left: &mut u64,
    limits: &Limits,
    mut sink: impl FnMut(&[u8]) -> Result<(), ArchiveError>,
) -> Result<(), ArchiveError> {
    let entry = || name.to_owned();
    let damaged = |problem: String| ArchiveError::Damaged {
        entry: name.to_owned(),
        problem,
    };
    let mut reader = archive
        .by_index(index)
        .map_err(|problem| damaged(problem.to_string()))?;
    let compressed = reader.compressed_size();
    let mut buffer = vec![0; 1 << 16];
    let mut total = 0_u64;
    loop {
        let count = reader
            .read(&mut buffer)
            .map_err(|problem| damaged(problem.to_string()))?;
        if count == 0 {
            return Ok(());
        }
        total += count as u64;
        if total > RATIO_FREE && total > compressed.saturating_mul(limits.ratio) {
            return Err(ArchiveError::Ratio {
                entry: entry(),
                compressed,
                limit: limits.ratio,
            });
        }
        *left = left.checked_sub(count as u64).ok_or_else(|| ArchiveError::TooLarge {
            entry: entry(),
            limit: limits.bytes,
        })?;
        sink(&buffer[..count])?;
    }
}
