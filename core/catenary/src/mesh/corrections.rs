//! Corrections of coarse elements: which of them a line can have.

use scene::{Catenary, ContactLaw, Correction, Element, Found, Scene, What, Wire, WireEnds};

/// Least spectral radius of the integrator for the mass correction: below, numerical damping and not dispersion is the
/// leading error of a step.
const LEAST_RHO_INF: f64 = 0.9;

/// Longest step for the mass correction: a share of the time that a wave takes through an element, with the length of
/// that element, m, and the speed of the wave, m/s, of the interval and wire that take the shortest step. Beyond, the
/// corrected mass matrix is not positive definite: the shares stay below those at which its smallest eigenvalue
/// vanishes, which are lower with bending layers, with few elements between them, and along a wire whose end moves
/// freely. With other numbers in each interval the bound is that of the interval by itself, tested in
/// `core/catenary/tests/even_elements.rs`.
fn longest_corrected_step(catenary: &Catenary, layers: bool) -> (f64, f64, f64) {
    let of_interval = |((_, wire), length, elements): ((_, &Wire), f64, usize)| {
        let inner: f64 = match (layers, elements) {
            (false, _) => 0.31,
            (true, 4..) => 0.28,
            (true, _) => 0.20,
        };
        let share = match catenary.wire_ends {
            WireEnds::ConstantTension => inner.min(0.25),
            WireEnds::Fixed => inner,
        };
        (share, length, wire.wave_speed())
    };
    let step = |of: &(f64, f64, f64)| of.0 * of.1 / of.2;
    let all = catenary.elements().map(of_interval);
    all.min_by(|a, b| step(a).total_cmp(&step(b))).unwrap_or_default()
}

/// Why `correction` cannot be used in this scene's line beside `others`; `None` where it can.
fn obstacle_of(scene: &Scene, correction: Correction, others: &[Correction]) -> Option<String> {
    let (catenary, contact) = scene.modelled_line()?;
    if catenary.mesh.element == Element::Beam {
        return Some("corrections are made for cable elements, and catenary.mesh.element = \"beam\"".to_owned());
    }
    match correction {
        Correction::ContactCompliance => {
            if contact.law == ContactLaw::SlidingJoint {
                return Some(
                    "contact.law is \"sliding_joint\", which holds the strip on the wire that the mesh has, without a \
                     spring that \
                     more flexibility could be in series with"
                        .to_owned(),
                );
            }
            let (v, c) = (scene.run.speed, catenary.contact_wire.wave_speed());
            (v >= c).then(|| {
                format!(
                    "the strip at {v:.2} m/s is not slower than the waves of the contact wire, √(tension / \
                     mass_per_length) = \
                     {c:.2} m/s: no part of the wire answers it at once"
                )
            })
        }
        Correction::BendingLayers => layers_obstacle(catenary),
        Correction::DropperCompliance => Some("this version does not have it".to_owned()),
        Correction::MassCorrection => {
            let rho_inf = scene.solver.rho_inf;
            if rho_inf < LEAST_RHO_INF {
                return Some(format!(
                    "solver.rho_inf = {rho_inf} is below {LEAST_RHO_INF}: the integrator's damping, not its \
                     dispersion, is the \
                     error of a step"
                ));
            }
            let (share, length, c) = longest_corrected_step(catenary, others.contains(&Correction::BendingLayers));
            let (step, limit) = (scene.internal_step(), share * length / c);
            (step > limit).then(|| {
                format!(
                    "internal steps of {:.4} ms are longer than {:.4} ms, {share} of the time that a wave of {c:.1} \
                     m/s takes \
                     through an element of {length:.3} m: the corrected mass would not be positive",
                    1e3 * step,
                    1e3 * limit
                )
            })
        }
    }
}

/// Takes every correction that can be used.
pub fn choose_corrections(scene: &mut Scene) {
    let mut corrections = Vec::new();
    for &correction in Correction::ALL {
        if scene.modelled_line().is_some() && obstacle_of(scene, correction, &corrections).is_none() {
            corrections.push(correction);
        }
    }
    if let Some(mesh) = scene.mesh_mut() {
        mesh.corrections = corrections;
    }
}

/// The corrections that are not in use, each with why not.
#[must_use]
pub fn corrections_left_out(scene: &Scene) -> Vec<(Correction, String)> {
    let Some((catenary, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let corrections = &catenary.mesh.corrections;
    (Correction::ALL.iter())
        .filter(|correction| !corrections.contains(correction))
        .map(|&correction| {
            let obstacle = obstacle_of(scene, correction, corrections);
            (
                correction,
                obstacle.unwrap_or_else(|| "left out by catenary.mesh.corrections".to_owned()),
            )
        })
        .collect()
}

/// The corrections in use that this scene cannot have, each with why not: none in a scene that was read and not
/// changed.
#[must_use]
pub fn impossible_corrections(scene: &Scene) -> Vec<(Correction, String)> {
    let Some((catenary, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let corrections = &catenary.mesh.corrections;
    let obstacle = |&correction: &Correction| Some((correction, obstacle_of(scene, correction, corrections)?));
    corrections.iter().filter_map(obstacle).collect()
}

/// The corrections in use that a scene cannot have, as problems of its keys.
#[must_use]
pub fn contradictions(scene: &Scene) -> Found {
    let refusal = |(correction, obstacle): (Correction, String)| {
        let what = What::Refused {
            value: format!("\"{correction}\""),
            expected: format!("must be left out: {obstacle}"),
        };
        ("catenary.mesh.corrections".to_owned(), what)
    };
    impossible_corrections(scene).into_iter().map(refusal).collect()
}

fn layers_obstacle(catenary: &Catenary) -> Option<String> {
    let bends = |(_, wire): (_, &Wire)| wire.bending_stiffness > 0.0;
    if !catenary.wire_kinds().any(bends) && catenary.messenger_wire.is_none() {
        return Some("the wire is a string, bending_stiffness = 0, so there is no bending layer to resolve".to_owned());
    }
    let shortest = catenary.shortest_element();
    catenary.wire_kinds().find_map(|(kind, wire)| {
        let layer = wire.bending_length();
        (layer > shortest).then(|| {
            format!(
                "the shortest element, {shortest:.4} m, is below the bending length of the {}, √(bending_stiffness / \
                 tension) = {layer:.4} m: the elements follow the bend themselves",
                kind.words()
            )
        })
    })
}
