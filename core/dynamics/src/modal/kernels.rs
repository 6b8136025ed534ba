//! Sums over all modes in the vector registers of the processor.
//!
//! Every vector is a multiple of `LANES` long, and sums run in that many parts whatever the registers: all machines
//! find the same bits.
use super::step::Factors;
use pulp::{Arch, Simd, WithSimd};

/// Numbers that are summed side by side.
pub const LANES: usize = 32;

/// Rows that are taken in one pass.
const TOGETHER: usize = 4;

/// `Σ a b` in double precision.
pub fn dot(arch: Arch, a: &[f32], b: &[f64]) -> f64 {
    struct Dot<'a>(&'a [f32], &'a [f64]);
    impl WithSimd for Dot<'_> {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> f64 {
            let mut sums = [0.0; LANES];
            let (a, b) = (self.0.as_chunks::<LANES>().0, self.1.as_chunks::<LANES>().0);
            for (a, b) in a.iter().zip(b) {
                for k in 0..LANES {
                    sums[k] += f64::from(a[k]) * b[k];
                }
            }
            sums.iter().sum()
        }
    }
    arch.dispatch(Dot(a, b))
}

/// Sum of parts in single precision.
#[inline]
fn sum(mut parts: [f32; LANES]) -> f64 {
    let mut count = LANES;
    while count > 8 {
        count /= 2;
        for k in 0..count {
            parts[k] += parts[k + count];
        }
    }
    parts[..count].iter().map(|part| f64::from(*part)).sum()
}

/// `Σ a b` for each `b`, in single precision.
#[must_use]
pub fn dots<const N: usize>(arch: Arch, a: &[f32], b: [&[f32]; N]) -> [f64; N] {
    let [[sums]] = dots_of_rows(arch, [a], [b]);
    sums
}

/// `Σ a b` for each row `a`, and each `b` of each of `L` lines, in single precision.
#[must_use]
pub fn dots_of_rows<const R: usize, const L: usize, const N: usize>(
    arch: Arch,
    rows: [&[f32]; R],
    b: [[&[f32]; N]; L],
) -> [[[f64; N]; L]; R] {
    struct Dots<'a, const R: usize, const L: usize, const N: usize>([&'a [f32]; R], [[&'a [f32]; N]; L]);
    impl<const R: usize, const L: usize, const N: usize> WithSimd for Dots<'_, R, L, N> {
        type Output = [[[f64; N]; L]; R];
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            // The largest processors hold the parts of eight sums in registers twice over.
            if R * L * N > 8 {
                dots_in_registers::<S, R, L, N, 1>(simd, self.0, self.1)
            } else {
                dots_in_registers::<S, R, L, N, 2>(simd, self.0, self.1)
            }
        }
    }
    arch.dispatch(Dots(rows, b))
}

/// `Σ a b` for each of `count` rows `a`, and each `b` of each of `L` lines: `found` takes the number of a row and its
/// sums. Rows are taken four at a time, which have the same bits one by one.
pub fn dots_of_many<'a, const L: usize, const N: usize>(
    arch: Arch,
    (count, row): (usize, impl Fn(usize) -> &'a [f32]),
    b: [[&[f32]; N]; L],
    mut found: impl FnMut(usize, [[f64; N]; L]),
) {
    let mut all = |first: usize, sums: &[[[f64; N]; L]]| {
        for (at, sums) in (first..).zip(sums) {
            found(at, *sums);
        }
    };
    for at in (0..count).step_by(TOGETHER) {
        match count - at {
            1 => all(at, &dots_of_rows(arch, [row(at)], b)),
            2 => all(at, &dots_of_rows(arch, [0, 1].map(|k| row(at + k)), b)),
            3 => all(at, &dots_of_rows(arch, [0, 1, 2].map(|k| row(at + k)), b)),
            _ => all(at, &dots_of_rows(arch, [0, 1, 2, 3].map(|k| row(at + k)), b)),
        }
    }
}

/// See [`dots_of_rows`]; parts of each sum are taken in groups of `W` registers.
#[inline(always)]
fn dots_in_registers<S: Simd, const R: usize, const L: usize, const N: usize, const W: usize>(
    simd: S,
    rows: [&[f32]; R],
    b: [[&[f32]; N]; L],
) -> [[[f64; N]; L]; R] {
    let mut parts = [[[[0.0_f32; LANES]; N]; L]; R];
    let len = S::as_simd_f32s(rows[0]).0.len() / W;
    let registers = |row| &S::as_simd_f32s(row).0.as_chunks::<W>().0[..len];
    let (rows, b) = (rows.map(registers), b.map(|b| b.map(registers)));
    let every = LANES / S::F32_LANES / W;
    for first in 0..every {
        let mut sums = [[[[simd.splat_f32s(0.0); W]; N]; L]; R];
        let mut at = first;
        while at < len {
            for l in 0..L {
                for n in 0..N {
                    for r in 0..R {
                        for w in 0..W {
                            let product = simd.mul_f32s(rows[r][at][w], b[l][n][at][w]);
                            sums[r][l][n][w] = simd.add_f32s(sums[r][l][n][w], product);
                        }
                    }
                }
            }
            at += every;
        }
        for (parts, sums) in parts
            .as_flattened_mut()
            .as_flattened_mut()
            .iter_mut()
            .zip(sums.as_flattened().as_flattened())
        {
            S::as_mut_simd_f32s(parts).0.as_chunks_mut::<W>().0[first] = *sums;
        }
    }
    let mut all = [[[0.0; N]; L]; R];
    let sums = all.as_flattened_mut().as_flattened_mut().iter_mut();
    for (all, parts) in sums.zip(parts.as_flattened().as_flattened()) {
        *all = sum(*parts);
    }
    all
}

/// Products of all entries.
pub fn products(arch: Arch, a: &[f32], b: &[f32], products: &mut [f32]) {
    struct Products<'a>([&'a [f32]; 2], &'a mut [f32]);
    impl WithSimd for Products<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let [a, b] = self.0;
            for (product, (a, b)) in self.1.iter_mut().zip(a.iter().zip(b)) {
                *product = a * b;
            }
        }
    }
    arch.dispatch(Products([a, b], products));
}

/// A row and its weight for each of `L` lines.
type Term<'a, const L: usize> = (&'a [f32], [f32; L]);

/// `y = Σ α x` over all rows `x` for each `y`, whose weights `α` are its own.
pub fn weigh<'a, const L: usize>(
    arch: Arch,
    terms: impl Iterator<Item = (&'a [f32], [f64; L])>,
    mut y: [&mut [f32]; L],
) {
    let mut some: [Term<'_, L>; TOGETHER] = [(&[], [0.0; L]); TOGETHER];
    let (mut count, mut more) = (0, false);
    for (row, weights) in terms {
        some[count] = (row, weights.map(|weight| weight as f32));
        count += 1;
        if count == TOGETHER {
            weigh_rows::<TOGETHER, L>(arch, &some, &mut y, more);
            (count, more) = (0, true);
        }
    }
    match count {
        1 => weigh_rows::<1, L>(arch, &some, &mut y, more),
        2 => weigh_rows::<2, L>(arch, &some, &mut y, more),
        3 => weigh_rows::<3, L>(arch, &some, &mut y, more),
        _ if !more => y.iter_mut().for_each(|y| y.fill(0.0)),
        _ => {}
    }
}

/// See [`weigh`], for the first `R` rows; added to what is there if `more`.
fn weigh_rows<const R: usize, const L: usize>(
    arch: Arch,
    terms: &[Term<'_, L>; TOGETHER],
    y: &mut [&mut [f32]; L],
    more: bool,
) {
    struct Weigh<'a, const R: usize, const L: usize>([&'a [f32]; R], [[f32; L]; R], [&'a mut [f32]; L], bool);
    impl<const R: usize, const L: usize> WithSimd for Weigh<'_, R, L> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(rows, weights, y, more) = self;
            let y = y.map(|y| S::as_mut_simd_f32s(y).0);
            let len = y.iter().map(|y| y.len()).min().unwrap_or(0);
            let y = y.map(|y| &mut y[..len]);
            let rows = rows.map(|row| &S::as_simd_f32s(row).0[..len]);
            let weights = weights.map(|weights| weights.map(|weight| simd.splat_f32s(weight)));
            for k in 0..len {
                for l in 0..L {
                    let mut sum = simd.mul_f32s(weights[0][l], rows[0][k]);
                    for r in 1..R {
                        sum = simd.add_f32s(sum, simd.mul_f32s(weights[r][l], rows[r][k]));
                    }
                    y[l][k] = if more { simd.add_f32s(y[l][k], sum) } else { sum };
                }
            }
        }
    }
    let (rows, weights) = (std::array::from_fn(|r| terms[r].0), std::array::from_fn(|r| terms[r].1));
    let y = y.each_mut().map(|y| &mut **y);
    arch.dispatch(Weigh::<R, L>(rows, weights, y, more));
}

/// Modal motion of one line in a step.
pub struct Motions<'a> {
    /// `q`, `v` and the force `r` at its begin.
    pub begin: [&'a [f32]; 3],
    /// The force at its end as far as it is known, and its bend: minus the second derivative within the step.
    pub forces: [&'a [f32]; 2],
    /// `q` and `v` at the end.
    pub end: [&'a mut [f32]; 2],
}

/// Moves lines on by one step under known forces.
pub fn free<const L: usize>(arch: Arch, factors: Factors<'_>, lines: [Motions<'_>; L]) {
    struct Free<'a, const L: usize>(Factors<'a>, [Motions<'a>; L]);
    impl<const L: usize> WithSimd for Free<'_, L> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(f, lines) = self;
            let len = S::as_simd_f32s(f.qq).0.len();
            let row = |row| &S::as_simd_f32s(row).0[..len];
            let of_q = [f.qq, f.qv, f.q0, f.q1, f.qb].map(row);
            let of_v = [f.vq, f.vv, f.v0, f.v1, f.vb].map(row);
            let mut lines = lines.map(|line| {
                let ([q, v, r], [known, bend]) = (line.begin, line.forces);
                let end = line.end.map(|end| &mut S::as_mut_simd_f32s(end).0[..len]);
                ([q, v, r, known, bend].map(row), end)
            });
            for k in 0..len {
                for (begin, end) in &mut lines {
                    let mut change = [simd.splat_f32s(0.0); 2];
                    for n in 0..5 {
                        change[0] = simd.add_f32s(change[0], simd.mul_f32s(of_q[n][k], begin[n][k]));
                        change[1] = simd.add_f32s(change[1], simd.mul_f32s(of_v[n][k], begin[n][k]));
                    }
                    end[0][k] = simd.add_f32s(begin[0][k], change[0]);
                    end[1][k] = simd.add_f32s(begin[1][k], change[1]);
                }
            }
        }
    }
    arch.dispatch(Free(factors, lines));
}

/// Point that moves along the line: modal forces `φ F` of a force `F` at it, in a step from `(φ₀, φ₀′)` to `(φ₁, φ₁′)`.
///
/// With `F` a parabola through `F₋₁` one step before, the second derivative of the modal force is
/// `s = c₁ F₁ − c₀ F₀ + φ₁ (F₁ − 2 F₀ + F₋₁)/h²` to the order of the step's square, `c = φ′ v/h + (φ₁ − φ₀)/h²`, `v`
/// the speed along the line.
pub struct Passing<'a> {
    /// `φ₀`, `φ₀′` along the line, `φ₁` and `φ₁′`.
    pub shapes: [&'a [f32]; 4],
    /// `v/h` and `1/h²`.
    pub rates: [f32; 2],
}

/// Bend of the modal force by a unit force at the begin of the step at a point that moves, `c₀`, and its second
/// derivative by one at the end, `c₁ + φ₁/h²`; and the motion `q` and `v` that the force at the end makes.
pub fn pass(arch: Arch, factors: Factors<'_>, point: Passing<'_>, bends: [&mut [f32]; 2], by_force: [&mut [f32]; 2]) {
    struct Pass<'a>(Factors<'a>, Passing<'a>, [&'a mut [f32]; 2], [&'a mut [f32]; 2]);
    impl WithSimd for Pass<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(f, point, bends, by_force) = self;
            let n = f.q1.len();
            let [before, slope_before, now, slope_now] = point.shapes.map(|values| &values[..n]);
            let [q1, v1, qb, vb] = [f.q1, f.v1, f.qb, f.vb].map(|values| &values[..n]);
            let [begin, end] = bends.map(|values| &mut values[..n]);
            let [q, v] = by_force.map(|values| &mut values[..n]);
            let [along, change] = point.rates;
            for k in 0..n {
                let difference = (now[k] - before[k]) * change;
                begin[k] = slope_before[k] * along + difference;
                end[k] = slope_now[k] * along + (now[k] * change + difference);
                q[k] = q1[k] * now[k] - qb[k] * end[k];
                v[k] = v1[k] * now[k] - vb[k] * end[k];
            }
        }
    }
    arch.dispatch(Pass(factors, point, bends, by_force));
}

/// Modal motion of one line at the end of a step.
pub struct Ending<'a> {
    /// A force there, and its bend within the step.
    pub forces: [&'a [f32]; 2],
    /// `q`, `v` and the force `r` without these.
    pub end: [&'a mut [f32]; 3],
}

/// Adds forces to the motions of lines at the end of a step.
pub fn finish<const L: usize>(arch: Arch, factors: Factors<'_>, lines: [Ending<'_>; L]) {
    struct Finish<'a, const L: usize>(Factors<'a>, [Ending<'a>; L]);
    impl<const L: usize> WithSimd for Finish<'_, L> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(f, lines) = self;
            let len = S::as_simd_f32s(f.q1).0.len();
            let row = |row| &S::as_simd_f32s(row).0[..len];
            let [q1, v1, qb, vb] = [f.q1, f.v1, f.qb, f.vb].map(row);
            let mut lines = lines.map(|line| {
                let end = line.end.map(|values| &mut S::as_mut_simd_f32s(values).0[..len]);
                (line.forces.map(row), end)
            });
            for k in 0..len {
                for (forces, [q, v, r]) in &mut lines {
                    let (force, bend) = (forces[0][k], forces[1][k]);
                    let change =
                        |by_force, by_bend| simd.add_f32s(simd.mul_f32s(by_force, force), simd.mul_f32s(by_bend, bend));
                    q[k] = simd.add_f32s(q[k], change(q1[k], qb[k]));
                    v[k] = simd.add_f32s(v[k], change(v1[k], vb[k]));
                    r[k] = simd.add_f32s(r[k], force);
                }
            }
        }
    }
    arch.dispatch(Finish(factors, lines));
}

#[cfg(test)]
mod tests {
    use super::super::StepFactors;
    use super::*;

    /// Amplitude of a mode of a string after `steps` steps of `h` s from rest, under a force of 1 N that starts at the
    /// left end and moves: `sin(turn t)` at the point.
    fn under_moving_force(omega: f64, turn: f64, h: f64, steps: usize) -> f64 {
        let (arch, factors) = (Arch::new(), StepFactors::new(&[omega * omega; LANES], &[0.0; LANES], h));
        let shape = |step: usize| {
            let angle = turn * h * step as f64;
            [angle.sin(), angle.cos()].map(|value| [value as f32; LANES])
        };
        let zeros = [0.0; LANES];
        let [mut q, mut v, mut r] = [zeros; 3];
        for step in 0..steps {
            let ([before, slope_before], [now, slope_now]) = (shape(step), shape(step + 1));
            let [[mut by_begin, mut by_end], [mut by_q, mut by_v], [mut q_end, mut v_end]] = [[zeros; 2]; 3];
            let (factors, per_step) = (factors.of(0..LANES), (1.0 / (h * h)) as f32);
            let passing = Passing {
                shapes: [&before, &slope_before, &now, &slope_now],
                rates: [(turn / h) as f32, per_step],
            };
            pass(
                arch,
                factors,
                passing,
                [&mut by_begin, &mut by_end],
                [&mut by_q, &mut by_v],
            );
            // A force of 1 N all the time: `c₀ F₀ + φ₁ (2 F₀ − F₋₁)/h²` is known, `c₁ F₁ + φ₁ F₁/h²` is of the end.
            let mut known = zeros;
            weigh(
                arch,
                [(&by_begin[..], [1.0]), (&now, [f64::from(per_step)])].into_iter(),
                [&mut known],
            );
            let begin = Motions {
                begin: [&q, &v, &r],
                forces: [&zeros, &known],
                end: [&mut q_end, &mut v_end],
            };
            free(arch, factors, [begin]);
            let mut of_end = zeros;
            weigh(arch, [(&by_end[..], [-1.0])].into_iter(), [&mut of_end]);
            let ([q_free, v_free], [q_answer, v_answer]) = ([q_end[0], v_end[0]], [by_q[0], by_v[0]]);
            r = zeros;
            let ending = Ending {
                forces: [&now, &of_end],
                end: [&mut q_end, &mut v_end, &mut r],
            };
            finish(arch, factors, [ending]);
            (q, v) = (q_end, v_end);
            for (end, sum) in [(q[0], q_free + q_answer), (v[0], v_free + v_answer)] {
                assert!(
                    (end - sum).abs() < 1e-5 * (1e-4 + end.abs()),
                    "the answer by itself: {end} {sum}"
                );
            }
        }
        f64::from(q[0])
    }

    #[test]
    fn a_moving_force_is_followed_within_steps() {
        // [Frýba 1972, a string under a moving force, mode by mode]
        let (omega, turn, t) = (90.0_f64, 60.0_f64, 0.1_f64);
        let closed = ((turn * t).sin() - turn / omega * (omega * t).sin()) / (omega * omega - turn * turn);
        let error = |steps: usize| (under_moving_force(omega, turn, t / steps as f64, steps) / closed - 1.0).abs();
        // A straight force within steps would be wrong by (turn h)²/12: 3 %, and by a quarter of that.
        let [long, short] = [10, 20].map(error);
        assert!(long < 2e-3 && short < long / 12.0, "{long} {short}");
    }

    #[test]
    fn a_bend_is_the_second_derivative_of_a_force() {
        let (omega, h, bend) = (70.0_f64, 0.02, -3.0_f64);
        let (arch, factors) = (Arch::new(), StepFactors::new(&[omega * omega; LANES], &[0.0; LANES], h));
        let [mut q, mut v, mut r] = [[0.0; LANES]; 3];
        let ending = Ending {
            forces: [&[0.0; LANES], &[bend as f32; LANES]],
            end: [&mut q, &mut v, &mut r],
        };
        finish(arch, factors.of(0..LANES), [ending]);
        // ½ τ (h − τ) bend from rest: q = particular solution and free motion.
        let (cos, sin) = ((omega * h).cos(), (omega * h).sin());
        let rest = bend / omega.powi(4);
        let q_end = rest - rest * cos - bend * h / (2.0 * omega.powi(3)) * sin;
        let v_end = -0.5 * bend * h / omega.powi(2) + rest * omega * sin - 0.5 * bend * h / omega.powi(2) * cos;
        assert!((f64::from(q[0]) / q_end - 1.0).abs() < 1e-5, "{} {q_end}", q[0]);
        assert!((f64::from(v[0]) / v_end - 1.0).abs() < 1e-5, "{} {v_end}", v[0]);
    }

    #[test]
    fn sums_and_weighted_rows_are_those_of_double_precision_for_any_number_of_lines() {
        let modes = 3 * LANES;
        let row = |seed: f32| (0..modes).map(|k| (seed * (k as f32 + 0.5)).sin()).collect::<Vec<_>>();
        let (rows, ends) = ([0.3, 0.7, 1.1].map(row), [1.9, 2.3, 2.9, 3.1].map(row));
        let rows = rows.each_ref().map(|row| &row[..]);
        let [a, b, c, d] = ends.each_ref().map(|end| &end[..]);
        let arch = Arch::new();
        let exact = |a: &[f32], b: &[f32]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum() };
        let both = dots_of_rows(arch, rows, [[a, b], [c, d]]);
        for (row, sums) in rows.iter().zip(both) {
            for (sum, end) in sums.as_flattened().iter().zip([a, b, c, d]) {
                assert!((sum - exact(row, end)).abs() < 1e-5, "{sum}");
            }
            // A line has the same bits by itself.
            assert_eq!([dots(arch, row, [a, b]), dots(arch, row, [c, d])], sums);
        }
        let weights = [[0.5, -2.0], [3.0, 0.25], [-1.5, 1.0]];
        for count in 0..=7 {
            let mut sums = Vec::new();
            dots_of_many(arch, (count, |at| rows[at % 3]), [[a, b]], |at, [found]| {
                sums.push((at, found))
            });
            let alone = (0..count).map(|at| (at, dots(arch, rows[at % 3], [a, b])));
            assert_eq!(sums, alone.collect::<Vec<_>>());
            let terms = || (0..count).map(|n| (rows[n % 3], weights[n % 3]));
            let [mut one, mut other, mut alone] = [(); 3].map(|()| vec![f32::NAN; modes]);
            weigh(arch, terms(), [&mut one, &mut other]);
            weigh(arch, terms().map(|(row, [_, weight])| (row, [weight])), [&mut alone]);
            assert_eq!(other, alone);
            for k in 0..modes {
                let exact: f64 = terms().map(|(row, [weight, _])| weight * f64::from(row[k])).sum();
                assert!((f64::from(one[k]) - exact).abs() < 1e-5, "{count} rows");
            }
        }
    }
}
