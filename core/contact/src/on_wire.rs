//! A strip on a wire under any contact law.
use super::{ContactPair, ContactState, SlidingJoint};
use dynamics::{Constraint, Force, Frame, Marker, Motion};
use std::sync::Arc;
use wire::WireCurve;

/// Interface of a strip to a line that follows its strips.
pub trait OnWire {
    /// Frame of the strip's marker.
    fn strip(&self, motion: &Motion<'_>) -> Frame;

    /// Replaces the wire by another one that continues it.
    fn set_curve(&mut self, curve: Arc<dyn WireCurve>);
}

/// A strip on a wire under the law of a scene.
pub enum StripContact {
    /// Unilateral contact: a spring presses, and the strip may leave.
    Penalty(ContactPair),
    /// Bilateral contact: the strip is held on the wire.
    SlidingJoint(SlidingJoint),
}

impl StripContact {
    /// Contact for a motion and the multipliers `lambda` of its system; `None` for a strip beyond the ends of the wire.
    #[must_use]
    pub fn state(&self, motion: &Motion<'_>, lambda: &[f64]) -> Option<ContactState> {
        match self {
            Self::Penalty(pair) => pair.state(motion),
            Self::SlidingJoint(joint) => joint.state(motion, lambda),
        }
    }

    /// Force of the contact; that of a joint is zero besides its multiplier, and follows the steps.
    pub fn force(&mut self) -> &mut dyn Force {
        match self {
            Self::Penalty(pair) => pair,
            Self::SlidingJoint(joint) => joint,
        }
    }

    /// Constraint of the contact; none under the penalty law.
    pub fn constraint(&mut self) -> Option<&mut dyn Constraint> {
        match self {
            Self::Penalty(_) => None,
            Self::SlidingJoint(joint) => Some(joint),
        }
    }

    /// Replaces the strip's marker by another one made from it.
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
