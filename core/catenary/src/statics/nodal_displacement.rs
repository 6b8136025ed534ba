//! Tension by nodal displacement [Thesis, 3.2]: straight wires, stretched, then sagging under gravity.
use super::form_finding::guess;
use super::{Standalone, StaticsError, options};
use crate::line::Equilibrium;
use crate::{Anchor, Line, Topology};
use dynamics::{Layout, State, solve_static};
use nalgebra::Vector3;
use scene::Catenary;
use std::sync::Arc;

/// Stretches straight wires and lets them sag.
///
/// Element lengths give the straight wire between its fixed ends the nominal tension: the ends have been moved apart
/// from the natural length. Supports and arms stand at the straight wires, unloaded but for the arms' own weight;
/// droppers have their given unstressed lengths, else the distance of the straight wires. Then gravity is turned on.
///
/// Returns the static state and the number of Newton iterations.
pub(super) fn displace_ends(
    catenary: &Catenary,
    topology: &Arc<Topology>,
) -> Result<(Equilibrium, usize), StaticsError> {
    let mut layout = Layout::new();
    let coordinates = topology.register(&mut layout);
    topology.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
    Topology::hold_directors(&coordinates, &mut layout);
    let [contact, messenger] = &coordinates;
    let straight = |z: f64| vec![z; topology.x().len()];
    let low = catenary.contact_wire_height;
    let arm_weight = Vector3::z() * (catenary.registration_arms.mass * catenary.gravity);
    let start = Equilibrium {
        contact_wire: guess(catenary, topology, contact, &catenary.contact_wire, straight(low)),
        messenger_wire: guess(
            catenary,
            topology,
            messenger,
            &catenary.messenger_wire,
            straight(low + catenary.encumbrance),
        ),
        directors: Vec::new(),
        dropper_lengths: topology
            .droppers()
            .iter()
            .map(|place| match &catenary.droppers.lengths {
                Some(lengths) => lengths[place.position],
                None => catenary.encumbrance,
            })
            .collect(),
        support_reactions: topology.inner_supports().map(|_| Vector3::zeros()).collect(),
        arm_reactions: topology.inner_supports().map(|_| arm_weight).collect(),
    };
    let mut system = Standalone {
        line: Line::new(catenary, topology, &start, 0),
        layout,
        load: Default::default(),
    };
    let mut state = system.layout.state_at_rest();
    let options = options(500);
    // Start from the parabola of both wires together: the messenger wire is held at every support.
    let weight = (catenary.contact_wire.mass_per_length + catenary.messenger_wire.mass_per_length) * catenary.gravity;
    let tension = catenary.contact_wire.tension + catenary.messenger_wire.tension;
    for wire in &coordinates {
        for (map, &x) in wire.nodes.iter().zip(topology.x()) {
            let right = topology
                .supports()
                .partition_point(|&node| topology.x()[node] < x)
                .max(1);
            let a = topology.x()[topology.supports()[right - 1]];
            let b = topology.x()[topology.supports()[right]];
            if let (Some(z), Some(z_s)) = (map.position(2), map.slope(2)) {
                state.q[z] = -weight * (x - a) * (b - x) / (2.0 * tension);
                state.q[z_s] = -weight * (a + b - 2.0 * x) / (2.0 * tension);
            }
        }
    }
    let mut equilibrium = start;
    let mut iterations = 0;
    // The first round finds the state; further rounds, with the found state as the reference, remove the small forces
    // of the springs at sliding ends.
    for _ in 0..MOST_ROUNDS {
        iterations += solve_static(&mut system, &mut state, &[], &options)?.iterations;
        let moved = state.q.iter().fold(0.0_f64, |max, q| max.max(q.abs()));
        equilibrium = taken_as_reference(&equilibrium, &system.line, &state);
        system.line = Line::new(catenary, topology, &equilibrium, 0);
        state = system.layout.state_at_rest();
        if moved < SETTLED {
            break;
        }
    }
    Ok((equilibrium, iterations))
}

/// Rounds after which the springs at sliding ends are taken as unloaded; each round reduces their force to about a
/// thousandth.
const MOST_ROUNDS: usize = 8;
/// Smallest motion between two rounds that asks for another round, m.
const SETTLED: f64 = 1e-9;

/// The state of a line as its reference.
pub(super) fn taken_as_reference(before: &Equilibrium, line: &Line, state: &State) -> Equilibrium {
    let motion = state.motion(&[]);
    let forces = |anchors: &[Anchor]| anchors.iter().map(|anchor| anchor.force(&motion)).collect();
    Equilibrium {
        contact_wire: before.contact_wire.with_reference(&state.q),
        messenger_wire: before.messenger_wire.with_reference(&state.q),
        directors: before
            .directors
            .iter()
            .map(|directors| directors.with_reference(&state.q))
            .collect(),
        dropper_lengths: before.dropper_lengths.clone(),
        support_reactions: forces(line.supports().as_slice()),
        arm_reactions: forces(line.registration_arms().as_slice()),
    }
}
