//! Making the runs of a study: errors in parallel, times one at a time, nothing twice.

use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::thread;

use scene::Scene;

use super::assemble::assemble;
use super::machine::{forget_touched, touched};
use super::outcome::Study;
use super::plan::{Options, Planned, Sweep, plan};
use super::recipe::{Family, Ground, identity};
use super::reference::{Discretisation, Refinement, expected_work, refine, wanted};
use super::store::{Store, Times};
use super::{Machine, store};
use crate::table_of_runs::{Attempt, Stage, attempt, settled};
use results::ResultsError;
use results::report::Progress;
use simulation::sliding_joint;
use simulation::{SetupError, prepare};
use system::run::Watch;

/// Most work of a run that is timed again alone, coordinates times micro steps: finer levels of references are judges, and
/// nobody runs them for speed.
const TIMED: f64 = 5e8;

/// Why a study cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scene.
    #[error(transparent)]
    Setup(Box<SetupError>),
    /// Its files.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl From<SetupError> for StudyError {
    fn from(error: SetupError) -> Self {
        Self::Setup(Box::new(error))
    }
}

/// A study that can begin.
#[derive(Debug)]
pub struct Script {
    /// What all runs share.
    pub ground: Ground,
    /// Hash of what no recipe changes.
    pub identity: String,
    /// Folder that paths in the scene are relative to.
    pub base: PathBuf,
    /// What was asked for.
    pub options: Options,
    /// Runs besides the levels of references.
    pub planned: Vec<Planned>,
    /// References: families and meshes.
    pub refinements: Vec<(Family, Discretisation)>,
    /// This machine.
    pub machine: Machine,
}

/// Solves the statics of a scene, which was read with these overrides, and plans its runs.
///
/// # Errors
/// What `master check` refuses.
pub fn script(
    mut scene: Scene,
    name: &str,
    base: &Path,
    overrides: &[String],
    options: Options,
) -> Result<Script, SetupError> {
    scene.run.duration = settled(&scene);
    let prepared = prepare(scene.clone(), name, base, false)?;
    let identity = identity(&scene, base);
    let ground = Ground::of(scene, &prepared, overrides, options.sweeps_over(Sweep::Vehicle));
    let planned = plan(&ground, &options);
    let mut families: Vec<Family> = planned
        .iter()
        .filter(|run| run.scene.is_some() && run.sweeps.iter().any(|sweep| sweep.is_judged_by_reference()))
        .map(|run| run.class().family)
        .collect();
    if !families.is_empty() {
        families.push(Family::Nonlinear);
    }
    families.sort();
    families.dedup();
    Ok(Script {
        refinements: wanted(&ground, &families),
        ground,
        identity,
        base: base.to_owned(),
        options,
        planned,
        machine: Machine::this(),
    })
}

impl Script {
    /// What is to be said of sweeps that were asked for, or belong to every study, and have no run.
    #[must_use]
    pub fn empty_sweeps(&self) -> Vec<String> {
        let ground = &self.ground;
        let joined = sliding_joint::holds(&ground.scene);
        let made = |sweep: &Sweep| self.planned.iter().any(|run| run.sweeps.contains(sweep));
        let unnamed = (joined && self.options.sweeps.is_empty()).then_some(Sweep::Coupling);
        let why = |sweep: &Sweep| match sweep {
            Sweep::Vehicle if ground.scene.vehicle.is_none() => "the scene has no [vehicle]",
            Sweep::Mesh | Sweep::Reductions | Sweep::Ladder | Sweep::Spans if !ground.meshed => {
                "the line is an FMU of somebody else"
            }
            Sweep::Coupling if joined => {
                "contact.law = \"sliding_joint\" makes line and pantograph one system, which nothing can couple"
            }
            Sweep::Spans => "--spans and --window-spans say how many there are",
            Sweep::RhoInf => "with --quick, --rho-inf says which there are",
            _ => "nothing is left to be changed",
        };
        let asked = self.options.sweeps.iter().copied().chain(unnamed);
        asked
            .filter(|sweep| !made(sweep))
            .map(|sweep| format!("sweep {} has no run: {}", sweep.name(), why(&sweep)))
            .collect()
    }

    /// Opens the store of the study in `folder`.
    ///
    /// # Errors
    /// See [`Store::open`].
    pub fn store(&self, folder: &Path) -> Result<Store, ResultsError> {
        Store::open(&folder.join(store::FOLDER), &self.identity, &self.machine)
    }
}

/// What is known so far.
#[derive(Debug, Default)]
pub struct State {
    /// Every run: those of the plan, then levels of references that are not among them.
    pub runs: Vec<Planned>,
    /// Their first runs.
    pub made: Vec<Option<Arc<Attempt>>>,
    /// Their wall times.
    pub times: Vec<Option<Times>>,
    /// References.
    pub refinements: Vec<Refinement>,
}

impl State {
    fn new(planned: &[Planned]) -> Self {
        Self {
            runs: planned.to_vec(),
            made: vec![None; planned.len()],
            times: vec![None; planned.len()],
            refinements: Vec::new(),
        }
    }

    /// Takes in a reference: its levels become runs, behind the `planned` ones in the order of the references, whichever is done
    /// first.
    fn take(&mut self, found: Refinement, planned: usize) {
        self.refinements.push(found);
        self.refinements
            .sort_by_key(|found| (found.family, found.discretisation));
        self.runs.truncate(planned);
        self.made.truncate(planned);
        self.times.truncate(planned);
        for level in self.refinements.iter().flat_map(|found| &found.levels) {
            match self.runs.iter().position(|run| run.same(&level.planned)) {
                Some(index) => {
                    if !self.runs[index].sweeps.contains(&Sweep::Reference) {
                        self.runs[index].sweeps.push(Sweep::Reference);
                    }
                    self.made[index] = Some(Arc::clone(&level.made));
                }
                None => {
                    self.runs.push(level.planned.clone());
                    self.made.push(Some(Arc::clone(&level.made)));
                    self.times.push(None);
                }
            }
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A run by its key: waited for while somebody else makes it.
type Slot = Arc<Mutex<Option<Arc<Attempt>>>>;

/// Makes runs, from any thread.
struct Runner<'a> {
    script: &'a Script,
    store: &'a Store,
    interrupted: &'a AtomicBool,
    progress: &'a Progress,
    slots: Mutex<BTreeMap<String, Slot>>,
}

impl Runner<'_> {
    fn key(&self, planned: &Planned) -> Option<String> {
        let scene = planned.scene.as_ref()?;
        Some(self.store.key(planned.variant.mode.name(), scene))
    }

    /// One run, whatever is known; `share` is its part of the progress, `begun` and `ended` are called around its time loop.
    fn fresh(&self, planned: &Planned, share: f64, [begun, ended]: [&dyn Fn(); 2]) -> Result<Attempt, StudyError> {
        let ground = &self.script.ground;
        let stage = Stage {
            name: &ground.name,
            base: &self.script.base,
            scene: ground.text_of(&planned.recipe).to_owned(),
            fmus: PathBuf::new(),
            logging: false,
            repeats: 1,
        };
        let part = self.progress.beside(share, ground.scene.run.duration);
        let watch = Watch {
            begun,
            ended,
            ..Watch::new(self.interrupted, &part)
        };
        let mut made = attempt(&stage, &planned.variant, &watch)?;
        part.fill();
        made.curves = made.curves.iter().map(crate::table_of_runs::Curve::cut).collect();
        Ok(made)
    }

    /// The run of a plan, made here, somewhere else or earlier; nothing when the study is to end.
    fn run(&self, planned: &Planned, share: f64) -> Result<Option<Arc<Attempt>>, StudyError> {
        let Some(key) = self.key(planned) else {
            // The scene refuses it: there is nothing to be kept.
            return Ok(Some(Arc::new(self.fresh(planned, share, [&|| {}; 2])?)));
        };
        let slot = Arc::clone(lock(&self.slots).entry(key.clone()).or_default());
        let mut slot = lock(&slot);
        if let Some(made) = &*slot {
            self.progress.beside(share, 1.0).fill();
            return Ok(Some(Arc::clone(made)));
        }
        if let Some(made) = self.store.run(&key) {
            self.progress.beside(share, 1.0).fill();
            return Ok(Some(Arc::clone(slot.insert(Arc::new(made)))));
        }
        if self.interrupted.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let made = self.fresh(planned, share, [&|| {}; 2])?;
        if made.interrupted {
            return Ok(None);
        }
        self.store.keep(&key, &made)?;
        Ok(Some(Arc::clone(slot.insert(Arc::new(made)))))
    }

    /// Wall times of a run, made one after the other; `made` is its first run, which may be made here. Nothing when the study is
    /// to end.
    fn timed(
        &self,
        planned: &Planned,
        made: &mut Option<Arc<Attempt>>,
        share: f64,
    ) -> Result<Option<Times>, StudyError> {
        let Some(key) = self.key(planned) else {
            return Ok(Some(Times::default()));
        };
        let mut times = self.store.times(&key);
        let growth = planned.sweeps.contains(&Sweep::Spans);
        if made.is_none() {
            *made = self.store.run(&key).map(Arc::new);
        }
        let repeats = self.script.options.repeats;
        let share = share / repeats as f64;
        for _ in 0..repeats.min(times.walls.len()) {
            self.progress.beside(share, 1.0).fill();
        }
        while times.walls.len() < repeats || made.is_none() {
            if self.interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let (watched, memory) = (Cell::new(false), Cell::new(None));
            let begun = || watched.set(growth && forget_touched());
            let ended = || memory.set(watched.get().then(touched).flatten());
            let again = self.fresh(planned, share, [&begun, &ended])?;
            if again.interrupted {
                return Ok(None);
            }
            times.memory = times.memory.or(memory.get());
            let (complete, wall) = (again.complete, again.row.wall);
            if made.is_none() {
                self.store.keep(&key, &again)?;
                *made = Some(Arc::new(again));
            }
            if !complete {
                break;
            }
            times.walls.extend(wall);
            self.store.keep_times(&key, &times)?;
        }
        Ok(Some(times))
    }
}

/// What a worker does next.
enum Job {
    Refine(Family, Discretisation, f64),
    Run(usize, f64),
}

/// What a worker has done.
enum Done {
    Refined(Refinement),
    Ran(usize, Arc<Attempt>),
}

/// Makes the runs of a script and times them; `keep` is given the study after each, so that nothing computed is lost.
///
/// Rows without a status have not been run.
///
/// # Errors
/// FMUs and files that cannot be made, and what `keep` returns.
pub fn study(
    script: &Script,
    store: &Store,
    interrupted: &AtomicBool,
    progress: &Progress,
    keep: &mut dyn FnMut(&Study) -> Result<(), StudyError>,
) -> Result<Study, StudyError> {
    let mut state = State::new(&script.planned);
    let is_growth = |run: &Planned| run.sweeps.contains(&Sweep::Spans);
    let weights = Weights::of(script);
    let runner = Runner {
        script,
        store,
        interrupted,
        progress,
        slots: Mutex::default(),
    };
    keep(&assemble(script, &state))?;

    let mut jobs: VecDeque<Job> = VecDeque::new();
    for &(family, discretisation) in &script.refinements {
        let work = expected_work(&script.ground, &script.options, family, discretisation);
        jobs.push_back(Job::Refine(family, discretisation, weights.parallel(work)));
    }
    // Long runs first: the last ones to end are short.
    let mut order: Vec<usize> = (0..state.runs.len())
        .filter(|&index| !is_growth(&state.runs[index]))
        .collect();
    order.sort_by(|a, b| state.runs[*b].work.total_cmp(&state.runs[*a].work));
    jobs.extend(
        order
            .into_iter()
            .map(|index| Job::Run(index, weights.parallel(state.runs[index].work))),
    );
    progress.message("errors");
    in_parallel(&runner, jobs, &mut |done| {
        match done {
            Done::Refined(found) => state.take(found, script.planned.len()),
            Done::Ran(index, made) => state.made[index] = Some(made),
        }
        keep(&assemble(script, &state))
    })?;

    progress.message("times");
    for index in 0..state.runs.len() {
        let run = state.runs[index].clone();
        let judged = state.made[index].as_ref().map(|made| made.complete);
        let wanted = is_growth(&run) || (judged == Some(true) && run.work <= TIMED);
        if !wanted || interrupted.load(Ordering::Relaxed) {
            continue;
        }
        let mut made = state.made[index].take();
        let share = weights.alone(run.work);
        if is_growth(&run) && run.scene.is_none() {
            // Refused: the row says why.
            made = runner.run(&run, share)?;
        }
        let times = runner.timed(&run, &mut made, share)?;
        state.made[index] = made;
        state.times[index] = times;
        keep(&assemble(script, &state))?;
    }
    let mut study = assemble(script, &state);
    study.complete = study.rows.iter().all(|entry| entry.row.status.is_some()) && !interrupted.load(Ordering::Relaxed);
    keep(&study)?;
    Ok(study)
}

/// Works on jobs on all cores; `take` is given what was done, on this thread.
fn in_parallel(
    runner: &Runner<'_>,
    jobs: VecDeque<Job>,
    take: &mut dyn FnMut(Done) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let jobs = Mutex::new(jobs);
    let stop = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel::<Result<Done, StudyError>>();
    thread::scope(|scope| {
        for _ in 0..runner.script.machine.cores.max(1) {
            let (sender, jobs, stop) = (sender.clone(), &jobs, &stop);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let Some(job) = lock(jobs).pop_front() else { break };
                    match work(runner, &job).transpose() {
                        Some(done) => {
                            // Nobody listens any more after an error.
                            if sender.send(done).is_err() {
                                break;
                            }
                        }
                        None => break,
                    }
                }
            });
        }
        drop(sender);
        let mut result = Ok(());
        for done in &receiver {
            if result.is_ok() {
                result = done.and_then(&mut *take);
            }
            if result.is_err() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        result
    })
}

fn work(runner: &Runner<'_>, job: &Job) -> Result<Option<Done>, StudyError> {
    match *job {
        Job::Run(index, share) => {
            let made = runner.run(&runner.script.planned[index], share)?;
            Ok(made.map(|made| Done::Ran(index, made)))
        }
        Job::Refine(family, discretisation, share) => {
            let (ground, options) = (&runner.script.ground, &runner.script.options);
            let total = expected_work(ground, options, family, discretisation).max(1.0);
            let mut one = |planned: &Planned| runner.run(planned, share * (planned.work / total).min(1.0));
            let found = refine(ground, options, family, discretisation, &mut one)?;
            let Some(found) = found else { return Ok(None) };
            let instead = found.levels.is_empty() && family != Family::Nonlinear;
            if instead && discretisation == Discretisation::Corrected {
                let plain = refine(ground, options, family, Discretisation::Plain, &mut one)?;
                return Ok(plain.map(Done::Refined));
            }
            Ok(Some(Done::Refined(found)))
        }
    }
}

/// Parts of the progress.
struct Weights {
    total: f64,
    cores: f64,
    repeats: f64,
}

impl Weights {
    fn of(script: &Script) -> Self {
        let cores = script.machine.cores.max(1) as f64;
        let repeats = script.options.repeats as f64;
        let references = script.refinements.iter();
        let mut total: f64 = references
            .map(|(family, mesh)| expected_work(&script.ground, &script.options, *family, *mesh) / cores)
            .sum();
        for run in script.planned.iter().filter(|run| run.scene.is_some()) {
            total += if run.sweeps.contains(&Sweep::Spans) {
                0.0
            } else {
                run.work / cores
            };
            total += if run.work <= TIMED { repeats * run.work } else { 0.0 };
        }
        Self {
            total: total.max(1.0),
            cores,
            repeats,
        }
    }

    fn parallel(&self, work: f64) -> f64 {
        work / self.cores / self.total
    }

    fn alone(&self, work: f64) -> f64 {
        self.repeats * work / self.total
    }
}
