//! What a pantograph stands on.
use crate::GivenMotion;
use crate::multibody::{Anchor, BaseMarker, BodyMarker, GivenMarker};
use dynamics::{Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// What a pantograph's base is fixed to. Points are those of the base in its reference position, in the frame of the base.
#[derive(Clone, Debug)]
pub(crate) enum BaseMount {
    /// The frame of the base itself.
    Still,
    /// A given motion.
    Given(Arc<GivenMotion>),
    /// A rigid body; the marker stands at the pantograph's base, its axes are those of the track in the reference position.
    Body(BodyMarker),
    /// A base that rests where `frame` is and not at `reference`, for statics.
    Displaced {
        /// Where the base's marker is in the reference position, m.
        reference: Vector3<f64>,
        /// Where it is.
        frame: Frame,
    },
}

impl BaseMount {
    /// The point and axes fixed in the mount.
    pub fn anchor(&self, position: Vector3<f64>, axes: Matrix3<f64>) -> Anchor {
        match self {
            Self::Still => Anchor::Base(BaseMarker { position, axes }),
            Self::Given(given) => Anchor::Given(GivenMarker {
                marker: BaseMarker { position, axes },
                given: Arc::clone(given),
            }),
            // The body's axes are those of the track in its reference position.
            Self::Body(marker) => Anchor::Body(BodyMarker {
                pose: marker.pose,
                offset: position - marker.pose.reference,
                axes,
            }),
            Self::Displaced { reference, frame } => Anchor::Base(BaseMarker {
                position: frame.position + frame.axes * (position - reference),
                axes: frame.axes * axes,
            }),
        }
    }

    /// How far the pantograph's base stands beside the middle of the track in the reference position, m.
    pub fn lateral(&self) -> f64 {
        match self {
            Self::Still | Self::Given(_) => 0.0,
            Self::Body(marker) => (marker.pose.reference + marker.offset).y,
            Self::Displaced { reference, .. } => reference.y,
        }
    }

    /// Where the point of the base is now, in the frame of the base.
    pub fn frame(&self, point: Vector3<f64>, motion: &Motion<'_>) -> Frame {
        self.anchor(point, Matrix3::identity()).frame(motion)
    }
}
