//! Digest of a system: tells an archive that was changed after the export.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use super::document::{Description, Source};
use super::unpacked::Unpacked;
use super::{SspError, write};

/// SHA-256 of what a system means: its content without our annotation, its parameters, its FMUs.
pub(super) fn digest(description: &Description, unpacked: Unpacked<'_>) -> Result<String, SspError> {
    digest_of(description, |uri, line| unpacked.content(uri, line))
}

/// The same, of files that `content` knows.
pub(super) fn digest_of(
    description: &Description,
    content: impl Fn(&str, usize) -> Result<Vec<u8>, SspError>,
) -> Result<String, SspError> {
    let mut hash = Sha256::new();
    let mut piece = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    piece(write::meaning(description).as_bytes());
    let system = &description.system;
    for component in &system.components {
        piece(&content(&component.source, component.line)?);
    }
    let bindings = system.components.iter().flat_map(|component| &component.bindings);
    for binding in bindings.chain(&system.bindings) {
        match (&binding.values, &binding.mapping) {
            (Source::File(uri), None) => piece(&content(uri, binding.line)?),
            other => piece(format!("{other:?}").as_bytes()),
        }
    }
    let mut text = String::new();
    for byte in hash.finalize() {
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}
