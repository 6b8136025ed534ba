//! All bushings of a vehicle: each body is looked at once.
use super::Bushing;
use crate::multibody::{BodyNow, Pose, Wrench};
use dynamics::{Blocks, Force, Motion, Weights};

/// Bushings between a few bodies.
#[derive(Clone, Debug, Default)]
pub struct Bushings {
    list: Vec<Bushing>,
    /// Bodies of the first and the second anchor of each.
    ends: Vec<[Option<usize>; 2]>,
    bodies: Vec<Pose>,
    /// Room for the bodies as they are now, and the forces on them.
    now: Vec<BodyNow>,
    sums: Vec<Wrench>,
}

impl Bushings {
    /// Bushings in this order.
    #[must_use]
    pub fn new(list: Vec<Bushing>) -> Self {
        let mut bodies: Vec<Pose> = Vec::new();
        let mut place = |pose: &Pose| {
            let known = bodies.iter().position(|body| body == pose);
            known.unwrap_or_else(|| {
                bodies.push(*pose);
                bodies.len() - 1
            })
        };
        let ends = (list.iter())
            .map(|bushing| [&bushing.pair.first, &bushing.pair.second].map(|anchor| anchor.pose().map(&mut place)))
            .collect();
        Self {
            ends,
            now: Vec::with_capacity(bodies.len()),
            sums: Vec::with_capacity(bodies.len()),
            bodies,
            list,
        }
    }

    /// The bushings in their order.
    #[must_use]
    pub fn as_slice(&self) -> &[Bushing] {
        &self.list
    }
}

impl Force for Bushings {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.now.clear();
        self.now.extend(self.bodies.iter().map(|pose| pose.now(motion)));
        self.sums.clear();
        self.sums.resize(self.bodies.len(), Wrench::default());
        for (bushing, ends) in self.list.iter().zip(&self.ends) {
            let now = ends.map(|end| end.map(|body| &self.now[body]));
            let wrenches = bushing.wrenches(&bushing.grips(motion, now));
            for (end, wrench) in ends.iter().zip(wrenches) {
                if let Some(body) = *end {
                    self.sums[body] += wrench;
                }
            }
        }
        for ((pose, now), sum) in self.bodies.iter().zip(&self.now).zip(&self.sums) {
            sum.add_to(pose, now, force);
        }
    }

    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for bushing in &mut self.list {
            bushing.add_tangent(motion, weights, blocks);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.list.iter().map(|bushing| bushing.energy(motion)).sum()
    }
}
