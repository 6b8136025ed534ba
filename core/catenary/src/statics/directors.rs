//! The static state of a line whose contact wire is a beam, from that of the same line of cables.
use super::nodal_displacement::taken_as_reference;
use super::{Standalone, StaticsError, options};
use crate::line::Equilibrium;
use crate::{Directors, Line, Topology};
use dynamics::{Layout, solve_static};
use scene::Catenary;
use std::sync::Arc;

/// Gives the contact wire its directors, across the cable, and lets the line settle: the lengths of wires and droppers
/// stay, and shear adds to the deflection by bending. Returns the number of Newton iterations.
pub(super) fn turn_into_beam(
    catenary: &Catenary,
    topology: &Arc<Topology>,
    equilibrium: &mut Equilibrium,
) -> Result<usize, StaticsError> {
    let mut layout = Layout::new();
    let coordinates = topology.register(&mut layout);
    topology.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
    let nodes = equilibrium.wires[0].nodes().iter();
    equilibrium.directors = nodes
        .zip(&coordinates[0].directors)
        .map(|(node, &first)| Directors::across(&node.slope, first))
        .collect();
    let mut system = Standalone {
        line: Line::new(catenary, topology, equilibrium, 0),
        layout,
        load: Default::default(),
    };
    let mut state = system.layout.state_at_rest();
    let options = options(200, topology);
    let report = solve_static(&mut system, &mut state, &[], &options)?;
    *equilibrium = taken_as_reference(equilibrium, &system.line, &state);
    Ok(report.iterations)
}
