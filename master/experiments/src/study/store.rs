//! Runs that are kept, so that a study that was ended goes on where it was.
//!
//! A run is found again by a hash of its scene with every default written out, its mode, the program's own bytes and those of the
//! files that the scene names: the same key gives the same results bit for bit. Wall times belong to a machine too.

use std::path::Path;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Machine;
use crate::table_of_runs::{Attempt, Curve, Row};
use results::{OutputDirectory, ResultsError};

/// Folder of the runs inside a study's output directory.
pub const FOLDER: &str = "study";

/// Hash of some bytes, in hexadecimal.
pub(super) fn digest(parts: &[&[u8]]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        // The length keeps parts apart.
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The program: its version and its own bytes.
static PROGRAM: LazyLock<String> = LazyLock::new(|| {
    let bytes = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    digest(&[env!("CARGO_PKG_VERSION").as_bytes(), &bytes])
});

/// Runs on disk.
#[derive(Debug)]
pub struct Store {
    directory: OutputDirectory,
    /// Of the study's scene, with the content of the files that it names.
    identity: String,
    machine: Machine,
}

/// What is written of a run besides its contact forces.
#[derive(Serialize, Deserialize)]
struct Head {
    row: Row,
    complete: bool,
    energy_share: f64,
    remarks: Vec<String>,
    setup: f64,
}

/// Wall times of the time loop on a machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Where.
    machine: Machine,
    /// One per run, one run at a time, s.
    pub walls: Vec<f64>,
    /// Working memory of the time loop, bytes; nothing where it was not measured.
    pub memory: Option<u64>,
}

impl Store {
    /// A store in `folder` for the runs of a study of the scene with this identity, which holds the content of the files that the
    /// scene names.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn open(folder: &Path, identity: &str, machine: &Machine) -> Result<Self, ResultsError> {
        Ok(Self {
            directory: OutputDirectory::open(folder)?,
            identity: identity.to_owned(),
            machine: machine.clone(),
        })
    }

    /// Key of a run: its mode and its scene as text.
    #[must_use]
    pub fn key(&self, mode: &str, scene: &str) -> String {
        let parts = [mode, scene, &*PROGRAM, &self.identity].map(str::as_bytes);
        digest(&parts)[..24].to_owned()
    }

    /// A run that was made before; one that cannot be read has not been made.
    #[must_use]
    pub fn run(&self, key: &str) -> Option<Attempt> {
        let head: Head = self.read(&format!("{key}.json"))?;
        let bytes = std::fs::read(self.directory.path().join(format!("{key}.force"))).ok()?;
        Some(Attempt {
            row: head.row,
            curves: curves(&bytes)?,
            winds: Vec::new(),
            complete: head.complete,
            interrupted: false,
            lost: false,
            energy_share: head.energy_share,
            remarks: head.remarks,
            setup: head.setup,
        })
    }

    /// Keeps a run; its forces are written first, so that a run with a head is whole. One that ended with the process of an FMU is not
    /// kept: it is made again.
    ///
    /// # Errors
    /// What the operating system reports.
    pub fn keep(&self, key: &str, run: &Attempt) -> Result<(), ResultsError> {
        if run.lost {
            return Ok(());
        }
        self.directory.replace(&format!("{key}.force"), |out, path| {
            out.write_all(&bytes(&run.curves)).map_err(results::io(path, "write"))
        })?;
        let head = Head {
            row: run.row.clone(),
            complete: run.complete,
            energy_share: run.energy_share,
            remarks: run.remarks.clone(),
            setup: run.setup,
        };
        self.write(&format!("{key}.json"), &head)
    }

    /// Wall times of a run on this machine; none where it was not timed here.
    #[must_use]
    pub fn times(&self, key: &str) -> Times {
        let found: Option<Times> = self.read(&format!("{key}.times.json"));
        found
            .filter(|times| times.machine == self.machine)
            .unwrap_or_else(|| Times {
                machine: self.machine.clone(),
                ..Times::default()
            })
    }

    /// Keeps wall times.
    ///
    /// # Errors
    /// What the operating system reports.
    pub fn keep_times(&self, key: &str, times: &Times) -> Result<(), ResultsError> {
        self.write(&format!("{key}.times.json"), times)
    }

    fn read<T: for<'a> Deserialize<'a>>(&self, name: &str) -> Option<T> {
        let text = std::fs::read(self.directory.path().join(name)).ok()?;
        serde_json::from_slice(&text).ok()
    }

    fn write(&self, name: &str, value: &impl Serialize) -> Result<(), ResultsError> {
        self.directory.replace(name, |out, path| {
            serde_json::to_writer(out, value).map_err(|source| ResultsError::Json {
                path: path.to_owned(),
                source,
            })
        })
    }
}

/// Contact forces as bytes: for each strip the number of samples, first and last evaluated sample, then x, raw and filtered
/// force; integers and floats of 64 bits, little end first.
fn bytes(curves: &[Curve]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for curve in curves {
        for count in [curve.x.len(), curve.range.start, curve.range.end] {
            bytes.extend((count as u64).to_le_bytes());
        }
        for value in curve.x.iter().chain(&curve.raw).chain(&curve.filtered) {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// The way back; nothing where the bytes are not whole.
fn curves(bytes: &[u8]) -> Option<Vec<Curve>> {
    let (words, rest) = bytes.as_chunks::<8>();
    if !rest.is_empty() {
        return None;
    }
    let (mut at, mut curves) = (0, Vec::new());
    while at < words.len() {
        let count = |index: usize| Some(u64::from_le_bytes(*words.get(index)?) as usize);
        let (length, from, to) = (count(at)?, count(at + 1)?, count(at + 2)?);
        let series = |index: usize| {
            let begin = at + 3 + index * length;
            let values = words.get(begin..begin.checked_add(length)?)?;
            Some(
                values
                    .iter()
                    .map(|word| f64::from_le_bytes(*word))
                    .collect::<Vec<f64>>(),
            )
        };
        if from > to || to > length {
            return None;
        }
        curves.push(Curve {
            x: series(0)?,
            raw: series(1)?,
            filtered: series(2)?,
            range: from..to,
        });
        at += 3 + 3 * length;
    }
    Some(curves)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_run_is_found_again_with_all_its_bits_and_half_a_run_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), "", &Machine::default()).unwrap();
        let samples: Vec<f64> = (0..50).map(|n| (0.1 * f64::from(n)).sin() * 1e2 / 3.0).collect();
        let run = Attempt {
            row: Row {
                std: Some(1.0 / 3.0),
                reason: "a, \"b\"".to_owned(),
                ..Row::default()
            },
            curves: vec![Curve {
                x: samples.clone(),
                raw: samples.clone(),
                filtered: samples,
                range: 3..47,
            }],
            winds: Vec::new(),
            complete: true,
            interrupted: false,
            lost: false,
            energy_share: 0.1 + 0.2,
            remarks: vec!["said".to_owned()],
            setup: 0.7,
        };
        let key = store.key("monolithic", "scene");
        assert_eq!(store.run(&key), None);
        let lost = Attempt {
            lost: true,
            ..run.clone()
        };
        store.keep(&key, &lost).unwrap();
        assert_eq!(store.run(&key), None);
        store.keep(&key, &run).unwrap();
        assert_eq!(store.run(&key), Some(run));
        assert_ne!(key, store.key("inprocess", "scene"));
        assert_ne!(key, store.key("monolithic", "scene "));
        let forces = folder.path().join(format!("{key}.force"));
        let whole = std::fs::read(&forces).unwrap();
        std::fs::write(&forces, &whole[..whole.len() - 8]).unwrap();
        assert_eq!(store.run(&key), None);
    }

    #[test]
    fn wall_times_of_another_machine_do_not_count() {
        let folder = tempfile::tempdir().unwrap();
        let here = Store::open(folder.path(), "", &Machine::default()).unwrap();
        let mut times = here.times("a");
        times.walls = vec![1.0, 2.0];
        here.keep_times("a", &times).unwrap();
        assert_eq!(here.times("a").walls, [1.0, 2.0]);
        let elsewhere = Machine {
            cpu: "another".to_owned(),
            ..Machine::default()
        };
        let there = Store::open(folder.path(), "", &elsewhere).unwrap();
        assert!(there.times("a").walls.is_empty());
    }
}
