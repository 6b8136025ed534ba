//! Droppers side by side in the lanes of vector registers.
use super::ends::Ends;
use super::{Dropper, DropperLaw};
use crate::{Attachment, UnilateralStart, UnilateralStep};
use dynamics::Motion;
use dynamics::simd::{Components, GROUP, Lanes, Number, Space, Transpose};
use dynamics::unilateral::unilateral_force;
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Number of droppers in a group.
pub(super) const LANES: usize = GROUP;

/// One number per dropper of a group.
pub(super) type Array = [f64; LANES];

/// Constants of a group of droppers, from which its forces follow.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct DropperGroup {
    ends: Ends,
    /// From the lower to the upper reference position, m.
    between: [Array; 3],
    /// m.
    unstressed_length: Array,
    /// Range that contains all coordinates of the group.
    range: Range<usize>,
    /// True if no end moves sideways; the difference along y is then constant.
    planar: bool,
}

impl DropperGroup {
    /// The groups of droppers in their order.
    pub fn all(droppers: &[Dropper]) -> Vec<Self> {
        droppers.chunks(LANES).map(Self::new).collect()
    }

    fn new(droppers: &[Dropper]) -> Self {
        let ends = || droppers.iter().flat_map(|dropper| [dropper.upper, dropper.lower]);
        let columns = || ends().flat_map(|end| end.columns());
        let indices = || columns().map(|(index, _)| index);
        let planar = columns().all(|(_, axis)| axis != 1);
        let mut group = Self {
            ends: Ends::new(droppers, if planar { &[0, 2] } else { &[0, 1, 2] }),
            // A lane without a dropper has no force: its ends are at the unstressed length.
            between: [[0.0; LANES], [0.0; LANES], [1.0; LANES]],
            unstressed_length: [1.0; LANES],
            range: indices().min().unwrap_or(0)..indices().max().map_or(0, |last| last + 1),
            planar,
        };
        for (lane, dropper) in droppers.iter().enumerate() {
            let between = dropper.upper.reference - dropper.lower.reference;
            group.unstressed_length[lane] = dropper.unstressed_length;
            for axis in 0..3 {
                group.between[axis][lane] = between[axis];
            }
        }
        group
    }

    /// True if the group may touch a range of coordinates.
    fn meets(&self, range: &Range<usize>) -> bool {
        self.range.start < range.end && range.start < self.range.end
    }

    /// Finds elongations and their rates, and the vectors from the lower to the upper ends; no end moves along other
    /// axes than `axes`.
    #[inline(always)]
    fn extend<S: Simd, const D: usize>(
        &self,
        transpose: Transpose<S>,
        axes: &[usize; D],
        (q, v): (&[f64], &[f64]),
        (elongation, rate): (&mut [f64], &mut [f64]),
    ) -> Seen<D> {
        let displacement = self.ends.differences(transpose, axes, q);
        let velocity = self.ends.differences(transpose, axes, v);
        let mut seen = Seen {
            between: [[0.0; LANES]; D],
            inverse_length: [0.0; LANES],
        };
        for part in 0..Lanes::<S>::PARTS {
            let load = |values: &[f64]| Lanes::load(transpose.simd, values, part);
            let unstressed_length = load(&self.unstressed_length);
            // `array::map` is avoided: a closure that is not inlined cannot use vector registers.
            let (mut between, mut moving) = (Components([unstressed_length; D]), Components([unstressed_length; D]));
            for (k, &axis) in axes.iter().enumerate() {
                between.0[k] = load(&self.between[axis]) + load(&displacement[k]);
                moving.0[k] = load(&velocity[k]);
                between.0[k].store(&mut seen.between[k], part);
            }
            let mut square = between.dot(between);
            if D < 3 {
                let y = load(&self.between[1]);
                square = y.mul_add(y, square);
            }
            // Ends that coincide have no direction: no force.
            let length = square.sqrt().at_least(f64::MIN_POSITIVE);
            let inverse = length.constant(1.0) / length;
            inverse.store(&mut seen.inverse_length, part);
            (length - unstressed_length).store(elongation, part);
            (between.dot(moving) * inverse).store(rate, part);
        }
        seen
    }

    /// Finds the extensions and adds the forces of springs and dampers; no end moves along other axes than `axes`.
    #[inline(always)]
    fn pull<S: Simd, const D: usize>(
        &self,
        (transpose, axes): (Transpose<S>, &[usize; D]),
        step: Step<'_>,
        motion: (&[f64], &[f64]),
        (elongation, rate, taut): (&mut [f64], &mut [f64], &mut bool),
        force: &mut [f64],
    ) {
        let seen = self.extend(transpose, axes, motion, (elongation, rate));
        let tensions = step.tensions(transpose.simd, (elongation, rate));
        *taut = step.began_taut() && every(&tensions, |tension| tension > 0.0);
        let mut pulls = seen.between;
        for part in 0..Lanes::<S>::PARTS {
            let load = |values: &[f64]| Lanes::load(transpose.simd, values, part);
            let per_length = load(&tensions) * load(&seen.inverse_length);
            for pull in &mut pulls {
                (load(pull) * per_length).store(pull, part);
            }
        }
        self.ends.transfer(transpose, axes, &pulls, force);
    }
}

/// Vectors from the lower to the upper ends of a group.
struct Seen<const D: usize> {
    /// Components by axis, m.
    between: [Array; D],
    /// 1/m
    inverse_length: Array,
}

/// The law of droppers in the present time step.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    pub law: DropperLaw,
    /// `δ⁺₀`, m; one per lane.
    pub start_closure: &'a [f64],
    /// Half of the step, s.
    pub half: f64,
}

impl Step<'_> {
    /// Steps of the groups one after the other.
    #[inline(always)]
    fn of_groups(self) -> impl Iterator<Item = Self> {
        self.start_closure
            .chunks_exact(LANES)
            .map(move |start_closure| Self { start_closure, ..self })
    }

    fn of(self, lane: usize) -> UnilateralStep {
        UnilateralStep::new(UnilateralStart::Known(self.start_closure[lane]), self.half)
    }

    /// True if all droppers began the step taut.
    #[inline(always)]
    fn began_taut(self) -> bool {
        every(self.start_closure, |start| start >= 0.0)
    }

    /// Tensions (N) by elongations (m) and their rates (m/s).
    #[inline(always)]
    fn tensions<S: Simd>(self, simd: S, (elongation, rate): (&[f64], &[f64])) -> Array {
        let mut parts = [1.0; LANES];
        if !self.began_taut() {
            for (lane, part) in parts.iter_mut().enumerate() {
                let step = self.of(lane);
                *part = step.closed_part(step.ahead(elongation[lane], rate[lane]), rate[lane]).0;
            }
        }
        let mut tensions = [0.0; LANES];
        for part in 0..Lanes::<S>::PARTS {
            let load = |values: &[f64]| Lanes::load(simd, values, part);
            let law = (self.law.stiffness, self.law.damping);
            unilateral_force(law, load(&parts), load(elongation), load(rate)).store(&mut tensions, part);
        }
        tensions
    }

    /// True if the forces of two motions, given as for [`Step::tensions`], come from the same branches of the law.
    #[inline(always)]
    fn is_smooth_between<S: Simd>(self, simd: S, before: (&[f64], &[f64]), now: (&[f64], &[f64])) -> bool {
        if self.began_taut() {
            let pull = |motion: (&[f64], &[f64])| self.tensions(simd, motion).map(|tension| tension > 0.0);
            return pull(before) == pull(now);
        }
        let branch =
            |lane: usize, motion: (&[f64], &[f64])| self.law.branch(self.of(lane), motion.0[lane], motion.1[lane]);
        (0..LANES).all(|lane| branch(lane, before) == branch(lane, now))
    }
}

/// True if `holds` is true of all values. Every value is tested, without an early exit, so that the lanes of a register
/// serve.
#[inline(always)]
fn every(values: &[f64], holds: impl Fn(f64) -> bool) -> bool {
    values.iter().fold(true, |all, &value| all & holds(value))
}

/// Elongations and rates of all droppers; the last lanes may have no dropper.
#[derive(Clone, Debug)]
pub(super) struct Extensions {
    /// `δ`, m.
    pub elongation: Vec<f64>,
    /// `δ̇`, m/s.
    pub rate: Vec<f64>,
    /// For each whole group, true if all droppers began the step taut and pull.
    pub taut: Vec<bool>,
}

impl Extensions {
    /// Room for the droppers of all groups.
    pub fn new(groups: usize) -> Self {
        Self {
            elongation: vec![0.0; groups * LANES],
            rate: vec![0.0; groups * LANES],
            taut: vec![false; groups],
        }
    }
}

/// Finds the extensions of all groups that meet `range`, and adds the forces of their springs and dampers.
pub(super) struct Evaluate<'a> {
    pub step: Step<'a>,
    pub groups: &'a [DropperGroup],
    pub range: Range<usize>,
    pub motion: &'a Motion<'a>,
    pub extensions: &'a mut Extensions,
    pub force: &'a mut [f64],
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Motion { q, v, .. } = *self.motion;
        let transpose = Transpose::new(simd);
        let lanes = (self.extensions.elongation.chunks_exact_mut(LANES))
            .zip(self.extensions.rate.chunks_exact_mut(LANES))
            .zip(&mut self.extensions.taut)
            .zip(self.step.of_groups());
        for (group, (((elongation, rate), taut), step)) in self.groups.iter().zip(lanes) {
            if !group.meets(&self.range) {
                continue;
            }
            let extensions = (elongation, rate, taut);
            if group.planar {
                group.pull((transpose, &[0, 2]), step, (q, v), extensions, self.force);
            } else {
                group.pull((transpose, &[0, 1, 2]), step, (q, v), extensions, self.force);
            }
        }
    }
}

/// Finds the extensions of all groups; true if every dropper's force comes from the same branch of its law as before.
pub(super) struct Move<'a> {
    pub step: Step<'a>,
    pub groups: &'a [DropperGroup],
    pub motion: &'a Motion<'a>,
    pub extensions: &'a mut Extensions,
}

impl WithSimd for Move<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Motion { q, v, .. } = *self.motion;
        let transpose = Transpose::new(simd);
        let lanes = (self.extensions.elongation.chunks_exact_mut(LANES))
            .zip(self.extensions.rate.chunks_exact_mut(LANES))
            .zip(self.step.of_groups());
        let mut smooth = true;
        for (group, ((elongation, rate), step)) in self.groups.iter().zip(lanes) {
            let mut now = ([0.0; LANES], [0.0; LANES]);
            if group.planar {
                group.extend(transpose, &[0, 2], (q, v), (&mut now.0, &mut now.1));
            } else {
                group.extend(transpose, &[0, 1, 2], (q, v), (&mut now.0, &mut now.1));
            }
            smooth &= step.is_smooth_between(simd, (elongation, rate), (&now.0, &now.1));
            elongation.copy_from_slice(&now.0);
            rate.copy_from_slice(&now.1);
        }
        smooth
    }
}

/// One end of a dropper with its share of the mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndMass {
    end: Attachment,
    /// kg
    value: f64,
}

impl EndMass {
    /// Ends of all droppers with mass.
    pub fn all(droppers: &[Dropper]) -> Vec<Self> {
        let heavy = droppers.iter().filter(|dropper| dropper.mass > 0.0);
        let ends = heavy.flat_map(|dropper| [dropper.upper, dropper.lower].map(|end| (end, 0.5 * dropper.mass)));
        ends.map(|(end, value)| Self { end, value }).collect()
    }

    /// Adds weight and inertia, `−m (v̇ + g)`, if the end touches a range of coordinates.
    pub fn add_force(&self, range: &Range<usize>, (gravity, v_dot): (f64, Option<&[f64]>), force: &mut [f64]) {
        if self.end.columns().any(|(index, _)| range.contains(&index)) {
            let acceleration = v_dot.map_or_else(Vector3::zeros, |v_dot| self.end.gather(v_dot));
            let upwards = Vector3::new(0.0, 0.0, gravity);
            self.end.add_force(&((acceleration + upwards) * -self.value), force);
        }
    }
}
