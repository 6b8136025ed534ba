//! `[catenary.mesh]`: elements of the wires, and what makes up for their coarseness.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::mesh_error;
use crate::write::shown_number;
use crate::{Catenary, ContactLaw, Division, Scene, WireEnds};

/// `[catenary.mesh]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Element of the contact wire.
    pub element: Element,
    /// Elements between neighbouring droppers or supports.
    pub division: Division,
    /// Axial strain measure.
    pub axial_strain: AxialStrain,
    /// What makes up for the coarseness of the mesh, in the order of [`Correction::ALL`]; empty is the plain mesh. `"auto"` is already
    /// resolved.
    pub corrections: Vec<Correction>,
    /// Speed of the strips when the scene was read, m/s: that of the contact's residual compliance. A standstill before the run, or
    /// another speed set later, is not another mesh.
    pub contact_speed: f64,
    /// What is still to be chosen; only while a scene is read.
    pub(crate) open: Option<Open>,
}

/// What a scene leaves to the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Open {
    /// The corrections.
    Corrections,
    /// Elements, corrections and, where it is not given, the micro step, for an error of the filtered force of at most this, % of its
    /// standard deviation.
    Error {
        /// %.
        percent: f64,
        /// True where the scene has no mesh at all.
        by_default: bool,
    },
}

/// The error of the filtered force that a mesh is chosen for where a scene has none, % of its standard deviation: far
/// below the scatter of measured contact forces.
const DEFAULT_ERROR: f64 = 1.0;

choice! {
    /// `catenary.mesh.element`.
    pub enum Element {
        /// ANCF cable element: position and one gradient per node.
        Cable = "cable",
        /// Fully parameterised ANCF beam element: position and three gradients per node, in the contact wire; the messenger wire is of
        /// cable elements.
        Beam = "beam",
    }
    unavailable: []
}

choice! {
    /// `catenary.mesh.axial_strain`.
    pub enum AxialStrain {
        /// Element mean of the Green-Lagrange strain.
        Mean = "mean",
        /// The strain at five Gauss points.
        Full = "full",
    }
    unavailable: []
}

choice! {
    /// An entry of `catenary.mesh.corrections`.
    pub enum Correction {
        /// The contact point yields by what the mesh lacks of the wire's flexibility under a moving point force.
        ContactCompliance = "contact_compliance",
        /// One unknown per attachment and wire for the bend there, which is shorter than an element.
        BendingLayers = "bending_layers",
        /// Droppers yield by what the mesh lacks of the wires' flexibility.
        DropperCompliance = "dropper_compliance",
        /// A mass matrix that cancels the leading dispersion error of the time step.
        MassCorrection = "mass_correction",
    }
    unavailable: ["dropper_compliance"]
}

/// Least spectral radius of the integrator for the mass correction: below, numerical damping and not dispersion is the leading
/// error of a step.
const LEAST_RHO_INF: f64 = 0.9;

/// Longest step for the mass correction: a share of the time that a wave takes through an element, and the length of that element,
/// m, of the dropper interval that takes the shortest step. Beyond, the corrected mass matrix is not positive definite. With as many
/// elements in each interval its smallest eigenvalue vanishes at 0.38 of the time through the shortest one without bending layers and
/// with ends that are held; with layers at the attachments of the standard's line and elements of up to 40 bending lengths at 0.21,
/// 0.26, 0.28, 0.29, 0.30 for 1, 2, 3, 4, 6 elements between them; along a wire whose end moves freely, as under a constant tension,
/// at 0.2545 for four elements and 0.2565 for many. With other numbers in each interval the bound is that of the interval by itself:
/// tested for elements of one length in `core/catenary/tests/even_elements.rs`.
fn longest_corrected_step(catenary: &Catenary, layers: bool) -> (f64, f64) {
    let of_interval = |(length, elements): (f64, usize)| {
        let inner: f64 = match (layers, elements) {
            (false, _) => 0.31,
            (true, 4..) => 0.28,
            (true, _) => 0.20,
        };
        let share = match catenary.wire_ends {
            WireEnds::ConstantTension => inner.min(0.25),
            WireEnds::Fixed => inner,
        };
        (share, length)
    };
    let step = |of: &(f64, f64)| of.0 * of.1;
    let all = catenary.elements().map(of_interval);
    all.min_by(|a, b| step(a).total_cmp(&step(b))).unwrap_or_default()
}

impl Mesh {
    /// Whether a correction is in use.
    #[must_use]
    pub fn has(&self, correction: Correction) -> bool {
        self.corrections.contains(&correction)
    }

    /// The corrections in a few words: `plain`, or their names joined by `+`.
    #[must_use]
    pub fn name(&self) -> String {
        if self.corrections.is_empty() {
            return "plain".to_owned();
        }
        let names: Vec<&str> = self.corrections.iter().map(|correction| correction.name()).collect();
        names.join("+")
    }
}

impl Scene {
    /// Why `correction` cannot be used in this scene's line beside `others`; `None` where it can.
    fn correction_obstacle(&self, correction: Correction, others: &[Correction]) -> Option<String> {
        let (catenary, contact) = self.modelled_line()?;
        if catenary.mesh.element == Element::Beam {
            return Some("corrections are made for cable elements, and catenary.mesh.element = \"beam\"".to_owned());
        }
        match correction {
            Correction::ContactCompliance => {
                if contact.law == ContactLaw::SlidingJoint {
                    return Some(
                        "contact.law is \"sliding_joint\", which holds the strip on the wire that the mesh has, without a spring that \
                         more flexibility could be in series with"
                            .to_owned(),
                    );
                }
                let (v, c) = (self.run.speed, catenary.contact_wire.wave_speed());
                (v >= c).then(|| {
                    format!(
                        "the strip at {v:.2} m/s is not slower than the waves of the contact wire, √(tension / mass_per_length) = \
                         {c:.2} m/s: no part of the wire answers it at once"
                    )
                })
            }
            Correction::BendingLayers => layers_obstacle(catenary),
            Correction::DropperCompliance => Some("this version does not have it".to_owned()),
            Correction::MassCorrection => {
                let rho_inf = self.solver.rho_inf;
                if rho_inf < LEAST_RHO_INF {
                    return Some(format!(
                        "solver.rho_inf = {rho_inf} is below {LEAST_RHO_INF}: the integrator's damping, not its dispersion, is the \
                         error of a step"
                    ));
                }
                let c = catenary
                    .contact_wire
                    .wave_speed()
                    .max(catenary.messenger_wire.wave_speed());
                let (share, length) = longest_corrected_step(catenary, others.contains(&Correction::BendingLayers));
                let (step, limit) = (self.internal_step(), share * length / c);
                (step > limit).then(|| {
                    format!(
                        "internal steps of {:.4} ms are longer than {:.4} ms, {share} of the time that a wave of {c:.1} m/s takes \
                         through an element of {length:.3} m: the corrected mass would not be positive",
                        1e3 * step,
                        1e3 * limit
                    )
                })
            }
        }
    }

    /// Resolves what `[catenary.mesh]` leaves open; nothing in a scene with problems, whose values may be no mesh's or no step's.
    pub(crate) fn choose_mesh(&mut self, keys: &mut Keys) {
        let step_is_given = !std::mem::take(&mut self.solver.open_step);
        let crate::Line::Modelled(catenary) = &mut self.catenary else {
            return;
        };
        match catenary.mesh.open.take().filter(|_| !keys.has_problems()) {
            None => {}
            Some(Open::Corrections) => self.choose_corrections(),
            Some(Open::Error { percent, by_default }) => match self.mesh_for(percent, step_is_given) {
                Ok(choice) => {
                    self.set_division(choice.division);
                    self.set_corrections(choice.corrections);
                    self.solver.micro_step = choice.micro_step;
                }
                Err(reason) if by_default => {
                    let expected = format!(
                        "a table with elements_per_interval or element_length, as none can be chosen for the default \
                         error_percent = {percent}: {reason}"
                    );
                    keys.report_path("catenary.mesh", What::Missing { expected });
                }
                Err(expected) => {
                    let value = shown_number(percent, "%");
                    keys.report_path("catenary.mesh.error_percent", What::Refused { value, expected });
                }
            },
        }
    }

    pub(crate) fn set_division(&mut self, division: Division) {
        if let crate::Line::Modelled(catenary) = &mut self.catenary {
            catenary.mesh.division = division;
        }
    }

    /// The mesh is that of the speed the scene was read with.
    pub(crate) fn keep_contact_speed(&mut self) {
        if let crate::Line::Modelled(catenary) = &mut self.catenary {
            catenary.mesh.contact_speed = self.run.speed;
        }
    }

    fn set_corrections(&mut self, corrections: Vec<Correction>) {
        if let crate::Line::Modelled(catenary) = &mut self.catenary {
            catenary.mesh.corrections = corrections;
        }
    }

    /// The corrections in use; none in somebody else's line.
    #[must_use]
    pub fn corrections(&self) -> &[Correction] {
        self.modelled_line().map_or(&[], |(line, _)| &line.mesh.corrections)
    }

    /// Takes every correction that can be used.
    pub(crate) fn choose_corrections(&mut self) {
        let mut corrections = Vec::new();
        for &correction in Correction::ALL {
            if self.modelled_line().is_some() && self.correction_obstacle(correction, &corrections).is_none() {
                corrections.push(correction);
            }
        }
        self.set_corrections(corrections);
    }

    /// The corrections that are not in use, each with why not.
    #[must_use]
    pub fn corrections_left_out(&self) -> Vec<(Correction, String)> {
        let Some((catenary, _)) = self.modelled_line() else {
            return Vec::new();
        };
        let corrections = &catenary.mesh.corrections;
        (Correction::ALL.iter())
            .filter(|correction| !corrections.contains(correction))
            .map(|&correction| {
                let obstacle = self.correction_obstacle(correction, corrections);
                (
                    correction,
                    obstacle.unwrap_or_else(|| "left out by catenary.mesh.corrections".to_owned()),
                )
            })
            .collect()
    }

    /// The corrections in use that this scene cannot have, each with why not: none in a scene that was read and not changed.
    #[must_use]
    pub fn impossible_corrections(&self) -> Vec<(Correction, String)> {
        let Some((catenary, _)) = self.modelled_line() else {
            return Vec::new();
        };
        let corrections = &catenary.mesh.corrections;
        let obstacle =
            |&correction: &Correction| Some((correction, self.correction_obstacle(correction, corrections)?));
        corrections.iter().filter_map(obstacle).collect()
    }

    /// Why a reduction of the line cannot be had with its elements; `None` where it can.
    pub(crate) fn element_obstacle(&self) -> Option<String> {
        let (catenary, _) = self.modelled_line()?;
        (catenary.mesh.element == Element::Beam)
            .then(|| "it is made for cable elements, and catenary.mesh.element = \"beam\"".to_owned())
    }

    pub(crate) fn check_corrections(&self, found: &mut Found) {
        for (correction, obstacle) in self.impossible_corrections() {
            let expected = format!("must be left out: {obstacle}");
            refuse(
                found,
                "catenary.mesh.corrections",
                format!("\"{correction}\""),
                expected,
            );
        }
    }
}

fn layers_obstacle(catenary: &Catenary) -> Option<String> {
    let wires = [
        ("contact wire", &catenary.contact_wire),
        ("messenger wire", &catenary.messenger_wire),
    ];
    if wires.iter().all(|(_, wire)| wire.bending_stiffness == 0.0) {
        return Some("both wires are strings, bending_stiffness = 0: their kinks have no inside".to_owned());
    }
    let shortest = catenary.shortest_element();
    wires.iter().find_map(|(name, wire)| {
        let layer = wire.bending_length();
        (layer > shortest).then(|| {
            format!(
                "the shortest element, {shortest:.4} m, is below the bending length of the {name}, √(bending_stiffness / tension) \
                 = {layer:.4} m: the elements follow the bend themselves"
            )
        })
    })
}

/// `error_percent`.
const ERROR: Number = Number::positive("%").at_least(mesh_error::LEAST);

/// A mesh whose elements and corrections are still to be chosen.
fn chosen_later(element: Element, axial_strain: AxialStrain) -> Mesh {
    Mesh {
        element,
        division: Division::PerInterval(1),
        axial_strain,
        corrections: Vec::new(),
        contact_speed: 0.0,
        open: None,
    }
}

impl Entry for Mesh {
    const SENTENCES: Sentences = &[
        (
            "element",
            "Element of the contact wire: ANCF cable, or fully parameterised ANCF beam.",
        ),
        (
            "axial_strain",
            "Axial strain measure: mean of the element, or the strain at five Gauss points.",
        ),
        (
            "error_percent",
            "Error of the filtered force, in percent of its standard deviation, that elements, corrections and a \
             micro step left out are chosen for; the default holds where no key of the mesh is given.",
        ),
        (
            "elements_per_interval",
            "Elements between neighbouring droppers or supports; this key, `element_length` or `error_percent`.",
        ),
        (
            "element_length",
            "Longest element; this key, `elements_per_interval` or `error_percent`.",
        ),
        (
            "corrections",
            "Sub-grid terms that make up for coarse elements; `\"auto\"` takes all that the scene can have.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let element = keys.word("element", was.map(|mesh| mesh.element), Some(Element::Cable));
        let axial_strain = keys.word(
            "axial_strain",
            was.map(|mesh| mesh.axial_strain),
            Some(AxialStrain::Mean),
        );
        if keys.describes() {
            keys.number("error_percent", None, ERROR.default(DEFAULT_ERROR));
            Division::entry(keys, None);
            keys.words::<Correction>("corrections", None);
            return chosen_later(element, axial_strain);
        }
        if keys.has("error_percent", false) && element == Element::Beam {
            keys.refuse(
                "error_percent",
                "must be left out: the rule was measured with cable elements, and catenary.mesh.element = \"beam\"; give \
                 elements_per_interval or element_length",
            );
        } else if keys.has("error_percent", false) {
            for name in ["elements_per_interval", "element_length", "corrections"] {
                if keys.has(name, false) {
                    let because = "catenary.mesh.error_percent chooses it".to_owned();
                    keys.report(name, What::LeaveOut { because });
                }
            }
            let error = keys.number("error_percent", None, ERROR);
            if error > 0.0 && error < mesh_error::LEAST {
                let expected = format!(
                    "must be at least {} %: below, no rule was measured; give elements_per_interval or element_length, and \
                     solver.micro_step, instead",
                    mesh_error::LEAST
                );
                let value = shown_number(error, "%");
                keys.report("error_percent", What::Refused { value, expected });
            }
            // What is no error at all is refused already, and nothing is chosen for it.
            let open = Open::Error {
                percent: error,
                by_default: false,
            };
            return Self {
                open: (error > 0.0).then_some(open),
                ..chosen_later(element, axial_strain)
            };
        }
        if keys.is_empty() {
            let open = Open::Error {
                percent: DEFAULT_ERROR,
                by_default: true,
            };
            return Self {
                open: Some(open),
                ..chosen_later(element, axial_strain)
            };
        }
        let division = Division::entry(keys, was.map(|mesh| mesh.division));
        let chosen = keys.words("corrections", was.map(|mesh| mesh.corrections.as_slice()));
        let open = chosen.is_none().then_some(Open::Corrections);
        let mut corrections = chosen.unwrap_or_default();
        corrections.sort_by_key(|correction| Correction::ALL.iter().position(|other| other == correction));
        Self {
            element,
            division,
            axial_strain,
            corrections,
            contact_speed: 0.0,
            open,
        }
    }
}
