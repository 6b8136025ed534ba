//! Nodes of a wire to which other parts are attached.
use crate::{NodeMap, WireNode};
use dynamics::{Blocks, Motion};
use nalgebra::{Matrix3, Vector3};

/// A node of a wire as droppers, supports and registration arms see it: a point and its displacements (m), which are
/// coordinates of the system. In a planar line the lateral coordinate is missing and its displacement zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// Position for zero displacement, m.
    pub reference: Vector3<f64>,
    /// Coordinates; `usize::MAX` marks a missing one, because no vector is as long.
    coordinates: [usize; 3],
}

impl Attachment {
    /// A node at `reference` (m) whose displacements along x, y, z are these coordinates.
    #[must_use]
    pub fn new(reference: Vector3<f64>, coordinates: [Option<usize>; 3]) -> Self {
        Self {
            reference,
            coordinates: coordinates.map(|index| index.unwrap_or(usize::MAX)),
        }
    }

    /// A node of a wire.
    #[must_use]
    pub fn node(node: &WireNode) -> Self {
        Self::new(node.position, Self::coordinates_of(&node.map))
    }

    fn coordinates_of(map: &NodeMap) -> [Option<usize>; 3] {
        [0, 1, 2].map(|axis| map.position(axis))
    }

    /// Index of the displacement along `axis` (0, 1, 2 for x, y, z).
    #[must_use]
    pub fn coordinate(&self, axis: usize) -> Option<usize> {
        Some(self.coordinates[axis]).filter(|&index| index != usize::MAX)
    }

    /// The node's three entries of `values`, one per coordinate of the system; zero for a missing coordinate.
    pub(crate) fn gather(&self, values: &[f64]) -> Vector3<f64> {
        Vector3::from(self.coordinates.map(|index| values.get(index).copied().unwrap_or(0.0)))
    }

    /// Displacement from the reference position, m.
    #[must_use]
    pub fn displacement(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.gather(motion.q)
    }

    /// Position, m.
    #[must_use]
    pub fn position(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.reference + self.displacement(motion)
    }

    /// Velocity, m/s.
    #[must_use]
    pub fn velocity(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.gather(motion.v)
    }

    /// The coordinates that exist, each with its axis.
    pub fn columns(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        self.coordinates
            .into_iter()
            .enumerate()
            .filter(|&(_, index)| index != usize::MAX)
            .map(|(axis, index)| (index, axis))
    }

    /// Adds a force (N) on the node to the generalised force.
    pub fn add_force(&self, force: &Vector3<f64>, out: &mut [f64]) {
        for (&index, part) in self.coordinates.iter().zip(force) {
            if let Some(value) = out.get_mut(index) {
                *value += part;
            }
        }
    }

    /// Adds a 3 × 3 matrix on the displacements of this node.
    pub fn add_block(&self, matrix: &Matrix3<f64>, blocks: &mut Blocks<'_>) {
        add_block([(self, 1.0)], matrix, blocks);
    }

    /// Adds a 3 × 3 matrix on the displacement of `self` relative to `other` to the coordinates of both.
    pub fn add_relative_block(&self, other: &Self, matrix: &Matrix3<f64>, blocks: &mut Blocks<'_>) {
        add_block([(self, 1.0), (other, -1.0)], matrix, blocks);
    }
}

/// Adds a 3 × 3 matrix on the sum of the displacements of nodes, each with a factor.
pub(crate) fn add_block<const N: usize>(
    nodes: [(&Attachment, f64); N],
    matrix: &Matrix3<f64>,
    blocks: &mut Blocks<'_>,
) {
    let (mut indices, mut axes, mut count) = ([0; 6], [(0, 0.0); 6], 0);
    for (node, sign) in nodes {
        for (index, axis) in node.columns() {
            indices[count] = index;
            axes[count] = (axis, sign);
            count += 1;
        }
    }
    let mut values = [0.0; 36];
    for (i, (row, row_sign)) in axes[..count].iter().enumerate() {
        for (j, (column, column_sign)) in axes[..count].iter().enumerate() {
            values[i * count + j] = row_sign * column_sign * matrix[(*row, *column)];
        }
    }
    blocks.add(&indices[..count], &indices[..count], &values[..count * count]);
}
