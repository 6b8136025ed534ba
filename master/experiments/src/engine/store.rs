//! Runs that are kept, so that an experiment that was ended goes on from there.
//!
//! The key of a run is a hash of its scene with every default written out, its mode, its disturbance, the program's own
//! bytes and those of the files that the scene names: the same key gives the same results bit for bit. Wall times
//! belong to a machine too.

use std::path::Path;
use std::sync::LazyLock;

use scene::Scene;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Machine;
use super::run::{Attempt, Run};
use super::table::ForceCurve;
use results::{OutputDirectory, ResultsError, WindRecord};
use simulation::Mode;
use system::disturbance::Disturbance;

/// Hash of some bytes, in hexadecimal.
#[must_use]
pub fn digest(parts: &[&[u8]]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        // The length keeps parts apart.
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Hash of files; one that cannot be read counts as empty.
fn files<'a>(paths: impl IntoIterator<Item = &'a Path>) -> String {
    let bytes: Vec<Vec<u8>> = paths
        .into_iter()
        .map(|path| std::fs::read(path).unwrap_or_default())
        .collect();
    digest(&bytes.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// The program: its version and its own bytes.
static PROGRAM: LazyLock<String> = LazyLock::new(|| {
    let program = fmi2::program::file().unwrap_or_default();
    digest(&[env!("CARGO_PKG_VERSION").as_bytes(), files([&*program]).as_bytes()])
});

/// The libraries that FMUs of this program are made of.
static LIBRARIES: LazyLock<String> = LazyLock::new(|| {
    let libraries = cosim::package::Libraries::find().ok();
    libraries.map_or_else(String::new, |found| files(found.paths()))
});

/// Hash of the program: the same hash gives the same results bit for bit.
#[must_use]
pub fn program() -> &'static str {
    &PROGRAM
}

/// The scene with a hash of their bytes in place of the files that it names: supplied FMUs and tables, relative to
/// `base`.
#[must_use]
pub fn by_content(scene: &Scene, base: &Path) -> Scene {
    let mut scene = scene.clone();
    // A file that cannot be read stops the run that it is for, with a message.
    let hashed = |path: &mut String| {
        let bytes = std::fs::read(base.join(&*path)).unwrap_or_default();
        path.clone_from(&digest(&[&bytes])[..12].to_owned());
    };
    scene.supplied_sides_mut().for_each(|side| hashed(&mut side.fmu));
    scene.unread_files_mut().into_iter().for_each(|(_, path)| hashed(path));
    scene
}

/// Key of a run; nothing where the scene refuses it, so that there is nothing to be kept.
#[must_use]
pub fn key(run: &Run) -> Option<String> {
    let scene = by_content(&run.scene().ok()?, &run.stage.base).to_toml();
    let disturbance = if run.disturbance == Disturbance::default() {
        String::new()
    } else {
        format!("{:?}", run.disturbance)
    };
    let libraries = if run.variant.mode == Mode::Cosimulation {
        &**LIBRARIES
    } else {
        ""
    };
    let mode = run.variant.mode.name();
    let parts = [
        &*run.stage.name,
        mode,
        &run.variant.algorithm,
        &scene,
        &disturbance,
        libraries,
        &**PROGRAM,
    ];
    Some(digest(&parts.map(str::as_bytes))[..24].to_owned())
}

/// Runs on disk.
#[derive(Debug)]
pub struct Store {
    directory: OutputDirectory,
    machine: Machine,
}

/// A run without its series, and how many there are.
#[derive(Serialize, Deserialize)]
struct Head<A> {
    attempt: A,
    curves: usize,
    winds: Vec<bool>,
}

/// Wall times of the time loop on a machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Machine of the times.
    machine: Machine,
    /// One per run, one run at a time, s.
    pub walls: Vec<f64>,
    /// Working memory of the time loop, bytes; nothing where it was not measured.
    pub memory: Option<u64>,
}

impl Store {
    /// A store in `folder`; wall times are those of `machine`.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn open(folder: &Path, machine: &Machine) -> Result<Self, ResultsError> {
        Ok(Self {
            directory: OutputDirectory::open(folder)?,
            machine: machine.clone(),
        })
    }

    /// A run that was made before; one that cannot be read has not been made.
    #[must_use]
    pub fn run(&self, key: &str) -> Option<Attempt> {
        let head: Head<Attempt> = self.read(&format!("{key}.json"))?;
        let bytes = std::fs::read(self.directory.path().join(format!("{key}.force"))).ok()?;
        let mut words = Words::of(&bytes)?;
        let curves = (0..head.curves).map(|_| words.curve()).collect::<Option<_>>()?;
        let winds = head.winds.iter();
        let winds = winds.map(|known| if *known { words.wind().map(Some) } else { Some(None) });
        Some(Attempt {
            curves,
            winds: winds.collect::<Option<_>>()?,
            ..head.attempt
        })
    }

    /// Keeps a run; its series are written first, so that a run with a head is whole. One that ended with the process
    /// of an FMU is not kept: it is made again.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn keep(&self, key: &str, run: &Attempt) -> Result<(), ResultsError> {
        if run.lost {
            return Ok(());
        }
        self.directory.replace(&format!("{key}.force"), |out, path| {
            out.write_all(&bytes(run)).map_err(results::io(path, "write"))
        })?;
        let head = Head {
            attempt: run,
            curves: run.curves.len(),
            winds: run.winds.iter().map(Option::is_some).collect(),
        };
        self.keep_value(key, &head)
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
    /// Reports of the operating system.
    pub fn keep_times(&self, key: &str, times: &Times) -> Result<(), ResultsError> {
        self.write(&format!("{key}.times.json"), times)
    }

    /// A figure that is no run of a scene, by the key of [`value_key`].
    #[must_use]
    pub fn value<T: for<'a> Deserialize<'a>>(&self, key: &str) -> Option<T> {
        self.read(&format!("{key}.json"))
    }

    /// A figure of a store in `folder` that is only read; nothing where there is no store.
    #[must_use]
    pub fn read_value<T: for<'a> Deserialize<'a>>(folder: &Path, key: &str) -> Option<T> {
        serde_json::from_slice(&std::fs::read(folder.join(format!("{key}.json"))).ok()?).ok()
    }

    /// Keeps such a figure.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn keep_value(&self, key: &str, value: &impl Serialize) -> Result<(), ResultsError> {
        self.write(&format!("{key}.json"), value)
    }

    fn read<T: for<'a> Deserialize<'a>>(&self, name: &str) -> Option<T> {
        serde_json::from_slice(&std::fs::read(self.directory.path().join(name)).ok()?).ok()
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

/// Key of a figure that is no run of a scene, by what it is a figure of; another program has other keys.
#[must_use]
pub fn value_key(of: &str) -> String {
    digest(&[of.as_bytes(), PROGRAM.as_bytes()])[..24].to_owned()
}

/// Series of a run as bytes, integers and floats of 64 bits, little end first. For each strip: number of samples, first
/// and last evaluated sample, x, raw and filtered force; then for each wind: number of samples, drag, lift.
fn bytes(run: &Attempt) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut add = |counts: &[usize], series: &[&[f64]]| {
        counts
            .iter()
            .for_each(|count| bytes.extend((*count as u64).to_le_bytes()));
        series
            .iter()
            .copied()
            .flatten()
            .for_each(|value| bytes.extend(value.to_le_bytes()));
    };
    for curve in &run.curves {
        let counts = [curve.x.len(), curve.range.start, curve.range.end];
        add(&counts, &[&curve.x, &curve.raw, &curve.filtered]);
    }
    for wind in run.winds.iter().flatten() {
        add(&[wind.drag.len()], &[&wind.drag, &wind.lift]);
    }
    bytes
}

/// The way back; nothing where the bytes are not whole.
struct Words<'a> {
    words: &'a [[u8; 8]],
}

impl<'a> Words<'a> {
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let (words, rest) = bytes.as_chunks::<8>();
        rest.is_empty().then_some(Self { words })
    }

    fn count(&mut self) -> Option<usize> {
        let (first, rest) = self.words.split_first()?;
        self.words = rest;
        usize::try_from(u64::from_le_bytes(*first)).ok()
    }

    fn series(&mut self, length: usize) -> Option<Vec<f64>> {
        let (series, rest) = self.words.split_at_checked(length)?;
        self.words = rest;
        Some(series.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }

    fn curve(&mut self) -> Option<ForceCurve> {
        let (length, from, to) = (self.count()?, self.count()?, self.count()?);
        let curve = ForceCurve {
            x: self.series(length)?,
            raw: self.series(length)?,
            filtered: self.series(length)?,
            range: from..to,
        };
        (from <= to && to <= length).then_some(curve)
    }

    fn wind(&mut self) -> Option<WindRecord> {
        let length = self.count()?;
        let (drag, lift) = (self.series(length)?, self.series(length)?);
        Some(WindRecord { drag, lift })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::engine::table::RunRow;
    use crate::engine::{Stage, Variant};

    fn run(scene: &str, mode: Mode) -> Run {
        let stage = Stage {
            scene: scene.to_owned(),
            ..Stage::default()
        };
        let variant = Variant {
            mode,
            algorithm: String::new(),
            overrides: Vec::new(),
        };
        Run::of(&Arc::new(stage), variant)
    }

    #[test]
    fn a_kept_run_is_found_again_with_all_its_bits_and_half_a_run_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), &Machine::default()).unwrap();
        let samples: Vec<f64> = (0..50).map(|n| (0.1 * f64::from(n)).sin() * 1e2 / 3.0).collect();
        let made = Attempt {
            row: RunRow {
                std: Some(1.0 / 3.0),
                reason: "a, \"b\"".to_owned(),
                ..RunRow::default()
            },
            curves: vec![ForceCurve {
                x: samples.clone(),
                raw: samples.clone(),
                filtered: samples,
                range: 3..47,
            }],
            winds: vec![
                None,
                Some(WindRecord {
                    drag: vec![0.1, 0.2],
                    lift: vec![-0.3, 1.0 / 7.0],
                }),
            ],
            complete: true,
            energy_share: 0.1 + 0.2,
            remarks: vec!["said".to_owned()],
            setup: 0.7,
            ..Attempt::default()
        };
        let (text, other) = (
            include_str!("../../../../scenes/en50318-250.toml"),
            include_str!("../../../../scenes/en50318-300.toml"),
        );
        let key_of = |text: &str, mode: Mode| super::key(&run(text, mode)).unwrap();
        let key = key_of(text, Mode::Monolithic);
        assert_eq!(store.run(&key), None);
        let lost = Attempt {
            lost: true,
            ..made.clone()
        };
        store.keep(&key, &lost).unwrap();
        assert_eq!(store.run(&key), None);
        store.keep(&key, &made).unwrap();
        assert_eq!(store.run(&key), Some(made));
        assert_ne!(key, key_of(text, Mode::Inprocess));
        assert_ne!(key, key_of(other, Mode::Monolithic));
        // A scene that is refused has nothing to be kept.
        assert_eq!(super::key(&run("", Mode::Monolithic)), None);
        let forces = folder.path().join(format!("{key}.force"));
        let whole = std::fs::read(&forces).unwrap();
        std::fs::write(&forces, &whole[..whole.len() - 8]).unwrap();
        assert_eq!(store.run(&key), None);
    }

    #[test]
    fn wall_times_of_another_machine_do_not_count() {
        let folder = tempfile::tempdir().unwrap();
        let here = Store::open(folder.path(), &Machine::default()).unwrap();
        let mut times = here.times("a");
        times.walls = vec![1.0, 2.0];
        here.keep_times("a", &times).unwrap();
        assert_eq!(here.times("a").walls, [1.0, 2.0]);
        let elsewhere = Machine {
            cpu: "another".to_owned(),
            ..Machine::default()
        };
        let there = Store::open(folder.path(), &elsewhere).unwrap();
        assert!(there.times("a").walls.is_empty());
    }
}
