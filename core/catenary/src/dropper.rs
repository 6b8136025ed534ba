//! Droppers: the ties between messenger wire and contact wire.
use crate::Attachment;
use dynamics::{Blocks, Force, Motion, Updates, Weights};
use nalgebra::{Matrix3, Vector3};

/// Force of a dropper: a spring and a damper that pull and never push.
///
/// ```text
/// F = max(0, k δ + c min(1, δ/δ_r) δ̇)    δ > 0
/// F = 0                                   δ ≤ 0         δ = length − unstressed length
/// ```
///
/// A slack dropper exerts no force at all, so its damping part is cut as well. The damper sets in over the elongation
/// `δ_r` = [`DAMPING_ONSET`]: with a damper that is there at once the force of a closing dropper jumps from 0 to `c δ̇`, and an
/// implicit step may then have no solution, neither slack nor taut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropperLaw {
    /// `k`, N/m.
    pub stiffness: f64,
    /// `c`, N·s/m.
    pub damping: f64,
}

/// Elongation over which the damper sets in, m: a fiftieth of what 100 N stretch the stiffest droppers in use.
pub const DAMPING_ONSET: f64 = 1e-5;

impl DropperLaw {
    /// Tension in N, never negative, for an `elongation` in m that changes with `rate` in m/s.
    #[must_use]
    pub fn force(&self, elongation: f64, rate: f64) -> f64 {
        if elongation <= 0.0 {
            return 0.0;
        }
        let onset = (elongation / DAMPING_ONSET).min(1.0);
        (self.stiffness * elongation + self.damping * onset * rate).max(0.0)
    }

    /// `(∂F/∂δ, ∂F/∂δ̇)`, N/m and N·s/m; zero without force.
    #[must_use]
    pub fn derivatives(&self, elongation: f64, rate: f64) -> (f64, f64) {
        if self.force(elongation, rate) <= 0.0 {
            (0.0, 0.0)
        } else if elongation < DAMPING_ONSET {
            let rising = self.damping * rate / DAMPING_ONSET;
            (self.stiffness + rising, self.damping * elongation / DAMPING_ONSET)
        } else {
            (self.stiffness, self.damping)
        }
    }

    /// Elastic energy at an `elongation` in m, J.
    #[must_use]
    pub fn energy(&self, elongation: f64) -> f64 {
        0.5 * self.stiffness * elongation.max(0.0).powi(2)
    }

    /// Slope of the force in the weighted tangent, N/m.
    #[must_use]
    pub fn slope(&self, elongation: f64, rate: f64, weights: Weights) -> f64 {
        let (by_elongation, by_rate) = self.derivatives(elongation, rate);
        weights.q * by_elongation + weights.v * by_rate
    }
}

/// One dropper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dropper {
    /// Node of the messenger wire.
    pub upper: Attachment,
    /// Node of the contact wire.
    pub lower: Attachment,
    /// Length at which it begins to pull, m.
    pub unstressed_length: f64,
    /// kg, half of it at each end.
    pub mass: f64,
}

/// Where a dropper stands: what its force follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    /// From the lower to the upper node, unit vector.
    direction: Vector3<f64>,
    length: f64,
    /// Velocity of the upper node relative to the lower one, m/s.
    velocity: Vector3<f64>,
    /// `δ`, m.
    elongation: f64,
    /// `δ̇`, m/s.
    rate: f64,
}

impl Dropper {
    fn pose(&self, motion: &Motion<'_>) -> Pose {
        let between = (self.upper.reference - self.lower.reference)
            + (self.upper.displacement(motion) - self.lower.displacement(motion));
        let length = between.norm();
        let direction = if length > 0.0 { between / length } else { Vector3::z() };
        let velocity = self.upper.velocity(motion) - self.lower.velocity(motion);
        Pose {
            direction,
            length,
            elongation: length - self.unstressed_length,
            rate: direction.dot(&velocity),
            velocity,
        }
    }

    /// Present length, m.
    #[must_use]
    pub fn length(&self, motion: &Motion<'_>) -> f64 {
        self.pose(motion).length
    }
}

/// What the last assembled tangent contains of one dropper.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Assembled {
    /// `w_q k + w_v c`; zero when it was slack. N/m.
    slope: f64,
    direction: Vector3<f64>,
}

/// All droppers of a line as one contribution.
///
/// The force acts along the line between the two nodes, in three dimensions. A dropper that was taut when the matrix was
/// factored and is slack now (or the other way round) is a rank-one correction `∓ κ u uᵀ` with the direction `u` of that
/// factorisation, and so is one whose damper is setting in; the transverse part `F/length`, smaller by five orders of magnitude, stays as it was assembled.
#[derive(Clone, Debug)]
pub struct Droppers {
    law: DropperLaw,
    gravity: f64,
    droppers: Vec<Dropper>,
    assembled: Vec<Assembled>,
    /// Increases with every assembled tangent.
    version: u64,
}

impl Droppers {
    /// A batch of droppers with one law; `gravity` in m/s².
    #[must_use]
    pub fn new(law: DropperLaw, droppers: Vec<Dropper>, gravity: f64) -> Self {
        let slack = Assembled {
            slope: 0.0,
            direction: Vector3::z(),
        };
        Self {
            law,
            gravity,
            assembled: vec![slack; droppers.len()],
            droppers,
            version: 0,
        }
    }

    /// The droppers in their order.
    #[must_use]
    pub fn as_slice(&self) -> &[Dropper] {
        &self.droppers
    }

    /// Their common law.
    #[must_use]
    pub fn law(&self) -> DropperLaw {
        self.law
    }

    /// Tension of dropper `index`, N.
    #[must_use]
    pub fn tension(&self, index: usize, motion: &Motion<'_>) -> f64 {
        self.pull(&self.droppers[index].pose(motion))
    }

    /// Number of droppers that exert no force.
    #[must_use]
    pub fn slack_count(&self, motion: &Motion<'_>) -> usize {
        (0..self.droppers.len())
            .filter(|&index| self.tension(index, motion) == 0.0)
            .count()
    }

    fn pull(&self, pose: &Pose) -> f64 {
        self.law.force(pose.elongation, pose.rate)
    }
}

impl Force for Droppers {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for dropper in &self.droppers {
            let pose = dropper.pose(motion);
            let pull = self.pull(&pose) * pose.direction;
            let weight = Vector3::new(0.0, 0.0, 0.5 * dropper.mass * self.gravity);
            dropper.upper.add_force(&(-pull - weight), force);
            dropper.lower.add_force(&(pull - weight), force);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.version += 1;
        for (dropper, assembled) in self.droppers.iter().zip(&mut self.assembled) {
            let pose = dropper.pose(motion);
            let force = self.law.force(pose.elongation, pose.rate);
            let (_, damping) = self.law.derivatives(pose.elongation, pose.rate);
            let mut block = Matrix3::zeros();
            assembled.direction = pose.direction;
            assembled.slope = 0.0;
            if force > 0.0 {
                assembled.slope = self.law.slope(pose.elongation, pose.rate, weights);
                let outer = pose.direction * pose.direction.transpose();
                // ∂²length/∂r², the change of the direction with the position of the upper end.
                let turning = (Matrix3::identity() - outer) / pose.length;
                // ∂F/∂r = (∂F/∂δ) d + (∂F/∂δ̇) ∂δ̇/∂r with ∂δ̇/∂r = turning · velocity.
                let swing = pose.direction * (turning * pose.velocity).transpose();
                block = assembled.slope * outer + weights.q * (damping * swing + force * turning);
            }
            dropper.upper.add_relative_block(&dropper.lower, &block, blocks);
        }
    }

    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        for (slot, (dropper, assembled)) in self.droppers.iter().zip(&self.assembled).enumerate() {
            let pose = dropper.pose(motion);
            let coefficient = self.law.slope(pose.elongation, pose.rate, weights) - assembled.slope;
            if coefficient == 0.0 {
                continue;
            }
            let d = assembled.direction;
            let upper = dropper.upper.columns().map(|(index, axis)| (index, d[axis]));
            let lower = dropper.lower.columns().map(|(index, axis)| (index, -d[axis]));
            updates.rank_one(slot as u32, self.version, coefficient, upper.chain(lower));
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for dropper in self.droppers.iter().filter(|dropper| dropper.mass > 0.0) {
            let half = Matrix3::from_diagonal_element(0.5 * dropper.mass);
            for end in [&dropper.upper, &dropper.lower] {
                end.add_block(&half, blocks);
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.droppers
            .iter()
            .map(|dropper| {
                let rise = dropper.upper.displacement(motion).z + dropper.lower.displacement(motion).z;
                self.law.energy(dropper.length(motion) - dropper.unstressed_length)
                    + 0.5 * dropper.mass * self.gravity * rise
            })
            .sum()
    }

    fn save(&self, out: &mut Vec<f64>) {
        for assembled in &self.assembled {
            out.push(assembled.slope);
            out.extend_from_slice(assembled.direction.as_slice());
        }
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut changed = false;
        for assembled in &mut self.assembled {
            let mut next = || *values.next().expect("a saved state holds four numbers per dropper");
            let saved = Assembled {
                slope: next(),
                direction: Vector3::new(next(), next(), next()),
            };
            changed |= saved != *assembled;
            *assembled = saved;
        }
        // Rows kept by the solver under the old version may not be those of the restored directions.
        self.version += u64::from(changed);
    }
}

#[cfg(test)]
mod tests;
