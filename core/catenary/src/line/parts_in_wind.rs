//! Droppers and registration arms in the wind.
use crate::Attachment;
use crate::support::add_block;
use dynamics::{Blocks, CrossFlow, Force, Motion, Power, Weights, Wind};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A dropper as a cylinder between two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct DropperInWind {
    /// Lower and upper end.
    pub ends: [Attachment; 2],
    pub flow: CrossFlow,
}

/// Drag of droppers and registration arms.
///
/// ```text
/// dropper:  F = ½ ρ C_D d |v_n| v_n × length, half of it on either end;  v_r = W(t, x) − (v₁ + v₂)/2
/// arm:      F = ½ ρ C_D A |v_r| v_r on the contact wire,                 v_r = W(t, x) − v
/// ```
///
/// A dropper keeps the direction and the length that it has at rest for the force of the air; its own lateral sway is
/// not modelled, and the wind is that at its lower end. Derived here.
#[derive(Clone, Debug, Default)]
pub(super) struct PartsInWind {
    wind: Arc<Wind>,
    droppers: Vec<DropperInWind>,
    arms: Vec<Attachment>,
    /// `½ ρ C_D A`, N s²/m².
    arm: f64,
}

impl PartsInWind {
    pub fn new(wind: Arc<Wind>, droppers: Vec<DropperInWind>, (arms, arm): (Vec<Attachment>, f64)) -> Self {
        Self {
            wind,
            droppers,
            arms,
            arm,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.droppers.is_empty() && self.arms.is_empty()
    }

    fn wind_at(&self, node: &Attachment, motion: &Motion<'_>) -> Vector3<f64> {
        self.wind.velocity(motion.t, node.reference.x)
    }

    /// Power of one force on nodes that move with `velocity`, for air that moves with `wind`.
    fn power_of(force: impl Fn(&Vector3<f64>) -> Vector3<f64>, wind: &Vector3<f64>, velocity: &Vector3<f64>) -> Power {
        let (standing, moving) = (force(wind), force(&(wind - velocity)));
        Power {
            driven: standing.dot(velocity),
            dissipated: (standing - moving).dot(velocity),
        }
    }

    fn on_arm(&self, v_r: &Vector3<f64>) -> Vector3<f64> {
        v_r * (self.arm * v_r.norm())
    }
}

impl DropperInWind {
    fn axis(&self) -> Vector3<f64> {
        self.ends[1].reference - self.ends[0].reference
    }

    fn velocity(&self, motion: &Motion<'_>) -> Vector3<f64> {
        (self.ends[0].velocity(motion) + self.ends[1].velocity(motion)) * 0.5
    }

    /// Force on the whole dropper, N.
    fn force(&self, v_r: &Vector3<f64>) -> Vector3<f64> {
        let axis = self.axis();
        self.flow.force(v_r, &axis) * axis.norm()
    }
}

impl Force for PartsInWind {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for dropper in &self.droppers {
            let v_r = self.wind_at(&dropper.ends[0], motion) - dropper.velocity(motion);
            let half = dropper.force(&v_r) * 0.5;
            dropper.ends.iter().for_each(|end| end.add_force(&half, force));
        }
        for arm in &self.arms {
            let v_r = self.wind_at(arm, motion) - arm.velocity(motion);
            arm.add_force(&self.on_arm(&v_r), force);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for dropper in &self.droppers {
            let v_r = self.wind_at(&dropper.ends[0], motion) - dropper.velocity(motion);
            let axis = dropper.axis();
            let quarter = dropper.flow.by_velocity(&v_r, &axis) * (0.25 * axis.norm() * weights.v);
            add_block([(&dropper.ends[0], 1.0), (&dropper.ends[1], 1.0)], &quarter, blocks);
        }
        for arm in &self.arms {
            let v_r = self.wind_at(arm, motion) - arm.velocity(motion);
            let speed = v_r.norm();
            if speed > 0.0 {
                let by = Matrix3::identity() * speed + v_r * v_r.transpose() / speed;
                arm.add_block(&(by * (self.arm * weights.v)), blocks);
            }
        }
    }

    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let mut power = Power::default();
        let mut add = |part: Power| {
            power.driven += part.driven;
            power.dissipated += part.dissipated;
        };
        for dropper in &self.droppers {
            let wind = self.wind_at(&dropper.ends[0], motion);
            add(Self::power_of(
                |v_r| dropper.force(v_r),
                &wind,
                &dropper.velocity(motion),
            ));
        }
        for arm in &self.arms {
            let wind = self.wind_at(arm, motion);
            add(Self::power_of(|v_r| self.on_arm(v_r), &wind, &arm.velocity(motion)));
        }
        Some(power)
    }
}
