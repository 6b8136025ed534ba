//! Uplift of the contact wires at the masts.
use crate::{NodeOfWire, Topology};

/// Heights that uplift is counted from, m above the static ones, as [`Topology::masts`].
#[derive(Clone, Debug)]
pub(crate) struct Uplift(Vec<Vec<f64>>);

impl Uplift {
    /// Uplift counted from these heights of the nodes on, m above the static ones.
    pub fn counted_from(topology: &Topology, height: impl Fn(NodeOfWire) -> f64) -> Self {
        let masts = topology.masts().iter();
        Self(
            masts
                .map(|nodes| nodes.iter().map(|&at| height(at)).collect())
                .collect(),
        )
    }

    /// Largest rise of the contact wires at a mast, m, and its node.
    pub fn most_lifted(
        &self,
        topology: &Topology,
        mast: usize,
        height: impl Fn(NodeOfWire) -> f64,
    ) -> Option<(f64, NodeOfWire)> {
        let nodes = topology.masts()[mast].iter().zip(&self.0[mast]);
        let rises = nodes.map(|(&at, reference)| (height(at) - reference, at));
        rises.reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}
