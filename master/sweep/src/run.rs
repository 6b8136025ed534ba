//! All cases on a pool, and the tables at the end.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use experiments::engine::table::Status;
use experiments::engine::{Crew, Guard, side_by_side};
use results::ResultsError;
use results::report::{Progress, Show};
use scene::Scene;
use serde::Serialize;
use simulation::identity::{digest, program};
use simulation::{FmuSource, Mode, StaticLines};

use crate::base::{Base, Numbers};
use crate::case::{Cases, Made};
use crate::error::SweepError;
use crate::journal::{Identity, Journal};
use crate::page::{PAGE, Page};
use crate::parquet::ParquetTable;
use crate::plan::{Case, Plan, PlanWishes};
use crate::record::Record;
use crate::table::{CsvTable, rows};
use crate::values::shown;

/// Table for programs and for reading.
pub const CSV: &str = "sweep.csv";
/// The same table, smaller and faster to read, with the filtered forces.
pub const PARQUET: &str = "sweep.parquet";
/// Wall times, which alone differ from one time to the next.
pub const TIMES: &str = "sweep-times.csv";

/// Lines at rest that are kept; the fastest key changes from case to case, and few lines are met in turn.
const LINES: usize = 8;

/// Most cases that a thread makes in lockstep.
const TOGETHER: usize = 16;

/// Choices beside the plan.
#[derive(Clone, Debug)]
pub struct Options {
    /// Mode of the runs.
    pub mode: Mode,
    /// Cases made side by side.
    pub jobs: usize,
    /// `true` where filtered forces are kept.
    pub series: bool,
    /// `true` where FMUs log debug messages.
    pub logging: bool,
    /// Folder for packages of FMUs.
    pub fmus: PathBuf,
}

/// A sweep that can begin.
pub struct Sweep {
    base: Base,
    plan: Plan,
    options: Options,
    identity: Identity,
    /// Simulated time of the scene itself, s: the measure of the progress.
    duration: f64,
    pantographs: usize,
    cases: u64,
}

/// Result of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Mode.
    pub mode: String,
    /// `true` where every case is finished.
    pub complete: bool,
    /// Cases of the plan.
    pub cases: u64,
    /// Combinations or samples that constraints leave out.
    pub left_out: u64,
    /// Finished cases.
    pub finished: u64,
    /// Finished cases that an earlier run of the sweep had made.
    pub made_earlier: u64,
    /// Cases that reached their end.
    pub stable: u64,
    /// Cases that began and did not.
    pub diverged: u64,
    /// Cases that could not begin.
    pub refused: u64,
    /// Rows of the table.
    pub rows: u64,
    /// Wall time of all time loops, and of statics and loading, s; sums over the threads.
    pub wall_s: f64,
    /// See above.
    pub setup_s: f64,
    /// Number and reason of the first case without figures.
    pub first_failure: Option<(u64, String)>,
}

impl Sweep {
    /// Reads the scene, makes the plan and tries its values.
    ///
    /// # Errors
    /// A scene or a wish that is refused.
    pub fn new(base: Base, wishes: PlanWishes, options: Options) -> Result<Self, SweepError> {
        // Contradictions of the scene itself may be solved by what is varied.
        let scene: Scene = base.read(&[])?;
        simulation::supervise(&scene, &mut None);
        let plan = Plan::new(wishes, &Numbers::of(&scene))?;
        plan.check(&base)?;
        let identity = Identity {
            scene: base.hash(&scene),
            plan: digest(&[plan.canonical().as_bytes()]),
            mode: options.mode.name().to_owned(),
            series: options.series,
            program: program().to_owned(),
        };
        Ok(Self {
            cases: plan.cases().count() as u64,
            duration: scene.run.duration,
            pantographs: scene.pantographs.len(),
            identity,
            base,
            plan,
            options,
        })
    }

    /// Texts of the files beside the scene, for the same sweep in another place.
    #[must_use]
    pub fn files(&self) -> BTreeMap<String, String> {
        self.base.files()
    }

    /// Number of cases.
    #[must_use]
    pub fn cases(&self) -> u64 {
        self.cases
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Makes the cases that `folder` does not hold yet, until all are made or `interrupted` is set, and writes the
    /// tables and the page of all that are finished.
    ///
    /// # Errors
    /// A folder with another sweep, reports of the operating system.
    pub fn run(&self, folder: &Path, interrupted: &AtomicBool, progress: &Progress) -> Result<Summary, SweepError> {
        let mut journal = Journal::open(folder, &self.identity, self.cases)?;
        let made_earlier = journal.finished();
        self.make(&mut journal, interrupted, progress)?;
        journal.sync()?;
        let mut summary = self.write(&mut journal, folder)?;
        summary.made_earlier = made_earlier;
        Ok(summary)
    }

    fn make(&self, journal: &mut Journal, interrupted: &AtomicBool, progress: &Progress) -> Result<(), SweepError> {
        let share = 1.0 / self.cases.max(1) as f64;
        let mut finished = journal.finished();
        progress.done_earlier(finished as f64 * share);
        // Cases that are known when the sweep begins; those made meanwhile are behind the iterator.
        let known: Vec<bool> = (1..=self.cases).map(|case| journal.has(case)).collect();
        let open = |case: u64| !known[case as usize - 1];
        self.make_open(&open, interrupted, (progress, share), &mut |made: Made| {
            journal.add(made.record, &made.series)?;
            finished += 1;
            progress.message(&format!("{finished} of {} cases", self.cases));
            Ok(())
        })
    }

    /// Makes the cases for which `open` holds and gives each to `keep`; `share` is the part of the bar for one case.
    fn make_open(
        &self,
        open: &(dyn Fn(u64) -> bool + Sync),
        interrupted: &AtomicBool,
        (progress, share): (&Progress, f64),
        keep: &mut dyn FnMut(Made) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let source = FmuSource {
            folder: self.options.fmus.clone(),
            logging: self.options.logging,
        };
        let lines = StaticLines::keeping(LINES.max(self.options.jobs));
        let cases = Cases {
            base: &self.base,
            plan: &self.plan,
            mode: self.options.mode,
            source: &source,
            lines: &lines,
            pantographs: self.pantographs,
            series: self.options.series,
        };
        let open = self.plan.cases().filter(|case| open(case.number));
        let one = |case: Case, guard: &Guard| {
            let bar = progress.beside(share, self.duration);
            let made = cases.make(&case, guard.stop(), &bar);
            bar.fill();
            Ok::<_, SweepError>(made)
        };
        let crew = Crew {
            workers: self.options.jobs,
            interrupted,
            limit: None,
            together: (self.cases as usize / self.options.jobs.max(1)).clamp(1, TOGETHER),
        };
        // A flag that is set between two cases ends the sweep too.
        let open = open.take_while(|_| !interrupted.load(std::sync::atomic::Ordering::Relaxed));
        side_by_side(crew, open, &one, keep)
    }

    /// Identity of the sweep: the same identity gives the same cases bit for bit.
    #[must_use]
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Makes some cases, for a sweep whose batches are made in several places: the records are those of
    /// [`Sweep::run`]. Fewer where `interrupted` is set meanwhile.
    ///
    /// # Errors
    /// FMUs that all cases need.
    pub fn make_batch(&self, cases: &BTreeSet<u64>, interrupted: &AtomicBool) -> Result<Vec<Made>, SweepError> {
        let mut batch = Vec::new();
        let hidden = Progress::share(&self.base.name, Show::Never);
        let share = 1.0 / cases.len().max(1) as f64;
        let open = |case: u64| cases.contains(&case);
        self.make_open(&open, interrupted, (&hidden, share), &mut |made| {
            batch.push(made);
            Ok(())
        })?;
        batch.sort_by_key(|made| made.record.case);
        Ok(batch)
    }

    /// Opens or begins the journal of the sweep in `folder`, for cases that are made elsewhere.
    ///
    /// # Errors
    /// See [`Journal::open`].
    pub fn journal(&self, folder: &Path) -> Result<Journal, SweepError> {
        Journal::open(folder, &self.identity, self.cases)
    }

    /// Writes the rows of a batch of cases as one Parquet file with the columns of the whole table.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn write_batch(&self, path: &Path, batch: &[Made]) -> Result<(), SweepError> {
        let failed = |source: parquet::errors::ParquetError| ResultsError::Io {
            path: path.to_owned(),
            action: "write",
            source: std::io::Error::other(source),
        };
        let mut table = ParquetTable::new(&self.plan, self.options.series, path).map_err(failed)?;
        let cases: BTreeMap<u64, &Made> = batch.iter().map(|made| (made.record.case, made)).collect();
        for case in self.plan.cases() {
            let Some(made) = cases.get(&case.number) else { continue };
            for (index, row) in rows(&self.plan, &case, &made.record).into_iter().enumerate() {
                let place = made.record.series.get(index).zip(made.series.get(index));
                let series = place.map(|(place, samples)| (samples.clone(), place.from, place.step));
                table.row(row, series).map_err(failed)?;
            }
        }
        table.finish().map_err(failed)?;
        Ok(())
    }

    /// Records of the finished cases in `folder`, in order.
    ///
    /// # Errors
    /// See [`Journal::open`].
    pub fn records(&self, folder: &Path) -> Result<Vec<Record>, SweepError> {
        let mut journal = self.journal(folder)?;
        let mut records = Vec::new();
        for case in self.plan.cases() {
            records.extend(journal.record(case.number)?);
        }
        Ok(records)
    }

    /// Writes tables and page of the finished cases, each file beside its place first.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn write(&self, journal: &mut Journal, folder: &Path) -> Result<Summary, SweepError> {
        let partial = |name: &str| folder.join(format!(".{name}.partial"));
        let create = |name: &str| {
            let path = partial(name);
            File::create(&path)
                .map(BufWriter::new)
                .map_err(results::io(&path, "write"))
        };
        let csv_failed = |source: csv::Error| ResultsError::Io {
            path: folder.join(CSV),
            action: "write",
            source: source.into(),
        };
        let parquet_failed = |source: parquet::errors::ParquetError| ResultsError::Io {
            path: folder.join(PARQUET),
            action: "write",
            source: std::io::Error::other(source),
        };
        let mut csv = CsvTable::new(&self.plan, create(CSV)?).map_err(csv_failed)?;
        let series = self.options.series;
        let mut parquet = ParquetTable::new(&self.plan, series, &partial(PARQUET)).map_err(parquet_failed)?;
        let mut times = csv::Writer::from_writer(create(TIMES)?);
        times.write_record(["case", "wall_s", "setup_s"]).map_err(csv_failed)?;
        let mut summary = Summary {
            scene: self.base.name.clone(),
            mode: self.options.mode.name().to_owned(),
            cases: self.cases,
            left_out: self.plan.points() - self.cases,
            ..Summary::default()
        };
        let mut page = Page::new(&self.plan, self.cases * self.pantographs as u64);
        for case in self.plan.cases() {
            let Some(record) = journal.record(case.number)? else {
                continue;
            };
            summary.take(&record);
            let seconds = |value: Option<f64>| value.map_or_else(String::new, shown);
            let row = [record.case.to_string(), seconds(record.wall), seconds(record.setup)];
            times.write_record(row).map_err(csv_failed)?;
            for (index, row) in rows(&self.plan, &case, &record).into_iter().enumerate() {
                csv.row(&row).map_err(csv_failed)?;
                page.take(&case, &record, index);
                let place = record.series.get(index);
                let samples = place.map(|place| journal.series(place).map(|samples| (samples, place.from, place.step)));
                parquet.row(row, samples.transpose()?).map_err(parquet_failed)?;
            }
        }
        summary.complete = summary.finished == self.cases;
        csv.finish().map_err(results::io(&folder.join(CSV), "write"))?;
        times.flush().map_err(results::io(&folder.join(TIMES), "write"))?;
        parquet.finish().map_err(parquet_failed)?;
        let html = page.finish(&summary, &|case| self.command(case, folder));
        std::fs::write(partial(PAGE), html).map_err(results::io(&partial(PAGE), "write"))?;
        for name in [CSV, PARQUET, TIMES, PAGE] {
            let path = folder.join(name);
            std::fs::rename(partial(name), &path).map_err(results::io(&path, "write"))?;
        }
        Ok(summary)
    }

    /// The command that computes the full report of a case beside the page in `folder`, given where the sweep was
    /// begun.
    #[must_use]
    pub fn command(&self, case: &Case, folder: &Path) -> String {
        let mut command = format!(
            "master run {} --mode {}",
            quoted(&self.base.origin),
            self.options.mode.name()
        );
        for set in self.base.overrides.iter().cloned().chain(self.plan.overrides(case)) {
            command.push_str(&format!(" --set {}", quoted(&set)));
        }
        let out = folder.join(format!("case-{}", case.number));
        format!("{command} --out {}", quoted(&out.display().to_string()))
    }
}

/// A word of a command for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/=+:,".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

impl Summary {
    fn take(&mut self, record: &Record) {
        self.finished += 1;
        self.rows += record.pantographs.len() as u64;
        match record.status {
            Status::Stable | Status::Limit => self.stable += 1,
            Status::Diverged => self.diverged += 1,
            Status::Refused => self.refused += 1,
        }
        if record.status != Status::Stable && self.first_failure.is_none() {
            self.first_failure = Some((record.case, record.reason.clone()));
        }
        self.wall_s += record.wall.unwrap_or_default();
        self.setup_s += record.setup.unwrap_or_default();
    }

    /// The result in words, for the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut parts = vec![format!("{} of {} cases finished", self.finished, self.cases)];
        let counts = [
            (self.made_earlier, "made earlier"),
            (self.left_out, "left out by constraints"),
            (self.stable, "stable"),
            (self.diverged, "diverged"),
            (self.refused, "refused"),
        ];
        parts.extend(
            counts
                .iter()
                .filter(|(count, _)| *count > 0)
                .map(|(count, what)| format!("{count} {what}")),
        );
        let failure = self
            .first_failure
            .iter()
            .map(|(case, reason)| format!("; case {case}: {reason}"));
        format!("{}: {}{}", self.scene, parts.join(", "), failure.collect::<String>())
    }
}
