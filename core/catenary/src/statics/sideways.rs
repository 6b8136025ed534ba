//! Lateral forces at the supports of a line whose wires do not move sideways.
use crate::{NodeOfWire, Topology, WireName};
use scene::Catenary;

/// Distance below which a node is at its support, m.
const ROUNDING: f64 = 1e-6;

/// A dropper that leans: its nodes, and the lateral force on the lower one, N.
pub(super) struct Leaning {
    pub upper: NodeOfWire,
    pub lower: NodeOfWire,
    pub force: f64,
}

/// Length of a bending layer, in spans, above which a wire is no string.
const STIFF: f64 = 0.05;

/// Lateral force by which a support holds the wire of a node at its place, N, to the left: what the tension pulls it
/// with where the wire turns, and the share by the lever rule of droppers that lean. None of a conductor rail, which is
/// a beam.
pub(super) fn held_sideways(
    (catenary, topology): (&Catenary, &Topology),
    leaning: &[Leaning],
    NodeOfWire { wire, node }: NodeOfWire,
) -> Option<f64> {
    let planned = &topology.wires()[wire];
    let section = catenary.section(planned.section);
    let x: Vec<f64> = section.supports_x().collect();
    let here = topology.x_of(NodeOfWire { wire, node });
    let support = x.partition_point(|&support| support < here - ROUNDING);
    let turn = section.turn_at(support, |support| match planned.name {
        WireName::ContactWire => section.stagger_at(support),
        WireName::MessengerWire | WireName::StitchWire => section.messenger_stagger_at(support),
    });
    let share = |at: NodeOfWire| {
        let own = topology.x_of(at);
        let next = if own < here {
            support.checked_sub(1)
        } else {
            Some(support + 1)
        };
        let next = next.and_then(|next| x.get(next));
        next.map_or(0.0, |next| (1.0 - (own - here) / (next - here)).max(0.0))
    };
    let pull = |dropper: &Leaning| {
        let of = |at: NodeOfWire, force: f64| if at.wire == wire { share(at) * force } else { 0.0 };
        of(dropper.lower, dropper.force) + of(dropper.upper, -dropper.force)
    };
    let wire = &planned.parameters;
    let shortest = section.span_lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let is_string = wire.bending_stiffness < wire.tension * (STIFF * shortest).powi(2);
    is_string.then(|| wire.tension * turn - leaning.iter().map(pull).sum::<f64>())
}
