//! Journal of a sweep: one line per finished case, in the order in which cases finish.
//!
//! Lines are only added. A line that was torn by a kill is cut off when the journal is opened again, and its case is
//! made again. The first line says what the sweep is: the journal of another sweep is refused.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use results::ResultsError;
use serde::{Deserialize, Serialize};

use crate::error::SweepError;
use crate::record::{Record, SeriesPlace};

/// File of the journal.
pub const JOURNAL: &str = "sweep.journal";

/// File of the filtered forces, floats of 64 bits, little end first.
pub const SERIES: &str = "sweep.series";

/// Time between two requests to the system to put the files on the disk.
const SYNC: Duration = Duration::from_secs(5);

/// Bytes of a sample.
const SAMPLE: u64 = 8;

/// Identity of a sweep: hashes of its parts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Scene with the keys set for all cases, and the files that it names.
    pub scene: String,
    /// Keys, values, derived values, constraints, samples.
    pub plan: String,
    /// Mode.
    pub mode: String,
    /// `true` where filtered forces are kept.
    pub series: bool,
    /// Program.
    pub program: String,
}

impl Identity {
    /// Parts that differ, in words.
    fn differs(&self, other: &Self) -> String {
        let parts = [
            (self.scene != other.scene, "scene"),
            (self.plan != other.plan, "plan"),
            (self.mode != other.mode, "mode"),
            (self.series != other.series, "--series"),
            (self.program != other.program, "version of the program"),
        ];
        let differing: Vec<&str> = parts
            .iter()
            .filter(|(differs, _)| *differs)
            .map(|(_, name)| *name)
            .collect();
        format!("other {}", differing.join(", other "))
    }
}

/// A journal, open for further cases.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    end: u64,
    /// First byte of the line of each case, by its number less one; nothing for a case that is not finished.
    lines: Vec<Option<u64>>,
    finished: u64,
    series: Option<(PathBuf, File, u64)>,
    synced: Instant,
}

fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> SweepError {
    let error = results::io(path, action);
    move |source| SweepError::Results(error(source))
}

fn open(path: &Path) -> Result<File, SweepError> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    options.open(path).map_err(io(path, "write"))
}

impl Journal {
    /// Opens or begins the journal of a sweep of `cases` cases in `folder`.
    ///
    /// # Errors
    /// [`SweepError::OtherSweep`], [`SweepError::Busy`], reports of the operating system.
    pub fn open(folder: &Path, identity: &Identity, cases: u64) -> Result<Self, SweepError> {
        let path = folder.join(JOURNAL);
        let file = open(&path)?;
        if matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock)) {
            return Err(SweepError::Busy {
                folder: folder.to_owned(),
            });
        }
        let mut series = None;
        if identity.series {
            let path = folder.join(SERIES);
            let file = open(&path)?;
            let length = file.metadata().map_err(io(&path, "read"))?.len();
            series = Some((path, file, length));
        }
        let mut journal = Self {
            path,
            file,
            end: 0,
            lines: vec![None; usize::try_from(cases).unwrap_or(0)],
            finished: 0,
            series,
            synced: Instant::now(),
        };
        journal.read(folder, identity)?;
        Ok(journal)
    }

    /// Reads what is there, and cuts off what is not whole.
    fn read(&mut self, folder: &Path, identity: &Identity) -> Result<(), SweepError> {
        let path = self.path.clone();
        let mut reader = BufReader::new(self.file.try_clone().map_err(io(&path, "read"))?);
        let available = self.series.as_ref().map_or(0, |(_, _, length)| *length);
        let (mut line, mut used) = (Vec::new(), 0);
        loop {
            line.clear();
            let length = reader.read_until(b'\n', &mut line).map_err(io(&path, "read"))? as u64;
            if line.last() != Some(&b'\n') {
                break;
            }
            if self.end == 0 {
                let Ok(found) = serde_json::from_slice::<Identity>(&line) else {
                    break;
                };
                if found != *identity {
                    let differs = identity.differs(&found);
                    return Err(SweepError::OtherSweep {
                        folder: folder.to_owned(),
                        differs,
                    });
                }
            } else {
                let Ok(record) = serde_json::from_slice::<Record>(&line) else {
                    break;
                };
                let ends = record.series.iter().map(|place| place.offset + SAMPLE * place.samples);
                let needed = ends.max().unwrap_or(0);
                if needed > available || !self.note(record.case, self.end) {
                    break;
                }
                used = used.max(needed);
            }
            self.end += length;
        }
        self.file.set_len(self.end).map_err(io(&path, "write"))?;
        if let Some((path, file, length)) = &mut self.series {
            file.set_len(used).map_err(io(path, "write"))?;
            *length = used;
        }
        if self.end == 0 {
            self.line(identity)?;
        }
        Ok(())
    }

    /// Notes the line of a case; `false` where there is no such case, or a line already.
    fn note(&mut self, case: u64, at: u64) -> bool {
        let slot = usize::try_from(case.wrapping_sub(1))
            .ok()
            .and_then(|index| self.lines.get_mut(index));
        match slot {
            Some(line @ None) => {
                *line = Some(at);
                self.finished += 1;
                true
            }
            _ => false,
        }
    }

    fn line(&mut self, value: &impl Serialize) -> Result<(), SweepError> {
        let path = &self.path;
        let json = |source| ResultsError::Json {
            path: path.clone(),
            source,
        };
        let mut line = serde_json::to_vec(value).map_err(json)?;
        line.push(b'\n');
        self.file.seek(SeekFrom::Start(self.end)).map_err(io(path, "write"))?;
        self.file.write_all(&line).map_err(io(path, "write"))?;
        self.end += line.len() as u64;
        Ok(())
    }

    /// `true` where a case is finished.
    #[must_use]
    pub fn has(&self, case: u64) -> bool {
        let index = usize::try_from(case.wrapping_sub(1)).ok();
        index
            .and_then(|index| self.lines.get(index))
            .is_some_and(Option::is_some)
    }

    /// Number of finished cases.
    #[must_use]
    pub fn finished(&self) -> u64 {
        self.finished
    }

    /// Adds a finished case; `series` are the filtered forces, one for each of `record.series`.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn add(&mut self, mut record: Record, series: &[Vec<f64>]) -> Result<(), SweepError> {
        match &mut self.series {
            // Series come first, so that a case with a line is whole.
            Some((path, file, end)) if !series.is_empty() => {
                let mut bytes = Vec::new();
                for (place, samples) in record.series.iter_mut().zip(series) {
                    (place.offset, place.samples) = (*end + bytes.len() as u64, samples.len() as u64);
                    bytes.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
                }
                file.seek(SeekFrom::Start(*end)).map_err(io(path, "write"))?;
                file.write_all(&bytes).map_err(io(path, "write"))?;
                *end += bytes.len() as u64;
            }
            _ => record.series.clear(),
        }
        let at = self.end;
        self.line(&record)?;
        self.note(record.case, at);
        if self.synced.elapsed() >= SYNC {
            self.sync()?;
        }
        Ok(())
    }

    /// Asks the system to put the files on the disk.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn sync(&mut self) -> Result<(), SweepError> {
        if let Some((path, file, _)) = &self.series {
            file.sync_data().map_err(io(path, "write"))?;
        }
        self.synced = Instant::now();
        self.file.sync_data().map_err(io(&self.path, "write"))
    }

    /// The record of a finished case.
    ///
    /// # Errors
    /// Reports of the operating system, a line that has changed since it was read.
    pub fn record(&mut self, case: u64) -> Result<Option<Record>, SweepError> {
        let line = usize::try_from(case.wrapping_sub(1))
            .ok()
            .and_then(|index| self.lines.get(index).copied());
        let Some(at) = line.flatten() else { return Ok(None) };
        let path = &self.path;
        self.file.seek(SeekFrom::Start(at)).map_err(io(path, "read"))?;
        let mut line = Vec::new();
        BufReader::new(&self.file)
            .read_until(b'\n', &mut line)
            .map_err(io(path, "read"))?;
        let json = |source| {
            SweepError::Results(ResultsError::Json {
                path: path.clone(),
                source,
            })
        };
        serde_json::from_slice(&line).map(Some).map_err(json)
    }

    /// Samples at a place.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn series(&mut self, place: &SeriesPlace) -> Result<Vec<f64>, SweepError> {
        let Some((path, file, _)) = &mut self.series else {
            return Ok(Vec::new());
        };
        let mut bytes = vec![0; usize::try_from(SAMPLE * place.samples).unwrap_or(0)];
        file.seek(SeekFrom::Start(place.offset)).map_err(io(path, "read"))?;
        file.read_exact(&mut bytes).map_err(io(path, "read"))?;
        let (words, _) = bytes.as_chunks::<8>();
        Ok(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }
}

#[cfg(test)]
mod tests {
    use experiments::engine::table::Status;

    use super::*;

    fn identity(series: bool) -> Identity {
        let part = |name: &str| format!("hash of {name}");
        Identity {
            scene: part("scene"),
            plan: part("plan"),
            mode: "monolithic".to_owned(),
            series,
            program: part("program"),
        }
    }

    fn record(case: u64) -> Record {
        let mut record = Record::without_figures(case, Status::Stable, "", 1);
        record.pantographs[0].mean = Some(100.0 + 1.0 / case as f64);
        record.series = vec![SeriesPlace {
            from: 0.1,
            step: 0.5,
            ..SeriesPlace::default()
        }];
        record
    }

    fn series(case: u64) -> Vec<Vec<f64>> {
        vec![(0..case + 2).map(|n| 1.0 / (n + case) as f64).collect()]
    }

    #[test]
    fn a_journal_cut_at_any_byte_goes_on_with_the_cases_that_are_whole() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mut journal = Journal::open(folder.path(), &identity(true), 4).unwrap();
        for case in [2, 1, 4] {
            journal.add(record(case), &series(case)).unwrap();
        }
        drop(journal);
        let (whole, forces) = (std::fs::read(at(JOURNAL)).unwrap(), std::fs::read(at(SERIES)).unwrap());
        for cut in 0..=whole.len() {
            std::fs::write(at(JOURNAL), &whole[..cut]).unwrap();
            std::fs::write(at(SERIES), &forces).unwrap();
            let mut journal = Journal::open(folder.path(), &identity(true), 4).unwrap();
            let lines = whole[..cut]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count()
                .saturating_sub(1);
            assert_eq!(journal.finished(), lines as u64, "cut at byte {cut}");
            for case in 1..=4 {
                if !journal.has(case) {
                    journal.add(record(case), &series(case)).unwrap();
                }
            }
            for case in 1..=4 {
                let found = journal.record(case).unwrap().unwrap();
                assert_eq!(found.pantographs, record(case).pantographs);
                assert_eq!(
                    journal.series(&found.series[0]).unwrap(),
                    series(case)[0],
                    "cut at byte {cut}"
                );
            }
        }
    }

    #[test]
    fn a_case_whose_series_are_cut_is_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), &identity(true), 2).unwrap();
        (1..=2).for_each(|case| journal.add(record(case), &series(case)).unwrap());
        drop(journal);
        let forces = folder.path().join(SERIES);
        let bytes = std::fs::read(&forces).unwrap();
        std::fs::write(&forces, &bytes[..bytes.len() - 1]).unwrap();
        let journal = Journal::open(folder.path(), &identity(true), 2).unwrap();
        assert!(journal.has(1) && !journal.has(2));
    }

    #[test]
    fn another_sweep_and_another_process_are_refused_and_nothing_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), &identity(false), 3).unwrap();
        journal.add(record(3), &[]).unwrap();
        let said = Journal::open(folder.path(), &identity(false), 3)
            .unwrap_err()
            .to_string();
        assert!(said.contains("another process"), "{said}");
        drop(journal);
        let other = Identity {
            plan: "another".to_owned(),
            ..identity(false)
        };
        let said = Journal::open(folder.path(), &other, 3).unwrap_err().to_string();
        assert!(said.contains("another sweep (other plan)"), "{said}");
        assert!(Journal::open(folder.path(), &identity(false), 3).unwrap().has(3));
    }
}
