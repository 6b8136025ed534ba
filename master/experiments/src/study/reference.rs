//! References: a run refined until two successive levels agree.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::options::{Options, Sweep};
use super::plan::{StudyRun, base};
use super::run_spec::{Family, Mesh, RunSpec, Subject};
use crate::engine::table::Status;
use crate::engine::{Attempt, Unmade, words};
use results::curve::{Errors, ForceCurve, NO_ERRORS};

/// Most levels: each has twice the elements at half the micro step.
const LEVELS: u32 = 8;

/// Makes a run.
pub type Run<'a> = dyn FnMut(&StudyRun) -> Result<Arc<Attempt>, Unmade> + 'a;

words! {
    /// Mesh of a reference that is refined.
    pub enum Discretisation {
        /// Elements with all corrections that the scene takes.
        Corrected = "corrected",
        /// Elements alone.
        Plain = "plain",
    }
}

/// One level.
#[derive(Clone, Debug)]
pub struct Level {
    /// Run of the level.
    pub planned: StudyRun,
    /// Outcome.
    pub made: Arc<Attempt>,
    /// Difference of the filtered force from the level before, % of the standard deviation.
    pub difference: Option<f64>,
}

/// A family refined.
#[derive(Clone, Debug)]
pub struct Refinement {
    /// Model.
    pub family: Family,
    /// Mesh.
    pub discretisation: Discretisation,
    /// Levels, coarse to fine.
    pub levels: Vec<Level>,
    /// `true` where the last two levels agree.
    pub converged: bool,
    /// Reason of the end; empty where the last two levels agree.
    pub ended: String,
}

impl Refinement {
    /// Difference of the last two levels, %: what is not known of the finest; `None` with one level.
    pub(super) fn uncertainty(&self) -> Option<f64> {
        self.levels.last().and_then(|level| level.difference)
    }
}

/// Level `number` (from 0) of a refinement.
fn level(subject: &Subject, family: Family, discretisation: Discretisation, number: u32) -> StudyRun {
    // Plain elements begin where corrected ones have their second level.
    let both = !subject.best_corrections().is_empty();
    let ahead = u32::from(discretisation == Discretisation::Plain && both);
    let elements = subject.elements << (number + ahead);
    let micro_step = 0.5 * subject.micro_step / f64::from(1_u32 << number);
    let mut reductions = subject.exact();
    if family != Family::Nonlinear {
        reductions.push(family.name().to_owned());
    }
    let mesh: Mesh = match discretisation {
        Discretisation::Corrected => subject.corrected(elements),
        Discretisation::Plain => subject.mesh(elements, Vec::new()),
    };
    let spec = RunSpec {
        mesh,
        micro_step,
        reductions,
        // With a supplied side the macro step is refined with the micro step.
        exchange: subject.plain_exchange(micro_step),
        ..base(subject)
    };
    StudyRun::new(subject, spec, Sweep::Reference)
}

/// Work of the levels that a refinement is expected to need.
pub(super) fn expected_work(
    subject: &Subject,
    options: &Options,
    family: Family,
    discretisation: Discretisation,
) -> f64 {
    let works = (0..3).map(|number| level(subject, family, discretisation, number).work);
    works.filter(|work| *work <= options.work).sum()
}

/// Refines until two successive levels agree within the tolerance, or the next level is beyond the limit.
///
/// # Errors
/// Errors of `run`.
pub fn refine(
    subject: &Subject,
    options: &Options,
    family: Family,
    discretisation: Discretisation,
    run: &mut Run<'_>,
) -> Result<Refinement, Unmade> {
    let mut found = Refinement {
        family,
        discretisation,
        levels: Vec::new(),
        converged: false,
        ended: format!("after {LEVELS} levels"),
    };
    for number in 0..LEVELS {
        let planned = level(subject, family, discretisation, number);
        if planned.work > options.work {
            found.ended = format!(
                "the next level is {:.1e} coordinates times micro steps, more than the limit of {:.1e} \
                 (--reference-work)",
                planned.work, options.work
            );
            break;
        }
        let made = run(&planned)?;
        if made.row.status == Some(Status::Refused) || !made.complete || made.curves.is_empty() {
            let (level, micro_step) = (number + 1, 1e3 * planned.spec.micro_step);
            let mut row = made.row.clone();
            made.remarks.iter().for_each(|remark| row.remark(remark));
            found.ended = format!("level {level} (micro step {micro_step} ms) did not run: {}", row.reason);
            break;
        }
        let still = made.curves.iter().any(ForceCurve::is_still);
        let before = found.levels.last();
        let difference = before.and_then(|level| Errors::between(&made.curves, &level.made.curves).filtered);
        found.levels.push(Level {
            planned,
            made,
            difference,
        });
        found.converged = difference.is_some_and(|difference| difference <= options.tolerance);
        if found.converged || still {
            found.ended = if found.converged { "" } else { NO_ERRORS }.to_owned();
            break;
        }
    }
    Ok(found)
}

/// Refinements that a study needs for its families.
pub(super) fn wanted(subject: &Subject, families: &BTreeSet<Family>) -> Vec<(Family, Discretisation)> {
    let both = !subject.best_corrections().is_empty();
    let mut all = Vec::new();
    for &family in families {
        if both {
            all.push((family, Discretisation::Corrected));
        }
        // Two discretisations confirm each other; for the reduced models one is enough, unless it cannot run.
        if !both || family == Family::Nonlinear {
            all.push((family, Discretisation::Plain));
        }
    }
    all
}

/// The reference of a family: the refinement that is known best.
pub(super) fn best(refinements: &[Refinement], family: Family) -> Option<&Refinement> {
    let is = |found: &&Refinement| found.family == family && !found.levels.is_empty();
    let known = |found: &Refinement| found.uncertainty().unwrap_or(f64::INFINITY);
    let of_family = refinements.iter().filter(is);
    of_family.min_by(|a, b| known(a).total_cmp(&known(b)))
}
