//! Expected error of mesh and time step in the filtered contact force.
//!
//! The rule is interpolated between measurements, and good to a factor of about two. An element of length `l` is
//! measured against the waves that carry a force of the low-pass frequency `f`: `c/f` behind a source at rest, `(c −
//! v)/f` ahead of one that moves,
//!
//! ```text
//! μ = l f / √(c (c − v))
//! by waves:   W(f) = a μ²              plain; half of it with one of contact_compliance and bending_layers
//!                    max(b μ⁴, b₂ μ²)  with both
//! by length:  L(f) = g l² (1 + (f/f₁)²)    g larger with fewer corrections, and without both as 1/v below 120 km/h
//! space:      u max(W(f), L(f)), and at most u W(max(f, f₀)) max(1, v₀/v)²
//! time:       u d h² f max(f, f₀)                           without mass_correction
//!             u (d₁ h² + d |h₁² − h²|) f max(f, f₀)         with it, made for steps h₁, of the wire farthest from h
//! u:          √(5·10⁻⁵ s / damping.beta), at least 1
//! error of the filtered force, % of its standard deviation: √(space² + time²)
//! ```
//!
//! with the slower wave of the two wires, the longest element and the internal step `h`. From `f₀` = 20 Hz and `v₀` =
//! 200 km/h on, that is `W` and `d (h f)²`. Below, a mesh is wrong in what waves do not tell: in the flexibility of the
//! line, whose error is felt at every frequency, and in what the strip feels as it passes elements, against a standard
//! deviation that goes with the speed.
//!
//! The constants were fitted to runs on the lines of EN 50318 and of the thesis under a lumped pantograph, each against
//! a much finer corrected mesh at a quarter of the step; the tests of `core/catenary/tests/mesh_choice.rs` hold the
//! rule against them. Below `f₀` and `v₀` the rule is an upper bound rather than an estimate.

use super::corrections::corrected_steps;
use scene::{Catenary, ContactLaw, Correction, Reduction, Scene, Wire, kmh};

/// Factor `a` of the plain mesh, %.
const PLAIN: f64 = 80.0;
/// Share of the plain error that is left with one correction, –.
const WITH_ONE_CORRECTION: f64 = 0.5;
/// Factor `b` of the mesh with both corrections, %.
const CORRECTED: f64 = 200.0;
/// Factor `b₂` of that mesh where its elements are short, %: corrections leave a small part of the second order.
const CORRECTED_SHORT: f64 = 10.0;
/// Factor `d` of the time step, %·(1/(s Hz))².
const STEP: f64 = 5000.0;
/// Factor `d₁` of the time step with the mass correction, %·(1/(s Hz))².
const CORRECTED_STEP: f64 = 500.0;
/// Factor `d` of a line in its modes, %·(1/(s Hz))².
const MODAL_STEP: f64 = 300.0;
/// Factor `d₁` under a sliding joint, whose force is not corrected as the joint moves, %·(1/(s Hz))².
const CORRECTED_STEP_OF_JOINT: f64 = 750.0;
/// Factor `g` of elements by their length with both corrections, %/m².
const CORRECTED_LENGTH: f64 = 0.5;
/// Factor `g` with one correction, %/m².
const LENGTH_WITH_ONE_CORRECTION: f64 = 1.8;
/// Factor `g` of the plain mesh, %/m².
const PLAIN_LENGTH: f64 = 3.0;
/// Speed below which meshes without both corrections err as 1/v, m/s: the standard deviation of the force falls with
/// the speed, and the force of passing an element does not.
const SLOW: f64 = 120.0 / 3.6;
/// Frequency `f₁` from which that error grows with the frequency, Hz.
const RISE: f64 = 12.0;
/// Filter `f₀` at and above which errors go by waves, Hz.
const WAVES_FROM: f64 = 20.0;
/// Speed `v₀` at and above which they do, m/s.
const WAVES_FROM_SPEED: f64 = 200.0 / 3.6;
/// Lowest speed that the rule was fitted at with all meshes, m/s; the force varies too little at lower ones.
const LEAST_SPEED: f64 = 60.0 / 3.6;
/// Least damping of the wires, `catenary.damping.beta` in s: with less the force does not settle with finer meshes.
const LEAST_DAMPING: f64 = 2e-5;
/// Damping below which errors grow with the inverse of its root, s.
const DAMPED_FROM: f64 = 5e-5;
/// Spectral radius of the integrator below which its damping is the error of a step (–).
const LEAST_RHO_INF: f64 = 0.8;
/// An error beyond which a mesh gives no force at all, %.
const MOST: f64 = 100.0;

/// The error of a mesh and a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshError {
    /// That of the mesh, % of the standard deviation of the filtered force.
    pub space: f64,
    /// That of the time step, likewise.
    pub time: f64,
}

impl MeshError {
    /// Both together, %.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.space.hypot(self.time)
    }
}

/// The error that mesh and time step of this scene's line are expected to make of the low-pass filtered contact force;
/// `Err` says for what no rule is known.
///
/// # Errors
///
/// Faster than the waves of a wire or slower than measured, with a damping integrator, wires hardly damped, a filter
/// below the passing of spans, or a supplied line.
pub fn expected_error(scene: &Scene) -> Result<MeshError, String> {
    expected_error_at(scene, scene.internal_step())
}

/// The same of a run with internal steps of `step` s, whatever the step that the mass is corrected for.
///
/// # Errors
///
/// As [`expected_error`].
pub fn expected_error_at(scene: &Scene, step: f64) -> Result<MeshError, String> {
    let (catenary, contact) = scene.modelled_line().ok_or("a line that is a supplied FMU")?;
    has_a_rule(scene, catenary)?;
    let (f, corrected) = (scene.run.low_pass_hz, corrected_steps(scene, catenary));
    let squares = match (catenary.mesh.has(Correction::MassCorrection), contact.law) {
        // The line is exact in time; the parabola of a force within a step is not.
        _ if scene.model.has(Reduction::Modal) => MODAL_STEP * (step * f).powi(2),
        (false, _) => STEP * (step * f).powi(2),
        (true, law) => {
            let rest = match law {
                ContactLaw::Penalty => CORRECTED_STEP,
                ContactLaw::SlidingJoint => CORRECTED_STEP_OF_JOINT,
            };
            // What was corrected for is not what the step does.
            let off = |corrected: f64| ((corrected * f).powi(2) - (step * f).powi(2)).abs();
            let most = off(corrected.contact_wire).max(off(corrected.messenger_wire));
            rest * (step * f).powi(2) + STEP * most
        }
    };
    let undamped = (DAMPED_FROM / catenary.damping.beta).sqrt().max(1.0);
    Ok(MeshError {
        space: (undamped * space_error(catenary, scene.run.speed, f)).min(MOST),
        time: (undamped * squares * (WAVES_FROM / f).max(1.0)).min(MOST),
    })
}

/// True where the rule is good to a factor of two both ways; else errors may be far below its value.
#[must_use]
pub fn error_goes_by_waves(scene: &Scene) -> bool {
    scene.run.low_pass_hz >= WAVES_FROM && scene.run.speed >= WAVES_FROM_SPEED
}

/// `Err` says by key, value and bound for what no rule is known.
fn has_a_rule(scene: &Scene, catenary: &Catenary) -> Result<(), String> {
    let (v, f) = (scene.run.speed, scene.run.low_pass_hz);
    if v >= catenary.slowest_wave() {
        let waves: Vec<String> = (catenary.wire_kinds())
            .map(|(_, wire)| format!("{:.1}", kmh(wire.wave_speed())))
            .collect();
        return Err(format!(
            "{:.1} km/h on wires with waves of {} km/h: run.speed_kmh must be below all",
            kmh(v),
            waves.join(" and ")
        ));
    }
    if v < LEAST_SPEED {
        let least = kmh(LEAST_SPEED);
        return Err(format!(
            "run.speed_kmh = {} km/h: must be at least {least} km/h, as measured",
            kmh(v)
        ));
    }
    let rho_inf = scene.solver.rho_inf;
    if rho_inf < LEAST_RHO_INF {
        return Err(format!(
            "solver.rho_inf = {rho_inf}: must be at least {LEAST_RHO_INF}, as measured"
        ));
    }
    let beta = catenary.damping.beta;
    if beta < LEAST_DAMPING {
        return Err(format!(
            "catenary.damping.beta = {beta} s: must be at least {LEAST_DAMPING} s, as measured; the force of wires \
             that are hardly \
             damped does not settle with finer meshes"
        ));
    }
    let span = catenary.span_lengths().iter().sum::<f64>() / catenary.spans() as f64;
    if f < v / span {
        return Err(format!(
            "run.low_pass_hz = {f} Hz: must be at least {:.2} Hz, at which spans of {span:.2} m pass at {:.1} km/h; \
             below, hardly \
             any force is left",
            v / span,
            kmh(v)
        ));
    }
    Ok(())
}

/// Error of the mesh in the force below `f` Hz at the speed `v` in m/s, %.
fn space_error(catenary: &Catenary, v: f64, f: f64) -> f64 {
    let waves = error_by_waves(catenary, v, f);
    let most = error_by_waves(catenary, v, f.max(WAVES_FROM)) * (WAVES_FROM_SPEED / v).max(1.0).powi(2);
    waves.max(error_by_length(catenary, v, f)).min(most)
}

/// `W(f)`, %.
fn error_by_waves(catenary: &Catenary, v: f64, f: f64) -> f64 {
    let mu = longest_of_waves(catenary, v, f);
    let plain = PLAIN * mu.powi(2);
    match force_corrections(catenary) {
        2 => plain.min((CORRECTED * mu.powi(4)).max(CORRECTED_SHORT * mu.powi(2))),
        1 => WITH_ONE_CORRECTION * plain,
        _ => plain,
    }
}

/// `L(f)`, %.
fn error_by_length(catenary: &Catenary, v: f64, f: f64) -> f64 {
    let slow = (SLOW / v).max(1.0);
    let low = match force_corrections(catenary) {
        2 => CORRECTED_LENGTH,
        1 => LENGTH_WITH_ONE_CORRECTION * slow,
        _ => PLAIN_LENGTH * slow,
    };
    low * catenary.longest_element().powi(2) * (1.0 + (f / RISE).powi(2))
}

/// How many of the corrections that make up for the length of elements are in use.
fn force_corrections(catenary: &Catenary) -> usize {
    let corrections = [Correction::ContactCompliance, Correction::BendingLayers];
    corrections
        .into_iter()
        .filter(|correction| catenary.mesh.has(*correction))
        .count()
}

/// Largest part that an element is of the waves on its wire: of the geometric mean of the waves that a force of
/// frequency `f` Hz sends out at rest and ahead of itself at the speed `v`, m/s, below all waves' speeds.
fn longest_of_waves(catenary: &Catenary, v: f64, f: f64) -> f64 {
    let along = catenary.elements().filter(|((kind, _), ..)| kind.runs_along());
    let part = |((_, wire), length, _): ((_, &Wire), f64, usize)| {
        let c = wire.wave_speed();
        length / ((c * (c - v)).sqrt() / f)
    };
    along.map(part).fold(0.0, f64::max)
}
