//! Rank of a single run in a study of its scene.
//!
//! The study keeps the figures that this takes in its store, so that nobody reads its tables.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::options::Sweep;
use super::outcome::{Entry, Study, label};
use super::pareto::{point, speed};
use super::run_spec::Class;
use super::text::known_to;
use super::{CSV, FOLDER};
use crate::engine::Store;
use crate::engine::table::{RunRow, Status};
use results::ResultsError;
use simulation::Mode;
use simulation::identity::{identity, settings};

/// Name of the ranks in the store of a study.
const RANKS: &str = "ranks";

/// Ranks of all runs of a study.
#[derive(Serialize, Deserialize)]
struct Ranks {
    /// Hash of the scene without the keys that the study changes.
    identity: String,
    runs: Vec<Ranked>,
}

/// One run, and what is known of its reference.
#[derive(Serialize, Deserialize)]
struct Ranked {
    entry: Entry,
    /// Difference of the last two levels of its reference, %.
    uncertainty: Option<f64>,
    /// Difference of its reference from another discretisation, %.
    confirmed: Option<f64>,
}

impl Ranked {
    /// `true` where it is the run that judges the others: of all levels, that alone has no reference.
    fn is_reference(&self) -> bool {
        let row = &self.entry.row;
        let ran = matches!(row.status, Some(Status::Stable | Status::Limit));
        self.entry.is_in(Sweep::Reference) && row.reference.is_empty() && ran
    }
}

/// Keeps the ranks of a study for later runs of its scene.
///
/// # Errors
/// Reports of the operating system.
pub fn keep_ranks(store: &Store, study: &Study) -> Result<(), ResultsError> {
    // On another vehicle or another length a run is one of another scene; without a status it has not been made.
    let of_scene = study.rows.iter().enumerate().filter(|(_, entry)| {
        entry.sweep != Sweep::Vehicle.name() && entry.spans.is_none() && entry.row.status.is_some()
    });
    let runs = of_scene.map(|(index, entry)| {
        let reference = study.reference_of(index, entry);
        Ranked {
            entry: entry.clone(),
            uncertainty: reference.and_then(|found| found.uncertainty_percent),
            confirmed: reference.and_then(|found| found.confirmed_to_percent),
        }
    });
    let ranks = Ranks {
        identity: study.identity.clone(),
        runs: runs.collect(),
    };
    store.keep_value(RANKS, &ranks)
}

/// Rank of a run of `scene` in `mode` by the study in `folder`: its expected error, and the nearest points of the
/// Pareto front; nothing where there is no study of this scene. Paths in the scene are relative to `base`.
#[must_use]
pub fn rank(folder: &Path, scene: &scene::Scene, base: &Path, mode: Mode) -> Option<String> {
    let Ranks { identity: of, runs } = Store::read_value(&folder.join(FOLDER), RANKS)?;
    if runs.is_empty() || of != identity(scene, base) {
        return None;
    }
    let own = RunRow::planned("", scene, mode, scene.coupling.algorithm.name());
    let same_model = |read: &&Ranked| {
        let Entry { row, .. } = &read.entry;
        // Of two lengths that make as many elements, each makes as many in every interval.
        row.element_length.is_some() == own.element_length.is_some()
            && row.elements_per_span == own.elements_per_span
            && row.mesh == own.mesh
            && row.micro_step == own.micro_step
            && row.reduction == own.reduction
            && read.entry.rho_inf == scene.solver.rho_inf
            && read.entry.newton_tolerance == scene.solver.newton_tolerance
    };
    let coupling = |row: &RunRow| (row.algorithm.clone(), row.extrapolation, row.macro_step);
    let same_coupling = |read: &&Ranked| coupling(&read.entry.row) == coupling(&own);
    let one_system = |read: &&Ranked| read.entry.row.macro_step.is_none();
    let intervals = scene.modelled_line().map_or(1, |(line, _)| line.intervals_per_span());
    let text = scene.to_toml();
    let [alone, coupled] = [false, true].map(|coupled| settings(&text, coupled));
    let as_settled = |read: &&Ranked| read.entry.settings == if one_system(read) { &*alone } else { &*coupled };
    let of_model = || runs.iter().filter(same_model);
    let of_spec = || of_model().filter(same_coupling);
    let exact = of_spec().find(as_settled);
    let Some(found) = exact.or_else(|| of_model().filter(one_system).find(as_settled)) else {
        return Some(if of_model().any(|read| same_coupling(&read) || one_system(&read)) {
            format!(
                "the study in {CSV} was made with other keys of [catenary.mesh], [coupling] or [solver]: the error of \
                 this run is not known"
            )
        } else {
            format!("the study in {CSV} has no row with these settings: its error is not known")
        });
    };
    let part = if exact.is_some() {
        ""
    } else if of_spec().next().is_some() {
        " without the coupling (its keys are others there)"
    } else {
        " without the coupling"
    };
    let (mut text, row) = (said(found, part), &found.entry.row);
    let Some(own) = point(row) else {
        return Some(text);
    };
    if found.entry.pareto && exact.is_some() {
        text.push_str("; no run of the study is both cheaper and more accurate");
    }
    let class = Class::of(&row.reduction);
    let front = runs.iter().map(|read| &read.entry);
    let front = front.filter(|entry| entry.pareto && Class::of(&entry.row.reduction) == class);
    let front: Vec<(&Entry, Point)> = front.filter_map(|entry| Some((entry, point(&entry.row)?))).collect();
    for (what, (entry, (factor, error))) in beside(own, &front) {
        let (name, speed) = (label(&entry.row, intervals), speed(factor));
        text.push_str(&format!("; {what}: {name} ({error:.2} %, {speed})"));
    }
    Some(text)
}

/// Real-time factor and error of a row.
type Point = (f64, f64);

/// Alternatives to a run at `own`: where a run of the front beats it the most accurate of those that do, else its
/// neighbours on the front; each with what it is.
fn beside<T: Copy>(own: Point, front: &[(T, Point)]) -> Vec<(&'static str, (T, Point))> {
    let (factor, error) = own;
    let others = || front.iter().copied().filter(|(_, point)| *point != own);
    let beating = others().filter(|(_, point)| point.0 <= factor && point.1 <= error);
    if let Some(best) = beating.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) {
        let what = match best.1 {
            (its, _) if its == factor => "it is off the front: as cheap and more accurate",
            (_, its) if its == error => "it is off the front: cheaper and as accurate",
            _ => "it is off the front: both cheaper and more accurate",
        };
        return vec![(what, best)];
    }
    let cheaper = others().filter(|(_, point)| point.0 < factor);
    let finer = others().filter(|(_, point)| point.1 < error);
    let cheaper = cheaper.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let finer = finer.max_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let said = [("next cheaper", cheaper), ("next more accurate", finer)];
    said.into_iter().filter_map(|(what, run)| Some((what, run?))).collect()
}

/// Error and status of a row; `part` says what of the run it does not hold.
fn said(found: &Ranked, part: &str) -> String {
    let row = &found.entry.row;
    let family = Class::of(&row.reduction).family.name();
    let known = known_to(found.uncertainty, found.confirmed);
    if found.is_reference() {
        return format!("this run{part} is the reference of the {family} line in the study in {CSV}, {known}");
    }
    let mut text = match row.filtered_error {
        Some(error) => format!(
            "error expected by the study in {CSV}{part}: {error:.2} % of σ (rms of the filtered force) against the \
             reference of the {family} line, {known}"
        ),
        None => format!("the study in {CSV} knows no error of this run{part}"),
    };
    if let Some(status) = row.trouble() {
        text.push_str(&format!("; there it is {}", status.name()));
        if !row.reason.is_empty() {
            text.push_str(&format!(": {}", row.reason));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Real-time factor and error: cheap and coarse to dear and fine.
    const FRONT: [(&str, Point); 4] = [
        ("a", (0.1, 5.0)),
        ("b", (0.2, 2.0)),
        ("c", (0.4, 1.0)),
        ("d", (0.8, 0.3)),
    ];

    fn said(own: Point) -> Vec<(&'static str, &'static str)> {
        let beside = beside(own, &FRONT);
        beside.into_iter().map(|(what, (run, _))| (what, run)).collect()
    }

    #[test]
    fn on_the_front_the_neighbours_are_dearer_and_finer_or_cheaper_and_coarser() {
        assert_eq!(said((0.2, 2.0)), [("next cheaper", "a"), ("next more accurate", "c")]);
        assert_eq!(said((0.1, 5.0)), [("next more accurate", "b")]);
        assert_eq!(said((0.8, 0.3)), [("next cheaper", "c")]);
    }

    #[test]
    fn a_run_that_is_beaten_is_off_the_front_and_named_what_beats_it() {
        let beaten = "it is off the front: both cheaper and more accurate";
        // b and c are both cheaper and more accurate: the more accurate one is named, and nothing else.
        assert_eq!(said((0.5, 3.0)), [(beaten, "c")]);
        assert_eq!(said((0.15, 6.0)), [(beaten, "a")]);
        assert_eq!(
            said((0.2, 3.0)),
            [("it is off the front: as cheap and more accurate", "b")]
        );
        assert_eq!(
            said((0.3, 2.0)),
            [("it is off the front: cheaper and as accurate", "b")]
        );
    }
}
