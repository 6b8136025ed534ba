//! Drive of a reduced linkage.
use super::ReducedLinkage;
use super::point::{ReducedPoint, Way};
use crate::VehicleError;
use crate::multibody::Anchor;
use control::Reading;
use dynamics::{Blocks, Force, Motion, Power, Weights};

/// The drive of a linkage in the two coordinates, as the input `u[input]`: the force on a point, N, or the moment on a
/// joint, N·m, does the work of the way `w` of what it drives.
///
/// ```text
/// Q = u ∂w/∂(σ, ζ)
/// ```
#[derive(Clone, Debug)]
pub(super) struct ReducedDrive {
    driven: Driven,
    /// First coordinate of the linkage.
    coordinate: usize,
    input: usize,
}

/// Driven point or joint.
#[derive(Clone, Debug)]
enum Driven {
    /// Height of a point.
    Point(ReducedPoint),
    /// Turn of the second body against the first one, times a sign; none is the base.
    Joint([Option<ReducedPoint>; 2], f64),
}

impl ReducedLinkage {
    /// Drive by the input `input`, where `actuator` has it.
    pub(super) fn drive(&self, actuator: &scene::Actuator, input: usize) -> Result<ReducedDrive, VehicleError> {
        let driven = match &actuator.joint {
            None => Driven::Point(self.point_of(self.full.uplift_marker())),
            Some(name) => {
                let moment = self.full.moment_on(name, input)?;
                let ends = moment.anchors().map(|anchor| match anchor {
                    Anchor::Body(marker) => Some(self.point_of(&marker)),
                    Anchor::Base(_) | Anchor::Given(_) => None,
                });
                // One end is a body: joints of a mechanism with one motion have their axes to the left or to the right.
                let axis = ends.iter().flatten().next().map_or(0.0, |point| point.axes.column(2).y);
                Driven::Joint(ends, moment.sense() * axis.signum())
            }
        };
        Ok(ReducedDrive {
            driven,
            coordinate: self.offsets.coordinate,
            input,
        })
    }
}

impl ReducedDrive {
    fn way(&self, motion: &Motion<'_>) -> Way {
        match &self.driven {
            Driven::Point(point) => point.height(motion),
            Driven::Joint(ends, sense) => {
                let [first, second] =
                    [&ends[0], &ends[1]].map(|end| end.as_ref().map_or_else(Way::default, |point| point.turn(motion)));
                let turned = |first: f64, second: f64| sense * (second - first);
                Way {
                    value: turned(first.value, second.value),
                    by: [turned(first.by[0], second.by[0]), turned(first.by[1], second.by[1])],
                    bend: turned(first.bend, second.bend),
                }
            }
        }
    }

    fn rate(&self, way: &Way, motion: &Motion<'_>) -> f64 {
        let i = self.coordinate;
        way.by[0] * motion.v[i] + way.by[1] * motion.v[i + 1]
    }

    /// Reads place and velocity of what is driven.
    pub fn read(&self, motion: &Motion<'_>, reading: &mut Reading) {
        let way = self.way(motion);
        (reading.driven, reading.driven_place) = (self.rate(&way, motion), way.value);
    }
}

impl Force for ReducedDrive {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let (way, drive) = (self.way(motion), motion.u[self.input]);
        for (force, by) in force[self.coordinate..].iter_mut().zip(way.by) {
            *force += drive * by;
        }
    }

    /// `−u ∂²w/∂σ²`
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let i = self.coordinate;
        let stiffness = -weights.q * motion.u[self.input] * self.way(motion).bend;
        blocks.add(&[i, i + 1], &[i, i + 1], &[stiffness, 0.0, 0.0, 0.0]);
    }

    /// The drive brings in all of its power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        Some(Power {
            driven: motion.u[self.input] * self.rate(&self.way(motion), motion),
            dissipated: 0.0,
        })
    }
}
