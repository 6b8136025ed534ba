//! Runs that are kept, so that an experiment that was ended goes on from there.
//!
//! The key of a run is a hash of its scene with every default written out, its mode, its disturbance, the program's own
//! bytes and those of the files that the scene names: the same key gives the same results bit for bit. Wall times
//! belong to a machine too.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::run::{Attempt, Run};
use results::Machine;
use results::curve::ForceCurve;
use results::{OutputDirectory, ResultsError, WindRecord};
use simulation::Mode;
use simulation::identity::{by_content, digest, libraries, program};

/// Key of a run; nothing where the scene refuses it, so that there is nothing to be kept.
pub(crate) fn key(run: &Run) -> Option<String> {
    let scene = by_content(&run.scene().ok()?, &run.stage.base).to_toml();
    let mode = run.variant.mode;
    let libraries = if mode == Mode::Cosimulation { libraries() } else { "" };
    let disturbance = format!("{:?}", run.disturbance);
    let (name, algorithm) = (&*run.stage.name, &*run.variant.algorithm);
    let parts = [name, mode.name(), algorithm, &scene, &disturbance, libraries, program()];
    Some(digest(&parts.map(str::as_bytes))[..24].to_owned())
}

/// Runs on disk.
#[derive(Debug)]
pub struct Store {
    directory: OutputDirectory,
    machine: Machine,
}

/// A run without its series, and their lengths.
#[derive(Serialize, Deserialize)]
struct Head<A> {
    attempt: A,
    /// Evaluated samples of each contact force.
    ranges: Vec<Range<usize>>,
    /// `true` for each strip that a wind acts on.
    winds: Vec<bool>,
    /// Samples of each series.
    lengths: Vec<usize>,
}

/// The series of a run: x, raw and filtered force of each strip, then drag and lift of each wind.
fn series(run: &Attempt) -> impl Iterator<Item = &Vec<f64>> {
    let forces = run
        .curves
        .iter()
        .flat_map(|curve| [&curve.x, &curve.raw, &curve.filtered]);
    let winds = run.winds.iter().flatten().flat_map(|wind| [&wind.drag, &wind.lift]);
    forces.chain(winds)
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
    pub(crate) fn run(&self, key: &str) -> Option<Attempt> {
        let head: Head<Attempt> = self.value(key)?;
        let bytes = std::fs::read(self.directory.path().join(format!("{key}.force"))).ok()?;
        let (words, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() || words.len() != head.lengths.iter().sum::<usize>() {
            return None;
        }
        let mut words = words.iter().map(|word| f64::from_le_bytes(*word));
        let mut series = head.lengths.iter().map(|length| words.by_ref().take(*length).collect());
        let mut next = || series.next();
        let curve = |range: Range<usize>| {
            let (x, raw, filtered) = (next()?, next()?, next()?);
            let curve = ForceCurve {
                x,
                raw,
                filtered,
                range,
            };
            (curve.range.end <= curve.x.len()).then_some(curve)
        };
        let curves = head.ranges.into_iter().map(curve).collect::<Option<_>>()?;
        let mut wind = || {
            Some(WindRecord {
                drag: next()?,
                lift: next()?,
            })
        };
        let winds = head
            .winds
            .iter()
            .map(|acts| if *acts { wind().map(Some) } else { Some(None) });
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
    pub(crate) fn keep(&self, key: &str, run: &Attempt) -> Result<(), ResultsError> {
        if run.lost {
            return Ok(());
        }
        self.directory.replace(&format!("{key}.force"), |out, path| {
            let bytes: Vec<u8> = series(run).flatten().flat_map(|value| value.to_le_bytes()).collect();
            out.write_all(&bytes).map_err(results::io(path, "write"))
        })?;
        let head = Head {
            attempt: run,
            ranges: run.curves.iter().map(|curve| curve.range.clone()).collect(),
            winds: run.winds.iter().map(Option::is_some).collect(),
            lengths: series(run).map(Vec::len).collect(),
        };
        self.keep_value(key, &head)
    }

    /// Wall times of a run on this machine; none where it was not timed here.
    pub(crate) fn times(&self, key: &str) -> Times {
        let found: Option<Times> = self.value(&format!("{key}.times"));
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
    pub(crate) fn keep_times(&self, key: &str, times: &Times) -> Result<(), ResultsError> {
        self.keep_value(&format!("{key}.times"), times)
    }

    /// A figure that is no run of a scene, by the key of [`value_key`].
    pub(crate) fn value<T: for<'a> Deserialize<'a>>(&self, key: &str) -> Option<T> {
        Self::read_value(self.directory.path(), key)
    }

    /// A figure of a store in `folder` that is only read; nothing where there is no store.
    pub(crate) fn read_value<T: for<'a> Deserialize<'a>>(folder: &Path, key: &str) -> Option<T> {
        serde_json::from_slice(&std::fs::read(folder.join(format!("{key}.json"))).ok()?).ok()
    }

    /// Keeps such a figure.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub(crate) fn keep_value(&self, key: &str, value: &impl Serialize) -> Result<(), ResultsError> {
        self.directory.replace(&format!("{key}.json"), |out, path| {
            serde_json::to_writer(out, value).map_err(|source| ResultsError::Json {
                path: path.to_owned(),
                source,
            })
        })
    }
}

/// Key of a figure that is no run of a scene, by what it is a figure of; another program has other keys.
pub(crate) fn value_key(of: &str) -> String {
    digest(&[of.as_bytes(), program().as_bytes()])[..24].to_owned()
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
