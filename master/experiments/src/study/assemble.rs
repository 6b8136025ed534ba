//! From runs to the results of a study: rows judged by their references, orders, front, recommendations.

use super::identity::settings;
use super::judge::{Script, State};
use super::options::Sweep;
use super::order::{Order, order};
use super::outcome::{Entry, Levels, Reference, Study, label};
use super::pareto::{pareto, recommendations};
use super::plan::StudyRun;
use super::reference::{Refinement, best};
use super::run_spec::{Class, Exchange, Family, Mesh};
use crate::engine::export::grouped;
use crate::engine::table::{Errors, ForceCurve, RunRow, Status, milliseconds};
use simulation::Mode;

/// The study as far as it is known.
#[must_use]
pub fn assemble(script: &Script, state: &State) -> Study {
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
    for family in Family::ALL {
        let wanted = script.refinements.iter().filter(|(of, _)| *of == family).count();
        let done = state.refinements.iter().filter(|found| found.family == family).count();
        if wanted > 0 && wanted == done {
            study.references.extend(reference(script, state, family));
        }
    }
    let nonlinear = forces(state, study.reference(Family::Nonlinear).and_then(|found| found.row));
    for reference in &mut study.references {
        if reference.family != Family::Nonlinear {
            let own = forces(state, reference.row);
            reference.distance_from_nonlinear_percent = nonlinear
                .zip(own)
                .and_then(|(nonlinear, own)| Errors::between(nonlinear, own).filtered);
        }
    }
    study.rows = (0..state.runs.len())
        .map(|index| entry(script, state, &study, index))
        .collect();
    // What stands on another vehicle is no choice of mesh, steps and reductions.
    let apart = RunRow::default();
    let competes = |entry: &Entry| entry.sweep != Sweep::Vehicle.name();
    let rows: Vec<&RunRow> = (study.rows.iter())
        .map(|entry| if competes(entry) { &entry.row } else { &apart })
        .collect();
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
    study.notes.extend(subject.left_out.iter().cloned());
    study.notes.extend(script.empty_sweeps());
    study
}

/// Contact forces of a run.
fn forces(state: &State, index: Option<usize>) -> Option<&[ForceCurve]> {
    let made = state.made[index?].as_ref()?;
    (!made.curves.is_empty()).then_some(&*made.curves)
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
    let name = level.map_or_else(String::new, |level| {
        format!(
            "{}: {}",
            family.name(),
            label(&level.made.row, script.subject.intervals)
        )
    });
    Some(Reference {
        family,
        name,
        row: level.and_then(|level| state.runs.iter().position(|run| run.same(&level.planned))),
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
    let planned = &state.runs[index];
    let growth = planned.sweeps.contains(&Sweep::Spans);
    let stage_row = || planned_row(script, planned);
    let made = state.made[index].as_ref();
    let family = planned.class().family;
    let reference = study.reference(family).filter(|_| !growth);
    let vehicles = planned.is_for_vehicle().then(|| judge(script, state, planned));
    // A row has no status before it can be judged.
    let known = match vehicles {
        Some(judge) => judge.is_some_and(|at| state.made[at].is_some()),
        None => growth || study.references.iter().any(|found| found.family == family),
    };
    let mut distance = None;
    let mut row = match made {
        Some(made) if made.row.status == Some(Status::Refused) => asked_for(script, planned, made.row.clone()),
        Some(made) if known => {
            let (at, name) = match vehicles {
                Some(judge) => (
                    judge,
                    judge.map_or_else(String::new, |at| vehicle_label(script, &state.runs[at])),
                ),
                None => reference.map_or_else(Default::default, |found| (found.row, found.name.clone())),
            };
            let against = at.filter(|at| *at != index).and_then(|at| {
                let truth = state.made[at].as_ref()?;
                Some((name.as_str(), &truth.row, forces(state, Some(at))?))
            });
            if family != Family::Nonlinear {
                let nonlinear = study
                    .reference(Family::Nonlinear)
                    .and_then(|found| forces(state, found.row));
                distance = nonlinear.and_then(|nonlinear| Errors::between(nonlinear, &made.curves).filtered);
            }
            made.judged(against)
        }
        _ => stage_row(),
    };
    if made.is_some_and(|made| !made.complete) {
        row.wall = None;
        row.real_time_factor = None;
        row.repeats = None;
    }
    let times = state.times[index].as_ref();
    match times.filter(|times| !times.walls.is_empty()) {
        Some(times) => row.timed(&mut times.walls.clone()),
        None if row.wall.is_some() => row.remark("timed once, beside other runs"),
        None => {}
    }
    Entry {
        row,
        sweep: planned
            .sweeps
            .iter()
            .map(|sweep| sweep.name())
            .collect::<Vec<_>>()
            .join("+"),
        pareto: false,
        rho_inf: planned.spec.rho_inf,
        newton_tolerance: planned.spec.newton_tolerance,
        distance_from_nonlinear_percent: distance,
        setup_s: made.filter(|made| made.complete).map(|made| made.setup),
        spans: planned.spec.spans.map(|spans| spans as u64),
        working_memory_bytes: times.and_then(|times| times.memory),
        settings: planned.scene.as_deref().map_or_else(String::new, |scene| {
            settings(scene, planned.variant.mode != Mode::Monolithic)
        }),
        vehicle_variant: (!script.subject.vehicle_variants.is_empty())
            .then(|| script.subject.vehicle_of(&planned.spec)),
    }
}

/// The run that judges what else the pantograph may stand on, on the same track: the first that is planned for it,
/// whether it is there for that alone or is the base case.
fn judge(script: &Script, state: &State, planned: &StudyRun) -> Option<usize> {
    let subject = &script.subject;
    let own = subject.vehicle_of(&planned.spec);
    let first = (subject.vehicle_variants.iter()).find(|vehicle_variant| vehicle_variant.name.track == own.track)?;
    state
        .runs
        .iter()
        .position(|run| run.sweeps.contains(&Sweep::Vehicle) && subject.vehicle_of(&run.spec) == first.name)
}

/// Name of a run that judges others.
fn vehicle_label(script: &Script, planned: &StudyRun) -> String {
    let name = script.subject.vehicle_of(&planned.spec);
    format!("vehicle {}, track {}", name.vehicle, name.track)
}

/// A refused row with what was asked for, where its scene could not be read.
fn asked_for(script: &Script, planned: &StudyRun, mut row: RunRow) -> RunRow {
    let spec = &planned.spec;
    if planned.scene.is_some() {
        return row;
    }
    if let (Mesh::Of { division, corrections }, Some((line, _))) = (&spec.mesh, script.subject.scene.modelled_line()) {
        row.divide(line, *division);
        row.mesh = if corrections.is_empty() {
            "plain".to_owned()
        } else {
            corrections.join("+")
        };
    }
    row.micro_step = Some(spec.micro_step);
    row.reduction = if spec.reductions.is_empty() {
        "none".to_owned()
    } else {
        spec.reductions.join("+")
    };
    if let Exchange::Of {
        extrapolation,
        macro_step,
        ..
    } = &spec.exchange
    {
        row.macro_step = Some(*macro_step);
        row.extrapolation = extrapolation.map(|degree| degree as u64);
    }
    row
}

/// Row of a run before it is made.
fn planned_row(script: &Script, planned: &StudyRun) -> RunRow {
    let subject = &script.subject;
    let variant = &planned.variant;
    match system::load(subject.text_of(&planned.spec), &subject.name, &variant.overrides) {
        Ok(scene) => RunRow::planned(&subject.name, &scene, variant.mode, &variant.algorithm),
        Err(_) => {
            let row = RunRow {
                scene: subject.name.clone(),
                mode: variant.mode.name().to_owned(),
                algorithm: variant.algorithm.clone(),
                ..RunRow::default()
            };
            asked_for(script, planned, row)
        }
    }
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
    for (index, run) in state.runs.iter().enumerate() {
        let made = state.made[index].as_ref();
        let Some(made) = made.filter(|made| made.complete && !made.curves.is_empty()) else {
            continue;
        };
        // A mesh that is the scene's own is one like any other.
        let alone = run.spec.exchange == Exchange::None;
        for (sweep, kind) in [("mesh", Sweep::Mesh), ("micro_step", Sweep::MicroStep)] {
            if !run.sweeps.contains(&kind) || !alone {
                continue;
            }
            let row = &made.row;
            let (size, shown) = match (sweep, row.elements_per_span, row.micro_step) {
                ("mesh", Some(count), _) => (1.0 / count as f64, count as f64),
                ("micro_step", _, Some(step)) => (step, step),
                _ => continue,
            };
            sized.push(((sweep, label_without(row, sweep)), (size, shown, index)));
        }
    }
    let mut all = Vec::new();
    for ((sweep, of), mut runs) in grouped(sized) {
        runs.sort_by(|a, b| b.0.total_cmp(&a.0));
        for three in runs.windows(3) {
            let between = |coarse: usize, fine: usize| {
                let (coarse, fine) = (forces(state, Some(coarse))?, forces(state, Some(fine))?);
                Errors::between(fine, coarse).filtered
            };
            let differences = between(three[0].2, three[1].2).zip(between(three[1].2, three[2].2));
            let Some((first, second)) = differences else { continue };
            all.push(Order {
                sweep,
                of: of.clone(),
                sizes: [three[0].1, three[1].1, three[2].1],
                differences: [first, second],
                order: order([three[0].0, three[1].0, three[2].0], [first, second]),
            });
        }
    }
    all
}

fn notes(study: &Study) -> Vec<String> {
    let mut notes = Vec::new();
    for reference in &study.references {
        let family = reference.family.name();
        let Some(uncertainty) = reference.uncertainty_percent else {
            let mut why: Vec<&str> = reference.refinements.iter().map(|found| found.ended.as_str()).collect();
            why.dedup();
            notes.push(format!(
                "{family}: nothing is known of the reference's own error: {}",
                why.join("; ")
            ));
            continue;
        };
        if !reference.converged {
            let why: Vec<String> = reference
                .refinements
                .iter()
                .map(|found| format!("{}: {}", found.discretisation.name(), found.ended))
                .collect();
            notes.push(format!(
                "{family}: the reference has not converged, its last two levels differ by {uncertainty:.2} % of σ \
                 ({}); errors below that mean nothing",
                why.join("; ")
            ));
        }
    }
    let classes: Vec<Class> = study.rows.iter().map(|entry| Class::of(&entry.row.reduction)).collect();
    if let Some(found) = study.reference(Family::Linearised)
        && classes.iter().any(|class| class.family == Family::Linearised)
        && let Some(distance) = found.distance_from_nonlinear_percent
    {
        notes.push(format!(
            "the converged linearised line differs from the converged nonlinear one by {distance:.2} % of σ"
        ));
    }
    notes
}
