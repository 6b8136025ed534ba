//! Results of a run in place of those of an earlier one.
//!
//! All files are written beside, in a folder of their own, which is complete when it has its final name. Moving them
//! takes no time to speak of, and a move that was broken off by a kill is finished by the next run, so that no moment
//! leaves a folder without results or with a mixture that has a summary.

use std::path::Path;

use tempfile::TempDir;

use super::{ANIMATION, REPORT, SUMMARY, TIMESERIES, io};
use crate::ResultsError;

/// Folder of results that are complete and not yet in their places.
const COMPLETE: &str = ".results.complete";
/// Beginning of the names of folders that are not complete.
const INCOMPLETE: &str = ".results-";
/// End of the names of files that are not complete.
pub(super) const PARTIAL: &str = ".partial";

/// A new folder beside the results in `folder`, removed when dropped.
pub(super) fn beside(folder: &Path) -> Result<TempDir, ResultsError> {
    let made = tempfile::Builder::new().prefix(INCOMPLETE).tempdir_in(folder);
    made.map_err(io(folder, "create a folder in"))
}

/// Puts the files in `written` in the place of the results in `folder`.
pub(super) fn exchange(written: TempDir, folder: &Path) -> Result<(), ResultsError> {
    let complete = folder.join(COMPLETE);
    std::fs::rename(written.path(), &complete).map_err(io(&complete, "write"))?;
    // The folder has another name, and nothing is left under the old one.
    let _ = written.keep();
    move_all(&complete, folder)
}

/// Finishes an exchange that was broken off, and removes what runs that were killed have left. For the holder of the
/// folder's lock.
pub(super) fn recover(folder: &Path) -> Result<(), ResultsError> {
    let complete = folder.join(COMPLETE);
    if complete.symlink_metadata().is_ok_and(|found| found.is_dir()) {
        move_all(&complete, folder)?;
    }
    for entry in std::fs::read_dir(folder).map_err(io(folder, "read"))? {
        let entry = entry.map_err(io(folder, "read"))?;
        let (path, name) = (entry.path(), entry.file_name());
        let (name, kind) = (name.to_string_lossy(), entry.file_type().map_err(io(folder, "read"))?);
        if kind.is_dir() && name.starts_with(INCOMPLETE) {
            std::fs::remove_dir_all(&path).map_err(io(&path, "remove"))?;
        } else if !kind.is_dir() && name.starts_with('.') && name.ends_with(PARTIAL) {
            std::fs::remove_file(&path).map_err(io(&path, "remove"))?;
        }
    }
    Ok(())
}

/// Moves all files of the results `complete` to their places: the series first, so that its presence says that nothing
/// has been moved, and the summary last, without which a folder holds no results.
fn move_all(complete: &Path, folder: &Path) -> Result<(), ResultsError> {
    let moved = |name: &str| {
        let target = folder.join(name);
        std::fs::rename(complete.join(name), &target).map_err(io(&target, "write"))
    };
    if complete.join(TIMESERIES).exists() {
        for name in [SUMMARY, REPORT, ANIMATION] {
            remove(&folder.join(name))?;
        }
        moved(TIMESERIES)?;
    }
    if complete.join(SUMMARY).exists() {
        move_files(complete, folder, &complete.join(SUMMARY))?;
        moved(SUMMARY)?;
    }
    std::fs::remove_dir_all(complete).map_err(io(complete, "remove"))
}

/// Moves the files of a folder and of all folders below, without `last`.
fn move_files(from: &Path, to: &Path, last: &Path) -> Result<(), ResultsError> {
    for entry in std::fs::read_dir(from).map_err(io(from, "read"))? {
        let entry = entry.map_err(io(from, "read"))?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path == last {
            continue;
        }
        if entry.file_type().map_err(io(&path, "read"))?.is_dir() {
            std::fs::create_dir_all(&target).map_err(io(&target, "create the folder"))?;
            move_files(&path, &target, last)?;
        } else {
            std::fs::rename(&path, &target).map_err(io(&target, "write"))?;
        }
    }
    Ok(())
}

/// Removes a file, where there is one.
pub(super) fn remove(path: &Path) -> Result<(), ResultsError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(io(path, "remove")(source)),
        _ => Ok(()),
    }
}
