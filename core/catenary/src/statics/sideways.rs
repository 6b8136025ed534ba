//! Lateral forces at the supports of a line whose wires do not move sideways.
use crate::{NodeOfWire, Topology};
use scene::Catenary;

/// Length of a bending layer, in spans, above which a wire is no string.
const STIFF: f64 = 0.05;

/// Turns of the wires of a line and droppers that lean, which lead the wires aside.
pub(super) struct Sideways<'a> {
    catenary: &'a Catenary,
    topology: &'a Topology,
    /// Lateral force of each dropper on its lower node, N.
    leaning: Vec<f64>,
}

impl<'a> Sideways<'a> {
    /// Those of a line whose droppers pull their lower nodes sideways by the forces `leaning`, N; none where nothing
    /// leads its wires aside.
    pub fn new(catenary: &'a Catenary, topology: &'a Topology, leaning: impl Iterator<Item = f64>) -> Option<Self> {
        (catenary.is_staggered() || catenary.is_curved()).then(|| Self {
            catenary,
            topology,
            leaning: leaning.collect(),
        })
    }

    /// Lateral force by which a support holds the wire of a node at its place, N, to the left: what the tension pulls
    /// it with where the wire turns, and the share by the lever rule of droppers that lean. None of a conductor rail,
    /// which is a beam.
    pub fn held(&self, node: NodeOfWire) -> Option<f64> {
        let planned = &self.topology.wires()[node.wire];
        let section = self.catenary.section(planned.section);
        let (span, xi) = self.topology.within_span(self.catenary, node);
        let support = span + xi.round() as usize;
        let turn = section.turn_at(support, |support| planned.lateral_at(section, support));
        let share = |at: NodeOfWire| {
            if at.wire != node.wire {
                return 0.0;
            }
            match self.topology.within_span(self.catenary, at) {
                (span, xi) if span == support => 1.0 - xi,
                (span, xi) if span + 1 == support => xi,
                _ => 0.0,
            }
        };
        let droppers = self.topology.droppers().iter().zip(&self.leaning);
        let pulls = droppers.map(|(dropper, force)| force * (share(dropper.lower) - share(dropper.upper)));
        let wire = &planned.parameters;
        let shortest = section.span_lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let is_string = wire.bending_stiffness < wire.tension * (STIFF * shortest).powi(2);
        is_string.then(|| wire.tension * turn - pulls.sum::<f64>())
    }
}
