//! Modes of lines that were found before: those of this process, and files in the user's cache folder.
use super::modes::Modes;
use crate::StaticsError;
use serde::{Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::{env, fs, io, process};

/// First line of a file; the number changes with the meaning of what follows.
const FORMAT: &[u8; 24] = b"Pantoline, modes, no. 9\n";
/// Modes kept by a process, and files kept in the folder; the oldest go first.
const IN_PROCESS: usize = 4;
const FILES: usize = 16;

/// Name of a line: digest of all that its modes follow from.
pub(super) struct Key(Sha256);

impl Key {
    pub fn new() -> Self {
        let mut digest = Sha256::new();
        digest.update(FORMAT);
        digest.update(env!("CARGO_PKG_VERSION"));
        Self(digest)
    }

    pub fn add(&mut self, values: impl IntoIterator<Item = f64>) {
        let mut bytes = Vec::new();
        values
            .into_iter()
            .for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn name(self) -> String {
        let digest = self.0.finalize();
        digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The modes of a line that were found before, or those that `find` finds.
pub(super) fn known_or(
    key: Key,
    find: impl FnOnce() -> Result<Modes, StaticsError>,
) -> Result<Arc<Modes>, StaticsError> {
    static KNOWN: Mutex<Vec<(String, Arc<Modes>)>> = Mutex::new(Vec::new());
    let name = key.name();
    let mut known = KNOWN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some((_, modes)) = known.iter().find(|(other, _)| *other == name) {
        return Ok(Arc::clone(modes));
    }
    let folder = cache_folder();
    let file = folder.as_deref().map(|folder| folder.join(format!("modes-{name}.bin")));
    let modes = match file.as_deref().and_then(read) {
        Some(modes) => modes,
        None => {
            let modes = find()?;
            // A folder that cannot be written to costs time only.
            if let (Some(folder), Some(file)) = (&folder, &file) {
                let _ = write(folder, file, &modes);
            }
            modes
        }
    };
    let modes = Arc::new(modes);
    known.insert(0, (name, Arc::clone(&modes)));
    known.truncate(IN_PROCESS);
    Ok(modes)
}

/// Folder of files that are kept to save time: `PANTOLINE_CACHE`, else that of the user; none where both are unset or
/// empty.
///
/// A relative path of the user's variables is passed over, as the XDG Base Directory Specification asks: a cache in the
/// current directory belongs to whoever made that directory.
#[must_use]
pub fn cache_folder() -> Option<PathBuf> {
    let of = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if env::var_os("PANTOLINE_CACHE").is_some() {
        return of("PANTOLINE_CACHE");
    }
    let absolute = |name: &str| of(name).filter(|path| path.is_absolute());
    let user = absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")));
    user.map(|folder| folder.join("pantoline"))
}

/// The modes in a file; none where it is missing, of another format or damaged.
fn read<T: DeserializeOwned>(file: &Path) -> Option<T> {
    let bytes = fs::read(file).ok()?;
    let rest = bytes.strip_prefix(FORMAT.as_slice())?;
    let (sum, body) = rest.split_first_chunk::<8>()?;
    if u64::from_le_bytes(*sum) != checksum(body) {
        return None;
    }
    postcard::from_bytes(body).ok()
}

/// Writes a file beside its place and moves it there, so that no other process ever reads a part of it.
fn write<T: Serialize>(folder: &Path, file: &Path, modes: &T) -> io::Result<()> {
    let body = postcard::to_stdvec(modes).map_err(io::Error::other)?;
    fs::create_dir_all(folder)?;
    let part = file.with_extension(format!("{}.partial", process::id()));
    fs::write(
        &part,
        [FORMAT.as_slice(), &checksum(&body).to_le_bytes(), &body].concat(),
    )?;
    fs::rename(&part, file)?;
    let mut files: Vec<(std::time::SystemTime, PathBuf)> = fs::read_dir(folder)?
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with("modes-"))
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
        .collect();
    files.sort();
    for (_, old) in files.iter().rev().skip(FILES) {
        fs::remove_file(old)?;
    }
    Ok(())
}

/// FNV-1a over words of eight bytes.
fn checksum(bytes: &[u8]) -> u64 {
    let words = bytes.chunks(8).map(|word| {
        let mut whole = [0; 8];
        whole[..word.len()].copy_from_slice(word);
        u64::from_le_bytes(whole)
    });
    words.fold(0xcbf2_9ce4_8422_2325, |sum, word| {
        (sum ^ word).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_gives_its_modes_back_and_a_damaged_one_none() {
        let folder = env::temp_dir().join(format!("pantoline-modes-{}", process::id()));
        let file = folder.join("modes-test.bin");
        let modes: Vec<Vec<f64>> = (0..13_u32).map(|k| vec![f64::from(k); 2]).collect();
        write(&folder, &file, &modes).unwrap();
        let again: Vec<Vec<f64>> = read(&file).unwrap();
        assert_eq!(again, modes);
        let mut bytes = fs::read(&file).unwrap();
        for at in [3, 30, bytes.len() - 1] {
            bytes[at] ^= 1;
            fs::write(&file, &bytes).unwrap();
            assert!(read::<Vec<Vec<f64>>>(&file).is_none(), "byte {at}");
            bytes[at] ^= 1;
        }
        fs::write(&file, &bytes[..bytes.len() - 4]).unwrap();
        assert!(read::<Vec<Vec<f64>>>(&file).is_none(), "a file that was cut off");
        fs::remove_dir_all(&folder).unwrap();
    }
}
