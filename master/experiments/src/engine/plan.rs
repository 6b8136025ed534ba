//! Experiment: jobs planned, made and judged.

use std::time::Duration;

use super::export::Table;
use super::pool::Bench;
use results::ResultsError;
use simulation::SetupError;

/// Reasons that end an experiment.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The scene or its FMUs.
    #[error(transparent)]
    Setup(Box<SetupError>),
    /// Files of the experiment.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl From<SetupError> for ExperimentError {
    fn from(error: SetupError) -> Self {
        Self::Setup(Box::new(error))
    }
}

/// Why a job has no outcome.
#[derive(Debug)]
pub enum Unmade {
    /// An end was asked for.
    Interrupted,
    /// A reason that concerns all jobs alike.
    Failed(ExperimentError),
}

impl<E: Into<ExperimentError>> From<E> for Unmade {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// Company in which a job is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timing {
    /// Beside others, on all workers: wall times say nothing.
    Beside,
    /// One at a time, after all jobs that are made beside others: wall times count.
    Alone,
}

/// One job of a plan.
#[derive(Clone, Debug)]
pub struct Planned<J> {
    /// The job.
    pub job: J,
    /// Expected cost relative to the other jobs, –: share of the progress, and the order beside others, dear jobs
    /// first.
    pub work: f64,
    /// Company.
    pub timing: Timing,
}

impl<J> Planned<J> {
    /// A job made beside others.
    pub fn beside(job: J, work: f64) -> Self {
        let timing = Timing::Beside;
        Self { job, work, timing }
    }

    /// A job that is timed.
    pub fn alone(job: J, work: f64) -> Self {
        let timing = Timing::Alone;
        Self { job, work, timing }
    }
}

/// A plan and a judge.
///
/// Jobs are usually single runs ([`super::Run`]); a job that needs several, one after the other, asks its [`Bench`] for
/// each.
pub trait Experiment: Sync {
    /// One piece of work.
    type Job: Sync;
    /// Outcome of a job.
    type Found: Send;
    /// All outcomes judged.
    type Table: Table;

    /// All jobs that are known beforehand.
    fn plan(&self) -> Vec<Planned<Self::Job>>;

    /// Makes a job.
    ///
    /// # Errors
    /// Reasons that concern all jobs alike, and an end that was asked for.
    fn make(&self, job: &Self::Job, bench: &Bench<'_>) -> Result<Self::Found, Unmade>;

    /// Name of a job beside the progress bar.
    fn label(&self, _job: &Self::Job) -> String {
        String::new()
    }

    /// Jobs that follow from the outcomes of [`plan`](Self::plan), once those are made; their outcomes stand behind the
    /// others.
    fn further(&self, _found: &[Option<Self::Found>]) -> Vec<Planned<Self::Job>> {
        Vec::new()
    }

    /// Work of the further jobs as far as it can be told beforehand, for the progress.
    fn further_work(&self) -> f64 {
        0.0
    }

    /// The table of all outcomes so far, in the order of the plan; called after every job, so that nothing computed is
    /// lost.
    fn judge(&self, found: &[Option<Self::Found>]) -> Self::Table;

    /// `true` where contact forces are kept over the whole run, for plots, or as far as a comparison needs them.
    fn whole_forces(&self) -> bool {
        true
    }

    /// Wall time after which a run is ended as diverged.
    fn limit(&self) -> Option<Duration> {
        None
    }
}
