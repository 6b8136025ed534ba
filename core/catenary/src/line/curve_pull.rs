//! Pull of curved track on the wires.
use super::topology::{NodeOfWire, Topology};
use crate::{DeadLoad, NodeMap};
use scene::Catenary;

/// Lateral load of wires along a curve, in the developed coordinates of the track:
///
/// ```text
/// q = T κ(x)        per length, towards the middle of the curve
/// ```
///
/// `T` is the nominal tension: a wire under tension in a curve is pulled towards the middle, `T y″ + T κ = 0`, so that
/// between supports it lies on the chord, `y = κ x (L − x)/2`. The load is consistent with the cubic elements for a
/// curvature that is linear along each. Derived here.
pub(crate) fn curve_pull<'a>(
    catenary: &Catenary,
    topology: &Topology,
    map: impl Fn(NodeOfWire) -> &'a NodeMap,
) -> DeadLoad {
    let mut load = DeadLoad::default();
    if !catenary.is_curved() {
        return load;
    }
    for (wire, planned) in topology.wires().iter().enumerate() {
        let tension = planned.parameters.tension;
        for node in 0..planned.last() {
            let ends = [NodeOfWire { wire, node }, NodeOfWire { wire, node: node + 1 }];
            let [a, b] = ends.map(|end| tension * topology.curvature(catenary, end));
            let length = planned.x[node + 1] - planned.x[node];
            let (position, slope) = (length / 20.0, length * length / 60.0);
            let loads = [
                [position * (7.0 * a + 3.0 * b), slope * (3.0 * a + 2.0 * b)],
                [position * (3.0 * a + 7.0 * b), -slope * (2.0 * a + 3.0 * b)],
            ];
            for (end, [force, moment]) in ends.into_iter().zip(loads) {
                let map = map(end);
                load.entries.extend(map.position(1).map(|index| (index, force)));
                load.entries.extend(map.slope(1).map(|index| (index, moment)));
            }
        }
    }
    load
}
