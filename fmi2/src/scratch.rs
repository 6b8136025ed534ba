//! Private folders of unpacked archives: removed by their owner, or by a later process where the owner was ended from
//! outside or by an FMU.
//!
//! A folder is locked as long as its owner lives, whatever ends it; one that is not locked belongs to nobody.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::sync::Once;
use std::time::Duration;

use tempfile::TempDir;

/// Begin of the names of such folders.
const PREFIX: &str = "pantoline-";

/// Age below which a folder is left alone: its owner may be about to lock it.
const YOUNG: Duration = Duration::from_secs(10);

/// A private folder, removed when dropped.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    /// Lock on the folder, where the system has such a lock.
    _held: Option<File>,
}

impl Scratch {
    /// An empty folder among those of the system for such files. The first one of a process removes what processes that
    /// are gone have left there.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn new() -> io::Result<Self> {
        static ONCE: Once = Once::new();
        let place = std::env::temp_dir();
        ONCE.call_once(|| remove_abandoned(&place, PREFIX, YOUNG));
        let prefix = of_process(std::process::id());
        let folder = tempfile::Builder::new().prefix(&prefix).tempdir_in(place)?;
        let held = locked(folder.path());
        Ok(Self { folder, _held: held })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Begin of the names of the folders of a process.
fn of_process(id: u32) -> String {
    format!("{PREFIX}{id}-")
}

/// Removes the folders that a child, which has ended, has left.
#[cfg(unix)]
pub(crate) fn remove_those_of(child: u32) {
    remove_abandoned(&std::env::temp_dir(), &of_process(child), Duration::ZERO);
}

/// The folder with its lock; nothing where another process holds it or the system has no such lock.
fn locked(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    file.try_lock().is_ok().then_some(file)
}

/// Removes folders in `place` whose names begin with `prefix`, that no process holds and that are older than `young`.
fn remove_abandoned(place: &Path, prefix: &str, young: Duration) {
    let Ok(entries) = fs::read_dir(place) else { return };
    for entry in entries.flatten() {
        // Not through a link.
        let Ok(metadata) = fs::symlink_metadata(entry.path()) else {
            continue;
        };
        let age = metadata.modified().ok().and_then(|time| time.elapsed().ok());
        if metadata.is_dir()
            && entry.file_name().to_string_lossy().starts_with(prefix)
            && age.is_some_and(|age| age >= young)
            && let Some(_held) = locked(&entry.path())
        {
            // What cannot be removed, as that of another user, stays.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn folders_that_nobody_holds_are_removed_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let made = |name: &str| {
            let folder = place.path().join(name);
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("file"), "x").unwrap();
            folder
        };
        let (abandoned, held, foreign) = (made("pantoline-a"), made("pantoline-b"), made("other"));
        let link = place.path().join("pantoline-c");
        std::os::unix::fs::symlink(&foreign, &link).unwrap();
        let hold = locked(&held).unwrap();
        remove_abandoned(place.path(), PREFIX, Duration::from_secs(3600));
        assert!(abandoned.is_dir(), "as young as its owner may be");
        remove_abandoned(place.path(), PREFIX, Duration::ZERO);
        assert!(!abandoned.exists() && held.join("file").is_file() && foreign.join("file").is_file() && link.exists());
        drop(hold);
        // A process that another test starts meanwhile has the handle until it runs its own program.
        for _ in 0..200 {
            remove_abandoned(place.path(), PREFIX, Duration::ZERO);
            if !held.exists() {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        panic!("{} is left", held.display());
    }

    #[test]
    fn a_folder_is_held_as_long_as_its_owner_has_it() {
        let scratch = Scratch::new().unwrap();
        let path = scratch.path().to_owned();
        assert!(locked(&path).is_none());
        drop(scratch);
        assert!(!path.exists());
    }
}
