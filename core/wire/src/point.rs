//! A fixed point of a wire as a marker.
use super::geometry::{Location, WireGeometry};
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A material point of a wire without orientation, to which a dropper, a support or an arm is clamped.
#[derive(Clone, Debug)]
pub struct WirePoint {
    geometry: Arc<WireGeometry>,
    at: Location,
    s: f64,
    columns: Vec<(usize, Vector3<f64>)>,
}

impl WirePoint {
    /// The point at `s`, m.
    #[must_use]
    pub fn new(geometry: Arc<WireGeometry>, s: f64) -> Self {
        let at = geometry.locate(s);
        let mut columns = Vec::with_capacity(Columns::CAPACITY);
        geometry.columns_at(&at, |index, n, _| {
            // Functions of other nodes are exactly zero at a node.
            if n != Vector3::zeros() {
                columns.push((index, n));
            }
        });
        Self {
            geometry,
            at,
            s,
            columns,
        }
    }

    /// The point at a node.
    #[must_use]
    pub fn at_node(geometry: Arc<WireGeometry>, node: usize) -> Self {
        let s = geometry.node_s(node);
        Self::new(geometry, s)
    }

    /// Parameter `s` of the point, m.
    #[must_use]
    pub fn s(&self) -> f64 {
        self.s
    }

    /// Wire of the point.
    #[must_use]
    pub fn geometry(&self) -> &Arc<WireGeometry> {
        &self.geometry
    }
}

impl Marker for WirePoint {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let point = self.geometry.point_at(&self.at, motion.q, motion.v);
        Frame {
            position: point.r,
            axes: Matrix3::identity(),
            velocity: point.velocity,
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        for &(index, translation) in &self.columns {
            columns.push(index, translation, Vector3::zeros());
        }
    }
}
