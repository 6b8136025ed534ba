//! What a joint or a spring is fixed to: a body or the base.
use super::BodyMarker;
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};

/// A point and axes fixed in the base: no generalised velocity moves them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseMarker {
    /// In the frame of the base, m.
    pub position: Vector3<f64>,
    /// The marker's axes as columns.
    pub axes: Matrix3<f64>,
}

impl Marker for BaseMarker {
    fn frame(&self, _motion: &Motion<'_>) -> Frame {
        Frame {
            position: self.position,
            axes: self.axes,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, _columns: &mut Columns) {}
}

/// One end of a joint or spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// Fixed to the base.
    Base(BaseMarker),
    /// Fixed to a rigid body.
    Body(BodyMarker),
}

impl Marker for Anchor {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        match self {
            Self::Base(marker) => marker.frame(motion),
            Self::Body(marker) => marker.frame(motion),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        match self {
            Self::Base(marker) => marker.columns(motion, columns),
            Self::Body(marker) => marker.columns(motion, columns),
        }
    }
}
