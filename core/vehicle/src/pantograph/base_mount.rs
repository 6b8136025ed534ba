//! Mount of a pantograph: the object to which the base is fixed.
use crate::GivenMotion;
use crate::multibody::{Anchor, BaseMarker, BodyMarker, GivenMarker};
use dynamics::{Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Object to which a pantograph's base is fixed. Points are points of the base in the reference position, in the frame
/// of the base.
#[derive(Clone, Debug)]
pub(crate) enum BaseMount {
    /// The frame of the base itself.
    Fixed,
    /// A given motion.
    Given(Arc<GivenMotion>),
    /// A rigid body; the marker is at the pantograph's base, with the axes of the track in the reference position.
    Body(BodyMarker),
    /// A base at rest beside the reference position, for statics.
    Displaced(BaseDisplacement),
}

/// Displacement of a base at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BaseDisplacement {
    /// Marker of the base in the reference position, m.
    pub reference: Vector3<f64>,
    /// Marker of the base at rest.
    pub frame: Frame,
}

impl BaseMount {
    /// Anchor at a point and axes fixed in the mount.
    pub fn anchor(&self, position: Vector3<f64>, axes: Matrix3<f64>) -> Anchor {
        match self {
            Self::Fixed => Anchor::Base(BaseMarker { position, axes }),
            Self::Given(given) => Anchor::Given(GivenMarker {
                marker: BaseMarker { position, axes },
                given: Arc::clone(given),
            }),
            // Body axes are the axes of the track in the reference position.
            Self::Body(marker) => Anchor::Body(BodyMarker {
                pose: marker.pose,
                offset: position - marker.pose.reference,
                axes,
            }),
            Self::Displaced(BaseDisplacement { reference, frame }) => Anchor::Base(BaseMarker {
                position: frame.position + frame.axes * (position - reference),
                axes: frame.axes * axes,
            }),
        }
    }

    /// Lateral position of the pantograph's base in the reference position, m from the middle of the track.
    pub fn lateral(&self) -> f64 {
        match self {
            Self::Fixed | Self::Given(_) => 0.0,
            Self::Body(marker) => (marker.pose.reference + marker.offset).y,
            Self::Displaced(displacement) => displacement.reference.y,
        }
    }

    /// Frame of a point of the base now, in the frame of the base.
    pub fn frame(&self, point: Vector3<f64>, motion: &Motion<'_>) -> Frame {
        self.anchor(point, Matrix3::identity()).frame(motion)
    }
}
