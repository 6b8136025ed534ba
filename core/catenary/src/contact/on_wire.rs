//! A strip on a wire, whatever the law between them.
use super::{ContactPair, ContactState, SlidingJoint};
use crate::WireCurve;
use dynamics::{Constraint, Force, Frame, Marker, Motion};
use std::sync::Arc;

/// What a line that follows its strips needs of them.
pub trait OnWire {
    /// The strip's marker.
    fn strip(&self, motion: &Motion<'_>) -> Frame;

    /// Goes on with another wire, which continues the one before.
    fn set_curve(&mut self, curve: Arc<dyn WireCurve>);
}

/// A strip on a wire under the law of a scene.
pub enum StripContact {
    /// It is pressed on by a spring and may leave.
    Penalty(ContactPair),
    /// It is held on.
    SlidingJoint(SlidingJoint),
}

impl StripContact {
    /// The contact for a motion and the multipliers `lambda` of its system; `None` where the strip is beyond the ends of the wire.
    #[must_use]
    pub fn state(&self, motion: &Motion<'_>, lambda: &[f64]) -> Option<ContactState> {
        match self {
            Self::Penalty(pair) => pair.state(motion),
            Self::SlidingJoint(joint) => joint.state(motion, lambda),
        }
    }

    /// Its force; a joint has none but its multiplier, and follows the steps here.
    pub fn force(&mut self) -> &mut dyn Force {
        match self {
            Self::Penalty(pair) => pair,
            Self::SlidingJoint(joint) => joint,
        }
    }

    /// Its constraint, where it has one.
    pub fn constraint(&mut self) -> Option<&mut dyn Constraint> {
        match self {
            Self::Penalty(_) => None,
            Self::SlidingJoint(joint) => Some(joint),
        }
    }

    /// Puts another marker in place of the strip's, made of it.
    pub fn replace_strip(&mut self, other: impl FnOnce(Box<dyn Marker>) -> Box<dyn Marker>) {
        match self {
            Self::Penalty(pair) => pair.replace_strip(other),
            Self::SlidingJoint(joint) => joint.replace_strip(other),
        }
    }
}

impl OnWire for StripContact {
    fn strip(&self, motion: &Motion<'_>) -> Frame {
        match self {
            Self::Penalty(pair) => pair.strip(motion),
            Self::SlidingJoint(joint) => joint.strip(motion),
        }
    }

    fn set_curve(&mut self, curve: Arc<dyn WireCurve>) {
        match self {
            Self::Penalty(pair) => pair.set_curve(curve),
            Self::SlidingJoint(joint) => joint.set_curve(curve),
        }
    }
}
