//! One way of carrying out experiments: progress, results kept after every run, page and tables at the end.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::{CommandError, interrupted, print, print_as_it_is};
use crate::cli::Common;
use experiments::engine::export::{Csv, Exporter, Html, Json, Text};
use experiments::engine::{Experiment, ExperimentError, Site, Store, Table, execute};
use results::Machine;
use results::report::{Progress, Show};
use results::{OutputDirectory, ResultsError};

impl From<ExperimentError> for CommandError {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Setup(error) => Self::Setup(error),
            ExperimentError::Results(error) => Self::Results(error),
        }
    }
}

/// Files of an experiment.
pub struct Files {
    /// Table.
    pub csv: &'static str,
    /// Page.
    pub page: &'static str,
}

/// An experiment's output directory, ready for its runs.
pub struct Outputs<'a> {
    files: Files,
    common: &'a Common,
    directory: PathBuf,
    output: OutputDirectory,
    /// Runs that are kept.
    pub store: Store,
    machine: Machine,
    interrupted: &'static AtomicBool,
}

impl<'a> Outputs<'a> {
    /// Opens the directory, with runs in its folder `runs`, and takes hold of it.
    ///
    /// # Errors
    /// A directory that cannot be written to, or that another process writes to.
    pub fn open(directory: &Path, runs: &str, files: Files, common: &'a Common) -> Result<Self, CommandError> {
        let mut output = OutputDirectory::open(directory).map_err(CommandError::Directory)?;
        let holder = format!("`master`, for {},", files.csv);
        output.lock(&holder).map_err(CommandError::Directory)?;
        let machine = Machine::this();
        let runs = directory.join(runs);
        let kept = OutputDirectory::open(&runs).and_then(|kept| kept.clear());
        kept.map_err(CommandError::Directory)?;
        let store = Store::open(&runs, &machine).map_err(CommandError::Directory)?;
        Ok(Self {
            files,
            common,
            directory: directory.to_owned(),
            output,
            store,
            machine,
            interrupted: interrupted(common),
        })
    }

    /// Carries out an experiment, `label` beside its progress, and prints its table; `more` is kept with each table.
    ///
    /// # Errors
    /// Reasons that end an experiment.
    pub fn run<E: Experiment>(
        &self,
        experiment: &E,
        label: &str,
        more: &dyn Fn(&E::Table) -> Result<(), ResultsError>,
    ) -> Result<E::Table, ExperimentError> {
        let show = if self.common.quiet {
            Show::Never
        } else {
            Show::OnTerminal
        };
        let progress = Progress::share(label, show);
        let site = Site {
            store: &self.store,
            interrupted: self.interrupted,
            progress: &progress,
            workers: self.machine.cores,
        };
        let table = execute(experiment, site, &mut |table| {
            // The page of an earlier run may be one of another table.
            self.output.remove(self.files.page)?;
            Csv.replace(table, &self.output, self.files.csv)?;
            Ok(more(table)?)
        });
        progress.finish();
        table
    }

    /// Writes the page and prints the table.
    ///
    /// # Errors
    /// An incomplete table is a failure, its results are kept.
    pub fn finish(&self, table: &impl Table) -> Result<(), CommandError> {
        Html.replace(table, &self.output, self.files.page)
            .map_err(CommandError::Results)?;
        if self.common.json {
            print_as_it_is(&Json.string(table).map_err(CommandError::Results)?)?;
        } else if !self.common.quiet {
            let text = Text.string(table).map_err(CommandError::Results)?;
            let Files { csv, page } = self.files;
            print(&format!("{text}\n  {csv} and {page} in {}\n", self.directory.display()))?;
        }
        if table.is_complete() {
            return Ok(());
        }
        let (made, all) = table.made();
        Err(CommandError::Incomplete {
            directory: self.directory.clone(),
            reason: format!("{made} of {all} runs were made; the same command goes on from there"),
        })
    }
}
