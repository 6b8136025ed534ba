//! Residual of the equations of motion: evaluated whole, in the ranges that a correction has changed, or known without
//! evaluation.
use crate::capability::{add_dynamic_tangent, by_range};
use crate::linear::iteration_matrix::{IterationMatrix, MovingRows, visit_jacobian, visit_still_jacobian};
use crate::{Blocks, Layout, Motion, NewtonOptions, SparseMatrix, System, Updates, Weights};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Size of the residual in units of its tolerance, and the place of the largest one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    /// Largest ratio of residual to tolerance; converged at ≤ 1; not a number where a residual is none.
    pub ratio: f64,
    /// First unknown of those with the largest ratio: coordinates or constraint equations.
    start: usize,
    /// The largest residual of these, N or m.
    pub value: f64,
}

/// Changes since the last residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Since {
    /// Anything.
    Anything,
    /// The last correction, applied in full.
    Correction,
    /// The last correction, applied in part.
    PartOfCorrection,
}

/// The last correction, and the equations that it solves.
pub(crate) struct Correction<'a> {
    /// `Δq` and `Δλ`.
    pub change: &'a [f64],
    /// Low-rank terms `U C Uᵀ`.
    pub updates: &'a Updates,
    /// `C Uᵀ Δq`.
    pub forces: &'a [f64],
    /// The unknowns whose equations it enters.
    pub affected: &'a [Range<usize>],
}

/// A solution with the factored matrix leaves less than this part of its right side: blocks inverted on the diagonal of
/// a line lose about half of the digits of a double. Tolerances below that are proved by evaluation.
const SOLVED: f64 = 1e-7;

/// Part of the coordinates above which all are evaluated in one pass: each range takes more than its share of that.
const WHOLE: f64 = 0.7;

/// Runs of rows of linear contributions alone that are shorter than this are evaluated with their neighbours: a range
/// of their own on either side, for which every contribution is asked, costs more.
const SHORTEST: usize = 32;

/// `Q − M v̇ − g_qᵀ λ` and `g` of one system, and their terms.
pub(crate) struct Imbalance {
    arch: Arch,
    coordinates: usize,
    fixed: Vec<usize>,
    /// `Q − M v̇` of the contributions that evaluate ranges.
    local: Vec<f64>,
    /// All other forces.
    others: Vec<f64>,
    scratch: Vec<f64>,
    /// The sum of both, then `g`.
    pub sum: Vec<f64>,
    linear: Option<LinearPart>,
    /// First residual of the present step in units of its tolerance.
    first: Option<f64>,
}

/// Rows on which linear contributions act, without other contributions that evaluate ranges and without constraints,
/// except those that move, which are borders of the updates. With their part `A_l` of the iteration matrix, that of the
/// others `A_o` and a correction `(A_l + A_o + U C Uᵀ) Δq = r_l + r_o` the linear contributions leave there
///
/// ```text
/// r_l − A_l Δq = A_o Δq + U z − r_o,    z = C Uᵀ Δq
/// ```
///
/// to which droppers and strips contribute a few entries.
struct LinearPart {
    /// Mark of each row, and the same as ranges, ascending and apart.
    own: Vec<bool>,
    rows: Vec<Range<usize>>,
    /// The other rows of contributions that evaluate ranges; each range includes the gaps between its rows.
    evaluated: Vec<Range<usize>>,
    /// `A_o`.
    others: SparseMatrix,
}

/// The indices for which `selected` holds, as ranges that are ascending and apart.
fn ranges(count: usize, selected: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for index in (0..count).filter(|&index| selected(index)) {
        match ranges.last_mut() {
            Some(last) if last.end == index => last.end += 1,
            _ => ranges.push(index..index + 1),
        }
    }
    ranges
}

/// Intersection of two ranges.
fn common(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    a.start.max(b.start)..a.end.min(b.end)
}

impl LinearPart {
    /// None if there are no such rows.
    fn of(system: &mut dyn System, motion: &Motion<'_>) -> Option<Self> {
        let coordinates = system.layout().coordinates();
        let mut rows_of = |linear: bool| {
            let mut rows = vec![false; coordinates];
            let mut blocks = Blocks::mark(&mut rows);
            system.forces(&mut |force| {
                if let Some(by_range) = by_range(force)
                    && by_range.is_linear() == linear
                {
                    by_range.add_dynamic_tangent(motion, Weights { q: 1.0, v: 1.0 }, 1.0, &mut blocks);
                }
            });
            rows
        };
        let (mut own, mut evaluated) = (rows_of(true), rows_of(false));
        visit_still_jacobian(system, motion, MovingRows::Placeholders, &mut |_, columns, _| {
            columns.iter().for_each(|&column| evaluated[column] |= own[column]);
        });
        for (own, evaluated) in own.iter_mut().zip(&evaluated) {
            *own &= !evaluated;
        }
        if evaluated.contains(&true) {
            let short = ranges(coordinates, |index| own[index]).into_iter();
            for range in short.filter(|range| range.len() < SHORTEST) {
                own[range.clone()].fill(false);
                evaluated[range].fill(true);
            }
        }
        let rows = ranges(coordinates, |index| own[index]);
        // Rows between two others cost less than a range of their own.
        let evaluated = ranges(coordinates, |index| !own[index])
            .into_iter()
            .filter(|range| evaluated[range.clone()].contains(&true));
        (!rows.is_empty()).then(|| Self {
            evaluated: evaluated.collect(),
            own,
            rows,
            others: SparseMatrix::default(),
        })
    }

    /// Takes over the part of the other contributions in the matrix that is factored at `motion`.
    fn linearise(&mut self, system: &mut dyn System, motion: &Motion<'_>, mass_weight: f64, weights: Weights) {
        let mut entries = Blocks::collect(|blocks| {
            system.forces(&mut |force| {
                if by_range(force).is_none() {
                    add_dynamic_tangent(force, motion, weights, mass_weight, blocks);
                }
            });
        });
        entries.retain(|entry| self.own[entry.0 as usize]);
        self.others = SparseMatrix::from_entries(system.layout().coordinates(), entries);
    }

    /// Residual of the linear contributions after a correction; `others` holds that of the other ones before it.
    fn after(&self, correction: &Correction<'_>, others: &[f64], local: &mut [f64]) {
        for range in &self.rows {
            for (left, other) in local[range.clone()].iter_mut().zip(&others[range.clone()]) {
                *left = -other;
            }
        }
        self.others.multiply_add(correction.change, local);
        for (row, z) in correction.forces.iter().enumerate() {
            // The multiplier of a border lies behind the coordinates.
            let own = |index: usize| self.own.get(index).is_some_and(|own| *own);
            for (index, value) in correction.updates.entries(row).filter(|entry| own(entry.0)) {
                local[index] += z * value;
            }
        }
    }
}

impl Imbalance {
    pub fn new(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        let linear = LinearPart::of(system, motion);
        let layout: &Layout = system.layout();
        let coordinates = layout.coordinates();
        Self {
            arch: Arch::new(),
            coordinates,
            fixed: layout.fixed().to_vec(),
            local: vec![0.0; coordinates],
            others: vec![0.0; coordinates],
            scratch: vec![0.0; coordinates],
            sum: vec![0.0; coordinates + layout.constraints()],
            linear,
            first: None,
        }
    }

    /// Returns `true` if all contributions that evaluate ranges are linear, and there are some.
    pub fn is_linear(&self) -> bool {
        self.linear.as_ref().is_some_and(|linear| linear.evaluated.is_empty())
    }

    /// First residual of forces in the present step, in units of its tolerance; zero before there is one.
    pub fn first(&self) -> f64 {
        self.first.unwrap_or(0.0)
    }

    /// Takes over the matrix that is factored at `motion`.
    pub fn linearise(&mut self, system: &mut dyn System, motion: &Motion<'_>, mass_weight: f64, weights: Weights) {
        if let Some(linear) = &mut self.linear {
            linear.linearise(system, motion, mass_weight, weights);
        }
    }

    /// Evaluates `Q`.
    pub fn at_rest(&mut self, system: &mut dyn System, motion: &Motion<'_>) {
        let others = &mut self.others;
        others.fill(0.0);
        self.local.fill(0.0);
        system.forces(&mut |contribution| contribution.add_force(motion, others));
    }

    /// Evaluates `Q − M v̇`, as far as the last correction may have changed it.
    pub fn in_motion(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        v_dot: &[f64],
        matrix: &IterationMatrix,
        (since, last): (Since, &Correction<'_>),
    ) {
        let linear = self.linear.as_ref().filter(|_| {
            let solved = self.first.is_some_and(|first| first * SOLVED <= 1.0);
            since == Since::Correction && solved
        });
        let known = linear.is_some();
        if let Some(linear) = linear {
            linear.after(last, &self.others, &mut self.local);
        }
        if since == Since::Anything {
            self.first = None;
        }
        let affected: usize = last.affected.iter().map(|range| range.len()).sum();
        let whole = since == Since::Anything || (!known && affected as f64 > WHOLE * self.coordinates as f64);
        if whole {
            self.local.fill(0.0);
        }
        self.others.fill(0.0);
        let (local, others) = (&mut self.local, &mut self.others);
        system.forces(&mut |contribution| {
            let Some(one_pass) = contribution.one_pass() else {
                contribution.add_force(motion, others);
                return;
            };
            if one_pass.by_range().is_none() {
                one_pass.add_dynamic_force(motion, v_dot, others);
            } else if whole {
                one_pass.add_dynamic_force(motion, v_dot, local);
            }
        });
        matrix.subtract_inertia(v_dot, others);
        if whole {
            return;
        }
        let everything = 0..self.coordinates;
        let evaluated = match &self.linear {
            Some(linear) if known => &linear.evaluated[..],
            _ => std::slice::from_ref(&everything),
        };
        let ranges = last.affected.iter().flat_map(|affected| {
            let within = evaluated.iter().map(|evaluated| common(affected, evaluated));
            within.filter(|range| !range.is_empty())
        });
        for range in ranges {
            self.scratch[range.clone()].fill(0.0);
            let scratch = &mut self.scratch;
            system.forces(&mut |contribution| {
                if let Some(by_range) = by_range(contribution) {
                    by_range.add_dynamic_force_within(range.clone(), motion, v_dot, scratch);
                }
            });
            self.local[range.clone()].copy_from_slice(&self.scratch[range]);
        }
    }

    /// Adds up what was evaluated, and the constraints with the multipliers `lambda`.
    pub fn sum_up(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        lambda: &[f64],
        options: &NewtonOptions,
    ) -> Residual {
        let (force, constraint) = self.sum.split_at_mut(self.coordinates);
        let others = &mut self.others;
        visit_jacobian(system, motion, &mut |row, columns, values| {
            for (&column, &value) in columns.iter().zip(values) {
                others[column] -= value * lambda[row];
            }
        });
        let mut first = 0;
        system.constraints(&mut |contribution| {
            let next = first + contribution.dimension();
            contribution.residual(motion, &mut constraint[first..next]);
            first = next;
        });
        for &index in &self.fixed {
            (self.others[index], self.local[index]) = (0.0, 0.0);
        }
        let of_forces = self.arch.dispatch(Sum {
            terms: [&self.local, &self.others],
            sum: force,
        });
        let of_constraints = largest(constraint);
        let ratios = [
            of_forces / options.tolerance,
            of_constraints / options.constraint_tolerance,
        ];
        self.first.get_or_insert(ratios[0]);
        let (ratio, start, value) = if ratios[1] > ratios[0] || ratios[1].is_nan() {
            (ratios[1], self.coordinates, of_constraints)
        } else {
            (ratios[0], 0, of_forces)
        };
        Residual { ratio, start, value }
    }

    /// Becomes the effect of a change of the inputs from motion `before` to motion `after`, the same state.
    pub fn jump(&mut self, system: &mut dyn System, before: &Motion<'_>, after: &Motion<'_>) {
        self.sum.fill(0.0);
        let force = &mut self.sum[..self.coordinates];
        let mut add = |motion: &Motion<'_>| {
            system.forces(&mut |contribution| {
                if contribution.depends_on_inputs() && by_range(contribution).is_none() {
                    contribution.add_force(motion, force);
                }
            });
            force.iter_mut().for_each(|value| *value = -*value);
        };
        add(before);
        add(after);
        force.iter_mut().for_each(|value| *value = -*value);
        for &index in &self.fixed {
            self.sum[index] = 0.0;
        }
    }

    /// The unknown with the largest residual.
    pub fn worst(&self, residual: &Residual) -> usize {
        let part = if residual.start == 0 {
            &self.sum[..self.coordinates]
        } else {
            &self.sum[self.coordinates..]
        };
        let size = |value: f64| if value.is_finite() { value.abs() } else { f64::INFINITY };
        let worst = (0..part.len()).max_by(|&i, &j| size(part[i]).total_cmp(&size(part[j])));
        residual.start + worst.unwrap_or(0)
    }
}

/// The sum of two vectors, and its largest absolute value; not a number where one of them is none or infinite.
struct Sum<'a> {
    terms: [&'a [f64]; 2],
    sum: &'a mut [f64],
}

impl WithSimd for Sum<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let zero = simd.splat_f64s(0.0);
        let (mut largest, mut spoilt) = (zero, zero);
        let mut see = |x: S::f64s| {
            largest = simd.max_f64s(largest, simd.abs_f64s(x));
            // 0 · ∞ is not a number either.
            spoilt = simd.mul_add_e_f64s(x, zero, spoilt);
        };
        let [a, b] = self.terms;
        let ((a, a_rest), (b, b_rest)) = (S::as_simd_f64s(a), S::as_simd_f64s(b));
        let (sum, rest) = S::as_mut_simd_f64s(self.sum);
        for (sum, (&a, &b)) in sum.iter_mut().zip(a.iter().zip(b)) {
            *sum = simd.add_f64s(a, b);
            see(*sum);
        }
        for (sum, (a, b)) in rest.iter_mut().zip(a_rest.iter().zip(b_rest)) {
            *sum = a + b;
        }
        see(simd.partial_load_f64s(rest));
        simd.reduce_max_f64s(largest) + simd.reduce_sum_f64s(spoilt)
    }
}

/// The largest absolute value of a few numbers; not a number where one of them is none or infinite.
fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |most: f64, value| most.max(value.abs()) + 0.0 * value)
}
