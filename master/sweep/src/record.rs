//! Record of a finished case: figures, costs, and the place of its series.

use experiments::engine::table::Status;
use results::standards::Limit;
use results::{Record as Series, RunInfo, Summary};
use serde::{Deserialize, Serialize};

/// Figures of one pantograph; empty where the case did not reach its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Mean of the filtered contact force, N.
    pub mean: Option<f64>,
    /// Its standard deviation, N.
    pub std: Option<f64>,
    /// Its minimum, N.
    pub min: Option<f64>,
    /// Its maximum, N.
    pub max: Option<f64>,
    /// Share of the evaluation time without contact, %.
    pub loss: Option<f64>,
    /// Limits that fail, of this pantograph and of the line: standard and quantity.
    pub failed: Vec<String>,
}

/// Costs of a case that are the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Generalised coordinates.
    pub coordinates: u64,
    /// Macro steps.
    pub macro_steps: u64,
    /// Micro steps.
    pub micro_steps: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Factorisations of an iteration matrix.
    pub factorizations: u64,
    /// Steps that were taken back.
    pub rollbacks: u64,
}

/// Filtered force of one pantograph over its evaluation range, by its place in the file of series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeriesPlace {
    /// First byte.
    pub offset: u64,
    /// Number of samples.
    pub samples: u64,
    /// Time of the first sample, s.
    pub from: f64,
    /// Time between two samples, s.
    pub step: f64,
}

/// Result of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Number of the case.
    pub case: u64,
    /// End of the case.
    pub status: Status,
    /// Why it is not stable.
    pub reason: String,
    /// One for each pantograph.
    pub pantographs: Vec<Figures>,
    /// Largest uplift at a support that bounds the evaluated spans, m.
    pub uplift: Option<f64>,
    /// Costs; nothing where the case could not begin.
    pub counts: Option<Counts>,
    /// Wall time of the time loop, s.
    pub wall: Option<f64>,
    /// Wall time of statics and loading, s.
    pub setup: Option<f64>,
    /// One for each pantograph, where series were asked for and the case reached its end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub series: Vec<SeriesPlace>,
}

/// A number of a table; one that is not finite is none.
fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}

impl Record {
    /// A case that has no figures.
    #[must_use]
    pub fn without_figures(case: u64, status: Status, reason: &str, pantographs: usize) -> Self {
        Self {
            case,
            status,
            // A table has one line per row.
            reason: reason.split_whitespace().collect::<Vec<_>>().join(" "),
            pantographs: vec![Figures::default(); pantographs],
            uplift: None,
            counts: None,
            wall: None,
            setup: None,
            series: Vec::new(),
        }
    }

    /// A case that has begun.
    #[must_use]
    pub fn of(case: u64, info: &RunInfo, record: &Series) -> Self {
        let summary = Summary::without_detail(info, record);
        let forces = summary
            .pantographs
            .iter()
            .map(|pantograph| pantograph.contact_force.filtered);
        let known = forces
            .clone()
            .all(|force| force.is_some_and(|force| force.mean.is_finite() && force.std.is_finite()));
        let (status, reason) = match (summary.complete, known) {
            (false, _) => (Status::Diverged, info.incomplete_reason.clone()),
            (true, false) => {
                let unknown = "the filtered contact force is not known over the evaluation range";
                let said = summary.notes.iter().find(|note| note.starts_with("pantograph "));
                (Status::Diverged, said.cloned().unwrap_or_else(|| unknown.to_owned()))
            }
            (true, true) => (Status::Stable, String::new()),
        };
        let mut made = Self::without_figures(case, status, &reason, summary.pantographs.len());
        let cost = &summary.cost;
        made.counts = Some(Counts {
            coordinates: summary.model.coordinates as u64,
            macro_steps: cost.macro_steps,
            micro_steps: cost.micro_steps,
            newton_iterations: cost.newton_iterations,
            factorizations: cost.factorizations,
            rollbacks: cost.rollbacks,
        });
        (made.wall, made.setup) = (Some(cost.wall_s), Some(cost.setup_s));
        if status != Status::Stable {
            return made;
        }
        made.uplift = finite(summary.uplift.max_at_support);
        for (index, (figures, pantograph)) in made.pantographs.iter_mut().zip(&summary.pantographs).enumerate() {
            let force = &pantograph.contact_force;
            *figures = Figures {
                mean: finite(force.filtered.map(|force| force.mean)),
                std: finite(force.filtered.map(|force| force.std)),
                min: finite(force.filtered.map(|force| force.min)),
                max: finite(force.filtered.map(|force| force.max)),
                loss: finite(force.loss_of_contact_percent),
                failed: failed(&summary.limits, index + 1),
            };
        }
        made
    }
}

/// Limits that fail for a pantograph (from 1) or for the line.
fn failed(limits: &[Limit], pantograph: usize) -> Vec<String> {
    let own = |limit: &&Limit| limit.pantograph.is_none_or(|number| number == pantograph);
    let failed = limits.iter().filter(|limit| limit.pass == Some(false)).filter(own);
    failed
        .map(|limit| format!("{} {}", limit.standard, limit.quantity))
        .collect()
}
