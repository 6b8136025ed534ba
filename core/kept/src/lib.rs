//! Results that are kept in files of the user's cache folder, by a digest of all that they follow from.
#![forbid(unsafe_code)]

use serde::{Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::{env, fs, io, process};

/// A kind of files.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// First line of a file; its number changes with the meaning of what follows.
    pub format: &'static [u8; 24],
    /// Begin of the names.
    pub prefix: &'static str,
    /// Files kept in the folder; the oldest go first.
    pub most: usize,
}

/// Digest of all that a result follows from.
pub struct Key(Sha256);

impl Key {
    /// The digest of nothing but the kind and a version of the program.
    #[must_use]
    pub fn new(kind: Kind, version: &str) -> Self {
        let mut digest = Sha256::new();
        digest.update(kind.format);
        digest.update(version);
        Self(digest)
    }

    /// Adds numbers, and how many they are.
    pub fn add(&mut self, values: impl IntoIterator<Item = f64>) {
        let mut bytes = Vec::new();
        values
            .into_iter()
            .for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Name of the result.
    #[must_use]
    pub fn name(self) -> String {
        let digest = self.0.finalize();
        digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

impl Kind {
    /// The result of that name in the cache folder, or what `find` finds, which is kept there.
    ///
    /// # Errors
    /// Those of `find`: a folder that cannot be written to costs time only.
    pub fn known_or<T: Serialize + DeserializeOwned, E>(
        self,
        name: &str,
        find: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let folder = folder();
        let file = folder
            .as_deref()
            .map(|folder| folder.join(format!("{}-{name}.bin", self.prefix)));
        if let Some(known) = file.as_deref().and_then(|file| self.read(file)) {
            return Ok(known);
        }
        let found = find()?;
        if let (Some(folder), Some(file)) = (&folder, &file) {
            let _ = self.write(folder, file, &found);
        }
        Ok(found)
    }

    /// The result in a file; none where the file is missing, of another format or damaged.
    fn read<T: DeserializeOwned>(self, file: &Path) -> Option<T> {
        let bytes = fs::read(file).ok()?;
        let rest = bytes.strip_prefix(self.format.as_slice())?;
        let (sum, body) = rest.split_first_chunk::<8>()?;
        if u64::from_le_bytes(*sum) != checksum(body) {
            return None;
        }
        postcard::from_bytes(body).ok()
    }

    /// Writes a file beside its place and moves it there, so that no other process ever reads a part of it.
    fn write<T: Serialize>(self, folder: &Path, file: &Path, result: &T) -> io::Result<()> {
        let body = postcard::to_stdvec(result).map_err(io::Error::other)?;
        fs::create_dir_all(folder)?;
        let part = file.with_extension(format!("{}.partial", process::id()));
        fs::write(
            &part,
            [self.format.as_slice(), &checksum(&body).to_le_bytes(), &body].concat(),
        )?;
        fs::rename(&part, file)?;
        let begin = format!("{}-", self.prefix);
        let mut files: Vec<(std::time::SystemTime, PathBuf)> = fs::read_dir(folder)?
            .flatten()
            .filter(|entry| entry.file_name().to_string_lossy().starts_with(&begin))
            .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
            .collect();
        files.sort();
        for (_, old) in files.iter().rev().skip(self.most) {
            fs::remove_file(old)?;
        }
        Ok(())
    }
}

/// Folder of files that are kept to save time: `PANTOLINE_CACHE`, else that of the user; none where both are unset or
/// empty.
///
/// A relative path of the user's variables is passed over, as the XDG Base Directory Specification asks: a cache in the
/// current directory belongs to whoever made that directory.
#[must_use]
pub fn folder() -> Option<PathBuf> {
    let of = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if env::var_os("PANTOLINE_CACHE").is_some() {
        return of("PANTOLINE_CACHE");
    }
    let absolute = |name: &str| of(name).filter(|path| path.is_absolute());
    let user = absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")));
    user.map(|folder| folder.join("pantoline"))
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

    const KIND: Kind = Kind {
        format: b"Pantoline, tests, no. 1\n",
        prefix: "tests",
        most: 16,
    };

    #[test]
    fn a_file_gives_its_result_back_and_a_damaged_one_none() {
        let folder = env::temp_dir().join(format!("pantoline-kept-{}", process::id()));
        let file = folder.join("tests-test.bin");
        let result: Vec<Vec<f64>> = (0..13_u32).map(|k| vec![f64::from(k); 2]).collect();
        KIND.write(&folder, &file, &result).unwrap();
        let again: Vec<Vec<f64>> = KIND.read(&file).unwrap();
        assert_eq!(again, result);
        let mut bytes = fs::read(&file).unwrap();
        for at in [3, 30, bytes.len() - 1] {
            bytes[at] ^= 1;
            fs::write(&file, &bytes).unwrap();
            assert!(KIND.read::<Vec<Vec<f64>>>(&file).is_none(), "byte {at}");
            bytes[at] ^= 1;
        }
        fs::write(&file, &bytes[..bytes.len() - 4]).unwrap();
        assert!(KIND.read::<Vec<Vec<f64>>>(&file).is_none(), "a file that was cut off");
        fs::remove_dir_all(&folder).unwrap();
    }
}
