//! Making the jobs of an experiment: beside each other on all workers, then those that are timed one at a time; nothing
//! twice.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::plan::{Experiment, ExperimentError, Planned, Timing, Unmade};
use super::run::{Attempt, Run};
use super::store::{Store, Times, key, value_key};
use results::curve::ForceCurve;
use results::report::Progress;
use simulation::memory::{forget_touched, touched};
use system::run::Watch;

/// Surroundings of an experiment.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// Runs that are kept.
    pub store: &'a Store,
    /// Set where an end is asked for.
    pub interrupted: &'a AtomicBool,
    /// Progress bar.
    pub progress: &'a Progress,
    /// Jobs made beside each other.
    pub workers: usize,
}

/// A run by its key: waited for while another worker makes it.
type Slot = Arc<Mutex<Weak<Attempt>>>;

/// Parts that all workers share.
struct Shared<'a> {
    site: Site<'a>,
    limit: Option<Duration>,
    whole_forces: bool,
    slots: Mutex<BTreeMap<String, Slot>>,
}

/// A worker's run under way: when it began, and the flag that ends it.
#[derive(Debug, Default)]
pub struct Guard {
    since: Mutex<Option<Instant>>,
    stop: AtomicBool,
}

/// Makes runs for one job; a run that was made before is taken from the store.
pub struct Bench<'a> {
    shared: &'a Shared<'a>,
    guard: &'a Guard,
    /// Part of the progress that the job is worth, and what of that its runs have moved.
    share: f64,
    moved: Cell<f64>,
}

/// A run with its wall times.
#[derive(Clone, Debug)]
pub struct Timed {
    /// The first run.
    pub made: Arc<Attempt>,
    /// Times of all runs.
    pub times: Times,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Guard {
    /// The flag that ends the run under way.
    #[must_use]
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    fn is_late(&self, limit: Option<Duration>) -> bool {
        let since = *lock(&self.since);
        limit.zip(since).is_some_and(|(limit, since)| since.elapsed() >= limit)
    }
}

impl Bench<'_> {
    /// Ends the job where an end was asked for.
    ///
    /// # Errors
    /// That end.
    pub(crate) fn go_on(&self) -> Result<(), Unmade> {
        if self.shared.site.interrupted.load(Ordering::Relaxed) {
            return Err(Unmade::Interrupted);
        }
        Ok(())
    }

    /// The only run of a job; see [`run_part`](Self::run_part).
    ///
    /// # Errors
    /// FMUs that cannot be made, a store that cannot be written, an end that was asked for.
    pub fn run(&self, run: &Run) -> Result<Arc<Attempt>, Unmade> {
        self.run_part(run, 1.0)
    }

    /// One run of a job, made here, by another worker or earlier. `part` is its share of the job's progress (–).
    ///
    /// # Errors
    /// FMUs that cannot be made, a store that cannot be written, an end that was asked for.
    pub fn run_part(&self, run: &Run, part: f64) -> Result<Arc<Attempt>, Unmade> {
        let Some(key) = key(run) else {
            // The scene refuses it: there is nothing to be kept.
            return Ok(Arc::new(self.fresh(run, part, [&|| {}; 2])?));
        };
        let slot = Arc::clone(lock(&self.shared.slots).entry(key.clone()).or_default());
        let mut slot = lock(&slot);
        let store = self.shared.site.store;
        let made = match slot.upgrade().or_else(|| store.run(&key).map(Arc::new)) {
            Some(made) => {
                self.skip(part);
                made
            }
            None => {
                let made = self.fresh(run, part, [&|| {}; 2])?;
                store.keep(&key, &made)?;
                Arc::new(made)
            }
        };
        *slot = Arc::downgrade(&made);
        Ok(made)
    }

    /// A run made `repeats` times, one after the other; the first may be known. With `memory`, the memory that the time
    /// loop touches is measured too.
    ///
    /// # Errors
    /// FMUs that cannot be made, a store that cannot be written, an end that was asked for.
    pub fn timed(&self, run: &Run, repeats: usize, memory: bool) -> Result<Timed, Unmade> {
        let Some(key) = key(run) else {
            let (made, times) = (self.run(run)?, Times::default());
            return Ok(Timed { made, times });
        };
        let store = self.shared.site.store;
        let mut times = store.times(&key);
        let part = 1.0 / repeats.max(1) as f64;
        self.skip(part * repeats.min(times.walls.len()) as f64);
        let again = |times: &mut Times, keep: bool| {
            let (watched, touched_now) = (Cell::new(false), Cell::new(None));
            let begun = || watched.set(memory && forget_touched());
            let finished = || touched_now.set(watched.get().then(touched).flatten());
            let made = self.fresh(run, part, [&begun, &finished])?;
            times.memory = times.memory.or(touched_now.get());
            if keep {
                store.keep(&key, &made)?;
            }
            if made.complete {
                times.walls.extend(made.row.wall);
                store.keep_times(&key, times)?;
            }
            Ok::<_, Unmade>(made)
        };
        let made = match store.run(&key) {
            Some(made) => made,
            None => again(&mut times, true)?,
        };
        // A run that cannot begin, or does not reach its end, has no time.
        let mut complete = made.complete;
        while complete && times.walls.len() < repeats {
            complete = again(&mut times, false)?.complete;
        }
        let made = Arc::new(made);
        Ok(Timed { made, times })
    }

    /// A figure that is no run of a scene: known by what it is a figure of, else made.
    ///
    /// # Errors
    /// A store that cannot be written, an end that was asked for.
    pub fn value<T: Serialize + for<'a> Deserialize<'a>>(
        &self,
        of: &str,
        make: impl FnOnce() -> T,
    ) -> Result<T, Unmade> {
        let (store, key) = (self.shared.site.store, value_key(of));
        if let Some(value) = store.value(&key) {
            return Ok(value);
        }
        self.go_on()?;
        let value = make();
        store.keep_value(&key, &value)?;
        Ok(value)
    }

    /// Moves the progress by a part that has not to be made.
    fn skip(&self, part: f64) {
        let share = part * self.share;
        self.shared.site.progress.beside(share, 1.0).fill();
        self.moved.set(self.moved.get() + share);
    }

    /// One run, whatever is known; `begun` and `ended` are called around its time loop.
    fn fresh(&self, run: &Run, part: f64, [begun, ended]: [&dyn Fn(); 2]) -> Result<Attempt, Unmade> {
        self.go_on()?;
        let share = part * self.share;
        let duration = run.scene().map_or(1.0, |scene| scene.run.duration);
        let bar = self.shared.site.progress.beside(share, duration);
        self.guard.stop.store(false, Ordering::Relaxed);
        *lock(&self.guard.since) = Some(Instant::now());
        let watch = Watch {
            begun,
            ended,
            ..Watch::new(&self.guard.stop, &bar)
        };
        let made = run.attempt(&watch);
        let is_late = self.guard.is_late(self.shared.limit);
        *lock(&self.guard.since) = None;
        let mut made = made?;
        bar.fill();
        self.moved.set(self.moved.get() + share);
        if is_late && !made.complete {
            // Another time, on a machine with less to do, it may not be.
            (made.interrupted, made.lost) = (false, true);
            let seconds = self.shared.limit.map_or(0, |limit| limit.as_secs());
            made.remarks.push(format!("ended after {seconds} s of wall time"));
        }
        if made.interrupted {
            return Err(Unmade::Interrupted);
        }
        if !self.shared.whole_forces {
            made.curves = made.curves.iter().map(ForceCurve::cut).collect();
        }
        Ok(made)
    }
}

/// Makes the jobs of an experiment; `keep` is given the table before the first, after each and at the end, so that
/// nothing computed is lost.
///
/// # Errors
/// FMUs and files that cannot be made, and errors of `keep`.
pub fn execute<E: Experiment>(
    experiment: &E,
    site: Site<'_>,
    keep: &mut dyn FnMut(&E::Table) -> Result<(), ExperimentError>,
) -> Result<E::Table, ExperimentError> {
    let shared = Shared {
        site,
        limit: experiment.limit(),
        whole_forces: experiment.whole_forces(),
        slots: Mutex::default(),
    };
    let plan = experiment.plan();
    let mut found: Vec<Option<E::Found>> = plan.iter().map(|_| None).collect();
    keep(&experiment.judge(&found))?;
    let workers = site.workers.max(1) as f64;
    let cost = |job: &Planned<E::Job>| match job.timing {
        Timing::Beside => job.work / workers,
        Timing::Alone => job.work,
    };
    let total = plan.iter().map(cost).sum::<f64>() + experiment.further_work();
    let share = |job: &Planned<E::Job>| cost(job) / total.max(f64::MIN_POSITIVE);
    let mut make = |jobs: &[Planned<E::Job>], found: &mut Vec<Option<E::Found>>| {
        let first = found.len() - jobs.len();
        for timing in [Timing::Beside, Timing::Alone] {
            let mut order: Vec<usize> = (0..jobs.len()).filter(|&index| jobs[index].timing == timing).collect();
            let mut workers = 1;
            if timing == Timing::Beside {
                workers = site.workers;
                // Long jobs first: the last ones to end are short.
                order.sort_by(|a, b| jobs[*b].work.total_cmp(&jobs[*a].work));
            }
            let one = |index: usize, guard: &Guard| {
                site.progress.message(&experiment.label(&jobs[index].job));
                let bench = Bench {
                    shared: &shared,
                    guard,
                    share: share(&jobs[index]),
                    moved: Cell::new(0.0),
                };
                let done = match experiment.make(&jobs[index].job, &bench) {
                    Ok(done) => done,
                    Err(Unmade::Interrupted) => return Ok(None),
                    Err(Unmade::Failed(error)) => return Err(error),
                };
                let left = (bench.share - bench.moved.get()).max(0.0);
                site.progress.beside(left, 1.0).fill();
                Ok(Some((index, done)))
            };
            let crew = Crew {
                workers,
                interrupted: site.interrupted,
                limit: shared.limit,
                together: 1,
            };
            side_by_side(crew, order.into_iter(), &one, &mut |(index, done)| {
                found[first + index] = Some(done);
                keep(&experiment.judge(found))
            })?;
        }
        Ok::<(), ExperimentError>(())
    };
    make(&plan, &mut found)?;
    let further = experiment.further(&found);
    if !further.is_empty() {
        found.extend(further.iter().map(|_| None));
        make(&further, &mut found)?;
    }
    let table = experiment.judge(&found);
    keep(&table)?;
    Ok(table)
}

/// Interval in which workers are looked after.
const LOOK: Duration = Duration::from_millis(50);

/// Threads that work side by side.
#[derive(Clone, Copy, Debug)]
pub struct Crew<'a> {
    /// Number of threads, at least one.
    pub workers: usize,
    /// Set where an end is asked for.
    pub interrupted: &'a AtomicBool,
    /// Wall time after which a run is ended.
    pub limit: Option<Duration>,
    /// Jobs that each thread makes in lockstep, at least one.
    pub together: usize,
}

/// Works on jobs in this order; `take` is given each outcome as it comes, on this thread. Jobs are drawn when a worker
/// is free and outcomes wait for `take`, so that memory does not grow with the number of jobs.
///
/// # Errors
/// The first error of a job or of `take`.
pub fn side_by_side<J: Send, F: Send, E: Send>(
    crew: Crew<'_>,
    jobs: impl Iterator<Item = J> + Send,
    one: &(impl Fn(J, &Guard) -> Result<Option<F>, E> + Sync),
    take: &mut dyn FnMut(F) -> Result<(), E>,
) -> Result<(), E> {
    let workers = crew.workers.max(1);
    let jobs = Mutex::new(jobs);
    let stop = AtomicBool::new(false);
    let guards: Vec<Guard> = (0..workers).map(|_| Guard::default()).collect();
    let (sender, receiver) = mpsc::sync_channel::<Result<F, E>>(workers);
    thread::scope(|scope| {
        for guard in &guards {
            let (sender, jobs, stop) = (sender.clone(), &jobs, &stop);
            scope.spawn(move || {
                let goes_on = || !stop.load(Ordering::Relaxed);
                let mut draw = || goes_on().then(|| lock(jobs).next()).flatten();
                // Nobody listens any more after an error.
                let mut done = |done: Result<Option<F>, E>| {
                    let done = done.transpose();
                    done.is_some_and(|done| sender.send(done).is_ok())
                };
                lockstep::together(crew.together.max(1), &mut draw, &|job| one(job, guard), &mut done);
            });
        }
        drop(sender);
        let mut result = Ok(());
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(done) if result.is_ok() => result = done.and_then(&mut *take),
                Ok(_) | Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => return result,
            }
            if result.is_err() {
                stop.store(true, Ordering::Relaxed);
            }
            let all = result.is_err() || crew.interrupted.load(Ordering::Relaxed);
            for guard in guards.iter().filter(|guard| all || guard.is_late(crew.limit)) {
                guard.stop.store(true, Ordering::Relaxed);
            }
        }
    })
}
