//! Corrections of coarse elements: which of them a line can have.

use scene::{Catenary, ContactLaw, Correction, Element, Found, Reduction, Scene, What, Wire, WireEnds, WireKind};

/// Least spectral radius of the integrator for the mass correction: below, numerical damping and not dispersion is the
/// leading error of a step.
const LEAST_RHO_INF: f64 = 0.9;

/// Least part of the dispersion of a step, which goes with its square, that the mass correction of the contact wire
/// takes away, –.
const LEAST_CORRECTED: f64 = 0.5;

/// Time steps that the mass of each kind of wire is corrected for, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectedSteps {
    /// Contact wires.
    pub contact_wire: f64,
    /// Messenger wires.
    pub messenger_wire: f64,
    /// Stitch wires.
    pub stitch_wire: f64,
}

impl CorrectedSteps {
    /// One step for all wires, s.
    #[must_use]
    pub fn alike(step: f64) -> Self {
        Self {
            contact_wire: step,
            messenger_wire: step,
            stitch_wire: step,
        }
    }
}

/// Longest step for the mass correction of a kind of wire: a share of the time that a wave takes through an element.
struct LongestStep {
    /// Share of that time, –.
    share: f64,
    /// Length of the element, m.
    length: f64,
    /// Speed of the waves, m/s.
    wave_speed: f64,
}

impl LongestStep {
    /// The step, s.
    fn step(&self) -> f64 {
        self.share * self.length / self.wave_speed
    }
}

/// Longest step for the mass correction of the wires of a kind, that of the interval that takes the shortest; none
/// without such wires.
///
/// Beyond, the corrected mass matrix is not positive definite: the shares stay below those at which its smallest
/// eigenvalue vanishes, which are lower with bending layers, with few elements between them, and along a wire whose end
/// moves freely. With other numbers in each interval the bound is that of the interval by itself, tested in
/// `core/catenary/tests/even_elements.rs`.
fn longest_corrected_step(catenary: &Catenary, kind: WireKind, layers: bool) -> Option<LongestStep> {
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
        LongestStep {
            share,
            length,
            wave_speed: wire.wave_speed(),
        }
    };
    let of_kind = catenary.elements().filter(|((of, _), ..)| *of == kind);
    of_kind.map(of_interval).min_by(|a, b| a.step().total_cmp(&b.step()))
}

/// Steps that the mass correction of a scene's line is made for: the internal step, or the longest one that a wire can
/// be corrected for.
#[must_use]
pub fn corrected_steps(scene: &Scene, catenary: &Catenary) -> CorrectedSteps {
    let layers = catenary.mesh.has(Correction::BendingLayers);
    let of = |kind| {
        let longest = longest_corrected_step(catenary, kind, layers);
        longest
            .map_or(f64::INFINITY, |longest| longest.step())
            .min(scene.internal_step())
    };
    CorrectedSteps {
        contact_wire: of(WireKind::Contact),
        messenger_wire: of(WireKind::Messenger),
        stitch_wire: of(WireKind::Stitch),
    }
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
        Correction::MassCorrection if scene.model.has(Reduction::Modal) => {
            Some("model.reduce has \"modal\", which solves the steps of the line exactly".to_owned())
        }
        Correction::MassCorrection => {
            let rho_inf = scene.solver.rho_inf;
            if rho_inf < LEAST_RHO_INF {
                return Some(format!(
                    "solver.rho_inf = {rho_inf} is below {LEAST_RHO_INF}: the integrator's damping, not its \
                     dispersion, is the \
                     error of a step"
                ));
            }
            let layers = others.contains(&Correction::BendingLayers);
            let longest = longest_corrected_step(catenary, WireKind::Contact, layers)?;
            let (step, limit) = (scene.internal_step(), longest.step());
            (limit.powi(2) < LEAST_CORRECTED * step.powi(2)).then(|| {
                let LongestStep {
                    share,
                    length,
                    wave_speed,
                } = longest;
                format!(
                    "internal steps of {:.4} ms are too long beside {:.4} ms, {share} of the time that a wave of \
                     {wave_speed:.1} m/s takes through an element of {length:.3} m of the contact wire: the corrected \
                     mass would not be positive, and corrected for shorter steps it would hardly help",
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
    let needs = |(kind, wire): (WireKind, &Wire)| wire.needs_layers(kind, catenary.shortest_element(kind));
    if catenary.wire_kinds().any(needs) {
        return None;
    }
    let Some((kind, wire)) = catenary.wire_kinds().find(|(_, wire)| wire.bending_stiffness > 0.0) else {
        return Some("the wire is a string, bending_stiffness = 0, so there is no bending layer to resolve".to_owned());
    };
    Some(format!(
        "the shortest element, {:.4} m, is below the bending length of the {}, √(bending_stiffness / tension) = {:.4} \
         m: the elements follow the bend themselves",
        catenary.shortest_element(kind),
        kind.words(),
        wire.bending_length()
    ))
}
