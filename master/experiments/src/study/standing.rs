//! Where a single run stands in a study of its scene.

use std::path::Path;

use super::front::{point, speed};
use super::plan::Sweep;
use super::recipe::{Class, identity, settings};
use super::text::known_to;
use super::{CSV, outcome::Study};
use crate::table_of_runs::{Row, Status};
use simulation::Mode;

/// A row of a study as it is read back.
struct Read {
    row: Row,
    rho_inf: f64,
    newton_tolerance: f64,
    pareto: bool,
    scene_hash: String,
    settings: String,
    /// Whether it is a level of a reference.
    level: bool,
    /// What is not known of its reference, from the last two levels of that, %.
    uncertainty: Option<f64>,
    /// Difference of its reference from another discretisation, %.
    confirmed: Option<f64>,
}

impl Read {
    /// Whether it is what the others are judged by: of all levels, that alone has no reference.
    fn is_reference(&self) -> bool {
        self.level && self.row.reference.is_empty() && matches!(self.row.status, Some(Status::Stable | Status::Limit))
    }
}

/// The rows of the study in `folder`; none where there is no study or it cannot be read.
fn read(folder: &Path) -> Vec<Read> {
    let Ok(mut reader) = csv::Reader::from_path(folder.join(CSV)) else {
        return Vec::new();
    };
    let Ok(head) = reader.headers().cloned() else {
        return Vec::new();
    };
    let place = |name: &str| head.iter().position(|column| column == name);
    let columns = [
        "rho_inf",
        "newton_tolerance_N",
        "pareto",
        "scene_hash",
        "settings_hash",
        "sweep",
        "spans",
        "reference_uncertainty_percent_of_std",
        "reference_confirmed_to_percent_of_std",
    ];
    let [
        Some(rho),
        Some(tolerance),
        Some(pareto),
        Some(hash),
        Some(settings),
        Some(sweep),
        Some(spans),
        Some(uncertainty),
        Some(confirmed),
    ] = columns.map(place)
    else {
        return Vec::new();
    };
    let mut rows = Vec::new();
    for record in reader.records() {
        let Ok(record) = record else { return Vec::new() };
        let Ok(row) = record.deserialize::<Row>(Some(&head)) else {
            return Vec::new();
        };
        // On another vehicle or another length it is another scene; without a status it has not been made.
        if &record[sweep] == Sweep::Vehicle.name() || !record[spans].is_empty() || row.status.is_none() {
            continue;
        }
        rows.push(Read {
            row,
            rho_inf: record[rho].parse().unwrap_or(f64::NAN),
            newton_tolerance: record[tolerance].parse().unwrap_or(f64::NAN),
            pareto: &record[pareto] == "1",
            scene_hash: record[hash].to_owned(),
            settings: record[settings].to_owned(),
            uncertainty: record[uncertainty].parse().ok(),
            confirmed: record[confirmed].parse().ok(),
            level: record[sweep].split('+').any(|name| name == Sweep::Reference.name()),
        });
    }
    rows
}

/// What the study in `folder` says of a run of `scene` in `mode`: its expected error, and the nearest points of the front;
/// nothing where there is no study of this scene. Paths in the scene are relative to `base`.
#[must_use]
pub fn standing(folder: &Path, scene: &scene::Scene, base: &Path, mode: Mode) -> Option<String> {
    let mut rows = read(folder);
    if rows.is_empty() {
        return None;
    }
    let hash = identity(scene, base);
    rows.retain(|read| read.scene_hash == hash);
    if rows.is_empty() {
        return None;
    }
    let own = Row::planned("", scene, mode, scene.coupling.algorithm.name());
    let same_model = |read: &&Read| {
        let row = &read.row;
        // Of two lengths that make as many elements, each makes as many in every interval.
        let even = row.element_length.is_some() == own.element_length.is_some();
        let mesh = row.elements_per_span == own.elements_per_span && row.mesh == own.mesh;
        even && mesh
            && row.micro_step == own.micro_step
            && row.reduction == own.reduction
            && read.rho_inf == scene.solver.rho_inf
            && read.newton_tolerance == scene.solver.newton_tolerance
    };
    let same_coupling = |read: &&Read| {
        let row = &read.row;
        row.algorithm == own.algorithm && row.extrapolation == own.extrapolation && row.macro_step == own.macro_step
    };
    let intervals = scene.modelled_line().map_or(1, |(line, _)| line.intervals_per_span());
    let names = Study {
        intervals,
        ..Study::default()
    };
    let text = scene.to_toml();
    let [alone, coupled] = [false, true].map(|coupled| settings(&text, coupled));
    let as_settled = |read: &&Read| {
        let settled = if read.row.macro_step.is_some() {
            &coupled
        } else {
            &alone
        };
        read.settings == *settled
    };
    let one_system = |read: &&Read| read.row.macro_step.is_none();
    let of_recipe = || rows.iter().filter(same_model).filter(same_coupling);
    let exact = of_recipe().find(as_settled);
    let found = exact.or_else(|| rows.iter().filter(same_model).filter(one_system).find(as_settled));
    let Some(found) = found else {
        let mut others = rows.iter().filter(same_model);
        return Some(if others.any(|read| same_coupling(&read) || one_system(&read)) {
            format!(
                "the study in {CSV} was made with other keys of [catenary.mesh], [coupling] or [solver]: the error of this run is not \
                 known"
            )
        } else {
            format!("the study in {CSV} has no row of this recipe: its error is not known")
        });
    };
    let part = if exact.is_some() {
        ""
    } else if of_recipe().next().is_some() {
        " without the coupling (its keys are others there)"
    } else {
        " without the coupling"
    };
    let (mut text, row) = (said(found, part), &found.row);
    let Some(own) = point(row) else {
        return Some(text);
    };
    if found.pareto && exact.is_some() {
        text.push_str("; no run of the study is both cheaper and more accurate");
    }
    let class = Class::of(&row.reduction);
    let of_class = rows
        .iter()
        .filter(|read| read.pareto && Class::of(&read.row.reduction) == class);
    let front: Vec<(&Read, Point)> = of_class.filter_map(|read| Some((read, point(&read.row)?))).collect();
    for (what, (read, (factor, error))) in beside(own, &front) {
        text.push_str(&format!(
            "; {what}: {} ({error:.2} %, {})",
            names.label(&read.row),
            speed(factor)
        ));
    }
    Some(text)
}

/// Real-time factor and error of a row.
type Point = (f64, f64);

/// What a user would take in place of a run at `own`: where a run of the front beats it the most accurate of those that do, else its
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
fn said(found: &Read, part: &str) -> String {
    let row = &found.row;
    let family = Class::of(&row.reduction).family.name();
    let known = known_to(found.uncertainty, found.confirmed);
    if found.is_reference() {
        return format!("this run{part} is the reference of the {family} line in the study in {CSV}, {known}");
    }
    let mut text = match row.filtered_error {
        Some(error) => format!(
            "error expected by the study in {CSV}{part}: {error:.2} % of σ (rms of the filtered force) against the reference of the \
             {family} line, {known}"
        ),
        None => format!("the study in {CSV} knows no error of this run{part}"),
    };
    if let Some(status @ (Status::Limit | Status::Diverged | Status::Refused)) = row.status {
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
