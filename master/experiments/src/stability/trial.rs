//! One case in one mode: the run and the figures that prove what it is worth.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use scene::Scene;
use serde::Serialize;

use super::cases::Case;
use crate::table_of_runs::{Curve, Errors, Row, Status};
use cosim::algorithm::stability::spectral_radius;
use cosim::chain;
use results::Summary;
use results::report::{Progress, Show};
use simulation::{FmuSource, Mode, SetupError, prepare};
use system::disturbance::Disturbance;
use system::run::Watch;

/// Micro steps of the reference in one of the run.
const REFINED: f64 = 2.0;

/// Energy that the integration may make, % of the work and heat that were exchanged and of the energy at the start.
pub(super) const MADE: f64 = 1.0;

/// A contact force beyond which nothing can be right, N: a hundred times what tears a contact wire off.
const ABSURD: f64 = 1e7;

/// Figures of a run beside the columns of all tables.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Energy that the coupling, or in one system the integration, has made per second of simulated time, W.
    #[serde(rename = "energy_growth_W")]
    pub energy_growth: Option<f64>,
    /// The same energy as a share of the work that crossed the contact, or in one system of work and heat, %.
    #[serde(rename = "energy_share_percent")]
    pub energy_share: Option<f64>,
    /// Circular frequency of the head on the contact's spring times the macro step, or in one system the micro step, –.
    pub omega_h: Option<f64>,
    /// Growth of that oscillation per macro step, from the algorithm itself, –.
    pub amplification: Option<f64>,
    /// Most Newton iterations of one internal step.
    pub most_iterations: Option<u64>,
    /// Largest violation of a constraint, m.
    #[serde(rename = "constraint_drift_m")]
    pub drift: Option<f64>,
    /// Largest rate of a constraint, m/s.
    #[serde(rename = "constraint_rate_m_per_s")]
    pub drift_rate: Option<f64>,
    /// Largest contact force of the whole run, N.
    #[serde(rename = "largest_force_N")]
    pub largest_force: Option<f64>,
    /// Most droppers without tension at one time.
    pub slack_droppers: Option<u64>,
    /// Where the case becomes stable, or stops being so.
    pub boundary: String,
}

/// How a case is run.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// How line and pantographs are put together.
    pub mode: Mode,
    /// Coupling algorithm; none in one system.
    pub algorithm: &'static str,
}

impl Way {
    /// One system.
    pub const ONE: Self = Self {
        mode: Mode::Monolithic,
        algorithm: "",
    };
}

/// A run that was made.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// Its row, with its status where it has one.
    pub row: Row,
    /// Its figures.
    pub figures: Figures,
    /// Its contact forces; none where it cannot be compared.
    pub curves: Vec<Curve>,
    /// Whether somebody asked for an end.
    pub interrupted: bool,
}

impl Made {
    /// The status of a run that has one.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.row.status == Some(Status::Stable)
    }
}

/// Runs `case` with other keys besides; `judges` are the run that errors are against and its name.
///
/// Whatever happens, there is a row: a run that cannot begin is refused, one that panics has diverged.
#[must_use]
pub fn make(case: &Case, way: &Way, keys: &[String], judge: Option<(&str, &Made)>, interrupted: &AtomicBool) -> Made {
    caught(case, way, || run(case, way, keys, judge, interrupted))
}

/// What `run` returns, or the row of its panic.
pub(super) fn caught(case: &Case, way: &Way, run: impl FnOnce() -> Made) -> Made {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
        let reason = format!("panicked: {}", text.unwrap_or_default());
        ended(case, way, Status::Diverged, reason)
    })
}

/// The row of a run that left nothing but a reason.
fn ended(case: &Case, way: &Way, status: Status, reason: String) -> Made {
    Made {
        row: Row {
            scene: case.name.clone(),
            mode: way.mode.name().to_owned(),
            algorithm: way.algorithm.to_owned(),
            status: Some(status),
            reason,
            ..Row::default()
        },
        ..Made::default()
    }
}

fn overrides(case: &Case, way: &Way, keys: &[String]) -> Vec<String> {
    let mut all = case.overrides.clone();
    if !way.algorithm.is_empty() {
        all.push(format!("coupling.algorithm=\"{}\"", way.algorithm));
    }
    all.extend_from_slice(keys);
    all
}

/// The scene of a case.
pub(super) fn scene(case: &Case, way: &Way, keys: &[String]) -> Result<Scene, SetupError> {
    Ok(system::load(case.base, &case.name, &overrides(case, way, keys))?)
}

/// The micro step of a case with these keys, s; `None` where the scene is refused.
pub(super) fn steps(case: &Case, keys: &[String]) -> Option<(f64, f64)> {
    let scene = scene(case, &Way::ONE, keys).ok()?;
    let row = Row::planned(&case.name, &scene, Mode::Inprocess, "");
    row.macro_step.zip(row.micro_step)
}

/// The keys that refine the micro step (s) of a run for its reference.
#[must_use]
pub fn refined(micro_step: f64) -> Vec<String> {
    let micro = micro_step / REFINED;
    vec![
        format!("coupling.macro_step={micro:?}"),
        format!("solver.micro_step={micro:?}"),
    ]
}

fn run(case: &Case, way: &Way, keys: &[String], judge: Option<(&str, &Made)>, interrupted: &AtomicBool) -> Made {
    let scene = match scene(case, way, keys) {
        Ok(scene) => scene,
        Err(error) => return ended(case, way, Status::Refused, chain(&error)),
    };
    let mut row = Row::planned(&case.name, &scene, way.mode, way.algorithm);
    let mut figures = theory(&scene, way, &row);
    let progress = Progress::share("", Show::Never);
    let watch = Watch::new(interrupted, &progress);
    let folder = tempfile::tempdir();
    let source = FmuSource {
        folder: folder
            .as_ref()
            .map_or_else(|_| std::env::temp_dir(), |folder| folder.path().to_owned()),
        logging: false,
    };
    let finished = prepare(scene, &case.name, Path::new("."), false).and_then(|mut prepared| {
        prepared.disturbance = Disturbance {
            audited: case.disturbance.audited && way.mode == Mode::Monolithic,
            ..case.disturbance.clone()
        };
        prepared.run(way.mode, &source, &watch, |_| Ok::<(), SetupError>(()))
    });
    let finished = match finished {
        Ok(finished) => finished,
        Err(error) => {
            row.status = Some(Status::Refused);
            row.remark(&chain(&error));
            return Made {
                row,
                figures,
                ..Made::default()
            };
        }
    };
    let info = &finished.info;
    let complete = finished.failure.is_none();
    let curves = if complete {
        Curve::of(&info.evaluation, &finished.record)
    } else {
        Vec::new()
    };
    let summary = Summary::new(info, &finished.record);
    row.take(info, &summary, info.cost.wall_s, 1);
    // Rows are made side by side: their times would say nothing.
    (row.wall, row.repeats, row.real_time_factor) = (None, None, None);
    let forces = finished.record.pantographs.iter().flat_map(|strip| &strip.force);
    figures.largest_force = Some(forces.fold(0.0_f64, |max, force| max.max(*force)));
    figures.most_iterations = Some(finished.most_iterations).filter(|count| *count > 0);
    let seconds = info.cost.simulated_s;
    let coupled = way.mode != Mode::Monolithic;
    let mut share = info.coupling.energy_share;
    let made = match (coupled, &finished.evidence) {
        (true, _) => info.coupling.energy_residual,
        (false, Some(evidence)) => {
            let all = evidence.exchanged + evidence.deflected;
            share = if all > 0.0 { evidence.residual / all } else { 0.0 };
            Some(evidence.residual)
        }
        _ => None,
    };
    figures.energy_growth = made.filter(|_| seconds > 0.0).map(|made| made / seconds);
    figures.energy_share = made.map(|_| 100.0 * share);
    if let Some(evidence) = &finished.evidence {
        figures.slack_droppers = Some(evidence.slack_droppers as u64);
        if evidence.constraints > 0 {
            [figures.drift, figures.drift_rate] = evidence.drift.map(Some);
        }
    }
    let errors = judge
        .filter(|(_, judge)| complete && !judge.curves.is_empty())
        .map(|(_, judge)| Errors::between(&judge.curves, &curves));
    if let (Some(errors), Some((name, _))) = (&errors, judge) {
        row.take_errors(errors, name);
    }
    let (mut status, reason) = judged(&row, complete, errors.as_ref(), judge.map(|(_, judge)| &judge.row));
    row.remark(&reason);
    if coupled {
        let (with_energy, reason) = status.with_energy(share);
        row.remark(&reason);
        status = with_energy;
    } else if status == Status::Stable && 100.0 * share > MADE {
        status = Status::Limit;
        row.remark(&format!(
            "the time integration made {:.1} % of the energy exchanged",
            100.0 * share
        ));
    }
    if figures.largest_force.is_some_and(|force| force > ABSURD) {
        status = Status::Diverged;
        row.remark("the contact force has no bound");
    }
    if let Some(evidence) = finished.evidence.filter(|evidence| evidence.unrepeated > 0) {
        status = Status::Diverged;
        row.remark(&format!(
            "{} steps did not repeat from a saved state",
            evidence.unrepeated
        ));
    }
    row.remark(&info.incomplete_reason);
    if coupled {
        let coupling = &info.coupling.reason;
        let said = coupling.strip_prefix("named in the scene").unwrap_or(coupling);
        row.remark(said.trim_start_matches("; "));
    }
    row.status = Some(status);
    Made {
        row,
        figures,
        curves,
        interrupted: !complete && interrupted.load(Ordering::Relaxed),
    }
}

/// [`Status::of`], where a force without any variation has no standard deviation that errors could be in percent of.
fn judged(row: &Row, complete: bool, errors: Option<&Errors>, judge: Option<&Row>) -> (Status, String) {
    if complete && row.std == Some(0.0) && judge.is_none_or(|judge| judge.std == Some(0.0)) {
        return (Status::Stable, String::new());
    }
    Status::of(row, complete, errors, judge)
}

/// What is known beforehand: the head on the contact's spring.
fn theory(scene: &Scene, way: &Way, row: &Row) -> Figures {
    let head = scene
        .pantographs
        .first()
        .and_then(|pantograph| match &pantograph.model {
            scene::PantographModel::Lumped(lumped) => lumped.masses.first().copied(),
            scene::PantographModel::Linkage(linkage) => {
                let head = linkage.bodies.iter().find(|body| body.name == linkage.strip.body);
                head.map(|body| body.mass)
            }
            scene::PantographModel::Supplied(_) => None,
        });
    let omega = head
        .zip(scene.contact)
        .map(|(mass, contact)| (contact.stiffness / mass).sqrt());
    let step = if way.mode == Mode::Monolithic {
        row.micro_step
    } else {
        row.macro_step
    };
    let omega_h = omega.zip(step).map(|(omega, step)| omega * step);
    let coupled = way.mode != Mode::Monolithic;
    let amplification = omega_h.filter(|_| coupled).and_then(|number| {
        let radius = spectral_radius(&scene.coupling, number).ok()?;
        radius.is_finite().then_some(radius)
    });
    Figures {
        omega_h,
        amplification,
        ..Figures::default()
    }
}
