//! The columns.

use std::borrow::Borrow;

use scene::{Catenary, Division, Scene};
use serde::{Deserialize, Serialize};

use super::Status;
use results::curve::Errors;
use results::{RunInfo, Summary};
use simulation::Mode;

/// A value as a cell: empty where it has no meaning for the row.
pub trait Cell {
    /// Text of the cell.
    fn cell(&self) -> String;
}

impl Cell for String {
    fn cell(&self) -> String {
        self.clone()
    }
}

impl Cell for Option<f64> {
    fn cell(&self) -> String {
        // The shortest text that reads back.
        self.filter(|value| value.is_finite())
            .map_or_else(String::new, |value| format!("{value:?}"))
    }
}

impl Cell for Option<u64> {
    fn cell(&self) -> String {
        self.map_or_else(String::new, |value| value.to_string())
    }
}

impl Cell for Option<Status> {
    fn cell(&self) -> String {
        self.map_or_else(String::new, |status| status.name().to_owned())
    }
}

/// Names joined by `+`, or the word for none.
pub(crate) fn joined<S: Borrow<str>>(names: &[S], none: &str) -> String {
    if names.is_empty() {
        return none.to_owned();
    }
    names.join("+")
}

macro_rules! columns {
    ($($(#[$meta:meta])* $field:ident: $type:ty = $name:literal),+ $(,)?) => {
        /// One run. What has no meaning for it is `None` or empty.
        ///
        /// Forces are those of the first pantograph after the low-pass filter, over the evaluation range; losses of
        /// contact are those of the raw force. Errors are the largest of all pantographs. Values that are not finite
        /// are `null` in JSON, as they are empty cells in CSV.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct RunRow {
            $($(#[$meta])* #[serde(rename = $name)] pub $field: $type,)+
        }

        impl RunRow {
            /// Names of the columns, in order.
            pub const COLUMNS: &[&str] = &[$($name),+];

            /// The cells, in the order of [`RunRow::COLUMNS`].
            #[must_use]
            pub fn cells(&self) -> Vec<String> {
                vec![$(self.$field.cell()),+]
            }
        }
    };
}

columns! {
    /// Name of the scene.
    scene: String = "scene",
    /// `monolithic`, `inprocess` or `cosimulation`.
    mode: String = "mode",
    /// Algorithm as asked for; empty where nothing is coupled.
    algorithm: String = "algorithm",
    /// Degree of the extrapolation, –.
    extrapolation: Option<u64> = "extrapolation",
    /// Communication step, s.
    macro_step: Option<f64> = "macro_step_s",
    /// Step of the time integration, as it divides the macro step, s.
    micro_step: Option<f64> = "micro_step_s",
    /// Elements of the contact wire in the span that has most, –.
    elements_per_span: Option<u64> = "elements_per_span",
    /// Corrections of the mesh, joined by `+`, or `plain`.
    mesh: String = "mesh",
    /// Reductions joined by `+`, or `none`.
    reduction: String = "reduction",
    /// End of the run; nothing for a run that has not been made yet.
    status: Option<Status> = "status",
    /// Mean, N.
    mean: Option<f64> = "mean_N",
    /// Standard deviation, N.
    std: Option<f64> = "std_N",
    /// Maximum, N.
    max: Option<f64> = "max_N",
    /// Minimum, N.
    min: Option<f64> = "min_N",
    /// Share of the evaluation time without contact, %.
    loss: Option<f64> = "loss_percent",
    /// Largest uplift at a support that bounds the evaluated spans, m.
    uplift: Option<f64> = "uplift_m",
    /// Name of the run that the errors are against.
    reference: String = "reference",
    /// rms difference of the filtered force at equal positions, % of the reference's standard deviation.
    filtered_error: Option<f64> = "rms_error_filtered_percent_of_std",
    /// rms difference of the raw force at equal positions, % of the reference's standard deviation (filtered).
    raw_error: Option<f64> = "rms_error_raw_percent_of_std",
    /// Difference of the standard deviations, % of the reference's; positive where it is too large.
    std_error: Option<f64> = "std_error_percent",
    /// Energy that the coupling added, J.
    energy_residual: Option<f64> = "energy_residual_J",
    /// Wall time of the time loop, median of the repeats, s.
    wall: Option<f64> = "wall_s",
    /// Runs that were timed, one at a time.
    repeats: Option<u64> = "repeats",
    /// Wall time over simulated time, –.
    real_time_factor: Option<f64> = "real_time_factor",
    /// Generalised coordinates.
    coordinates: Option<u64> = "coordinates",
    /// Macro steps.
    macro_steps: Option<u64> = "macro_steps",
    /// Micro steps of all sides, repeated ones included.
    micro_steps: Option<u64> = "micro_steps",
    /// Newton iterations.
    newton_iterations: Option<u64> = "newton_iterations",
    /// Factorisations of an iteration matrix.
    factorizations: Option<u64> = "factorizations",
    /// Times that the sides were taken back.
    rollbacks: Option<u64> = "rollbacks",
    /// Observed order of the filtered error from the next smaller macro step to this one, –.
    order: Option<f64> = "observed_order",
    /// `catenary.mesh.element_length`, m; nothing where the mesh has `elements_per_interval`.
    element_length: Option<f64> = "element_length_m",
    /// Remarks: result of an automatic choice, cause of an early end.
    reason: String = "reason",
}

impl RunRow {
    /// Row of a run before it is made.
    #[must_use]
    pub fn planned(name: &str, scene: &Scene, mode: Mode, algorithm: &str) -> Self {
        let coupled = mode != Mode::Monolithic;
        let line = scene.modelled_line().map(|(line, _)| line);
        let reductions = scene.model.reductions.iter();
        let reductions: Vec<&str> = reductions.map(|reduction| reduction.name()).collect();
        let mut row = Self {
            scene: name.to_owned(),
            mode: mode.name().to_owned(),
            algorithm: if coupled { algorithm.to_owned() } else { String::new() },
            extrapolation: coupled.then_some(scene.coupling.extrapolation as u64),
            macro_step: coupled.then_some(scene.coupling.macro_step),
            micro_step: Some(scene.internal_step()),
            mesh: line.map_or_else(String::new, |line| line.mesh.name()),
            reduction: joined(&reductions, "none"),
            ..Self::default()
        };
        if let Some(line) = line {
            row.divide(line, line.mesh.division);
        }
        row
    }

    /// `true` where the run is stable.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.status == Some(Status::Stable)
    }

    /// The status of a run that is not stable; nothing where it is, or has not been made.
    #[must_use]
    pub fn trouble(&self) -> Option<Status> {
        self.status.filter(|status| *status != Status::Stable)
    }

    /// Takes in a status and, where there is one, its reason.
    pub fn judge(&mut self, (status, reason): (Status, String)) {
        self.status = Some(status);
        self.remark(&reason);
    }

    /// Takes in the energy that the coupling added, as a share of the work that crossed the contact (–).
    pub(crate) fn judge_energy(&mut self, share: f64) {
        if let Some(status) = self.status {
            self.judge(status.with_energy(share));
        }
    }

    /// Takes in the elements of a line that is so divided.
    pub fn divide(&mut self, line: &Catenary, division: Division) {
        self.elements_per_span = Some(line.elements_per_span(division) as u64);
        self.element_length = match division {
            Division::PerInterval(_) => None,
            Division::UpTo(length) => Some(length),
        };
    }

    /// Takes in the figures and the cost of a run that has ended.
    pub fn take(&mut self, info: &RunInfo, summary: &Summary) {
        // Figures of a part of the evaluation range would be taken for those of the run.
        let complete = info.complete;
        let force = summary
            .pantographs
            .first()
            .map(|first| &first.contact_force)
            .filter(|_| complete);
        let filtered = force.and_then(|force| force.filtered);
        self.mean = filtered.map(|force| force.mean);
        self.std = filtered.map(|force| force.std);
        self.max = filtered.map(|force| force.max);
        self.min = filtered.map(|force| force.min);
        self.loss = force.and_then(|force| force.loss_of_contact_percent);
        self.uplift = summary.uplift.max_at_support.filter(|_| complete);
        if self.mode != Mode::Monolithic.name() {
            self.energy_residual = info.coupling.energy_residual;
            self.macro_steps = Some(info.cost.macro_steps);
            self.rollbacks = Some(info.cost.rollbacks);
        }
        self.wall = Some(info.cost.wall_s);
        self.repeats = Some(1);
        self.real_time_factor = info.cost.real_time_factor;
        self.coordinates = Some(info.model.coordinates as u64);
        self.micro_steps = Some(info.cost.micro_steps);
        self.newton_iterations = Some(info.cost.newton_iterations);
        self.factorizations = Some(info.cost.factorizations);
    }

    /// Takes in the wall times of all runs that were timed, s.
    pub fn timed(&mut self, walls: &[f64]) {
        let Some(wall) = crate::engine::median(walls) else {
            return;
        };
        // Wall time over simulated time: both grow alike.
        self.real_time_factor = match (self.real_time_factor, self.wall) {
            (Some(factor), Some(was)) if was > 0.0 => Some(factor / was * wall),
            (factor, _) => factor,
        };
        self.wall = Some(wall);
        self.repeats = Some(walls.len() as u64);
    }

    /// Takes in the errors against the run that is called `reference`.
    pub fn take_errors(&mut self, errors: &Errors, reference: &str) {
        self.reference = reference.to_owned();
        self.filtered_error = errors.filtered;
        self.raw_error = errors.raw;
        self.std_error = errors.std;
    }

    /// Adds to what is to be said of the run.
    pub fn remark(&mut self, text: &str) {
        if text.is_empty() || self.reason.contains(text) {
            return;
        }
        if !self.reason.is_empty() {
            self.reason.push_str("; ");
        }
        self.reason.push_str(text);
    }

    /// Mode and algorithm: what belongs to one curve over the macro step.
    #[must_use]
    pub fn method(&self) -> (&str, &str) {
        (&self.mode, &self.algorithm)
    }
}

/// Writes into each row the order of convergence that it shows together with the next smaller macro step of the same
/// mode and algorithm: `p = ln(e₂/e₁) / ln(h₂/h₁)`. Both must be stable and have errors above zero.
pub fn observed_orders(rows: &mut [RunRow]) {
    let point = |row: &RunRow| match (row.status, row.macro_step, row.filtered_error) {
        (Some(Status::Stable), Some(step), Some(error)) if error > 0.0 && error.is_finite() => Some((step, error)),
        _ => None,
    };
    let order = |row: &RunRow| {
        let (step, error) = point(row)?;
        let of_method = rows.iter().filter(|other| other.method() == row.method());
        let smaller = of_method.filter_map(|other| Some((other.macro_step.filter(|other| *other < step)?, other)));
        // The neighbour must itself be stable: no order across a step that is not.
        let (_, neighbour) = smaller.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let (before, was) = point(neighbour)?;
        Some((error / was).ln() / (step / before).ln())
    };
    let orders: Vec<Option<f64>> = rows.iter().map(order).collect();
    for (row, order) in rows.iter_mut().zip(orders) {
        row.order = order;
    }
}
