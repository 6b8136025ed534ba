//! Markers: a point on some body, as forces and joints see it.
use crate::Motion;
use nalgebra::{Matrix3, Vector3};

/// Position, orientation and velocity of a marker in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Position, m.
    pub position: Vector3<f64>,
    /// Axes of the marker as columns (body to world); the identity where the body has no orientation.
    pub axes: Matrix3<f64>,
    /// Velocity of the point, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity in the world frame, rad/s.
    pub angular_velocity: Vector3<f64>,
}

/// Effect of one generalised velocity on a marker: `velocity += translation · v`, `angular velocity += rotation · v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Index of the generalised velocity.
    pub index: usize,
    /// Velocity of the point per unit of the generalised velocity.
    pub translation: Vector3<f64>,
    /// Angular velocity (world) per unit of the generalised velocity.
    pub rotation: Vector3<f64>,
}

/// The columns of a marker; at most [`Columns::CAPACITY`], held without allocation.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    entries: [Column; Columns::CAPACITY],
    count: usize,
}

impl Default for Columns {
    fn default() -> Self {
        let empty = Column {
            index: 0,
            translation: Vector3::zeros(),
            rotation: Vector3::zeros(),
        };
        Self {
            entries: [empty; Self::CAPACITY],
            count: 0,
        }
    }
}

impl Columns {
    /// Largest number of generalised velocities one marker depends on: two cable nodes with an enrichment each.
    pub const CAPACITY: usize = 18;

    /// Appends a column.
    ///
    /// # Panics
    /// When there are more than [`Columns::CAPACITY`].
    pub fn push(&mut self, index: usize, translation: Vector3<f64>, rotation: Vector3<f64>) {
        self.entries[self.count] = Column {
            index,
            translation,
            rotation,
        };
        self.count += 1;
    }

    /// Removes all columns.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The columns as a slice.
    #[must_use]
    pub fn as_slice(&self) -> &[Column] {
        &self.entries[..self.count]
    }

    /// Adds the generalised force of a `force` (N) at `offset` (m, world, from the marker's point) to `out`.
    pub fn add_force(&self, force: &Vector3<f64>, offset: &Vector3<f64>, out: &mut [f64]) {
        let moment = offset.cross(force);
        for column in self.as_slice() {
            out[column.index] += column.translation.dot(force) + column.rotation.dot(&moment);
        }
    }
}

/// A point on some body: position, velocity, and how a force on it maps to generalised coordinates.
pub trait Marker: Send {
    /// Position, axes and velocities of the marker.
    fn frame(&self, motion: &Motion<'_>) -> Frame;

    /// Appends the marker's columns, always in the same order. A prescribed marker has none.
    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns);
}
