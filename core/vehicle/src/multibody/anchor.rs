//! Ends of joints and springs: on a body or on the base.
use super::{BodyMarker, BodyNow, Grip, Pose};
use crate::GivenMotion;
use dynamics::{Column, Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Point and axes fixed in the base: no generalised velocity moves them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseMarker {
    /// Position in the frame of the base, m.
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

/// Point and axes on a given motion: a function of time alone.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenMarker {
    /// Marker without the motion.
    pub marker: BaseMarker,
    /// The motion.
    pub given: Arc<GivenMotion>,
}

impl Marker for GivenMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        self.given.frame_of(&self.marker, motion.t)
    }

    fn columns(&self, _motion: &Motion<'_>, _columns: &mut Columns) {}
}

/// One end of a joint or spring.
#[derive(Clone, Debug, PartialEq)]
pub enum Anchor {
    /// Fixed to the base.
    Base(BaseMarker),
    /// Fixed to a rigid body.
    Body(BodyMarker),
    /// On a given motion.
    Given(GivenMarker),
}

impl Anchor {
    /// Coordinates of the body; none of an anchor that no coordinate moves.
    pub(crate) fn pose(&self) -> Option<&Pose> {
        match self {
            Self::Body(marker) => Some(&marker.pose),
            Self::Base(_) | Self::Given(_) => None,
        }
    }

    /// Position (m) and axes.
    pub(crate) fn place(&self, motion: &Motion<'_>) -> (Vector3<f64>, Matrix3<f64>) {
        self.columns_of(motion, &mut |_| ())
    }

    /// Position (m) and axes; `see` is given the columns of [`Marker::columns`].
    #[inline]
    pub(crate) fn columns_of(&self, motion: &Motion<'_>, see: &mut impl FnMut(Column)) -> (Vector3<f64>, Matrix3<f64>) {
        match self {
            Self::Body(marker) => marker.columns_of(motion, see),
            Self::Base(_) | Self::Given(_) => {
                let frame = self.frame(motion);
                (frame.position, frame.axes)
            }
        }
    }

    /// The anchor on its body as it is now.
    #[inline]
    pub(crate) fn grip<'a>(&'a self, motion: &Motion<'_>, now: Option<&'a BodyNow>) -> Grip<'a> {
        match (self, now) {
            (Self::Body(marker), Some(now)) => marker.grip(now),
            _ => Grip::Fixed(self.frame(motion)),
        }
    }
}

impl Marker for Anchor {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        match self {
            Self::Base(marker) => marker.frame(motion),
            Self::Body(marker) => marker.frame(motion),
            Self::Given(marker) => marker.frame(motion),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        match self {
            Self::Base(marker) => marker.columns(motion, columns),
            Self::Body(marker) => marker.columns(motion, columns),
            Self::Given(marker) => marker.columns(motion, columns),
        }
    }
}
