//! From runs to the results of a study: rows judged by their references, orders, front, recommendations.

use super::judge::{Known, Script, State};
use super::options::Sweep;
use super::outcome::{Entry, Levels, Order, Reference, Study, label};
use super::pareto::{pareto, recommendations};
use super::plan::StudyRun;
use super::reference::{Refinement, best};
use super::run_spec::{Exchange, Family};
use crate::engine::export::grouped;
use crate::engine::table::{RunRow, Status};
use results::curve::{Errors, ForceCurve};
use results::report::format::milliseconds;
use results::statistics::order_of_convergence;
use simulation::Mode;
use simulation::identity::settings;

/// The study as far as it is known.
pub(super) fn assemble(script: &Script, state: &State) -> Study {
    let subject = &script.subject;
    let mut study = Study {
        scene: subject.name.clone(),
        title: subject.scene.title.clone(),
        source: subject.scene.source.clone().unwrap_or_default(),
        identity: script.identity.clone(),
        machine: script.machine.clone(),
        simulated_s: subject.scene.run.duration,
        intervals: subject.intervals,
        ..Study::default()
    };
    for &family in Family::ALL {
        let wanted = script.refinements.iter().filter(|(of, _)| *of == family).count();
        let done = state.refinements.iter().filter(|found| found.family == family).count();
        if wanted > 0 && wanted == done {
            study.references.extend(reference(script, state, family));
        }
    }
    let nonlinear = forces(state, &study, Family::Nonlinear);
    let distance = |reference: &Reference| {
        let own = forces(state, &study, reference.family).filter(|_| reference.family != Family::Nonlinear)?;
        Errors::between(nonlinear?, own).filtered
    };
    let distances: Vec<Option<f64>> = study.references.iter().map(distance).collect();
    for (reference, distance) in study.references.iter_mut().zip(distances) {
        reference.distance_from_nonlinear_percent = distance;
    }
    let rows = 0..state.runs.len();
    study.rows = rows.map(|index| entry(script, state, &study, index)).collect();
    // What stands on another vehicle is no choice of mesh, steps and reductions.
    let apart = RunRow::default();
    let competes = |entry: &Entry| entry.sweep != Sweep::Vehicle.name();
    let rows = study.rows.iter();
    let rows = rows.map(|entry| if competes(entry) { &entry.row } else { &apart });
    let rows: Vec<&RunRow> = rows.collect();
    let front = pareto(&rows);
    let advice = |index: usize| study.advice(&study.rows[index]);
    let chosen = recommendations(&rows, advice, |class, target| study.caveat(class.family, target));
    for (entry, front) in study.rows.iter_mut().zip(front) {
        entry.pareto = front;
    }
    study.recommendations = chosen;
    study.orders = orders(state);
    for found in &study.orders {
        // The finest of the three shows it.
        let shown = |entry: &&mut Entry| {
            let row = &entry.row;
            let size = match found.sweep {
                "mesh" => row.elements_per_span.map(|count| count as f64),
                _ => row.micro_step,
            };
            size == Some(found.sizes[2]) && label_without(row, found.sweep) == found.of && row.mode == "monolithic"
        };
        if let Some(entry) = study.rows.iter_mut().find(shown) {
            entry.row.order = found.order;
        }
    }
    study.notes = notes(&study);
    study.notes.extend(subject.vehicles.left_out.iter().cloned());
    study.notes.extend(script.empty_sweeps());
    study
}

/// Contact forces of the reference of a family.
fn forces<'a>(state: &'a State, study: &Study, family: Family) -> Option<&'a [ForceCurve]> {
    state.runs[study.reference(family)?.row?].forces()
}

/// The reference of a family; nothing where none of its levels ran.
fn reference(script: &Script, state: &State, family: Family) -> Option<Reference> {
    let chosen = best(&state.refinements, family);
    let of_family = || state.refinements.iter().filter(|found| found.family == family);
    let finest = |found: &Refinement| found.levels.last().map(|level| level.made.clone());
    let other = chosen.and_then(|chosen| {
        let own = finest(chosen)?;
        let other = of_family().find(|found| found.discretisation != chosen.discretisation)?;
        Errors::between(&own.curves, &finest(other)?.curves).filtered
    });
    let level = chosen.and_then(|found| found.levels.last());
    let name = level.map(|level| label(&level.made.row, script.subject.intervals));
    let name = name.map_or_else(String::new, |name| format!("{}: {name}", family.name()));
    Some(Reference {
        family,
        name,
        row: level.and_then(|level| state.place(|run| run.same(&level.planned))),
        std: level.and_then(|level| level.made.row.std),
        uncertainty_percent: chosen.and_then(Refinement::uncertainty),
        converged: chosen.is_some_and(|found| found.converged),
        confirmed_to_percent: other,
        distance_from_nonlinear_percent: None,
        refinements: of_family().map(levels).collect(),
    })
}

fn levels(found: &Refinement) -> Levels {
    let rows = || found.levels.iter().map(|level| &level.made.row);
    Levels {
        discretisation: found.discretisation,
        elements_per_span: rows().map(|row| row.elements_per_span).collect(),
        micro_step_s: rows().filter_map(|row| row.micro_step).collect(),
        std: rows().map(|row| row.std).collect(),
        difference_percent: found.levels.iter().map(|level| level.difference).collect(),
        converged: found.converged,
        ended: found.ended.clone(),
    }
}

/// The row of a run, judged where its reference is known.
fn entry(script: &Script, state: &State, study: &Study, index: usize) -> Entry {
    let Known {
        run: planned,
        made,
        times,
    } = &state.runs[index];
    let family = planned.class().family;
    let made = made.as_deref();
    let mut distance = None;
    let mut row = match (made, judge(script, state, study, planned)) {
        (Some(made), _) if made.row.status == Some(Status::Refused) => RunRow {
            status: made.row.status,
            reason: made.row.reason.clone(),
            ..planned.row.clone()
        },
        (Some(made), Some((at, name))) => {
            if family != Family::Nonlinear {
                let nonlinear = forces(state, study, Family::Nonlinear);
                distance = nonlinear.and_then(|nonlinear| Errors::between(nonlinear, &made.curves).filtered);
            }
            let truth = at.filter(|at| *at != index).map(|at| &state.runs[at]);
            let row = truth.and_then(|truth| Some(&truth.made.as_ref()?.row));
            let forces = truth.and_then(Known::forces);
            made.judged(row.zip(forces).map(|(row, forces)| (name.as_str(), row, forces)))
        }
        // A row has no status before it can be judged.
        _ => planned.row.clone(),
    };
    if made.is_some_and(|made| !made.complete) {
        (row.wall, row.real_time_factor, row.repeats) = (None, None, None);
    }
    let times = times.as_ref();
    match times.filter(|times| !times.walls.is_empty()) {
        Some(times) => row.timed(&times.walls),
        None if row.wall.is_some() => row.remark("timed once, beside other runs"),
        None => {}
    }
    let sweeps: Vec<&str> = planned.sweeps.iter().map(|sweep| sweep.name()).collect();
    let coupled = planned.variant.mode != Mode::Monolithic;
    let settings = planned.scene.as_deref().map(|scene| settings(scene, coupled));
    let subject = &script.subject;
    Entry {
        row,
        sweep: sweeps.join("+"),
        pareto: false,
        rho_inf: planned.spec.rho_inf,
        newton_tolerance: planned.spec.newton_tolerance,
        distance_from_nonlinear_percent: distance,
        setup_s: made.filter(|made| made.complete).map(|made| made.setup),
        spans: planned.spec.spans.map(|spans| spans as u64),
        working_memory_bytes: times.and_then(|times| times.memory),
        settings: settings.unwrap_or_default(),
        vehicle_variant: (!subject.vehicles.all.is_empty()).then(|| subject.vehicle_of(&planned.spec)),
    }
}

/// The place and the name of the run that judges another, no place where that one is judged by itself; nothing as long
/// as it is not known.
///
/// Another vehicle below the pantograph is judged by the first that is planned for its track, whether that is there for
/// the vehicle alone or is the base case.
fn judge(script: &Script, state: &State, study: &Study, planned: &StudyRun) -> Option<(Option<usize>, String)> {
    if planned.is_growth() {
        return Some((None, String::new()));
    }
    if !planned.is_for_vehicle() {
        let reference = study.reference(planned.class().family)?;
        return Some((reference.row, reference.name.clone()));
    }
    let subject = &script.subject;
    let track = subject.vehicle_of(&planned.spec).track;
    let name = subject
        .vehicles
        .all
        .iter()
        .map(|variant| variant.name)
        .find(|name| name.track == track)?;
    let first = |run: &StudyRun| run.sweeps.contains(&Sweep::Vehicle) && subject.vehicle_of(&run.spec) == name;
    let at = state.place(first).filter(|at| state.runs[*at].made.is_some())?;
    Some((Some(at), format!("vehicle {}, track {track}", name.vehicle)))
}

/// Settings that stay the same in a sweep of mesh or micro step.
fn label_without(row: &RunRow, sweep: &str) -> String {
    let mesh = if sweep == "mesh" {
        format!("micro step {} ms", milliseconds(row.micro_step))
    } else {
        row.elements_per_span
            .map_or_else(String::new, |count| format!("{count} elements per span"))
    };
    format!("{}, {mesh}, {}", row.mesh, row.reduction)
}

/// Orders of mesh and micro step from the runs that differ in nothing else.
fn orders(state: &State) -> Vec<Order> {
    // Runs that differ in one size only: the sweep, what stays the same; size, size as shown and place of each.
    let mut sized = Vec::new();
    for (index, Known { run, made, .. }) in state.runs.iter().enumerate() {
        let made = made.as_ref().filter(|made| made.complete && !made.curves.is_empty());
        // A mesh that is the scene's own is one like any other.
        let Some(made) = made.filter(|_| run.spec.exchange == Exchange::None) else {
            continue;
        };
        let row = &made.row;
        let elements = row.elements_per_span.map(|count| count as f64);
        for (sweep, kind, size, shown) in [
            ("mesh", Sweep::Mesh, elements.map(f64::recip), elements),
            ("micro_step", Sweep::MicroStep, row.micro_step, row.micro_step),
        ] {
            if let (true, Some(size), Some(shown)) = (run.sweeps.contains(&kind), size, shown) {
                sized.push(((sweep, label_without(row, sweep)), (size, shown, index)));
            }
        }
    }
    let between = |coarse: usize, fine: usize| {
        let (coarse, fine) = (state.runs[coarse].forces()?, state.runs[fine].forces()?);
        Errors::between(fine, coarse).filtered
    };
    let mut all = Vec::new();
    for ((sweep, of), mut runs) in grouped(sized) {
        runs.sort_by(|a, b| b.0.total_cmp(&a.0));
        for [first, second, third] in runs.array_windows() {
            let differences = between(first.2, second.2).zip(between(second.2, third.2));
            let Some(differences) = differences.map(<[f64; 2]>::from) else {
                continue;
            };
            all.push(Order {
                sweep,
                of: of.clone(),
                sizes: [first.1, second.1, third.1],
                differences,
                order: order_of_convergence([first.0, second.0, third.0], differences),
            });
        }
    }
    all
}

fn notes(study: &Study) -> Vec<String> {
    let of_reference = |reference: &Reference| {
        let family = reference.family.name();
        let refinements = reference.refinements.iter();
        let Some(uncertainty) = reference.uncertainty_percent else {
            let mut why: Vec<&str> = refinements.map(|found| found.ended.as_str()).collect();
            why.dedup();
            let why = why.join("; ");
            return Some(format!(
                "{family}: nothing is known of the reference's own error: {why}"
            ));
        };
        let why = refinements.map(|found| format!("{}: {}", found.discretisation.name(), found.ended));
        let why = why.collect::<Vec<_>>().join("; ");
        let note = format!(
            "{family}: the reference has not converged, its last two levels differ by {uncertainty:.2} % of σ ({why}); \
             errors below that mean nothing"
        );
        (!reference.converged).then_some(note)
    };
    let linearised = study.reference(Family::Linearised);
    let has_runs = study
        .rows
        .iter()
        .any(|entry| Family::of(&entry.row.reduction) == Family::Linearised);
    let distance = linearised
        .filter(|_| has_runs)
        .and_then(|found| found.distance_from_nonlinear_percent);
    let distance = distance.map(|distance| {
        format!("the converged linearised line differs from the converged nonlinear one by {distance:.2} % of σ")
    });
    study
        .references
        .iter()
        .filter_map(of_reference)
        .chain(distance)
        .collect()
}
