//! Expected errors of a scene's run in the filtered contact force, cause by cause.
//!
//! Every share is an rms difference in percent of the standard deviation of the filtered force. Mesh and step go by
//! [`crate::expected_error`]. Rules of the other causes are upper bounds of runs in pairs on the shipped lines, listed
//! in `docs/validation/reductions.csv`, `solver.csv` and `coupling.csv`: no theory stands behind them, and a line
//! unlike the shipped ones may be worse.
//!
//! ```text
//! linearised   the line about its static state
//! window       spans beyond the window linear, reduced to modes
//! modal        modes left out, borrowed dampers
//! planar       wires that do not move sideways: nothing where nothing would move them
//! tolerance    residual that ends Newton's method
//! coupling     exchange of line and pantographs once per macro step
//! ```

use super::error_model::expected_error_at;
use scene::{Catenary, PantographModel, Reduction, Scene, WireEnds};

/// One cause of error.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorShare {
    /// Cause, a word: `mesh`, `step`, a reduction, `newton_tolerance` or `coupling`.
    pub cause: &'static str,
    /// Expected error of the filtered force, % of its standard deviation.
    pub percent: f64,
}

/// Error of Newton's tolerance, %/N.
const TOLERANCE: f64 = 0.5;
/// Error of the coupling with macro steps of 1 ms, which goes with their square, %.
const COUPLING: f64 = 0.02;

/// Error of wires that keep their lateral places, %: of all, and further with stitch wires and in curves.
const KEPT: f64 = 0.15;
const KEPT_STITCHED: f64 = 0.5;
const KEPT_CURVED: f64 = 0.4;
/// The same by arms that give way, % per share of the contact wire's stretch.
const ARMS: f64 = 150.0;
/// Error of a linearised line under the force [`USUAL_FORCE`], %.
const LINEARISED: f64 = 1.4;
/// Force of a pantograph, N, above which a linearised line errs with this power of it.
const USUAL_FORCE: f64 = 117.0;
const POWER_OF_FORCE: f64 = 2.5;
/// Factor of that error with wire ends that do not move, –.
const FIXED_ENDS: f64 = 2.2;
/// Factor of that error with stitch wires, –.
const STITCHED: f64 = 2.2;
/// Factor of that error under a pantograph of rigid bodies, –.
const LINKAGE: f64 = 1.7;
/// Error of a window in a linear line of two wires on straight track, in one tension length, %.
const WINDOW: f64 = 0.2;
/// The same in any other linear line, %.
const WINDOW_IN_OTHERS: f64 = 1.5;
/// Further error of a window in a nonlinear line, %, and per second of the run, %/s.
const WINDOW_NONLINEAR: f64 = 0.1;
const WINDOW_NONLINEAR_RATE: f64 = 0.02;
/// Error of modes beside the line linearised, %: half of it by modes left out.
const MODAL: f64 = 1.0;

/// Expected errors of a run of `scene` with internal steps of `step` s; `Err` says for what no rule is known.
///
/// # Errors
/// As [`expected_error_at`].
pub fn error_shares(scene: &Scene, step: f64) -> Result<Vec<ErrorShare>, String> {
    let of_mesh = expected_error_at(scene, step)?;
    let mut shares = vec![
        ErrorShare {
            cause: "mesh",
            percent: of_mesh.space,
        },
        ErrorShare {
            cause: "step",
            percent: of_mesh.time,
        },
    ];
    shares.extend(shares_of_reductions(scene)?);
    shares.push(ErrorShare {
        cause: "newton_tolerance",
        percent: TOLERANCE * scene.solver.newton_tolerance,
    });
    if scene.coupling.step_control.is_none() {
        shares.push(ErrorShare {
            cause: "coupling",
            percent: COUPLING * (1e3 * scene.coupling.macro_step).powi(2),
        });
    }
    Ok(shares)
}

/// Expected errors of the reductions of the line, whatever its mesh and its steps.
///
/// # Errors
/// A supplied line; a reduction that makes another line.
pub(crate) fn shares_of_reductions(scene: &Scene) -> Result<Vec<ErrorShare>, String> {
    let (catenary, _) = scene.modelled_line().ok_or("a line that is a supplied FMU")?;
    let share = |&reduction: &Reduction| {
        let percent = match reduction {
            Reduction::Planar => planar(scene, catenary),
            Reduction::Linearised => linearised(scene, catenary),
            Reduction::Modal => linearised(scene, catenary) + MODAL,
            Reduction::Window => window(scene, catenary),
            Reduction::Linkage => 0.0,
            Reduction::Flat => return Err("\"flat\" in model.reduce, which is another line".to_owned()),
        };
        let cause = reduction.name();
        Ok(ErrorShare { cause, percent })
    };
    scene.model.reductions.iter().map(share).collect()
}

/// Sum of the shares, %.
#[must_use]
pub fn sum(shares: &[ErrorShare]) -> f64 {
    shares.iter().map(|share| share.percent).sum()
}

/// Error of a line whose wires keep their lateral places, %.
///
/// Change `T` of the tension of a contact wire of stiffness `EA`, which turns by an angle `γ`, moves an arm of lateral
/// stiffness `k` by `T γ/k`, which lets the wire go by `T γ²/k` beside the `T L/EA` of its stretch over a span `L`.
fn planar(scene: &Scene, catenary: &Catenary) -> f64 {
    if scene.leaves_its_plane().is_none() {
        return 0.0;
    }
    let mut percent = KEPT;
    percent += if catenary.is_curved() { KEPT_CURVED } else { 0.0 };
    percent += catenary.stitch_wires.as_ref().map_or(0.0, |_| KEPT_STITCHED);
    let turns = catenary.sections().flat_map(|section| {
        (1..section.spans()).map(move |support| {
            let turn = section.turn_at(support, |support| section.stagger_at(support));
            turn.powi(2) / section.span_lengths[support].min(section.span_lengths[support - 1])
        })
    });
    let sharpest = turns.fold(0.0, f64::max);
    let (wire, arms) = (&catenary.contact_wire, &catenary.registration_arms);
    let give = if sharpest > 0.0 {
        (sharpest * wire.axial_stiffness / arms.lateral_stiffness).min(1.0)
    } else {
        0.0
    };
    percent + ARMS * give
}

/// Error of a line linearised about its static state, %.
fn linearised(scene: &Scene, catenary: &Catenary) -> f64 {
    let (mut force, mut factor) = (USUAL_FORCE, 1.0);
    for pantograph in &scene.pantographs {
        match &pantograph.model {
            PantographModel::Lumped(lumped) => {
                force = force.max(lumped.static_force + lumped.aero_coefficient * scene.run.speed.powi(2));
            }
            PantographModel::Linkage(_) | PantographModel::Supplied(_) => factor = LINKAGE,
        }
    }
    if catenary.wire_ends == WireEnds::Fixed {
        factor *= FIXED_ENDS;
    }
    if catenary.stitch_wires.is_some() {
        factor *= STITCHED;
    }
    factor * LINEARISED * (force / USUAL_FORCE).powf(POWER_OF_FORCE)
}

/// Error of a window, %: the spans beyond it are linear, and what a nonlinear one passes on to them adds up.
fn window(scene: &Scene, catenary: &Catenary) -> f64 {
    let is_plain = catenary.tension_lengths.len() == 1
        && catenary.stitch_wires.is_none()
        && catenary.contact_wire_spacing.is_none()
        && catenary.messenger_wire.is_some()
        && !catenary.is_curved();
    let of_linear = if is_plain { WINDOW } else { WINDOW_IN_OTHERS };
    if scene.model.has(Reduction::Linearised) {
        of_linear
    } else {
        of_linear + WINDOW_NONLINEAR + WINDOW_NONLINEAR_RATE * scene.run.duration
    }
}
