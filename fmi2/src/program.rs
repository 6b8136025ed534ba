//! File of the program: libraries and the program of child processes are beside it.

use std::io;
use std::path::PathBuf;
use std::sync::OnceLock;

static STAND_IN: OnceLock<PathBuf> = OnceLock::new();

/// Names the file that stands for the program where this crate is part of another one, such as an interpreter. Only
/// the first call counts.
pub fn stand_in(file: PathBuf) {
    let _ = STAND_IN.set(file);
}

/// `true` where another file stands for the program.
#[must_use]
pub fn is_elsewhere() -> bool {
    STAND_IN.get().is_some()
}

/// File of this program, or the one that stands for it.
///
/// # Errors
/// Reports of the operating system.
pub fn file() -> io::Result<PathBuf> {
    match STAND_IN.get() {
        Some(file) => Ok(file.clone()),
        None => std::env::current_exe(),
    }
}
