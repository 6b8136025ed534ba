//! Droppers: the ties between messenger wire and contact wire.
use crate::{Attachment, UnilateralStart, UnilateralStep};
use dynamics::unilateral::{restore_step, save_step, unilateral_force};
use dynamics::{Blocks, ByRange, Force, LowRank, Motion, OnePass, Power, StepHistory, Updates, Weights};
use lanes::{DropperGroup, EndMass, Evaluate, Extensions, LANES, Move, Step};
use nalgebra::{Matrix3, Vector3};
use pulp::Arch;
use serde::{Deserialize, Serialize};
use std::ops::Range;

mod ends;
mod lanes;
mod slackening;

pub use slackening::Slackening;

/// Force of a dropper: a spring and a damper that pull and never push.
///
/// ```text
/// F = max(0, k δ + φ c δ̇)        δ = length − unstressed length
/// ```
///
/// `φ` is the part of a time step in which the dropper is taut, see [`UnilateralStep`]: 1 in a step that begins taut, 0
/// in one that begins and ends slack: a slack dropper exerts no force at all [Thesis, section 3.2].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DropperLaw {
    /// `k`, N/m.
    pub stiffness: f64,
    /// `c`, N·s/m.
    pub damping: f64,
}

impl DropperLaw {
    /// Tension in N, never negative, for an `elongation` in m that changes with `rate` in m/s at the end of a `step`.
    #[must_use]
    pub fn force(&self, step: UnilateralStep, elongation: f64, rate: f64) -> f64 {
        let (part, _) = step.closed_part(step.ahead(elongation, rate), rate);
        unilateral_force((self.stiffness, self.damping), part, elongation, rate)
    }

    /// `(∂F/∂δ, ∂F/∂δ̇)`, N/m and N·s/m; zero without force.
    #[must_use]
    pub fn derivatives(&self, step: UnilateralStep, elongation: f64, rate: f64) -> (f64, f64) {
        let (part, by_ahead) = step.closed_part(step.ahead(elongation, rate), rate);
        let law = (self.stiffness, self.damping);
        if unilateral_force(law, part, elongation, rate) <= 0.0 {
            return (0.0, 0.0);
        }
        let closing = by_ahead * self.damping * rate;
        (self.stiffness + closing, part * self.damping + step.half * closing)
    }

    /// Branch of the law, see [`UnilateralStep::branch`].
    pub(crate) fn branch(&self, step: UnilateralStep, elongation: f64, rate: f64) -> u8 {
        step.branch(step.ahead(elongation, rate), rate, self.force(step, elongation, rate))
    }

    /// Elastic energy at an `elongation` in m, J.
    #[must_use]
    pub fn energy(&self, elongation: f64) -> f64 {
        0.5 * self.stiffness * elongation.max(0.0).powi(2)
    }

    /// Slope of the force in the weighted tangent, N/m. In a step that closes, the chord to the closing is the lower
    /// bound, so that no correction opens the dropper again.
    #[must_use]
    pub fn slope(&self, step: UnilateralStep, elongation: f64, rate: f64, weights: Weights) -> f64 {
        let (by_elongation, by_rate) = self.derivatives(step, elongation, rate);
        let slope = weights.q * by_elongation + weights.v * by_rate;
        let ahead = step.ahead(elongation, rate);
        if step.closes(ahead, rate) {
            slope.max(step.chord(self.force(step, elongation, rate), ahead, weights))
        } else {
            slope
        }
    }
}

/// One dropper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dropper {
    /// Node of the messenger wire.
    pub upper: Attachment,
    /// Node of the contact wire.
    pub lower: Attachment,
    /// Unstressed length: a longer dropper pulls, m.
    pub unstressed_length: f64,
    /// Mass, kg; half at each end.
    pub mass: f64,
}

/// Position and motion of a dropper, from which its force follows.
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
        let between = self.between(motion);
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

    /// From the lower to the upper node, m.
    fn between(&self, motion: &Motion<'_>) -> Vector3<f64> {
        (self.upper.reference - self.lower.reference)
            + (self.upper.displacement(motion) - self.lower.displacement(motion))
    }

    /// `∂δ/∂q` (–) with the dropper along the unit vector `direction`, as (coordinate, value).
    fn gradient(&self, direction: Vector3<f64>) -> impl Iterator<Item = (usize, f64)> + use<> {
        let upper = self.upper.columns().map(move |(index, axis)| (index, direction[axis]));
        let lower = self.lower.columns().map(move |(index, axis)| (index, -direction[axis]));
        upper.chain(lower)
    }

    /// Present length, m.
    #[must_use]
    pub fn length(&self, motion: &Motion<'_>) -> f64 {
        self.between(motion).norm()
    }
}

/// Last assembled tangent, one entry per dropper.
#[derive(Clone, Debug)]
struct Assembled {
    /// `w_q k + w_v c`, N/m; zero for a dropper that was slack.
    slopes: Vec<f64>,
    /// Unit vectors.
    directions: Vec<[f64; 3]>,
}

/// All droppers of a line as one contribution.
///
/// The force acts along the line between the two nodes, in three dimensions. A dropper that was taut when the matrix
/// was factored and is slack now (or the other way round) is a rank-one correction `∓ κ u uᵀ` with the direction `u` of
/// that factorisation; the transverse part `F/length`, smaller by five orders of magnitude, keeps its assembled value.
#[derive(Clone, Debug)]
pub struct Droppers {
    law: DropperLaw,
    gravity: f64,
    droppers: Vec<Dropper>,
    groups: Vec<DropperGroup>,
    masses: Vec<EndMass>,
    assembled: Assembled,
    /// Slope (N/m) that the last assembled tangent contains of every dropper of a whole group, if all are equal.
    common_slopes: Vec<Option<f64>>,
    /// `δ⁺₀` of each dropper in the present step, m; padded to whole groups.
    start_closure: Vec<f64>,
    /// `δ⁺₀` of each dropper in the step that has just ended, m: the force at its end belongs to these.
    ended_closure: Vec<f64>,
    /// Half of the present step, or of the one that has just ended, s.
    half: f64,
    /// Elongations and rates at the last evaluation of the forces.
    extensions: Extensions,
    /// True while `extensions` belong to the present motion: within a time step the solver asks for forces first, then
    /// for everything that follows from them.
    evaluated: bool,
    /// Version of the assembled tangent, increased with every assembly.
    version: u64,
    arch: Arch,
}

impl Droppers {
    /// A batch of droppers with one law; `gravity` in m/s².
    #[must_use]
    pub fn new(law: DropperLaw, droppers: Vec<Dropper>, gravity: f64) -> Self {
        let groups = DropperGroup::all(&droppers);
        Self {
            law,
            gravity,
            assembled: Assembled {
                slopes: vec![0.0; droppers.len()],
                directions: vec![[0.0, 0.0, 1.0]; droppers.len()],
            },
            common_slopes: vec![None; groups.len()],
            start_closure: vec![0.0; groups.len() * LANES],
            ended_closure: vec![0.0; groups.len() * LANES],
            half: 0.0,
            extensions: Extensions::new(groups.len()),
            evaluated: false,
            groups,
            masses: EndMass::all(&droppers),
            droppers,
            version: 0,
            arch: Arch::new(),
        }
    }

    /// The droppers in their order.
    #[must_use]
    pub fn as_slice(&self) -> &[Dropper] {
        &self.droppers
    }

    /// Common law of all droppers.
    #[must_use]
    pub fn law(&self) -> DropperLaw {
        self.law
    }

    /// Tension of dropper `index`, N; after a step the one that the next step begins with.
    #[must_use]
    pub fn tension(&self, index: usize, motion: &Motion<'_>) -> f64 {
        let pose = self.droppers[index].pose(motion);
        self.law
            .force(self.step_of(self.start_closure[index]), pose.elongation, pose.rate)
    }

    /// The present step of a dropper that began with `start` m.
    fn step_of(&self, start: f64) -> UnilateralStep {
        UnilateralStep::new(UnilateralStart::Known(start), self.half)
    }

    /// Elongations `δ` of all droppers at the end of the last step, m.
    #[must_use]
    pub fn elongations(&self) -> &[f64] {
        &self.extensions.elongation[..self.droppers.len()]
    }

    /// Gradient `∂δ/∂q` (–) of each dropper, as (coordinate, value).
    pub fn gradients(&self, motion: &Motion<'_>) -> impl Iterator<Item = Vec<(usize, f64)>> {
        let gradient = |dropper: &Dropper| dropper.gradient(dropper.pose(motion).direction).collect();
        self.droppers.iter().map(gradient)
    }

    /// Number of droppers that exert no force.
    #[must_use]
    pub fn slack_count(&self, motion: &Motion<'_>) -> usize {
        (0..self.droppers.len())
            .filter(|&index| self.tension(index, motion) == 0.0)
            .count()
    }
}

/// All coordinates.
const EVERYWHERE: Range<usize> = 0..usize::MAX;

impl Droppers {
    /// Elongation (m) and its rate (m/s) at `motion`.
    fn extension(&self, index: usize, motion: &Motion<'_>) -> (f64, f64) {
        if self.evaluated {
            return (self.extensions.elongation[index], self.extensions.rate[index]);
        }
        let pose = self.droppers[index].pose(motion);
        (pose.elongation, pose.rate)
    }

    /// Adds the forces of the springs and dampers that touch a range of coordinates.
    fn pull(&mut self, range: Range<usize>, motion: &Motion<'_>, force: &mut [f64]) {
        self.arch.dispatch(Evaluate {
            step: Step {
                law: self.law,
                start_closure: &self.start_closure,
                half: self.half,
            },
            groups: &self.groups,
            range,
            motion,
            extensions: &mut self.extensions,
            force,
        });
    }

    fn find_common_slopes(&mut self) {
        for (common, group) in self.common_slopes.iter_mut().zip(self.assembled.slopes.chunks(LANES)) {
            let same = group.len() == LANES && group.iter().all(|&slope| slope == group[0]);
            *common = same.then_some(group[0]);
        }
    }

    /// Adds weights, and inertia if accelerations are given.
    fn weigh(&self, range: &Range<usize>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        for mass in &self.masses {
            mass.add_force(range, (self.gravity, v_dot), force);
        }
    }
}

impl Force for Droppers {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.pull(EVERYWHERE, motion, force);
        self.evaluated = false;
        self.weigh(&EVERYWHERE, None, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.version += 1;
        for (index, dropper) in self.droppers.iter().enumerate() {
            let step = self.step_of(self.start_closure[index]);
            let pose = dropper.pose(motion);
            let force = self.law.force(step, pose.elongation, pose.rate);
            let (_, damping) = self.law.derivatives(step, pose.elongation, pose.rate);
            let mut block = Matrix3::zeros();
            let mut slope = 0.0;
            if force > 0.0 {
                slope = self.law.slope(step, pose.elongation, pose.rate, weights);
                let outer = pose.direction * pose.direction.transpose();
                // ∂²length/∂r², the change of the direction with the position of the upper end.
                let turning = (Matrix3::identity() - outer) / pose.length;
                // ∂F/∂r = (∂F/∂δ) d + (∂F/∂δ̇) ∂δ̇/∂r with ∂δ̇/∂r = turning · velocity.
                let swing = pose.direction * (turning * pose.velocity).transpose();
                block = slope * outer + weights.q * (damping * swing + force * turning);
            }
            self.assembled.slopes[index] = slope;
            self.assembled.directions[index] = pose.direction.into();
            dropper.upper.add_relative_block(&dropper.lower, &block, blocks);
        }
        self.find_common_slopes();
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

    /// Power of the force without the spring's share, in the step that has just ended.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let heat = self.droppers.iter().zip(&self.ended_closure).map(|(dropper, &start)| {
            let pose = dropper.pose(motion);
            let elastic = self.law.stiffness * pose.elongation.max(0.0);
            (self.law.force(self.step_of(start), pose.elongation, pose.rate) - elastic) * pose.rate
        });
        Some(Power {
            driven: 0.0,
            dissipated: heat.sum(),
        })
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl OnePass for Droppers {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_dynamic_force_within(EVERYWHERE, motion, v_dot, force);
        self.evaluated = true;
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        Some(self)
    }
}

impl ByRange for Droppers {
    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.weigh(&range, Some(v_dot), force);
        self.pull(range, motion, force);
    }
}

impl LowRank for Droppers {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        let taut = weights.q * self.law.stiffness + weights.v * self.law.damping;
        for (group, common) in self.common_slopes.iter().enumerate() {
            if *common == Some(taut) && self.evaluated && self.extensions.taut[group] {
                continue;
            }
            let first = group * LANES;
            for slot in first..self.droppers.len().min(first + LANES) {
                let (elongation, rate) = self.extension(slot, motion);
                let step = self.step_of(self.start_closure[slot]);
                let coefficient = self.law.slope(step, elongation, rate, weights) - self.assembled.slopes[slot];
                if coefficient != 0.0 {
                    let direction = Vector3::from(self.assembled.directions[slot]);
                    let gradient = self.droppers[slot].gradient(direction);
                    updates.rank_one(slot as u32, self.version, coefficient, gradient);
                }
            }
        }
    }
}

impl StepHistory for Droppers {
    fn begin_step(&mut self, _: &Motion<'_>, h: f64) {
        self.half = 0.5 * h;
    }

    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        self.evaluated
            && self.arch.dispatch(Move {
                step: Step {
                    law: self.law,
                    start_closure: &self.start_closure,
                    half: self.half,
                },
                groups: &self.groups,
                motion,
                extensions: &mut self.extensions,
            })
    }

    fn end_step(&mut self, motion: &Motion<'_>) {
        if !self.evaluated {
            for (index, dropper) in self.droppers.iter().enumerate() {
                let pose = dropper.pose(motion);
                self.extensions.elongation[index] = pose.elongation;
                self.extensions.rate[index] = pose.rate;
            }
        }
        self.evaluated = false;
        let step = UnilateralStep::new(UnilateralStart::Unknown, self.half);
        let Extensions { elongation, rate, .. } = &self.extensions;
        for (start, (&elongation, &rate)) in self.ended_closure.iter_mut().zip(elongation.iter().zip(rate)) {
            *start = step.ahead(elongation, rate);
        }
        std::mem::swap(&mut self.ended_closure, &mut self.start_closure);
    }

    fn save(&self, out: &mut Vec<f64>) {
        save_step(self.half, &self.start_closure[..self.droppers.len()], out);
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        restore_step(&mut self.half, &mut self.start_closure[..self.droppers.len()], values);
        self.evaluated = false;
    }
}

#[cfg(test)]
mod tests;
