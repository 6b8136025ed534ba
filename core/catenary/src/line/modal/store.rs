//! Modes of lines that were found before: those of this process, and files in the user's cache folder.
use super::modes::Modes;
use crate::StaticsError;
use kept::{Key, Kind};
use std::sync::{Arc, Mutex, PoisonError};

/// Files of modes.
const MODES: Kind = Kind {
    format: b"Pantoline, modes, no. 9\n",
    prefix: "modes",
    most: 16,
};
/// Modes kept by a process; the oldest go first.
const IN_PROCESS: usize = 4;

/// Digest of a line, to which all that its modes follow from is to be added.
pub(super) fn key() -> Key {
    Key::new(MODES, env!("CARGO_PKG_VERSION"))
}

/// The modes of a line that were found before, or those that `find` finds.
pub(super) fn known_or(
    key: Key,
    find: impl FnOnce() -> Result<Modes, StaticsError>,
) -> Result<Arc<Modes>, StaticsError> {
    static KNOWN: Mutex<Vec<(String, Arc<Modes>)>> = Mutex::new(Vec::new());
    let name = key.name();
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, modes)) = known.iter().find(|(other, _)| *other == name) {
        return Ok(Arc::clone(modes));
    }
    let modes = Arc::new(MODES.known_or(&name, find)?);
    known.insert(0, (name, Arc::clone(&modes)));
    known.truncate(IN_PROCESS);
    Ok(modes)
}
