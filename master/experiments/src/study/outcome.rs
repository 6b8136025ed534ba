//! Results of a study.

use serde::{Deserialize, Serialize};

use super::options::Sweep;
use super::pareto::Recommendation;
use super::reference::Discretisation;
use super::run_spec::Family;
use super::text::known_to;
use super::vehicle::VehicleVariantName;
use crate::engine::table::{AUTO, Columns, RunRow};
use crate::engine::{Sheet, Table};
use results::Machine;
use results::report::Page;
use results::report::format::milliseconds;

/// A study, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Study {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Source of the scene.
    pub source: String,
    /// Hash of the keys that no run changes.
    pub identity: String,
    /// `true` where every run was made and timed.
    pub complete: bool,
    /// Machine of the wall times.
    pub machine: Machine,
    /// Simulated time of the runs, s.
    pub simulated_s: f64,
    /// Intervals between droppers and supports in a span.
    pub intervals: usize,
    /// References of the errors.
    pub references: Vec<Reference>,
    /// One per run.
    pub rows: Vec<Entry>,
    /// Observed orders.
    pub orders: Vec<Order>,
    /// Recommendation for an error.
    pub recommendations: Vec<Recommendation>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: RunRow,
    /// Sweeps that it is part of, joined by `+`.
    pub sweep: String,
    /// `true` where no run of its class is both cheaper and more accurate.
    pub pareto: bool,
    /// Spectral radius at infinite frequency, –.
    pub rho_inf: f64,
    /// Residual that ends Newton's method, N.
    pub newton_tolerance: f64,
    /// Difference from the nonlinear reference, where its own reference is another one, % of the standard deviation.
    pub distance_from_nonlinear_percent: Option<f64>,
    /// Wall time of statics and loading, s.
    pub setup_s: Option<f64>,
    /// Spans of the line, where that is swept.
    pub spans: Option<u64>,
    /// Memory touched by the time loop, bytes.
    pub working_memory_bytes: Option<u64>,
    /// Hash of the keys that no run specification says.
    pub settings: String,
    /// Vehicle below the pantograph; nothing where the scene has none.
    #[serde(flatten, skip_deserializing)]
    pub vehicle_variant: Option<VehicleVariantName>,
}

impl Entry {
    /// `true` where it is part of a sweep.
    pub(super) fn is_in(&self, sweep: Sweep) -> bool {
        self.sweep.split('+').any(|name| name == sweep.name())
    }

    /// Vehicle and track below the pantograph; empty words where the scene has no vehicle.
    pub(super) fn stands_on(&self) -> VehicleVariantName {
        let (vehicle, track) = ("", "");
        self.vehicle_variant.unwrap_or(VehicleVariantName { vehicle, track })
    }
}

/// A reference and what is known of it.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    /// Model.
    pub family: Family,
    /// Its name in the table.
    pub name: String,
    /// Its row.
    pub row: Option<usize>,
    /// Standard deviation of its filtered force, N.
    #[serde(rename = "std_N")]
    pub std: Option<f64>,
    /// Difference of its last two levels, % of the standard deviation: what is not known of it.
    pub uncertainty_percent: Option<f64>,
    /// `true` where that is within the tolerance.
    pub converged: bool,
    /// Difference from the finest level of another discretisation, %.
    pub confirmed_to_percent: Option<f64>,
    /// Difference from the nonlinear reference, %.
    pub distance_from_nonlinear_percent: Option<f64>,
    /// Refinements of the family.
    pub refinements: Vec<Levels>,
}

/// Levels of a refinement.
#[derive(Clone, Debug, Serialize)]
pub struct Levels {
    /// Mesh.
    pub discretisation: Discretisation,
    /// Elements per span of each level.
    pub elements_per_span: Vec<Option<u64>>,
    /// Micro step of each level, s.
    pub micro_step_s: Vec<f64>,
    /// Standard deviation of each level's filtered force, N.
    #[serde(rename = "std_N")]
    pub std: Vec<Option<f64>>,
    /// Difference of each level from the one before, %.
    pub difference_percent: Vec<Option<f64>>,
    /// `true` where the last two agree.
    pub converged: bool,
    /// Reason of the end.
    pub ended: String,
}

/// Order that three runs of one sweep show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Order {
    /// Refined quantity: `mesh` or `micro_step`.
    pub sweep: &'static str,
    /// Quantities that stay the same, in words.
    pub of: String,
    /// Elements per span or micro steps (s) of the three runs, coarse to fine.
    pub sizes: [f64; 3],
    /// Difference of the first two, and of the last two, % of the standard deviation.
    pub differences: [f64; 2],
    /// Order `p`; `None` where the differences do not fall.
    pub order: Option<f64>,
}

impl Study {
    /// The rows of a sweep.
    pub fn of(&self, sweep: Sweep) -> impl Iterator<Item = &Entry> {
        self.rows.iter().filter(move |entry| entry.is_in(sweep))
    }

    /// The reference of a family.
    pub(super) fn reference(&self, family: Family) -> Option<&Reference> {
        self.references.iter().find(|found| found.family == family)
    }

    /// Caveat on an error of `target` percent that a row of a family is claimed to have; nothing where the reference is
    /// known as well as that.
    pub(super) fn caveat(&self, family: Family, target: f64) -> String {
        let reference = self.reference(family);
        let open = reference.filter(|found| found.uncertainty_percent.is_none_or(|percent| percent > target));
        open.map_or_else(String::new, |found| {
            let known = known_to(found.uncertainty_percent, found.confirmed_to_percent);
            format!("as far as the reference can tell: {known}")
        })
    }

    /// The reference that a row is judged by, or is.
    pub(super) fn reference_of(&self, index: usize, entry: &Entry) -> Option<&Reference> {
        let judged = !entry.row.reference.is_empty() && entry.sweep != Sweep::Vehicle.name();
        self.reference(Family::of(&entry.row.reduction))
            .filter(|found| judged || found.row == Some(index))
    }

    /// Name of a row: mesh, micro step, coupling, reductions.
    pub(super) fn label(&self, row: &RunRow) -> String {
        label(row, self.intervals)
    }

    /// Settings of the same run, in words.
    pub(super) fn advice(&self, entry: &Entry) -> String {
        format!("{}, Newton to {} N", self.label(&entry.row), entry.newton_tolerance)
    }
}

impl Table for Study {
    fn sheet(&self) -> Sheet {
        let of_reference = |index: usize, entry: &Entry, known: fn(&Reference) -> Option<f64>| {
            self.reference_of(index, entry).and_then(known)
        };
        let columns = Columns::of(&self.rows)
            .column("sweep", |entry| entry.sweep.clone())
            .column("pareto", |entry| u8::from(entry.pareto).to_string())
            .column("rho_inf", |entry| format!("{:?}", entry.rho_inf))
            .column("newton_tolerance_N", |entry| format!("{:?}", entry.newton_tolerance))
            .indexed("reference_uncertainty_percent_of_std", |index, entry| {
                of_reference(index, entry, |found| found.uncertainty_percent)
            })
            .indexed("reference_confirmed_to_percent_of_std", |index, entry| {
                of_reference(index, entry, |found| found.confirmed_to_percent)
            })
            .column("distance_from_nonlinear_percent_of_std", |entry| {
                entry.distance_from_nonlinear_percent
            })
            .column("setup_s", |entry| entry.setup_s)
            .column("spans", |entry| entry.spans)
            .column("working_memory_bytes", |entry| entry.working_memory_bytes)
            .column("vehicle", |entry| entry.stands_on().vehicle.to_owned())
            .column("track", |entry| entry.stands_on().track.to_owned())
            .column("scene_hash", |_| self.identity.clone())
            .column("settings_hash", |entry| entry.settings.clone());
        Sheet {
            leading: Vec::new(),
            rows: self.rows.iter().map(|entry| entry.row.clone()).collect(),
            trailing: columns.finish(),
        }
    }

    fn is_complete(&self) -> bool {
        self.complete
    }

    fn text(&self) -> String {
        super::text::text(self)
    }

    fn sections(&self) -> Page {
        super::page::page(self)
    }
}

/// Name of a row.
pub(super) fn label(row: &RunRow, intervals: usize) -> String {
    let mut parts = Vec::new();
    if let Some(elements) = row.elements_per_span {
        parts.push(match row.element_length {
            Some(length) => format!("elements of up to {length} m ({elements} per span)"),
            None => format!("{} elements per dropper interval", elements / intervals.max(1) as u64),
        });
        parts.push(row.mesh.clone());
    }
    parts.push(format!("micro step {} ms", milliseconds(row.micro_step)));
    if let Some(step) = row.macro_step {
        let degree = match row.extrapolation {
            Some(degree) if row.algorithm != AUTO => format!(" (extrapolation {degree})"),
            _ => String::new(),
        };
        let step = milliseconds(Some(step));
        parts.push(format!("{}{degree}, macro step {step} ms", row.algorithm));
    }
    parts.push(match row.reduction.as_str() {
        "none" => "no reductions".to_owned(),
        reductions => reductions.to_owned(),
    });
    parts.join(", ")
}
