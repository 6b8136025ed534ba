//! The plan of a study carried out: errors in parallel, times one at a time, nothing twice.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use scene::Scene;

use super::assemble::assemble;
use super::options::{Options, Sweep};
use super::outcome::Study;
use super::plan::{StudyRun, plan};
use super::reference::{Discretisation, Refinement, expected_work, refine, wanted};
use super::run_spec::{Family, Subject};
use crate::engine::{Attempt, Bench, Experiment, Planned, Run, Stage, Times, Unmade};
use results::Machine;
use results::curve::ForceCurve;
use simulation::identity::identity;
use simulation::sliding_joint;
use simulation::{SetupError, prepare, settled};

/// Folder of the runs inside a study's output directory.
pub const FOLDER: &str = "study";

/// Most work of a run that is timed again alone, coordinates times micro steps: finer levels of references are judges,
/// and nobody runs them for speed.
const TIMED: f64 = 5e8;

/// A study that can begin.
#[derive(Debug)]
pub struct Script {
    /// The scene, and the values that it allows.
    pub subject: Subject,
    /// Hash of the keys that no run changes.
    pub identity: String,
    /// Folder that paths in the scene are relative to.
    pub base: PathBuf,
    /// Options of the user.
    pub options: Options,
    /// Runs besides the levels of references.
    pub planned: Vec<StudyRun>,
    /// References: families and meshes.
    pub refinements: Vec<(Family, Discretisation)>,
    /// This machine.
    pub machine: Machine,
}

/// Solves the statics of a scene, which was read with these overrides, and plans its runs.
///
/// # Errors
/// Scenes that `master check` refuses.
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
    let subject = Subject::of(scene, &prepared, overrides, options.sweeps_over(Sweep::Vehicle));
    let planned = plan(&subject, &options);
    let judged = |run: &&StudyRun| run.scene.is_some() && run.sweeps.iter().any(|sweep| sweep.is_judged_by_reference());
    let families = planned.iter().filter(judged).map(|run| run.class().family);
    let mut families: BTreeSet<Family> = families.collect();
    if !families.is_empty() {
        families.insert(Family::Nonlinear);
    }
    Ok(Script {
        refinements: wanted(&subject, &families),
        subject,
        identity,
        base: base.to_owned(),
        options,
        planned,
        machine: Machine::this(),
    })
}

impl Script {
    /// Remarks on sweeps that were asked for, or belong to every study, and have no run.
    #[must_use]
    pub fn empty_sweeps(&self) -> Vec<String> {
        let subject = &self.subject;
        let joined = sliding_joint::holds(&subject.scene);
        let made = |sweep: &Sweep| self.planned.iter().any(|run| run.sweeps.contains(sweep));
        let unnamed = (joined && self.options.sweeps.is_empty()).then_some(Sweep::Coupling);
        let why = |sweep: &Sweep| match sweep {
            Sweep::Vehicle if subject.scene.vehicle.is_none() => "the scene has no [vehicle]",
            Sweep::Mesh | Sweep::Reductions | Sweep::Ladder | Sweep::Spans if !subject.meshed => {
                "the line is a supplied FMU"
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

    fn run(&self, planned: &StudyRun) -> Run {
        let stage = Stage {
            name: self.subject.name.clone(),
            base: self.base.clone(),
            scene: self.subject.text_of(&planned.spec).to_owned(),
            ..Stage::default()
        };
        Run::of(&Arc::new(stage), planned.variant.clone())
    }

    /// Everything that is known, from the outcomes of the jobs.
    fn state(&self, found: &[Option<StudyFound>]) -> State {
        let mut state = State {
            runs: self.planned.iter().cloned().map(Known::of).collect(),
            refinements: Vec::new(),
        };
        for found in found.iter().flatten() {
            match found {
                StudyFound::Refined(found) => state.take(found.clone(), self.planned.len()),
                StudyFound::Ran(index, made, times) => {
                    state.runs[*index].made = Some(Arc::clone(made));
                    state.runs[*index].times.clone_from(times);
                }
            }
        }
        state
    }

    /// Expected work of a refinement, coordinates times micro steps.
    fn work(&self, family: Family, discretisation: Discretisation) -> f64 {
        expected_work(&self.subject, &self.options, family, discretisation)
    }

    /// Work of timing a run as often as was asked for.
    fn timing(&self, run: &StudyRun) -> f64 {
        self.options.repeats as f64 * run.work
    }
}

/// A run, and what is known of it so far.
#[derive(Debug)]
pub struct Known {
    /// The run.
    pub run: StudyRun,
    /// How it went the first time.
    pub made: Option<Arc<Attempt>>,
    /// Its wall times.
    pub times: Option<Times>,
}

impl Known {
    fn of(run: StudyRun) -> Self {
        let (made, times) = (None, None);
        Self { run, made, times }
    }

    /// Its contact forces.
    pub(super) fn forces(&self) -> Option<&[ForceCurve]> {
        let made = self.made.as_ref()?;
        (!made.curves.is_empty()).then_some(&made.curves)
    }
}

/// Everything that is known so far.
#[derive(Debug)]
pub struct State {
    /// Every run: those of the plan, then levels of references that are not among them.
    pub runs: Vec<Known>,
    /// References.
    pub refinements: Vec<Refinement>,
}

impl State {
    /// Takes in a reference: its levels become runs, behind the `planned` ones in the order of the references,
    /// whichever is done first.
    fn take(&mut self, found: Refinement, planned: usize) {
        self.refinements.push(found);
        self.refinements
            .sort_by_key(|found| (found.family, found.discretisation));
        self.runs.truncate(planned);
        for level in self.refinements.iter().flat_map(|found| &found.levels) {
            let known = self.runs.iter().position(|known| known.run.same(&level.planned));
            let index = known.unwrap_or(self.runs.len());
            if known.is_none() {
                self.runs.push(Known::of(level.planned.clone()));
            }
            self.runs[index].run.join(Sweep::Reference);
            self.runs[index].made = Some(Arc::clone(&level.made));
        }
    }

    /// The place of a run.
    pub(super) fn place(&self, is: impl Fn(&StudyRun) -> bool) -> Option<usize> {
        self.runs.iter().position(|known| is(&known.run))
    }
}

/// One job of a study.
#[derive(Clone, Debug)]
pub enum StudyJob {
    /// Refine a model until two levels agree.
    Refine(Family, Discretisation),
    /// Make a run of the plan, by its number.
    Run(usize),
    /// Time a run alone: a run of the plan or a level of a reference, by its number among both.
    Time(usize, Box<StudyRun>),
}

/// Outcome of such a job.
#[derive(Clone, Debug)]
pub enum StudyFound {
    /// Levels of a reference.
    Refined(Refinement),
    /// A run of the plan or a level of a reference, and its times where it was timed.
    Ran(usize, Arc<Attempt>, Option<Times>),
}

impl Experiment for Script {
    type Job = StudyJob;
    type Found = StudyFound;
    type Table = Study;

    fn plan(&self) -> Vec<Planned<StudyJob>> {
        let refine = |&(family, mesh): &(Family, Discretisation)| {
            Planned::beside(StudyJob::Refine(family, mesh), self.work(family, mesh))
        };
        let runs = self.planned.iter().enumerate().filter(|(_, run)| !run.is_growth());
        let runs = runs.map(|(index, run)| Planned::beside(StudyJob::Run(index), run.work));
        self.refinements.iter().map(refine).chain(runs).collect()
    }

    fn further(&self, found: &[Option<StudyFound>]) -> Vec<Planned<StudyJob>> {
        let timed = |(index, Known { run, made, .. }): (usize, &Known)| {
            let complete = made.as_ref().is_some_and(|made| made.complete);
            let job = || StudyJob::Time(index, Box::new(run.clone()));
            (run.is_growth() || (complete && run.work <= TIMED)).then(|| Planned::alone(job(), self.timing(run)))
        };
        self.state(found).runs.iter().enumerate().filter_map(timed).collect()
    }

    fn further_work(&self) -> f64 {
        let planned = self.planned.iter();
        let timed = planned.filter(|run| run.scene.is_some() && run.work <= TIMED);
        timed.map(|run| self.timing(run)).sum()
    }

    fn make(&self, job: &StudyJob, bench: &Bench<'_>) -> Result<StudyFound, Unmade> {
        Ok(match job {
            StudyJob::Run(index) => {
                let made = bench.run(&self.run(&self.planned[*index]))?;
                StudyFound::Ran(*index, made, None)
            }
            StudyJob::Time(index, run) => {
                let timed = bench.timed(&self.run(run), self.options.repeats, run.is_growth())?;
                StudyFound::Ran(*index, timed.made, Some(timed.times))
            }
            StudyJob::Refine(family, mesh) => {
                let total = self.work(*family, *mesh).max(1.0);
                let mut one = |run: &StudyRun| bench.run_part(&self.run(run), (run.work / total).min(1.0));
                let mut refine = |mesh| refine(&self.subject, &self.options, *family, mesh, &mut one);
                let found = refine(*mesh)?;
                // A reduced model whose corrected mesh cannot run has a plain one.
                let reduced = *family != Family::Nonlinear && *mesh == Discretisation::Corrected;
                let instead = reduced && found.levels.is_empty();
                StudyFound::Refined(if instead { refine(Discretisation::Plain)? } else { found })
            }
        })
    }

    fn label(&self, job: &StudyJob) -> String {
        let is_time = matches!(job, StudyJob::Time(..));
        if is_time { "times" } else { "errors" }.to_owned()
    }

    fn judge(&self, found: &[Option<StudyFound>]) -> Study {
        let mut study = assemble(self, &self.state(found));
        study.complete = found.iter().all(Option::is_some) && study.rows.iter().all(|entry| entry.row.status.is_some());
        study
    }

    fn whole_forces(&self) -> bool {
        false
    }
}
