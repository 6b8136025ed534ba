//! Form finding: the shape and the lengths of a line whose contact wire is held at its heights.
use super::load::{DeadLoad, LateralPull};
use super::{StaticsError, options};
use crate::line::WireCoordinates;
use crate::line::{Equilibrium, layers, wire};
use crate::{Attachment, Topology, Wire, WireGeometry, WireName, WireNode};
use dynamics::{Force, Layout, System, solve_static};
use nalgebra::Vector3;
use scene::Catenary;
use std::sync::Arc;

/// Largest distance of a node from its nominal x, m.
const TOLERANCE: f64 = 1e-10;
/// Most rounds of form finding; convergent lines need fewer than ten.
const MOST_ROUNDS: usize = 60;

/// Both wires, each held at its prescribed places, with the droppers replaced by their forces.
struct Wires {
    layout: Layout,
    wires: [Wire; 2],
    loads: DeadLoad,
    lateral: LateralPull,
}

impl System for Wires {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        for wire in &mut self.wires {
            visit(wire);
        }
        visit(&mut self.loads);
        visit(&mut self.lateral);
    }
}

/// Finds the form of a line:
///
/// - the contact wire is held at its prescribed heights at droppers and supports (laterally at supports), the messenger
///   wire at its supports; each wire has one end fixed and the nominal tension as horizontal force at the other;
/// - the force that holds the contact wire at a dropper is the dropper's, and hangs on the messenger wire;
/// - element lengths are corrected by nominal/found `Δx` until every node stands at its nominal x;
/// - a dropper's unstressed length is its length less `F/k`; the forces at supports and arms become their preloads.
///
/// Returns the state and the number of Newton iterations.
pub(super) fn find_form(catenary: &Catenary, topology: &Topology) -> Result<(Equilibrium, usize), StaticsError> {
    let mut layout = Layout::new();
    let coordinates = topology.register(&mut layout);
    hold(topology, &coordinates, &mut layout);
    Topology::hold_directors(&coordinates, &mut layout);
    let [contact, messenger] = &coordinates;
    let mut wires = Wires {
        wires: [
            wire(
                catenary,
                WireName::ContactWire,
                Arc::new(contact_wire_guess(catenary, topology, contact)),
            ),
            wire(
                catenary,
                WireName::MessengerWire,
                Arc::new(messenger_wire_guess(catenary, topology, messenger)),
            ),
        ],
        loads: DeadLoad::default(),
        lateral: LateralPull::default(),
        layout,
    };
    let options = options(200);
    let half_weight = 0.5 * catenary.droppers.mass * catenary.gravity;
    let tension_load = [
        (position(contact, topology.last(), 0), catenary.contact_wire.tension),
        (position(messenger, topology.last(), 0), catenary.messenger_wire.tension),
    ];
    let mut pulls = vec![Vector3::<f64>::zeros(); topology.droppers().len()];
    let mut iterations = 0;
    let mut distance = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        wires.loads.entries = tension_load.to_vec();
        wires.lateral.ties.clear();
        for (place, pull) in topology.droppers().iter().zip(&pulls) {
            // The pull along the track ends at zero, with both ends at the same x; in earlier rounds it would only slow
            // the search down.
            let hanging = position(messenger, place.node, 2);
            wires.loads.entries.push((hanging, -pull.z - half_weight));
            let [lower, upper] = [0, 1].map(|wire| Attachment::node(&wires.wires[wire].geometry().nodes()[place.node]));
            let height = upper.reference.z - lower.reference.z;
            wires.lateral.ties.push((upper, lower, pull.z / height));
        }
        let mut state = wires.layout.state_at_rest();
        iterations += solve_static(&mut wires, &mut state, &[], &options)?.iterations;
        let mut force = vec![0.0; state.q.len()];
        wires.forces(&mut |part| part.add_force(&state.motion(&[]), &mut force));

        // Force of a dropper that gives its node the prescribed height, along the line to its upper end.
        let mut change = 0.0_f64;
        for (place, pull) in topology.droppers().iter().zip(&mut pulls) {
            let ends =
                [&wires.wires[1], &wires.wires[0]].map(|wire| wire.geometry().nodes()[place.node].at(&state.q).0);
            let between = ends[0] - ends[1];
            let vertical = half_weight - force[position(contact, place.node, 2)];
            let next = Vector3::new(0.0, between.y, between.z) * (vertical / between.z);
            change = change.max((next - *pull).amax());
            *pull = next;
        }
        distance = 0.0;
        for wire in &mut wires.wires {
            distance = distance.max(adjust(wire, topology, &state.q));
        }
        if distance <= TOLERANCE && change <= 1e-9 * catenary.contact_wire.tension {
            let reaction = |wire: &WireCoordinates, node: usize| {
                Vector3::from_fn(|axis, _| match (axis, wire.nodes[node].position(axis)) {
                    (0, _) | (_, None) => 0.0,
                    (_, Some(index)) => -force[index],
                })
            };
            let arm_weight = Vector3::z() * (catenary.registration_arms.mass * catenary.gravity);
            let [contact_wire, messenger_wire] = &wires.wires;
            let mut equilibrium = Equilibrium {
                contact_wire: WireGeometry::clone(contact_wire.geometry()),
                messenger_wire: WireGeometry::clone(messenger_wire.geometry()),
                directors: Vec::new(),
                dropper_lengths: Vec::new(),
                support_reactions: topology
                    .inner_supports()
                    .map(|(_, node)| reaction(messenger, node))
                    .collect(),
                arm_reactions: topology
                    .inner_supports()
                    .map(|(_, node)| reaction(contact, node) + arm_weight)
                    .collect(),
            };
            equilibrium.dropper_lengths = dropper_lengths(catenary, topology, &equilibrium, &pulls)?;
            return Ok((equilibrium, iterations));
        }
    }
    Err(StaticsError::FormNotFound {
        iterations: MOST_ROUNDS,
        distance,
        tolerance: TOLERANCE,
    })
}

fn position(wire: &WireCoordinates, node: usize, axis: usize) -> usize {
    wire.nodes[node].position(axis).expect("x and z exist in every node")
}

/// Holds the coordinates that form finding prescribes.
fn hold(topology: &Topology, [contact, messenger]: &[WireCoordinates; 2], layout: &mut Layout) {
    let mut fix = |wire: &WireCoordinates, node: usize, axis: usize| {
        if let Some(index) = wire.nodes[node].position(axis) {
            layout.fix(index);
        }
    };
    for wire in [contact, messenger] {
        fix(wire, 0, 0);
        for &node in topology.supports() {
            fix(wire, node, 1);
            fix(wire, node, 2);
        }
    }
    for place in topology.droppers() {
        fix(contact, place.node, 2);
    }
}

/// Takes the found state as the reference and corrects each element's length by nominal/found `Δx`; returns the largest
/// distance of a node from its nominal x, m.
fn adjust(wire: &mut Wire, topology: &Topology, q: &[f64]) -> f64 {
    let geometry = wire.geometry();
    let found: Vec<f64> = geometry.nodes().iter().map(|node| node.at(q).0.x).collect();
    let distance = found
        .iter()
        .zip(topology.x())
        .fold(0.0_f64, |max, (x, nominal)| max.max((x - nominal).abs()));
    let steps = found.windows(2).zip(topology.x().windows(2));
    let lengths = geometry.lengths().iter().zip(steps).map(|(length, (found, nominal))| {
        if distance <= TOLERANCE {
            return *length;
        }
        length * (nominal[1] - nominal[0]) / (found[1] - found[0])
    });
    let lengths = lengths.collect();
    *wire = wire.with_geometry(Arc::new(geometry.with_reference(q).with_lengths(lengths)));
    distance
}

fn contact_wire_guess(catenary: &Catenary, topology: &Topology, wire: &WireCoordinates) -> WireGeometry {
    // Straight from attachment to attachment.
    let attached: Vec<usize> = {
        let mut nodes: Vec<usize> = topology.supports().to_vec();
        nodes.extend(topology.droppers().iter().map(|place| place.node));
        nodes.sort_unstable();
        nodes
    };
    let z = (0..=topology.last()).map(|node| {
        let right = attached.partition_point(|&other| other < node).max(1);
        let (a, b) = (attached[right - 1], attached[right]);
        let (z_a, z_b) = (
            topology.prescribed_height(catenary, a),
            topology.prescribed_height(catenary, b),
        );
        z_a + (z_b - z_a) * (topology.x()[node] - topology.x()[a]) / (topology.x()[b] - topology.x()[a])
    });
    guess(catenary, topology, wire, &catenary.contact_wire, z.collect())
}

fn messenger_wire_guess(catenary: &Catenary, topology: &Topology, wire: &WireCoordinates) -> WireGeometry {
    let weight = (catenary.contact_wire.mass_per_length + catenary.messenger_wire.mass_per_length) * catenary.gravity;
    let top = catenary.contact_wire_height + catenary.encumbrance;
    let z = topology.x().iter().map(|&x| {
        let right = topology
            .supports()
            .partition_point(|&node| topology.x()[node] < x)
            .max(1);
        let (a, b) = (
            topology.x()[topology.supports()[right - 1]],
            topology.x()[topology.supports()[right]],
        );
        top - weight * (x - a) * (b - x) / (2.0 * catenary.messenger_wire.tension)
    });
    guess(catenary, topology, wire, &catenary.messenger_wire, z.collect())
}

/// A wire through the nodes at heights `z`, with chords as element lengths and chord directions as slopes.
pub(super) fn guess(
    catenary: &Catenary,
    topology: &Topology,
    wire: &WireCoordinates,
    parameters: &scene::Wire,
    z: Vec<f64>,
) -> WireGeometry {
    let points: Vec<Vector3<f64>> = z
        .iter()
        .enumerate()
        .map(|(node, &z)| Vector3::new(topology.x()[node], topology.lateral(catenary, node), z))
        .collect();
    let chords: Vec<Vector3<f64>> = points.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let nodes = points.iter().enumerate().map(|(i, &position)| {
        let (before, after) = (chords[i.saturating_sub(1)], chords[i.min(chords.len() - 1)]);
        WireNode {
            position,
            slope: (before.normalize() + after.normalize()).normalize(),
            map: wire.nodes[i],
        }
    });
    let lengths = chords.iter().map(|chord| chord.norm());
    WireGeometry::new(nodes.collect(), lengths.collect(), layers(parameters, wire))
}

fn dropper_lengths(
    catenary: &Catenary,
    topology: &Topology,
    equilibrium: &Equilibrium,
    pulls: &[Vector3<f64>],
) -> Result<Vec<f64>, StaticsError> {
    let places = topology.droppers().iter().zip(pulls);
    places
        .map(|(place, pull)| {
            let between = equilibrium.messenger_wire.nodes()[place.node].position
                - equilibrium.contact_wire.nodes()[place.node].position;
            let (span, dropper, x) = (place.span, place.position + 1, topology.x()[place.node]);
            if between.z <= 0.0 {
                let length = between.z;
                return Err(StaticsError::NoRoomForDropper {
                    span,
                    dropper,
                    x,
                    length,
                });
            }
            if pull.z <= 0.0 {
                let force = pull.norm();
                return Err(StaticsError::DropperPushes {
                    span,
                    dropper,
                    x,
                    force,
                });
            }
            let length = between.norm() - pull.norm() / catenary.droppers.stiffness;
            if length <= 0.0 {
                return Err(StaticsError::NoRoomForDropper {
                    span,
                    dropper,
                    x,
                    length,
                });
            }
            Ok(length)
        })
        .collect()
}
