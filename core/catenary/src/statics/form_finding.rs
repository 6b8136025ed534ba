//! Form finding: the shape and the lengths of a line whose contact wire is held at its heights.
use super::load::LateralPull;
use super::{StaticsError, options};
use crate::line::{EndsOfWire, Equilibrium, WireCoordinates, curve_pull, layers, wire};
use crate::{Attachment, DeadLoad, NodeOfWire, PlannedWire, Topology, Wire, WireGeometry, WireName, WireNode};
use dynamics::{Force, Layout, State, StaticSolver, System};
use nalgebra::Vector3;
use scene::Catenary;
use std::sync::Arc;

/// Largest distance of a node from its nominal x, m.
const TOLERANCE: f64 = 1e-10;
/// Most rounds of form finding; convergent lines need fewer than ten.
const MOST_ROUNDS: usize = 60;

/// Wires, each held at its prescribed places, with the droppers replaced by their forces.
struct Wires {
    layout: Layout,
    wires: Vec<Wire>,
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
///   wire at its supports; each has one end fixed and the nominal tension as horizontal force at the other; stitch
///   wires are clamped to the messenger wire;
/// - the force that holds the contact wire at a dropper is the dropper's, and hangs on the wire above;
/// - element lengths are corrected by nominal/found `Δx` until every node stands at its nominal x, those of a stitch
///   wire also until it has its tension;
/// - a dropper's unstressed length is its length less `F/k`; the forces at supports and arms become their preloads.
///
/// Returns the state and the number of Newton iterations.
pub(super) fn find_form(catenary: &Catenary, topology: &Topology) -> Result<(Equilibrium, usize), StaticsError> {
    let mut layout = Layout::new();
    let coordinates = topology.register(&mut layout);
    hold(topology, &coordinates, &mut layout);
    Topology::hold_directors(&coordinates, &mut layout);
    let planned = topology.wires();
    let first_guess = |(number, planned): (usize, &PlannedWire)| {
        let z = match planned.name {
            WireName::ContactWire => contact_wire_heights(catenary, topology, number),
            WireName::MessengerWire | WireName::StitchWire => messenger_wire_heights(catenary, planned),
        };
        let geometry = guess(catenary, topology, number, &coordinates[number], z);
        wire(catenary, planned, Arc::new(geometry))
    };
    let mut wires = Wires {
        wires: planned.iter().enumerate().map(first_guess).collect(),
        loads: DeadLoad::default(),
        lateral: LateralPull::default(),
        layout,
    };
    let options = options(200, topology);
    let half_weight = 0.5 * catenary.droppers.mass * catenary.gravity;
    let anchored = planned.iter().zip(&coordinates);
    let anchored = anchored.filter(|(planned, _)| planned.ends == EndsOfWire::Anchored);
    let tension_load: Vec<(usize, f64)> = anchored
        .map(|(planned, own)| (position(own, planned.last(), 0), planned.parameters.tension))
        .collect();
    let vertical = |at: NodeOfWire| position(&coordinates[at.wire], at.node, 2);
    let weights = topology
        .masses()
        .iter()
        .map(|&(at, mass)| (vertical(at), -mass * catenary.gravity));
    let pull = curve_pull(catenary, topology, |at| &coordinates[at.wire].nodes[at.node]);
    let dead: Vec<(usize, f64)> = tension_load.into_iter().chain(weights).chain(pull.entries).collect();
    let mut pulls = vec![Vector3::<f64>::zeros(); topology.droppers().len()];
    let mut solver = None;
    let mut iterations = 0;
    let mut distance = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        wires.loads.entries.clone_from(&dead);
        wires.lateral.ties.clear();
        for (place, pull) in topology.droppers().iter().zip(&pulls) {
            // The pull along the track ends at zero, with both ends at the same x; in earlier rounds it would only slow
            // the search down.
            wires.loads.entries.push((vertical(place.upper), -pull.z - half_weight));
            let [lower, upper] = [place.lower, place.upper]
                .map(|at| Attachment::node(&wires.wires[at.wire].geometry().nodes()[at.node]));
            let height = upper.reference.z - lower.reference.z;
            wires.lateral.ties.push((upper, lower, pull.z / height));
        }
        let mut state = wires.layout.state_at_rest();
        // Rounds differ in lengths and forces only.
        let solver = solver.get_or_insert_with(|| StaticSolver::new(&mut wires, &state.motion(&[])));
        iterations += solver.solve(&mut wires, &mut state, &[], &options)?.iterations;
        let mut force = vec![0.0; state.q.len()];
        wires.forces(&mut |part| part.add_force(&state.motion(&[]), &mut force));

        // Force of a dropper that gives its node the prescribed height, along the line to its upper end.
        let mut change = 0.0_f64;
        for (place, pull) in topology.droppers().iter().zip(&mut pulls) {
            let ends =
                [place.upper, place.lower].map(|at| wires.wires[at.wire].geometry().nodes()[at.node].at(&state.q).0);
            let between = ends[0] - ends[1];
            let vertical = half_weight - force[vertical(place.lower)];
            let next = Vector3::new(0.0, between.y, between.z) * (vertical / between.z);
            change = change.max((next - *pull).amax());
            *pull = next;
        }
        distance = 0.0;
        let mut off_tension = 0.0_f64;
        for (wire, planned) in wires.wires.iter_mut().zip(planned) {
            let excess = match planned.ends {
                EndsOfWire::Anchored => 0.0,
                EndsOfWire::Clamped(_) => horizontal_tension(wire, &state) - planned.parameters.tension,
            };
            off_tension = off_tension.max(excess.abs() / planned.parameters.tension);
            distance = distance.max(adjust(wire, planned, excess, &state.q));
        }
        let settled = change.max(off_tension * catenary.contact_wire.tension);
        if distance <= TOLERANCE && settled <= 1e-9 * catenary.contact_wire.tension {
            let reaction = |at: NodeOfWire| {
                let map = &coordinates[at.wire].nodes[at.node];
                Vector3::from_fn(|axis, _| match (axis, map.position(axis)) {
                    (0, _) | (_, None) => 0.0,
                    (_, Some(index)) => -force[index],
                })
            };
            let arm_weight = Vector3::z() * (catenary.registration_arms.mass * catenary.gravity);
            let mut equilibrium = Equilibrium {
                wires: wires
                    .wires
                    .iter()
                    .map(|wire| WireGeometry::clone(wire.geometry()))
                    .collect(),
                directors: Vec::new(),
                dropper_lengths: Vec::new(),
                support_reactions: topology.held_by_supports().map(reaction).collect(),
                arm_reactions: topology.held_by_arms().map(|at| reaction(at) + arm_weight).collect(),
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

/// Horizontal force in a wire at its first end, N.
fn horizontal_tension(wire: &Wire, state: &State) -> f64 {
    let mut force = vec![0.0; state.q.len()];
    wire.clone().add_force(&state.motion(&[]), &mut force);
    let first = wire.geometry().nodes()[0].map.position(0);
    first.map_or(0.0, |index| force[index])
}

fn position(wire: &WireCoordinates, node: usize, axis: usize) -> usize {
    wire.nodes[node].position(axis).expect("x and z exist in every node")
}

/// Holds the coordinates that form finding prescribes.
fn hold(topology: &Topology, coordinates: &[WireCoordinates], layout: &mut Layout) {
    let mut fix = |at: NodeOfWire, axis: usize| {
        if let Some(index) = coordinates[at.wire].nodes[at.node].position(axis) {
            layout.fix(index);
        }
    };
    for (wire, planned) in topology.wires().iter().enumerate() {
        if planned.ends == EndsOfWire::Anchored {
            fix(NodeOfWire { wire, node: 0 }, 0);
        }
    }
    for support in topology.support_places() {
        for &node in support.contact_wires.iter().chain(&support.messenger_wire) {
            fix(node, 1);
            fix(node, 2);
        }
    }
    for place in topology.droppers() {
        fix(place.lower, 2);
    }
}

/// Takes the found state as the reference and corrects each element's length by nominal/found `Δx`, and by the strain
/// of `excess` tension in N; returns the largest distance of a node from its nominal x, m.
fn adjust(wire: &mut Wire, planned: &PlannedWire, excess: f64, q: &[f64]) -> f64 {
    let geometry = wire.geometry();
    let found: Vec<f64> = geometry.nodes().iter().map(|node| node.at(q).0.x).collect();
    let distance = found
        .iter()
        .zip(&planned.x)
        .fold(0.0_f64, |max, (x, nominal)| max.max((x - nominal).abs()));
    let slack = 1.0 + excess / planned.parameters.axial_stiffness;
    let steps = found.windows(2).zip(planned.x.windows(2));
    let lengths = geometry.lengths().iter().zip(steps).map(|(length, (found, nominal))| {
        if distance <= TOLERANCE {
            return *length * slack;
        }
        length * (nominal[1] - nominal[0]) / (found[1] - found[0]) * slack
    });
    let lengths = lengths.collect();
    *wire = wire.with_geometry(Arc::new(geometry.with_reference(q).with_lengths(lengths)));
    distance
}

/// Heights of contact wire `wire`, m, straight from fastening to fastening.
fn contact_wire_heights(catenary: &Catenary, topology: &Topology, wire: usize) -> Vec<f64> {
    let planned = &topology.wires()[wire];
    let attached: Vec<usize> = planned.fastened().collect();
    let prescribed = |node: usize| topology.prescribed_height(catenary, NodeOfWire { wire, node });
    let height = |node: usize| {
        let right = attached.partition_point(|&other| other < node).max(1);
        let (a, b) = (attached[right - 1], attached[right]);
        let (z_a, z_b) = (prescribed(a), prescribed(b));
        z_a + (z_b - z_a) * (planned.x[node] - planned.x[a]) / (planned.x[b] - planned.x[a])
    };
    (0..=planned.last()).map(height).collect()
}

/// Heights of a messenger wire that carries contact wires and itself, m: a parabola from support to support.
fn messenger_wire_heights(catenary: &Catenary, planned: &PlannedWire) -> Vec<f64> {
    let Some(messenger) = &catenary.messenger_wire else {
        return Vec::new();
    };
    let contact = catenary.contact_wire.mass_per_length * catenary.contact_wire_offsets().len() as f64;
    let weight = (contact + messenger.mass_per_length) * catenary.gravity;
    let section = catenary.section(planned.section);
    let supports: Vec<f64> = section.supports_x().collect();
    let top = |support: usize| section.height_at(support) + section.encumbrance_at(support);
    let height = |&x: &f64| {
        let right = supports.partition_point(|&support| support < x).max(1);
        let (a, b) = (supports[right - 1], supports[right]);
        let chord = top(right - 1) + (top(right) - top(right - 1)) * (x - a) / (b - a);
        chord - weight * (x - a) * (b - x) / (2.0 * messenger.tension)
    };
    planned.x.iter().map(height).collect()
}

/// A wire through the nodes at heights `z`, with chords as element lengths and chord directions as slopes.
pub(super) fn guess(
    catenary: &Catenary,
    topology: &Topology,
    number: usize,
    wire: &WireCoordinates,
    z: Vec<f64>,
) -> WireGeometry {
    let planned = &topology.wires()[number];
    let point = |(node, &z): (usize, &f64)| {
        let lateral = topology.lateral(catenary, NodeOfWire { wire: number, node });
        Vector3::new(planned.x[node], lateral, z)
    };
    let points: Vec<Vector3<f64>> = z.iter().enumerate().map(point).collect();
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
    WireGeometry::new(nodes.collect(), lengths.collect(), layers(&planned.parameters, wire))
        .with_tension_shares(topology.tension_shares(number))
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
            let [upper, lower] =
                [place.upper, place.lower].map(|at| equilibrium.wires[at.wire].nodes()[at.node].position);
            let between = upper - lower;
            let (span, dropper, x) = (place.span, place.position + 1, topology.x_of(place.lower));
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
