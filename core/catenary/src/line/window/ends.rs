//! Supports, true ends and absorbing ends of the spans beyond the window.
use super::far::Ground;
use super::places::SpanPlaces;
use super::plan::Arrangement;
use super::{Fixed, SPONGE};
use crate::support::HOLDING_STIFFNESS;
use crate::{Dimension, NodeOfWire, PlannedWire, WireName};
use scene::WireEnds;

/// Coordinates that are held at the end of a wire, and that along the track where the tension is constant; `end` has
/// the positions first.
pub(super) fn held_at_end(end: &[usize], wire_ends: WireEnds) -> (&[usize], Option<usize>) {
    let positions = &end[..end.len() / 2];
    match wire_ends {
        WireEnds::Fixed => (positions, None),
        WireEnds::ConstantTension => (&positions[1..], Some(positions[0])),
    }
}

impl Fixed {
    /// Place of the vertical displacement among the coordinates of a node.
    pub(super) fn vertical(&self) -> usize {
        if self.topology.options().dimension == Dimension::Planar {
            1
        } else {
            2
        }
    }

    /// Damping added to the modes of a reduced span, 1/s: only on a side where the line goes on unmodelled.
    pub(super) fn sponge(&self, arrangement: &Arrangement, span: usize) -> f64 {
        let (plan, modelled) = (&self.plan, &arrangement.modelled);
        let goes_on = if span < arrangement.window.start {
            modelled.start > 0
        } else {
            modelled.end < plan.spans
        };
        let beyond = arrangement.distance(span).saturating_sub(plan.near);
        if goes_on {
            SPONGE * (beyond as f64 / plan.reach as f64).powi(2)
        } else {
            0.0
        }
    }

    /// Holds a wire that ends at a mast which others pass, with these coordinates at its end.
    pub(super) fn hold_inner_end(&self, end: &[usize], grounds: &mut Vec<Ground>, held: &mut Vec<usize>) {
        let (fixed, along) = held_at_end(end, self.catenary.wire_ends);
        held.extend(fixed);
        grounds.extend(along.map(|index| Ground {
            index,
            stiffness: HOLDING_STIFFNESS,
            ..Ground::default()
        }));
    }

    /// Holds a support by its springs, or an end of the modelled line.
    pub(super) fn hold(
        &self,
        (arrangement, places): (&Arrangement, &SpanPlaces),
        support: usize,
        grounds: &mut Vec<Ground>,
        held: &mut Vec<usize>,
    ) {
        let Some(places) = arrangement.support(places, support) else {
            return;
        };
        let places: Vec<usize> = places.collect();
        let nodes: Vec<NodeOfWire> = self.nodes_at(support).collect();
        let per_node = places.len() / nodes.len();
        let wires: Vec<(&[usize], &PlannedWire)> = nodes
            .iter()
            .zip(places.chunks_exact(per_node))
            .map(|(at, node)| (node, &self.topology.wires()[at.wire]))
            .collect();
        let vertical = self.vertical();
        let transverse = 1..=vertical;
        let catenary = &self.catenary;
        let true_end = support == 0 || support == self.plan.spans;
        let cut = support == arrangement.modelled.start || support == arrangement.modelled.end;
        if true_end || cut {
            held.extend(
                wires
                    .iter()
                    .flat_map(|(node, _)| node[transverse.clone()].iter().copied()),
            );
        }
        if true_end {
            for (node, _) in wires {
                match catenary.wire_ends {
                    WireEnds::Fixed => held.push(node[0]),
                    WireEnds::ConstantTension => grounds.push(Ground {
                        index: node[0],
                        stiffness: HOLDING_STIFFNESS,
                        ..Ground::default()
                    }),
                }
            }
        } else if cut {
            for (node, planned) in wires {
                let wire = &planned.parameters;
                grounds.push(Ground {
                    index: node[0],
                    stiffness: HOLDING_STIFFNESS,
                    damping: (wire.axial_stiffness * wire.mass_per_length).sqrt(),
                    mass: 0.0,
                });
            }
        } else {
            let (springs, arm) = (&catenary.supports, &catenary.registration_arms);
            let mut ground = |index: usize, stiffness: f64, mass: f64| {
                grounds.push(Ground {
                    index,
                    stiffness,
                    damping: 0.0,
                    mass,
                });
            };
            let of = |name: WireName| wires.iter().filter(move |(_, planned)| planned.name == name);
            for (messenger, _) in of(WireName::MessengerWire) {
                ground(messenger[0], springs.messenger_longitudinal_stiffness, 0.0);
                ground(messenger[vertical], springs.messenger_vertical_stiffness, 0.0);
                if vertical == 2 {
                    ground(messenger[1], springs.messenger_lateral_stiffness, 0.0);
                }
            }
            for (contact, _) in of(WireName::ContactWire) {
                ground(contact[0], 0.0, arm.mass);
                ground(contact[vertical], arm.vertical_stiffness, arm.mass);
                if vertical == 2 {
                    ground(contact[1], arm.lateral_stiffness, arm.mass);
                }
            }
            for (at, (node, _)) in nodes.iter().zip(&wires) {
                let here = self.topology.masses().iter().filter(|(place, _)| place == at);
                for (_, mass) in here {
                    node[..=vertical].iter().for_each(|&index| ground(index, 0.0, *mass));
                }
            }
        }
    }
}
