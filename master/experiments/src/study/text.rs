//! The table on the terminal.

use super::options::Sweep;
use super::outcome::{Entry, Reference, Study};
use super::page::vehicle_error;
use super::pareto::speed;
use super::run_spec::Class;
use crate::engine::export::{grouped, scene_head};
use crate::engine::table::RunRow;
use results::report::format::{milliseconds, or_dash, short, wrapped};
use results::report::{TextColumn, aligned, grouped_table, text_table};

/// Accuracy of a reference in words: from its last two levels, and from another discretisation, both %.
pub(super) fn known_to(uncertainty: Option<f64>, confirmed: Option<f64>) -> String {
    let own = match uncertainty {
        Some(percent) => format!("known to {percent:.2} % (its last two levels)"),
        None => "its own error is not known".to_owned(),
    };
    match confirmed {
        Some(percent) => format!("{own}, confirmed to {percent:.2} % by another discretisation"),
        None => format!("{own}, not confirmed by another discretisation"),
    }
}

/// Accuracy of a reference, in a sentence.
pub(super) fn known(reference: &Reference) -> String {
    let mut text = known_to(reference.uncertainty_percent, reference.confirmed_to_percent);
    if let Some(percent) = reference.distance_from_nonlinear_percent {
        text.push_str(&format!("; {percent:.2} % from the nonlinear one"));
    }
    text
}

/// Columns of the front.
const FRONT: &[TextColumn<RunRow, 2>] = &[
    (["front", ""], |row| match row.algorithm.as_str() {
        "" => "  one system".to_owned(),
        algorithm => format!("  {algorithm}"),
    }),
    (["elements", "per span"], |row| or_dash(row.elements_per_span)),
    (["micro", "ms"], |row| milliseconds(row.micro_step)),
    (["macro", "ms"], |row| milliseconds(row.macro_step)),
    (["filtered", "rms % σ"], |row| short(row.filtered_error)),
    (["σ", "error %"], |row| short(row.std_error)),
    (["real-time", "factor"], |row| short(row.real_time_factor)),
    (["wall", "s"], |row| short(row.wall)),
    (["", "mesh, reduced"], |row| {
        format!(
            "{}, {}",
            shortened(&row.mesh),
            row.reduction.replace("linearised", "linear")
        )
    }),
];

/// References, front and recommendations, no wider than 120 columns.
pub(super) fn text(study: &Study) -> String {
    let mut text = scene_head(&study.scene, &study.title, study);
    for reference in study.references.iter().filter(|reference| reference.row.is_some()) {
        text.push('\n');
        text.push_str(&wrapped(&format!("reference {}", reference.name)));
        text.push_str(&wrapped(&format!("σ {} N, {}", short(reference.std), known(reference))));
    }
    let front = || study.rows.iter().filter(|entry| entry.pareto).map(|entry| &entry.row);
    let mut classes = grouped(front().map(|row| (Class::of(&row.reduction), row)));
    classes.sort_by_key(|(class, _)| *class);
    let cost = |row: &RunRow| row.real_time_factor.unwrap_or(f64::INFINITY);
    for (_, of_class) in &mut classes {
        of_class.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    }
    let classes = classes.into_iter().map(|(class, rows)| (class.name(), rows));
    text.push_str(&format!("\n{}\n", aligned(&grouped_table(FRONT, classes))));
    for found in &study.recommendations {
        text.push_str(&wrapped(&format!("{}: {}", found.class, found.text)));
    }
    if let Some(cheapest) = front().filter_map(|row| row.real_time_factor).reduce(f64::min) {
        text.push_str(&format!("  the cheapest run on a front is {}\n", speed(cheapest)));
    }
    text.push_str(&vehicles(study));
    text.push_str(&format!("  machine: {}\n", study.machine.name()));
    for note in &study.notes {
        text.push_str(&wrapped(note));
    }
    let rows = study.rows.iter().map(|entry| &entry.row);
    let ended = rows.filter_map(|row| Some((format!("{}: {}", row.trouble()?.name(), row.reason), ())));
    for (reason, runs) in grouped(ended) {
        text.push_str(&wrapped(&format!("{} × {reason}", runs.len())));
    }
    text
}

/// Columns of the vehicles.
const VEHICLES: &[TextColumn<Entry, 1>] = &[
    (["track"], |entry| entry.stands_on().track.to_owned()),
    (["vehicle"], |entry| entry.stands_on().vehicle.to_owned()),
    (["from the first, rms % σ"], |entry| {
        short(vehicle_error(entry, entry.row.filtered_error))
    }),
    (["σ N"], |entry| short(entry.row.std)),
    (["real-time factor"], |entry| short(entry.row.real_time_factor)),
];

/// Effect and cost of each model of the vehicle.
fn vehicles(study: &Study) -> String {
    if study.of(Sweep::Vehicle).next().is_none() {
        return String::new();
    }
    format!("\n{}\n", aligned(&text_table(VEHICLES, study.of(Sweep::Vehicle))))
}

/// Names of corrections by their initials, for narrow tables: `contact_compliance+bending_layers` is `cc+bl`.
pub(super) fn shortened(mesh: &str) -> String {
    let initials = |name: &str| -> String { name.split('_').filter_map(|word| word.chars().next()).collect() };
    let parts = mesh.split('+').map(|name| {
        if name.contains('_') {
            initials(name)
        } else {
            name.to_owned()
        }
    });
    parts.collect::<Vec<_>>().join("+")
}
