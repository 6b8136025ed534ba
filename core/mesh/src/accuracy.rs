//! `run.accuracy_percent`: reductions, mesh, steps and tolerance, the cheapest whose expected errors add up to no more.

use scene::{Accuracy, MeshChoice, Open, Reduction, Scene, What, shown_number};

use super::division::{Search, mesh_for};
use super::error_shares::{error_shares, shares_of_reductions, sum};

/// Share of the wish that Newton's tolerance may take, N/%: fewer iterations at an error that hardly counts.
const TOLERANCE: f64 = 0.2;
/// Largest tolerance chosen, N.
const LARGEST_TOLERANCE: f64 = 0.3;

/// Reductions that may be added to those that change nothing. Modes are not among them: finding them takes longer than
/// one run, and many runs over one line ask for them by name.
const CANDIDATES: [&[Reduction]; 8] = [
    &[],
    &[Reduction::Window],
    &[Reduction::Linearised],
    &[Reduction::Linearised, Reduction::Window],
    &[Reduction::Planar],
    &[Reduction::Planar, Reduction::Window],
    &[Reduction::Planar, Reduction::Linearised],
    &[Reduction::Planar, Reduction::Linearised, Reduction::Window],
];

/// Cost of a line in its plane beside one in space, fitted to `docs/validation/reductions.csv`, –.
const PLANAR_COST: f64 = 0.6;
/// Cost of a linearised line beside a nonlinear one, fitted to `docs/validation/speed.csv`, –.
const LINEARISED_COST: f64 = 0.6;
/// Cost of a line in its modes, likewise, –.
const MODAL_COST: f64 = 0.2;
/// Cost of a span beyond the window beside one in full, likewise, –.
const REDUCED_SPAN_COST: f64 = 0.4;
/// Spans of a window in full beside those between the strips.
const WINDOW_SPANS: f64 = 4.0;
/// Set-up of a window, in steps of a span in full: a short line is stepped whole before its spans are reduced. Fitted
/// to lines of equal spans; mixed spans take two to four times as long, on longer lines.
const WINDOW_SETUP: f64 = 20_000.0;

/// Step by which a wish that given keys exceed is raised, –.
const RAISE: f64 = 1.25;
/// Largest error that a wish is raised to, %.
const MOST: f64 = 100.0;

/// Makes the choices that a scene leaves to `run.accuracy_percent`.
///
/// Choices given by keys stay. Where they alone exceed the wish, the rest is chosen for the least error that they leave
/// possible, and the shares of the run add up to more than the wish.
///
/// # Errors
/// The key and why no choice can be made: no rule is known for the line, or none is fine enough.
pub(crate) fn choose(scene: &mut Scene, wish: Accuracy) -> Result<(), (String, What)> {
    let Accuracy { percent, open } = wish;
    if open.newton_tolerance {
        scene.solver.newton_tolerance = (TOLERANCE * percent).min(LARGEST_TOLERANCE);
    }
    let mut raised = percent;
    let mut left = open;
    let chosen = loop {
        match cheapest(scene, left, raised) {
            Err(_) if open != Accuracy::new(percent).open && raised < MOST => {
                raised *= RAISE;
                // No further error on top.
                left.reductions = false;
            }
            other => break other,
        }
    };
    *scene = chosen.map_err(|expected| {
        let value = shown_number(percent, "%");
        ("run.accuracy_percent".to_owned(), What::Refused { value, expected })
    })?;
    scene.run.accuracy = Some(Accuracy {
        percent,
        open: Open::default(),
    });
    Ok(())
}

/// The cheapest scene with an error of at most `percent` %; `Err` says why there is none.
fn cheapest(scene: &Scene, open: Open, percent: f64) -> Result<Scene, String> {
    let search = Search {
        percent,
        error: &|scene| Ok(sum(&error_shares(scene, scene.internal_step())?)),
        mesh_is_given: !open.mesh,
        micro_step_is_given: !open.micro_step,
        macro_step_follows: open.macro_step,
    };
    let candidates = if open.reductions {
        &CANDIDATES[..]
    } else {
        &CANDIDATES[..1]
    };
    let mut best: Option<(f64, Scene)> = None;
    let mut why = String::new();
    let are_new = |reductions: &&&[Reduction]| !reductions.iter().any(|reduction| scene.model.has(*reduction));
    for reductions in candidates.iter().filter(are_new) {
        let mut trial = scene.clone();
        trial.model.reductions.extend(*reductions);
        // No mesh makes up for what reductions alone exceed.
        if !reductions.is_empty() && shares_of_reductions(&trial).is_ok_and(|shares| sum(&shares) > percent) {
            continue;
        }
        match mesh_for(&trial, &search) {
            Ok((choice, cost)) => {
                search.apply(choice, &mut trial);
                trial.run.accuracy = None;
                if let Some(mesh) = trial.mesh_mut() {
                    mesh.choice = MeshChoice::Given;
                }
                let steps = trial.run.duration / trial.internal_step();
                let set_up = if trial.model.has(Reduction::Window) {
                    WINDOW_SETUP / steps
                } else {
                    0.0
                };
                let cost = cost * (cost_of_line(&trial) + set_up);
                let is_cheaper = best.as_ref().is_none_or(|(least, _)| cost < *least);
                // The scene without further reductions is checked with its file.
                if is_cheaper && (reductions.is_empty() || trial.check("").is_ok()) {
                    best = Some((cost, trial));
                }
            }
            Err(reason) if why.is_empty() => why = reason,
            Err(_) => {}
        }
    }
    best.map(|(_, scene)| scene).ok_or(why)
}

/// Cost of a step of the nonlinear whole line beside that of the line as it is reduced, on the same mesh, –.
///
/// Known to a factor of two: it goes by spans in full, not by iterations, and parts other than the line are left out.
#[must_use]
pub fn cost_of_whole_line(scene: &Scene) -> Option<f64> {
    let (catenary, _) = scene.modelled_line()?;
    Some(catenary.spans() as f64 / cost_of_line(scene))
}

/// Cost of a step of the line, in spans of a nonlinear line.
fn cost_of_line(scene: &Scene) -> f64 {
    let Some((catenary, _)) = scene.modelled_line() else {
        return 0.0;
    };
    let has = |reduction| scene.model.has(reduction);
    let motion = if has(Reduction::Modal) {
        MODAL_COST
    } else if has(Reduction::Linearised) || has(Reduction::Flat) {
        LINEARISED_COST
    } else {
        1.0
    };
    let plane = if has(Reduction::Planar) && scene.leaves_its_plane().is_some() {
        PLANAR_COST
    } else {
        1.0
    };
    let spans = catenary.spans() as f64;
    if !has(Reduction::Window) {
        return plane * motion * spans;
    }
    let full = (WINDOW_SPANS + scene.spans_between_strips(catenary) as f64).min(spans);
    plane * motion * (full + REDUCED_SPAN_COST * (spans - full))
}
