//! One run in a folder at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use super::io;
use crate::ResultsError;

/// File that is locked; its text names the holder.
const LOCK: &str = ".pantoline.lock";

/// Hold on a folder, given back by the system at the end of the process, whatever ends it.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
    /// Words of a holder that has not come to its end in order.
    pub broken_off: Option<String>,
}

impl Lock {
    /// Takes hold of `folder` for `holder`, words for the message of whoever comes next.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Busy`] with the words of the other holder; what the operating system reports.
    pub fn take(folder: &Path, holder: &str) -> Result<Self, ResultsError> {
        let path = folder.join(LOCK);
        loop {
            let mut file = opened(&path)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(busy(folder, file)),
                Err(TryLockError::Error(source)) => return Err(io(&path, "lock")(source)),
                Ok(()) => {}
            }
            // The file may have been removed by its last holder in between: that of the next one is another.
            if !is_at(&file, &path) {
                continue;
            }
            let mut left = String::new();
            // The words are for a note only.
            let _ = file.read_to_string(&mut left);
            let broken_off = Some(left.trim().to_owned()).filter(|left| !left.is_empty());
            let words = format!("{holder} (process {})\n", std::process::id());
            file.rewind().map_err(io(&path, "write"))?;
            file.set_len(0).map_err(io(&path, "write"))?;
            file.write_all(words.as_bytes()).map_err(io(&path, "write"))?;
            return Ok(Self {
                path,
                _file: file,
                broken_off,
            });
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that stays is taken by the next holder.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// The file at `path`, made where there is none; a link is refused, because the lock would be that of another folder.
fn opened(path: &Path) -> Result<File, ResultsError> {
    if path.is_symlink() {
        let source = std::io::Error::other("the file is a link; must be removed");
        return Err(io(path, "lock")(source));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    options.open(path).map_err(io(path, "lock"))
}

fn busy(folder: &Path, mut file: File) -> ResultsError {
    let mut words = String::new();
    // The words are for the message only.
    let _ = file.read_to_string(&mut words);
    let words = words.trim();
    ResultsError::Busy {
        folder: folder.to_owned(),
        holder: if words.is_empty() { "another process" } else { words }.to_owned(),
    }
}

/// `true` where the open `file` is the one at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    let (open, there) = (file.metadata().map(identity), path.symlink_metadata().map(identity));
    open.is_ok_and(|open| there.is_ok_and(|there| open == there))
}

/// An open file cannot be removed where the system is none of Unix.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}
