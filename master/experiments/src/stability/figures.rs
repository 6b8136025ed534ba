//! Figures of a run, and its status by them.

use std::sync::Arc;

use scene::Scene;
use serde::{Deserialize, Serialize};

use crate::engine::table::{RunRow, Status};
use crate::engine::{Attempt, Run};
use cosim::algorithm::stability::spectral_radius;
use simulation::Mode;

/// Energy that the integration may make, % of the work and heat that were exchanged and of the energy at the start.
pub(super) const MADE: f64 = 1.0;

/// A contact force beyond which nothing can be right, N: a hundred times what tears a contact wire off.
const ABSURD: f64 = 1e7;

/// Figures of a run beside the columns of all tables.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Energy that the coupling, or in one system the integration, has made per second of simulated time, W.
    #[serde(rename = "energy_growth_W")]
    pub energy_growth: Option<f64>,
    /// Share of this energy of the work that crossed the contact, or in one system of work and heat, %.
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
    /// Boundary between stable and not.
    pub boundary: String,
}

/// A run that was made and judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its row.
    pub row: RunRow,
    /// Its figures.
    pub figures: Figures,
    /// The run.
    pub made: Arc<Attempt>,
}

impl Judged {
    /// A run that was made, judged against the run that errors are against, with its name.
    pub(super) fn of(run: &Run, made: Arc<Attempt>, judge: Option<(&str, &Self)>) -> Self {
        let coupled = run.variant.mode != Mode::Monolithic;
        let judge = judge.filter(|(_, judge)| judge.made.complete && !judge.made.curves.is_empty());
        let mut row = made.compared(judge.map(|(name, judge)| (name, &judge.row, &*judge.made.curves)));
        // Rows are made side by side: their times would say nothing.
        (row.wall, row.repeats, row.real_time_factor) = (None, None, None);
        let mut figures = run
            .scene()
            .map_or_else(|_| Figures::default(), |scene| theory(&scene, coupled, &row));
        if row.status == Some(Status::Refused) {
            return Self { row, figures, made };
        }
        let share = figures.take(&made, coupled);
        if coupled {
            row.judge_energy(share);
        } else if row.is_stable() && 100.0 * share > MADE {
            let share = 100.0 * share;
            let reason = format!("the time integration made {share:.1} % of the energy exchanged");
            row.judge((Status::Limit, reason));
        }
        if figures.largest_force.is_some_and(|force| force > ABSURD) {
            row.judge((Status::Diverged, "the contact force has no bound".to_owned()));
        }
        let unrepeated = made.evidence.map_or(0, |evidence| evidence.unrepeated);
        if unrepeated > 0 {
            let reason = format!("{unrepeated} steps did not repeat from a saved state");
            row.judge((Status::Diverged, reason));
        }
        made.remarks.iter().for_each(|remark| row.remark(remark));
        Self { row, figures, made }
    }
}

impl Figures {
    /// Takes in the figures of a run; the energy that was made as a share of that exchanged (–).
    fn take(&mut self, run: &Attempt, coupled: bool) -> f64 {
        self.largest_force = run.largest_force;
        self.most_iterations = run.most_iterations;
        let mut share = run.energy_share;
        let made = match (coupled, &run.evidence) {
            (true, _) => run.row.energy_residual,
            (false, Some(evidence)) => {
                let all = evidence.exchanged + evidence.deflected;
                share = if all > 0.0 { evidence.residual / all } else { 0.0 };
                Some(evidence.residual)
            }
            _ => None,
        };
        self.energy_growth = made.filter(|_| run.simulated > 0.0).map(|made| made / run.simulated);
        self.energy_share = made.map(|_| 100.0 * share);
        if let Some(evidence) = &run.evidence {
            self.slack_droppers = Some(evidence.slack_droppers as u64);
            if evidence.constraints > 0 {
                [self.drift, self.drift_rate] = evidence.drift.map(Some);
            }
        }
        share
    }
}

/// Figures that are known beforehand: the head on the contact's spring.
fn theory(scene: &Scene, coupled: bool, row: &RunRow) -> Figures {
    let of_head = |pantograph: &scene::Pantograph| match &pantograph.model {
        scene::PantographModel::Lumped(lumped) => lumped.masses.first().copied(),
        scene::PantographModel::Linkage(linkage) => {
            let head = linkage.bodies.iter().find(|body| body.name == linkage.strip.body);
            head.map(|body| body.mass)
        }
        scene::PantographModel::Supplied(_) => None,
    };
    let contact = scene.pantographs.first().and_then(of_head).zip(scene.contact);
    let omega = contact.map(|(mass, contact)| (contact.stiffness / mass).sqrt());
    let step = if coupled { row.macro_step } else { row.micro_step };
    let omega_h = omega.zip(step).map(|(omega, step)| omega * step);
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
