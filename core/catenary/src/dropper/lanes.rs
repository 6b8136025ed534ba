//! Droppers side by side in the lanes of vector registers.
use super::{Dropper, DropperLaw};
use crate::{AtStart, Attachment, OneWayStep};
use dynamics::Motion;
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Droppers of a group.
pub(super) const LANES: usize = 8;

type Lanes = [f64; LANES];

/// What the forces of some droppers follow from; a lane without a dropper has no coordinates.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group {
    /// Coordinates of both ends by axis; `usize::MAX` stands for one that does not exist: no vector is as long.
    upper: [[usize; LANES]; 3],
    lower: [[usize; LANES]; 3],
    /// From the lower to the upper reference position, m.
    between: [Lanes; 3],
    /// m.
    unstressed_length: Lanes,
    /// All its coordinates lie in here.
    range: Range<usize>,
    /// Whether no end moves sideways; the difference along y is constant then.
    planar: bool,
}

impl Group {
    /// The groups of droppers in their order.
    pub fn all(droppers: &[Dropper]) -> Vec<Self> {
        droppers.chunks(LANES).map(Self::new).collect()
    }

    fn new(droppers: &[Dropper]) -> Self {
        let missing = usize::MAX;
        let mut group = Self {
            upper: [[missing; LANES]; 3],
            lower: [[missing; LANES]; 3],
            between: [[0.0; LANES], [0.0; LANES], [1.0; LANES]],
            unstressed_length: [1.0; LANES],
            range: missing..0,
            planar: true,
        };
        for (lane, dropper) in droppers.iter().enumerate() {
            let between = dropper.upper.reference - dropper.lower.reference;
            group.unstressed_length[lane] = dropper.unstressed_length;
            for axis in 0..3 {
                group.between[axis][lane] = between[axis];
                let mut place = |end: &Attachment, coordinates: &mut [usize; LANES]| {
                    if let Some(index) = end.coordinate(axis) {
                        coordinates[lane] = index;
                        group.planar &= axis != 1;
                        group.range = group.range.start.min(index)..group.range.end.max(index + 1);
                    }
                };
                place(&dropper.upper, &mut group.upper[axis]);
                place(&dropper.lower, &mut group.lower[axis]);
            }
        }
        group
    }

    /// Whether it may have to do with a range of coordinates.
    fn meets(&self, range: &Range<usize>) -> bool {
        self.range.start < range.end && range.start < self.range.end
    }

    /// Finds the extensions, and where the upper ends are as seen from the lower ones; no end moves along other axes than `axes`.
    #[inline(always)]
    fn extend<const D: usize>(&self, axes: &[usize; D], (q, v): (&[f64], &[f64])) -> Extended<D> {
        let mut between = [[0.0; LANES]; D];
        let (mut square, mut along) = ([0.0; LANES], [0.0; LANES]);
        if D < 3 {
            for (square, y) in square.iter_mut().zip(self.between[1]) {
                *square = y * y;
            }
        }
        for (between, &axis) in between.iter_mut().zip(axes) {
            *between = self.difference(axis, self.between[axis], q);
            let velocity = self.difference(axis, [0.0; LANES], v);
            for lane in 0..LANES {
                square[lane] += between[lane] * between[lane];
                along[lane] += between[lane] * velocity[lane];
            }
        }
        let (mut length, mut elongation, mut rate) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            // Ends that coincide have no direction: no force.
            length[lane] = square[lane].sqrt().max(f64::MIN_POSITIVE);
            elongation[lane] = length[lane] - self.unstressed_length[lane];
            rate[lane] = along[lane] / length[lane];
        }
        Extended {
            between,
            length,
            elongation,
            rate,
        }
    }

    /// Finds the extensions and adds the forces of springs and dampers; no end moves along other axes than `axes`.
    #[inline(always)]
    fn pull<const D: usize>(
        &self,
        axes: &[usize; D],
        (law, at_start, half): (DropperLaw, &[f64], f64),
        (q, v): (&[f64], &[f64]),
        (elongation, rate, taut): (&mut [f64], &mut [f64], &mut bool),
        force: &mut [f64],
    ) {
        let now = self.extend(axes, (q, v));
        elongation.copy_from_slice(&now.elongation);
        rate.copy_from_slice(&now.rate);
        let mut pull_per_length = [0.0; LANES];
        for lane in 0..LANES {
            let step = OneWayStep::new(AtStart::At(at_start[lane]), half);
            pull_per_length[lane] = law.force(step, now.elongation[lane], now.rate[lane]) / now.length[lane];
        }
        *taut = (0..LANES).all(|lane| at_start[lane] >= 0.0 && pull_per_length[lane] > 0.0);
        for (between, &axis) in now.between.iter().zip(axes) {
            for lane in 0..LANES {
                let pull = pull_per_length[lane] * between[lane];
                if let Some(force) = force.get_mut(self.upper[axis][lane]) {
                    *force -= pull;
                }
                if let Some(force) = force.get_mut(self.lower[axis][lane]) {
                    *force += pull;
                }
            }
        }
    }

    /// Difference of the ends' entries of `values` along an axis, on top of `start`.
    #[inline(always)]
    fn difference(&self, axis: usize, start: Lanes, values: &[f64]) -> Lanes {
        let mut difference = start;
        let at = |index: usize| values.get(index).copied().unwrap_or(0.0);
        for (lane, difference) in difference.iter_mut().enumerate() {
            *difference += at(self.upper[axis][lane]) - at(self.lower[axis][lane]);
        }
        difference
    }
}

/// How some droppers stand.
struct Extended<const D: usize> {
    /// From the lower to the upper end by axis, m.
    between: [Lanes; D],
    /// m
    length: Lanes,
    /// `δ`, m.
    elongation: Lanes,
    /// `δ̇`, m/s.
    rate: Lanes,
}

/// Where droppers stand: entries of the last lanes are without a dropper.
#[derive(Clone, Debug)]
pub(super) struct Extensions {
    /// `δ`, m.
    pub elongation: Vec<f64>,
    /// `δ̇`, m/s.
    pub rate: Vec<f64>,
    /// Of each whole group, whether all began the step taut and pull.
    pub taut: Vec<bool>,
}

impl Extensions {
    /// Room for those of all groups.
    pub fn new(groups: usize) -> Self {
        Self {
            elongation: vec![0.0; groups * LANES],
            rate: vec![0.0; groups * LANES],
            taut: vec![false; groups],
        }
    }
}

/// Finds the extensions of all groups that meet `range`, and adds their springs' and dampers' forces.
pub(super) struct Evaluate<'a> {
    pub law: DropperLaw,
    pub groups: &'a [Group],
    /// `δ⁺₀`, m; one per lane.
    pub at_start: &'a [f64],
    /// Half of the step, s.
    pub half: f64,
    pub range: Range<usize>,
    pub motion: &'a Motion<'a>,
    pub extensions: &'a mut Extensions,
    pub force: &'a mut [f64],
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Motion { q, v, .. } = *self.motion;
        let lanes = (self.extensions.elongation.chunks_exact_mut(LANES))
            .zip(self.extensions.rate.chunks_exact_mut(LANES))
            .zip(&mut self.extensions.taut)
            .zip(self.at_start.chunks_exact(LANES));
        for (group, (((elongation, rate), taut), at_start)) in self.groups.iter().zip(lanes) {
            if !group.meets(&self.range) {
                continue;
            }
            let (law, extensions) = ((self.law, at_start, self.half), (elongation, rate, taut));
            if group.planar {
                group.pull(&[0, 2], law, (q, v), extensions, self.force);
            } else {
                group.pull(&[0, 1, 2], law, (q, v), extensions, self.force);
            }
        }
    }
}

/// Finds the extensions of all groups, and whether each dropper's force comes from the same piece of its law as with those before.
pub(super) struct Move<'a> {
    pub law: DropperLaw,
    pub groups: &'a [Group],
    /// `δ⁺₀`, m; one per lane.
    pub at_start: &'a [f64],
    /// Half of the step, s.
    pub half: f64,
    pub motion: &'a Motion<'a>,
    pub extensions: &'a mut Extensions,
}

impl WithSimd for Move<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Motion { q, v, .. } = *self.motion;
        let lanes = (self.extensions.elongation.chunks_exact_mut(LANES))
            .zip(self.extensions.rate.chunks_exact_mut(LANES))
            .zip(self.at_start.chunks_exact(LANES));
        let mut others = 0;
        for (group, ((elongation, rate), at_start)) in self.groups.iter().zip(lanes) {
            let (now_elongation, now_rate) = if group.planar {
                let now = group.extend(&[0, 2], (q, v));
                (now.elongation, now.rate)
            } else {
                let now = group.extend(&[0, 1, 2], (q, v));
                (now.elongation, now.rate)
            };
            for lane in 0..LANES {
                let step = OneWayStep::new(AtStart::At(at_start[lane]), self.half);
                let before = self.law.piece(step, elongation[lane], rate[lane]);
                others |= before ^ self.law.piece(step, now_elongation[lane], now_rate[lane]);
            }
            elongation.copy_from_slice(&now_elongation);
            rate.copy_from_slice(&now_rate);
        }
        others == 0
    }
}

/// One end of a dropper with its share of the mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mass {
    end: Attachment,
    /// kg
    value: f64,
}

impl Mass {
    /// Those of the droppers that have one.
    pub fn all(droppers: &[Dropper]) -> Vec<Self> {
        let heavy = droppers.iter().filter(|dropper| dropper.mass > 0.0);
        let ends = heavy.flat_map(|dropper| [dropper.upper, dropper.lower].map(|end| (end, 0.5 * dropper.mass)));
        ends.map(|(end, value)| Self { end, value }).collect()
    }

    /// Adds weight and inertia, `−m (v̇ + g)`, where it has to do with a range of coordinates.
    pub fn add_force(&self, range: &Range<usize>, (gravity, v_dot): (f64, Option<&[f64]>), force: &mut [f64]) {
        if self.end.columns().any(|(index, _)| range.contains(&index)) {
            let acceleration = v_dot.map_or_else(Vector3::zeros, |v_dot| self.end.gather(v_dot));
            let upwards = Vector3::new(0.0, 0.0, gravity);
            self.end.add_force(&((acceleration + upwards) * -self.value), force);
        }
    }
}
