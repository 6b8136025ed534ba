//! The line of a scene together with the strips on it.
use crate::{
    BendingLayers, ContactPair, ContactTangent, Dimension, LineOptions, LinearLine, MassCorrection, ModalLine,
    OverheadLine, PenaltyContact, PrescribedStrip, SlidingJoint, StaticLine, StaticsError, StripContact, WindOnLine,
    WindowedLine, adopt_state, follow_strips,
};
use contact::STRIP_VALUES;
use dynamics::{Continuity, Force, Layout, Marker, State, StepError, System};
use scene::{Catenary, ContactLaw, Correction, Reduction, Scene};

/// Errors of modelling or starting a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CatenaryError {
    /// The scene names a supplied line.
    #[error("the scene's line is a supplied FMU: there is nothing to model")]
    SuppliedLine,
    /// The scene's strips are held on the wire.
    #[error(
        "contact.law = \"sliding_joint\": line and pantograph are one system under it, for its contact force is the \
         multiplier of an equation with the coordinates of both: neither can be advanced without the other; \
         must be \"penalty\""
    )]
    SlidingJoint,
    /// The scene was read and its mesh not yet chosen.
    #[error(
        "catenary.mesh leaves elements or corrections to be chosen: a resolved scene is needed, such as the \
            scene.toml that a \
         run writes"
    )]
    OpenMesh,
    /// Values set since the scene was read contradict its mesh.
    #[error("catenary.mesh.corrections = \"{correction}\": must be left out: {obstacle}")]
    Correction {
        /// Correction that contradicts.
        correction: Correction,
        /// Reason.
        obstacle: String,
    },
    /// The static state was not found.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The line does not settle under its strips.
    #[error("the line does not settle under its strips: {0}")]
    Settling(#[from] StepError),
}

/// A line with strips that follow the system's inputs, [`STRIP_VALUES`] per strip.
pub struct Model {
    layout: Layout,
    /// The line.
    pub line: Box<dyn OverheadLine>,
    /// Contacts of each strip in turn with each contact wire in turn.
    pub contacts: Vec<ContactPair>,
}

impl Model {
    /// A line of any kind in its layout under prescribed strips, those of the scene.
    ///
    /// # Errors
    /// See [`CatenaryError::SuppliedLine`] and [`CatenaryError::SlidingJoint`].
    pub fn with_prescribed_strips(
        scene: &Scene,
        layout: Layout,
        line: Box<dyn OverheadLine>,
    ) -> Result<Self, CatenaryError> {
        let wires = line.contact_wires();
        let contacts = (0..scene.strip_count() * wires).map(|contact| {
            let (strip, wire) = (contact / wires, contact % wires);
            let first = strip * STRIP_VALUES;
            contact_pair(scene, &*line, (strip, wire), Box::new(PrescribedStrip { first }))
        });
        let contacts = contacts.collect::<Result<_, _>>()?;
        Ok(Self { layout, line, contacts })
    }

    /// Contacts of a strip (from 0) with each contact wire in turn.
    #[must_use]
    pub fn contacts_of(&self, strip: usize) -> &[ContactPair] {
        let wires = self.line.contact_wires();
        &self.contacts[strip * wires..(strip + 1) * wires]
    }
}

impl System for Model {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
        for contact in &mut self.contacts {
            visit(contact);
        }
    }

    fn follow(&mut self, state: &mut State, u: &[f64]) -> Continuity {
        follow_strips(&mut *self.line, &mut self.contacts, &mut self.layout, state, u)
    }

    fn adopt(&mut self, state: &State) -> Continuity {
        adopt_state(&mut *self.line, &mut self.contacts, &mut self.layout, state)
    }
}

/// Inputs of a static state: scenes with equal ones have the same static state, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticsInputs {
    catenary: Catenary,
    options: LineOptions,
    /// Spans that a window has together; nothing without a window.
    together: Option<usize>,
    /// `true` where wind acts on the wires, which belongs to the scene as a whole.
    in_wind: bool,
}

impl StaticsInputs {
    /// Inputs of a scene's line.
    ///
    /// # Errors
    /// See [`CatenaryError`].
    pub fn of(scene: &Scene) -> Result<Self, CatenaryError> {
        let (catenary, _) = scene.modelled_line().ok_or(CatenaryError::SuppliedLine)?;
        if let Some((correction, obstacle)) = crate::mesh::impossible_corrections(scene).into_iter().next() {
            return Err(CatenaryError::Correction { correction, obstacle });
        }
        let mesh = &catenary.mesh;
        if !mesh.is_given() {
            return Err(CatenaryError::OpenMesh);
        }
        let options = LineOptions {
            dimension: if scene.is_planar() {
                Dimension::Planar
            } else {
                Dimension::Spatial
            },
            layers: if mesh.has(Correction::BendingLayers) {
                BendingLayers::AtAttachments
            } else {
                BendingLayers::Absent
            },
            contact_compliance: mesh.has(Correction::ContactCompliance).then_some(mesh.contact_speed),
            mass_correction: mesh.has(Correction::MassCorrection).then(|| MassCorrection {
                steps: crate::mesh::corrected_steps(scene, catenary),
                rho_inf: scene.solver.rho_inf,
            }),
        };
        let windowed = scene.model.has(Reduction::Window);
        Ok(Self {
            catenary: catenary.clone(),
            options,
            together: windowed.then(|| WindowedLine::most_spans(scene, catenary)),
            in_wind: !windowed && WindOnLine::of_scene(scene).is_some(),
        })
    }

    /// `true` where a static state serves every scene with these inputs.
    #[must_use]
    pub fn can_be_shared(&self) -> bool {
        !self.in_wind
    }
}

/// The static state of a scene's line.
///
/// # Errors
/// See [`CatenaryError`].
pub fn static_line(scene: &Scene) -> Result<StaticLine, CatenaryError> {
    let inputs = StaticsInputs::of(scene)?;
    if let Some(together) = inputs.together {
        return Ok(StaticLine::solve_long(&inputs.catenary, inputs.options, together)?);
    }
    Ok(StaticLine::solve(&inputs.catenary, inputs.options)?.in_wind(WindOnLine::of_scene(scene)))
}

/// Line that a scene runs with, from a solved static state, its coordinates added to `layout`: all zero is the static
/// state.
///
/// Every mode uses this function, so that `model.reduce` means the same in each.
///
/// # Errors
/// See [`WindowedLine::new`] and [`ModalLine::new`].
pub fn scene_line(
    scene: &Scene,
    statics: &StaticLine,
    layout: &mut Layout,
) -> Result<Box<dyn OverheadLine>, CatenaryError> {
    if scene.model.has(Reduction::Window) {
        return Ok(Box::new(WindowedLine::new(scene, statics, layout)?));
    }
    if scene.model.has(Reduction::Modal) {
        return Ok(Box::new(ModalLine::new(scene, statics, layout)?));
    }
    if scene.model.has(Reduction::Flat) {
        return Ok(Box::new(LinearLine::flat(statics, layout)));
    }
    let mut line = statics.line_in(layout);
    if scene.model.has(Reduction::Linearised) {
        return Ok(Box::new(LinearLine::about(&mut line, layout)));
    }
    Ok(Box::new(line))
}

/// The contact of strip `index` (from 0, over all heads) of a scene, seen through `strip`, with contact wire `wire`
/// (from 0), under the scene's penalty law.
///
/// # Errors
/// See [`CatenaryError::SuppliedLine`] and [`CatenaryError::SlidingJoint`].
pub fn contact_pair(
    scene: &Scene,
    line: &dyn OverheadLine,
    (index, wire): (usize, usize),
    strip: Box<dyn Marker>,
) -> Result<ContactPair, CatenaryError> {
    let (_, contact) = scene.modelled_line().ok_or(CatenaryError::SuppliedLine)?;
    if contact.law == ContactLaw::SlidingJoint {
        return Err(CatenaryError::SlidingJoint);
    }
    let law = PenaltyContact {
        stiffness: contact.stiffness,
        damping: contact.damping,
    };
    // The width of a supplied strip is unknown and taken as infinite.
    let head = &scene.pantographs[scene.head_of(index).0];
    let width = head.strip_width().unwrap_or(f64::INFINITY);
    let curve = line.contact_curve((index, wire));
    Ok(ContactPair::new(law, curve, strip, width, tangent(scene)).with_horns(head.top()))
}

/// The contact of strip `index` (from 0, over all heads) of a scene, seen through `strip`, with contact wire `wire`
/// (from 0), under the scene's law; a joint adds its equation to `layout`, and its constraint is to be visited after
/// those that are there.
///
/// # Errors
/// See [`CatenaryError::SuppliedLine`].
pub fn strip_contact(
    scene: &Scene,
    line: &dyn OverheadLine,
    (index, wire): (usize, usize),
    strip: Box<dyn Marker>,
    layout: &mut Layout,
) -> Result<StripContact, CatenaryError> {
    let (_, contact) = scene.modelled_line().ok_or(CatenaryError::SuppliedLine)?;
    Ok(match contact.law {
        ContactLaw::Penalty => StripContact::Penalty(contact_pair(scene, line, (index, wire), strip)?),
        ContactLaw::SlidingJoint => {
            let multiplier = layout.add_constraints(1);
            let joint = SlidingJoint::new(line.contact_curve((index, wire)), strip, multiplier, tangent(scene));
            StripContact::SlidingJoint(joint)
        }
    })
}

fn tangent(scene: &Scene) -> ContactTangent {
    match scene.solver.jacobian {
        scene::Jacobian::Modified => ContactTangent::RankOne,
        scene::Jacobian::Full => ContactTangent::Exact,
    }
}
