//! Nodes of a wire and the positions of their coordinates in the system.
use nalgebra::Vector3;

/// Index that marks a missing coordinate.
const MISSING: usize = usize::MAX;

/// Positions of the six coordinates of a node among those of the system: `x, y, z` of the position, then `x, y, z` of
/// the slope.
///
/// A missing coordinate keeps its reference value: a planar wire has no `y` entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeMap {
    index: [usize; 6],
}

impl NodeMap {
    /// Any selection of coordinates.
    #[must_use]
    pub fn new(index: [Option<usize>; 6]) -> Self {
        Self {
            index: index.map(|index| index.unwrap_or(MISSING)),
        }
    }

    /// A node in space: six consecutive coordinates from `first`.
    #[must_use]
    pub fn spatial(first: usize) -> Self {
        Self {
            index: std::array::from_fn(|i| first + i),
        }
    }

    /// A node in the plane of x and z: four consecutive coordinates `x, z, x,ₓ, z,ₓ` from `first`.
    #[must_use]
    pub fn planar(first: usize) -> Self {
        Self {
            index: [first, MISSING, first + 1, first + 2, MISSING, first + 3],
        }
    }

    /// Index of the position along `axis` (0, 1, 2 for x, y, z).
    #[must_use]
    pub fn position(&self, axis: usize) -> Option<usize> {
        self.component(axis)
    }

    /// Index of the slope along `axis` (0, 1, 2 for x, y, z).
    #[must_use]
    pub fn slope(&self, axis: usize) -> Option<usize> {
        self.component(3 + axis)
    }

    /// Indices of the existing coordinates, in order.
    pub fn indices(&self) -> impl Iterator<Item = usize> {
        self.index.into_iter().filter(|&index| index != MISSING)
    }

    fn component(&self, component: usize) -> Option<usize> {
        Some(self.index[component]).filter(|&index| index != MISSING)
    }

    /// Part of `values` that belongs to the node: position and slope; zero for a missing coordinate.
    #[inline(always)]
    pub(super) fn gather(&self, values: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        // A single bounds check serves both purposes: no vector is as long as MISSING.
        let [x, y, z, x_s, y_s, z_s] = self.index.map(|index| {
            debug_assert!(index == MISSING || index < values.len());
            values.get(index).copied().unwrap_or(0.0)
        });
        (Vector3::new(x, y, z), Vector3::new(x_s, y_s, z_s))
    }
}

/// A node: its reference and its coordinates, which are displacements from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireNode {
    /// Reference position, m.
    pub position: Vector3<f64>,
    /// Reference of `∂r/∂s`, –.
    pub slope: Vector3<f64>,
    /// Positions of the coordinates in the system.
    pub map: NodeMap,
}

impl WireNode {
    /// Position (m) and slope (–) for the coordinates `q` of the system.
    #[must_use]
    pub fn at(&self, q: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let (position, slope) = self.map.gather(q);
        (self.position + position, self.slope + slope)
    }
}
