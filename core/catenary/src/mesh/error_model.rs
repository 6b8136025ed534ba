//! What error a mesh is expected to make, and the mesh for an error.
//!
//! The rule is interpolated between measurements, and good to a factor of about two. An element of length `l` is measured against the
//! waves that carry a force of the low-pass frequency `f`: `c/f` behind a source at rest, `(c − v)/f` ahead of one that moves,
//!
//! ```text
//! μ = l f / √(c (c − v))
//! by waves:   W(f) = a μ²    plain; half of it with one of contact_compliance and bending_layers
//!                    b μ⁴    with both
//! by length:  L(f) = g l² (1 + (f/f₁)²)    g larger with fewer corrections, and without both as 1/v below 120 km/h
//! space:      u max(W(f), L(f)), and at most u W(max(f, f₀)) max(1, v₀/v)²
//! time:       u d h² f max(f, f₀)                           without mass_correction
//!             u (d₁ h² + d |h₁² − h²|) f max(f, f₀)         with it, made for steps h₁
//! u:          √(5·10⁻⁵ s / damping.beta), at least 1
//! error of the filtered force, % of its standard deviation: √(space² + time²)
//! ```
//!
//! with the slower wave of the two wires, the longest element and the internal step `h`. From `f₀` = 20 Hz and `v₀` = 200 km/h on, that
//! is `W` and `d (h f)²`. Below, a mesh is wrong in what waves do not tell: in the flexibility of the line, whose error is felt at every
//! frequency, and in what the strip feels as it passes elements, against a standard deviation that goes with the speed.
//!
//! Measured below `f₀` and `v₀` against 16 corrected elements at 0.25 ms, at 2, 3, 5, 7, 10, 15 and 20 Hz, on the lines of EN 50318 at 60,
//! 120, 200 and 300 km/h and of the thesis at 60, 120 and 200 km/h under a lumped pantograph, with 2 to 8 elements between droppers and
//! steps of 0.5 to 2 ms: nothing makes twice what the rule says, but meshes without both corrections on the line of EN 50318 at 120 and
//! 200 km/h up to 2.3 times from 15 Hz on. The other way the rule is less exact: on the line of EN 50318 coarse elements make down to an
//! eighth of it at 3 Hz and a twentieth at 2 Hz. Corrected elements of 0.81, 1.6 and 3.3 m at 1 ms, %, measured (expected):
//!
//! ```text
//! EN 50318       3 Hz                                 5 Hz                                  10 Hz
//! 300 km/h       0.06 (0.4)  0.6 (1.4)  2.7 (5.6)     0.08 (0.4)  1.0 (1.6)  3.9 (6.2)      0.2 (0.6)  2.9 (2.2)  6.8 (10)
//! 120 km/h       0.07 (0.3)  0.2 (1.4)  0.8 (5.6)     0.10 (0.3)  0.3 (1.6)  1.1 (6.2)      0.2 (0.3)  0.9 (2.2)  5.7 (8.9)
//!  60 km/h       0.1  (0.4)  0.4 (1.4)  1.0 (5.6)     0.2  (0.4)  0.5 (1.6)  1.5 (6.2)      0.2 (0.6)  1.3 (2.2)  2.7 (8.9)
//! ```

use scene::{Catenary, ContactLaw, Correction, Scene, Wire, kmh};

/// Of the plain mesh, %. Measured with 4, 8 and 16 elements between droppers at 0.5 and 1 ms, against 12 corrected ones at 0.25 ms, on
/// seven spans of EN 50318 at 250 and 300 km/h and eight of the thesis' line at 200 km/h under a lumped pantograph: 67 to 102.
const PLAIN: f64 = 80.0;
/// Share of it that is left with one correction; measured 0.44 to 0.73.
const WITH_ONE_CORRECTION: f64 = 0.5;
/// Of the mesh with both corrections, %. Measured with 4, 6 and 8 elements likewise: 89 to 250.
const CORRECTED: f64 = 200.0;
/// Of the time step, %: at 1 ms and 20 Hz 2 %.
const STEP: f64 = 5000.0;
/// Of the time step with the mass correction, %: at 1 ms and 20 Hz 0.2 %. Measured with 8 elements of up to 0.81 m on the line of
/// EN 50318 at 300 and 250 km/h between 1 and 1.5 ms: 0.12 to 0.2 % per ms²; on that of the thesis between 0.5 and 1.5 ms 0.3 to 0.35.
const CORRECTED_STEP: f64 = 500.0;
/// The same of a sliding joint, whose force is not corrected as it moves, %: at 1 ms and 20 Hz 0.3 %.
const CORRECTED_STEP_OF_JOINT: f64 = 750.0;
/// Of elements by their length, with both corrections, % per m² at low frequency: measured 0.1 to 0.4 on the line of EN 50318 and 0.2 to 1.0
/// on that of the thesis up to 5 Hz, 0.2 to 1.1 at 10 Hz.
const CORRECTED_LENGTH: f64 = 0.5;
/// The same with one correction: 0.3 to 3.9 up to 5 Hz, compliance more than layers.
const LENGTH_WITH_ONE_CORRECTION: f64 = 1.8;
/// The same of the plain mesh: 0.5 to 4 from 120 km/h on up to 5 Hz, 2.0 to 5.3 at 60 km/h.
const PLAIN_LENGTH: f64 = 3.0;
/// Speed below which those without both corrections go with 1/v, as the standard deviation goes down with v and what the strip feels of an
/// element does not, m/s.
const SLOW: f64 = 120.0 / 3.6;
/// Frequency `f₁` from which that error grows with the frequency, Hz.
const RISE: f64 = 12.0;
/// Filter `f₀` at and above which errors go by waves, Hz.
const WAVES_FROM: f64 = 20.0;
/// Speed `v₀` at and above which they do, m/s.
const WAVES_FROM_SPEED: f64 = 200.0 / 3.6;
/// The lowest speed that was measured with all meshes, m/s. At 20 km/h the standard deviation at 20 Hz is 1 N: corrected elements of 1.6 m
/// make a fifth of what the rule would say, plain ones twice.
const LEAST_SPEED: f64 = 60.0 / 3.6;
/// The least damping of the wires that was measured to converge, `catenary.damping.beta` in s. Without any, on the line of EN 50318 at
/// 300 km/h, eight corrected elements at 1 ms are 5 % from sixteen at 0.25 ms, and at 0.5 ms 8 %.
const LEAST_DAMPING: f64 = 2e-5;
/// Damping below which errors go with its root, s: those of eight corrected elements at 1 ms (of a step of 2 ms without correction) at 20 Hz
/// are 0.4 (5.3) % with 1e-4 s, 0.6 (9.6) % with 5e-5 s and 1.2 (14.7) % with 2e-5 s, on the line of EN 50318 at 300 km/h.
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

/// The error that mesh and time step of this scene's line are expected to make of the low-pass filtered contact force; `Err` says
/// for what no rule is known.
///
/// # Errors
///
/// Faster than the waves of a wire or slower than measured, with a damping integrator, wires hardly damped, a filter below the
/// passing of spans, or somebody else's line.
pub fn expected_error(scene: &Scene) -> Result<MeshError, String> {
    expected_error_at(scene, scene.internal_step())
}

/// The same of a run with internal steps of `step` s, whatever the step that the mass is corrected for.
///
/// # Errors
///
/// As [`expected_error`].
pub fn expected_error_at(scene: &Scene, step: f64) -> Result<MeshError, String> {
    let (catenary, contact) = scene.modelled_line().ok_or("a line that is an FMU of somebody else")?;
    has_a_rule(scene, catenary)?;
    let (f, corrected) = (scene.run.low_pass_hz, scene.internal_step());
    let squares = match (catenary.mesh.has(Correction::MassCorrection), contact.law) {
        (false, _) => STEP * (step * f).powi(2),
        (true, law) => {
            let rest = match law {
                ContactLaw::Penalty => CORRECTED_STEP,
                ContactLaw::SlidingJoint => CORRECTED_STEP_OF_JOINT,
            };
            // What was corrected for is not what the step does.
            let off = (corrected * f).powi(2) - (step * f).powi(2);
            rest * (step * f).powi(2) + STEP * off.abs()
        }
    };
    let undamped = (DAMPED_FROM / catenary.damping.beta).sqrt().max(1.0);
    Ok(MeshError {
        space: (undamped * space_error(catenary, scene.run.speed, f)).min(MOST),
        time: (undamped * squares * (WAVES_FROM / f).max(1.0)).min(MOST),
    })
}

/// Whether the rule is good to a factor of two both ways; else errors may be far below what it says.
#[must_use]
pub fn error_goes_by_waves(scene: &Scene) -> bool {
    scene.run.low_pass_hz >= WAVES_FROM && scene.run.speed >= WAVES_FROM_SPEED
}

/// `Err` says by key, value and bound for what no rule is known.
fn has_a_rule(scene: &Scene, catenary: &Catenary) -> Result<(), String> {
    let (v, f) = (scene.run.speed, scene.run.low_pass_hz);
    let waves = [&catenary.contact_wire, &catenary.messenger_wire].map(Wire::wave_speed);
    if v >= waves[0].min(waves[1]) {
        let [contact, messenger] = waves.map(kmh);
        return Err(format!(
            "{:.1} km/h on wires with waves of {contact:.1} and {messenger:.1} km/h: run.speed_kmh must be below both",
            kmh(v)
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
            "catenary.damping.beta = {beta} s: must be at least {LEAST_DAMPING} s, as measured; the force of wires that are hardly \
             damped does not settle with finer meshes"
        ));
    }
    let span = catenary.span_lengths.iter().sum::<f64>() / catenary.spans() as f64;
    if f < v / span {
        return Err(format!(
            "run.low_pass_hz = {f} Hz: must be at least {:.2} Hz, at which spans of {span:.2} m pass at {:.1} km/h; below, hardly \
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
    let mu = catenary.longest_element() / shortest_wave(catenary, v, f);
    let plain = PLAIN * mu.powi(2);
    match force_corrections(catenary) {
        2 => plain.min(CORRECTED * mu.powi(4)),
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

/// Geometric mean of the waves that a force of frequency `f` Hz sends out at rest and ahead of itself at the speed `v`, m, on the wire
/// where it is shorter. `v` is below both waves' speeds.
fn shortest_wave(catenary: &Catenary, v: f64, f: f64) -> f64 {
    let c = (catenary.contact_wire.wave_speed()).min(catenary.messenger_wire.wave_speed());
    (c * (c - v)).sqrt() / f
}
