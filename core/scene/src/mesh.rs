//! `[catenary.mesh]`: elements of the wires, and what makes up for their coarseness.

use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences, placeholder};
use crate::write::shown_number;
use crate::{Division, Scene};

/// `[catenary.mesh]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Element of the contact wire.
    pub element: Element,
    /// Elements between neighbouring droppers or supports.
    pub division: Division,
    /// Axial strain measure.
    pub axial_strain: AxialStrain,
    /// Terms that make up for the coarseness of the mesh, in the order of [`Correction::ALL`]; empty is the plain mesh.
    pub corrections: Vec<Correction>,
    /// Speed of the strips when the scene was read, m/s: that of the contact's residual compliance. A phase at rest
    /// before the run, or another speed set later, is not another mesh.
    pub contact_speed: f64,
    /// Choice that is left to the rules of the line's physics; until it is made nothing runs.
    pub choice: MeshChoice,
}

/// Part of a mesh that a scene leaves to be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshChoice {
    /// Nothing: elements and corrections are given.
    Given,
    /// The corrections, all that the scene can have; `corrections = "auto"` in the file.
    Corrections,
    /// Elements and corrections for an error; `error_percent` in the file.
    Error {
        /// Largest error of the filtered force, % of its standard deviation.
        percent: f64,
        /// True where the micro step is chosen too.
        choose_micro_step: bool,
        /// True where a micro step that is chosen is the macro step too.
        choose_macro_step: bool,
    },
}

/// The error of the filtered force that a mesh is chosen for where a scene has none, % of its standard deviation: far
/// below the scatter of measured contact forces.
pub(crate) const DEFAULT_ERROR: f64 = 1.0;
/// Least error that a mesh is chosen for, %: down to it the rule was compared with finer meshes.
const LEAST_ERROR: f64 = 0.1;

choice! {
    /// `catenary.mesh.element`.
    pub enum Element {
        /// ANCF cable element: position and one gradient per node.
        Cable = "cable",
        /// Fully parameterised ANCF beam element: position and three gradients per node, in the contact wire; the
        /// messenger wire is of cable elements.
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

impl Default for Mesh {
    /// An empty table.
    fn default() -> Self {
        placeholder()
    }
}

impl Mesh {
    /// Cable elements with every correction that the scene can have, which is to be chosen.
    #[must_use]
    pub fn new(division: Division) -> Self {
        Self {
            element: Element::Cable,
            division,
            axial_strain: AxialStrain::Mean,
            corrections: Vec::new(),
            contact_speed: 0.0,
            choice: MeshChoice::Corrections,
        }
    }

    /// Cable elements without corrections.
    #[must_use]
    pub fn plain(division: Division) -> Self {
        Self {
            choice: MeshChoice::Given,
            ..Self::new(division)
        }
    }

    /// A mesh whose elements, corrections and, where the scene leaves it open, micro step are to be chosen for an error
    /// of the filtered force of at most `percent` % of its standard deviation.
    #[must_use]
    pub fn for_error(element: Element, axial_strain: AxialStrain, percent: f64) -> Self {
        Self {
            element,
            division: Division::PerInterval(1),
            axial_strain,
            corrections: Vec::new(),
            contact_speed: 0.0,
            choice: MeshChoice::Error {
                percent,
                choose_micro_step: true,
                choose_macro_step: false,
            },
        }
    }

    /// True where nothing is left to be chosen.
    #[must_use]
    pub fn is_given(&self) -> bool {
        self.choice == MeshChoice::Given
    }

    /// True where a correction is in use.
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
    /// The corrections in use; none in a supplied line.
    #[must_use]
    pub fn corrections(&self) -> &[Correction] {
        self.modelled_line().map_or(&[], |(line, _)| &line.mesh.corrections)
    }

    /// Why a reduction of the line cannot be had with its elements; `None` where it can.
    pub(crate) fn element_obstacle(&self) -> Option<String> {
        let (catenary, _) = self.modelled_line()?;
        (catenary.mesh.element == Element::Beam)
            .then(|| "it is made for cable elements, and catenary.mesh.element = \"beam\"".to_owned())
    }

    /// The mesh is that of the speed the scene was read or built with.
    pub(crate) fn keep_contact_speed(&mut self) {
        let speed = self.run.speed;
        if let Some(mesh) = self.mesh_mut() {
            mesh.contact_speed = speed;
        }
    }

    /// The mesh of the line; `None` of a supplied one.
    pub fn mesh_mut(&mut self) -> Option<&mut Mesh> {
        match &mut self.catenary {
            crate::Line::Modelled(catenary) => Some(&mut catenary.mesh),
            crate::Line::Supplied(_) => None,
        }
    }
}

/// `error_percent`.
const ERROR: Number = Number::positive("%").at_least(LEAST_ERROR);

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
            "Error of the filtered force, in percent of its standard deviation, that elements, corrections and \
             steps left out are chosen for; the default holds where no key of the mesh is given.",
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
            return Self::for_error(element, axial_strain, DEFAULT_ERROR);
        }
        if let Some(MeshChoice::Error { percent, .. }) = was.map(|mesh| mesh.choice) {
            keys.number("error_percent", Some(percent), ERROR);
            return was
                .cloned()
                .unwrap_or_else(|| Self::for_error(element, axial_strain, percent));
        }
        if keys.has("error_percent", false) && element == Element::Beam {
            keys.refuse(
                "error_percent",
                "must be left out: the rule was measured with cable elements, and catenary.mesh.element = \"beam\"; \
                 give \
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
            if error > 0.0 && error < LEAST_ERROR {
                let expected = format!(
                    "must be at least {LEAST_ERROR} %: below, no rule was measured; give elements_per_interval or \
                     element_length, and solver.micro_step, instead"
                );
                let value = shown_number(error, "%");
                keys.report("error_percent", What::Refused { value, expected });
            }
            return Self::for_error(element, axial_strain, error);
        }
        if keys.is_empty() {
            return Self::for_error(element, axial_strain, DEFAULT_ERROR);
        }
        let division = Division::entry(keys, was.map(|mesh| mesh.division));
        if let Some(mesh) = was.filter(|mesh| mesh.choice == MeshChoice::Corrections) {
            return Self {
                division,
                ..mesh.clone()
            };
        }
        let chosen = keys.words("corrections", was.map(|mesh| mesh.corrections.as_slice()));
        let choice = match chosen {
            Some(_) => MeshChoice::Given,
            None => MeshChoice::Corrections,
        };
        let mut corrections = chosen.unwrap_or_default();
        corrections.sort_by_key(|correction| Correction::ALL.iter().position(|other| other == correction));
        Self {
            element,
            division,
            axial_strain,
            corrections,
            contact_speed: 0.0,
            choice,
        }
    }
}
