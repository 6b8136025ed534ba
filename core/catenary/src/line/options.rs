//! Discretisation of a line beyond the mesh of the scene.
use super::topology::WireName;
use mesh::CorrectedSteps;

/// Coordinates of the nodes of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dimension {
    /// Six coordinates per node.
    #[default]
    Spatial,
    /// Four coordinates per node, none of them lateral: for lines in which nothing moves sideways.
    Planar,
}

/// Unknowns for the bending layers at the attachments of the wires, see [`crate::Enrichment`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BendingLayers {
    /// Cubic elements only.
    #[default]
    Absent,
    /// One vertical layer per attachment and wire, and a lateral one at the supports of a line with lateral
    /// coordinates.
    AtAttachments,
    /// [`BendingLayers::AtAttachments`] and a layer at each end: the end of a section whose wires go on has half of the
    /// layer there. `ψ` and its slope vanish at the node, so that each half is a layer of its own.
    AtAttachmentsAndEnds,
}

/// A mass matrix for a time step, see [`crate::Line::with_mass_correction`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassCorrection {
    /// Internal step of the integrator, or the longest one that a wire can be corrected for, s.
    pub steps: CorrectedSteps,
    /// Spectral radius of the integrator at infinite frequency, –.
    pub rho_inf: f64,
}

/// Discretisation of a line beyond the mesh of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineOptions {
    /// Coordinates per node.
    pub dimension: Dimension,
    /// Extra unknowns at attachments.
    pub layers: BendingLayers,
    /// Speed of the strips for which the contact wire has its residual compliance, m/s, see
    /// [`crate::ResidualCompliance`]. Statics use the compliance of a strip at rest, except for the start of a run.
    pub contact_compliance: Option<f64>,
    /// Corrected inertia of the wires; without effect on statics.
    pub mass_correction: Option<MassCorrection>,
}

impl MassCorrection {
    /// Step of a kind of wire, s.
    #[must_use]
    pub fn step_of(&self, name: WireName) -> f64 {
        match name {
            WireName::ContactWire => self.steps.contact_wire,
            WireName::MessengerWire => self.steps.messenger_wire,
            WireName::StitchWire => self.steps.stitch_wire,
        }
    }
}
