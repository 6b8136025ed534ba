//! Transfer between the coordinates of a system and the arrays of a batch of elements.
use super::node::WireNode;
use super::rows::{NodeRows, gather, scatter};
use dynamics::simd::{GROUP, Transpose};
use pulp::Simd;
use std::ops::Range;

/// Elements that are gathered, evaluated and scattered together: their arrays stay in the nearest cache.
pub(super) const BLOCK: usize = 8 * GROUP;

/// Room for the nodes of a block and for the last lanes of those that follow them.
pub(super) const NODES: usize = BLOCK + GROUP;

/// Position and slope of the nodes of a block, `D` components each, one array per component.
pub(super) type NodeArrays<const D: usize> = [[[f64; NODES]; D]; 2];

/// Positions of the coordinates of the nodes among those of the system.
#[derive(Clone, Debug)]
pub(super) enum NodePlaces<const D: usize> {
    /// First coordinate of each node; its `2 D` coordinates and those of the next node are consecutive.
    Runs(Vec<u32>),
    /// Coordinates anywhere; `u32::MAX` marks a missing one.
    Anywhere(Vec<[[u32; D]; 2]>),
}

impl<const D: usize> NodePlaces<D> {
    /// Positions for `nodes`, with the `axes` of the components.
    pub fn new(nodes: &[WireNode], axes: [usize; D]) -> Self {
        let places = nodes.iter().map(|node| {
            let place = |index: Option<usize>| index.map_or(u32::MAX, |index| index as u32);
            [
                axes.map(|axis| place(node.map.position(axis))),
                axes.map(|axis| place(node.map.slope(axis))),
            ]
        });
        let places: Vec<[[u32; D]; 2]> = places.collect();
        let consecutive = |node: &[[u32; D]; 2]| {
            let run = node.as_flattened();
            run.windows(2).all(|pair| pair[0] != u32::MAX && pair[1] == pair[0] + 1)
        };
        let ascending = places.is_sorted_by_key(|node| node[0][0]);
        if ascending && places.iter().all(consecutive) {
            Self::Runs(places.iter().map(|node| node[0][0]).collect())
        } else {
            Self::Anywhere(places)
        }
    }

    /// First coordinate of each node, if the others follow it.
    pub fn runs(&self) -> Option<&[u32]> {
        match self {
            Self::Runs(starts) => Some(starts),
            Self::Anywhere(_) => None,
        }
    }

    /// True if each node's coordinates follow those of the node before.
    pub fn ascend(&self) -> bool {
        match self {
            Self::Runs(_) => true,
            Self::Anywhere(_) => false,
        }
    }

    /// The nodes with a coordinate in a range, or all.
    pub fn nodes_of(&self, range: &Range<usize>) -> Range<usize> {
        match self {
            Self::Runs(starts) => {
                let first = starts.partition_point(|&start| start as usize + 2 * D <= range.start);
                first..starts.partition_point(|&start| (start as usize) < range.end)
            }
            Self::Anywhere(places) => 0..places.len(),
        }
    }

    /// Copies the values of the nodes from `first` to `last` to arrays; missing coordinates are zero.
    #[inline(always)]
    pub fn gather<S: Simd>(
        &self,
        transpose: Transpose<S>,
        (first, last): (usize, usize),
        values: &[f64],
        (rows, arrays): (&mut NodeRows, &mut NodeArrays<D>),
    ) {
        match self {
            Self::Runs(starts) => gather(transpose, &starts[first..=last], values, (rows, arrays)),
            Self::Anywhere(places) => {
                for (i, node) in places[first..=last].iter().enumerate().take(NODES) {
                    for (array, &place) in arrays.as_flattened_mut().iter_mut().zip(node.as_flattened()) {
                        array[i] = values.get(place as usize).copied().unwrap_or(0.0);
                    }
                }
            }
        }
    }

    /// Subtracts the forces in both arrays from those of the system.
    #[inline(always)]
    pub fn scatter<S: Simd>(
        &self,
        transpose: Transpose<S>,
        (first, last): (usize, usize),
        ([a, b], rows): ([&NodeArrays<D>; 2], &mut NodeRows),
        force: &mut [f64],
    ) {
        match self {
            Self::Runs(starts) => scatter(transpose, &starts[first..=last], ([a, b], rows), force),
            Self::Anywhere(places) => {
                let (a, b) = (a.as_flattened(), b.as_flattened());
                for (i, node) in places[first..=last].iter().enumerate().take(NODES) {
                    for (part, &place) in node.as_flattened().iter().enumerate() {
                        if let Some(value) = force.get_mut(place as usize) {
                            *value -= a[part][i] + b[part][i];
                        }
                    }
                }
            }
        }
    }
}
