//! Moment of a drive in a joint.
use super::measure::add_square;
use super::{Anchor, Pair};
use dynamics::{Blocks, Force, Marker, Motion, Power, Weights};

/// The moment of a drive between the two bodies of a revolute joint, as the input `u[input]`, N·m.
///
/// ```text
/// Q_k = s u a · (c_k of the second anchor − c_k of the first one)
/// ```
///
/// `a` is the third axis of the first anchor, `s = ±1` the sense in which a positive moment turns the second anchor
/// about it. What the first anchor stands on bears the reaction.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMoment {
    pair: Pair,
    sense: f64,
    input: usize,
}

impl JointMoment {
    /// Moment by the input `input` between `anchors`, which have the axis of the joint as their third one.
    #[must_use]
    pub fn new([first, second]: [Anchor; 2], sense: f64, input: usize) -> Self {
        Self {
            pair: Pair { first, second },
            sense,
            input,
        }
    }

    /// Anchors of the joint.
    #[must_use]
    pub fn anchors(&self) -> [Anchor; 2] {
        [self.pair.first.clone(), self.pair.second.clone()]
    }

    /// `s`
    #[must_use]
    pub fn sense(&self) -> f64 {
        self.sense
    }

    /// Turn of the joint from its reference position in the sense of a positive moment, rad.
    #[must_use]
    pub fn angle(&self, motion: &Motion<'_>) -> f64 {
        let [first, second] = [&self.pair.first, &self.pair.second].map(|anchor| anchor.frame(motion).axes);
        let turned = second.column(0);
        self.sense * turned.dot(&first.column(1)).atan2(turned.dot(&first.column(0)))
    }

    /// Rate of the turn, rad/s.
    #[must_use]
    pub fn rate(&self, motion: &Motion<'_>) -> f64 {
        let [first, second] = [&self.pair.first, &self.pair.second].map(|anchor| anchor.frame(motion));
        let axis = first.axes.column(2);
        self.sense * axis.dot(&(second.angular_velocity - first.angular_velocity))
    }
}

impl Force for JointMoment {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let view = self.pair.view(motion);
        let moment = self.sense * motion.u[self.input];
        let turning = view.turning();
        for (&index, turning) in view.indices().iter().zip(turning.iter()) {
            force[index] += moment * turning;
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let view = self.pair.view(motion);
        let moment = self.sense * motion.u[self.input];
        add_square(blocks, view.indices(), &(view.turning_change() * (-weights.q * moment)));
    }

    /// The drive brings in all of its power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        Some(Power {
            driven: motion.u[self.input] * self.rate(motion),
            dissipated: 0.0,
        })
    }
}
