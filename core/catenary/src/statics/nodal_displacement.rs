//! Tension by nodal displacement [Thesis, 3.2]: straight wires, stretched, then sagging under gravity.
use super::form_finding::guess;
use super::{Standalone, StaticsError, options};
use crate::line::Equilibrium;
use crate::{Anchor, Line, PlannedWire, Topology, WireName};
use dynamics::{Layout, State, StaticSolver};
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
    let line = catenary.first();
    let arm_weight = Vector3::z() * (catenary.registration_arms.mass * catenary.gravity);
    let straight = |(number, planned): (usize, &PlannedWire)| {
        let height = |support: usize| match planned.name {
            WireName::ContactWire => line.height_at(support),
            WireName::MessengerWire | WireName::StitchWire => line.height_at(support) + line.encumbrance_at(support),
        };
        let z = planned.x.iter().map(|&x| {
            let (left, right, xi) = between_supports(catenary, x);
            height(left) + (height(right) - height(left)) * xi
        });
        guess(catenary, topology, number, &coordinates[number], z.collect())
    };
    let start = Equilibrium {
        wires: topology.wires().iter().enumerate().map(straight).collect(),
        directors: Vec::new(),
        dropper_lengths: topology
            .droppers()
            .iter()
            .map(|place| match line.dropper_lengths_of(place.span - 1) {
                Some(lengths) => lengths[place.position],
                None => {
                    let (left, right, xi) = between_supports(catenary, topology.x()[place.lower.node]);
                    let (a, b) = (line.encumbrance_at(left), line.encumbrance_at(right));
                    a + (b - a) * xi
                }
            })
            .collect(),
        support_reactions: topology.held_by_supports().map(|_| Vector3::zeros()).collect(),
        arm_reactions: topology.held_by_arms().map(|_| arm_weight).collect(),
    };
    let system = Standalone {
        line: Line::new(catenary, topology, &start, 0),
        layout,
        load: Default::default(),
    };
    let mut state = system.layout.state_at_rest();
    // Start from the parabola of both wires together: the messenger wire is held at every support.
    let wires = topology.wires().iter().map(|planned| &planned.parameters);
    let weight = wires.clone().map(|wire| wire.mass_per_length).sum::<f64>() * catenary.gravity;
    let tension: f64 = wires.map(|wire| wire.tension).sum();
    for (wire, planned) in coordinates.iter().zip(topology.wires()) {
        for (map, &x) in wire.nodes.iter().zip(&planned.x) {
            let (left, right, _) = between_supports(catenary, x);
            let (a, b) = (catenary.support_x(left), catenary.support_x(right));
            if let (Some(z), Some(z_s)) = (map.position(2), map.slope(2)) {
                state.q[z] = -weight * (x - a) * (b - x) / (2.0 * tension);
                state.q[z_s] = -weight * (a + b - 2.0 * x) / (2.0 * tension);
            }
        }
    }
    let line = |equilibrium: &Equilibrium| Line::new(catenary, topology, equilibrium, 0);
    settle(topology, &start, system, state, &line)
}

/// Lets a line come to rest from `state`: its equilibrium, and the number of Newton iterations.
///
/// The first round finds the state; further rounds, with the found state as the reference, remove the small forces of
/// the springs at sliding ends. `line` makes the line of an equilibrium.
pub(super) fn settle(
    topology: &Topology,
    start: &Equilibrium,
    mut system: Standalone,
    mut state: State,
    line: &dyn Fn(&Equilibrium) -> Line,
) -> Result<(Equilibrium, usize), StaticsError> {
    let options = options(500, topology);
    let mut equilibrium = start.clone();
    let mut iterations = 0;
    let mut solver = StaticSolver::new(&mut system, &state.motion(&[]));
    for _ in 0..MOST_ROUNDS {
        iterations += solver.solve(&mut system, &mut state, &[], &options)?.iterations;
        let moved = state.q.iter().fold(0.0_f64, |max, q| max.max(q.abs()));
        equilibrium = taken_as_reference(&equilibrium, &system.line, &state);
        system.line = line(&equilibrium);
        state = system.layout.state_at_rest();
        if moved < SETTLED {
            break;
        }
    }
    Ok((equilibrium, iterations))
}

/// Supports (from 0) on either side of `x` (m), and the position between them, 0…1.
fn between_supports(catenary: &Catenary, x: f64) -> (usize, usize, f64) {
    let supports = catenary.supports_x();
    let right = supports.partition_point(|&support| support < x).max(1);
    let (a, b) = (supports[right - 1], supports[right]);
    (right - 1, right, (x - a) / (b - a))
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
        wires: before.wires.iter().map(|wire| wire.with_reference(&state.q)).collect(),
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
