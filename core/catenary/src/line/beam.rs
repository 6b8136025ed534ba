//! The contact wire of a scene as a beam.
use crate::{BeamSection, BeamStiffness, DirectorInertia, Directors, WireDirectors, WireGeometry};
use scene::Catenary;

/// The directors of the contact wire: round, so that it bends alike in all directions, with the material's own
/// stiffness of the cross-section.
pub(super) fn contact_wire_directors(
    catenary: &Catenary,
    beam: &scene::Beam,
    geometry: &WireGeometry,
    directors: &[Directors],
) -> WireDirectors {
    let wire = &catenary.contact_wire;
    let stiffness = BeamStiffness {
        axial: wire.axial_stiffness,
        shear: [beam.shear_stiffness; 2],
        torsion: beam.torsional_stiffness,
        bending: [wire.bending_stiffness; 2],
        section: [wire.axial_stiffness, wire.axial_stiffness, beam.shear_stiffness],
    };
    let inertia = DirectorInertia {
        section: beam.rotary_inertia,
        alpha: catenary.damping.alpha,
        beta: catenary.damping.beta,
    };
    WireDirectors::new(geometry, directors, inertia, |length| {
        BeamSection::new(&stiffness, length)
    })
}
