//! Sums over all modes in the vector registers of the processor.
//!
//! Every vector is a multiple of `LANES` long, and sums run in that many parts whatever the registers: all machines
//! find the same bits.
use super::step::Factors;
use pulp::{Arch, Simd, WithSimd};

/// Numbers that are summed side by side.
pub const LANES: usize = 32;

/// Rows that are added in one pass.
pub const TOGETHER: usize = 4;

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

/// Parts of a sum in single precision.
pub type Parts = [f32; LANES];

/// The sum.
#[must_use]
#[inline]
pub fn sum(parts: &Parts) -> f64 {
    parts.iter().map(|part| f64::from(*part)).sum()
}

/// `Σ a b` for each `b`, in single precision.
#[must_use]
pub fn dots<const N: usize>(arch: Arch, a: &[f32], b: [&[f32]; N]) -> [f64; N] {
    let mut parts = [[0.0; LANES]; N];
    add_dots(arch, [a], b, [&mut parts]);
    parts.map(|parts| sum(&parts))
}

/// Adds `a b` of some modes to parts of `Σ a b`, for each row `a` and each `b`.
pub fn add_dots<const R: usize, const N: usize>(
    arch: Arch,
    rows: [&[f32]; R],
    b: [&[f32]; N],
    parts: [&mut [Parts; N]; R],
) {
    struct Dots<'a, const R: usize, const N: usize>([&'a [f32]; R], [&'a [f32]; N], [&'a mut [Parts; N]; R]);
    impl<const R: usize, const N: usize> WithSimd for Dots<'_, R, N> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(rows, b, parts) = self;
            // Registers of the parts are taken in pairs, which the largest processors hold at once.
            let every = LANES / S::F32_LANES / 2;
            let len = S::as_simd_f32s(rows[0]).0.len() / 2;
            let rows = rows.map(|row| &S::as_simd_f32s(row).0.as_chunks::<2>().0[..len]);
            let b = b.map(|b| &S::as_simd_f32s(b).0.as_chunks::<2>().0[..len]);
            for first in 0..every {
                let mut sums = [[[simd.splat_f32s(0.0); 2]; N]; R];
                for r in 0..R {
                    for n in 0..N {
                        sums[r][n] = S::as_simd_f32s(&parts[r][n]).0.as_chunks::<2>().0[first];
                    }
                }
                let mut at = first;
                while at < len {
                    for n in 0..N {
                        let [low, high] = b[n][at];
                        for r in 0..R {
                            let ([of_low, of_high], row) = (&mut sums[r][n], rows[r][at]);
                            *of_low = simd.add_f32s(*of_low, simd.mul_f32s(row[0], low));
                            *of_high = simd.add_f32s(*of_high, simd.mul_f32s(row[1], high));
                        }
                    }
                    at += every;
                }
                for r in 0..R {
                    for n in 0..N {
                        S::as_mut_simd_f32s(&mut parts[r][n]).0.as_chunks_mut::<2>().0[first] = sums[r][n];
                    }
                }
            }
        }
    }
    arch.dispatch(Dots(rows, b, parts));
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

/// Rows with their weights, four at a time; the last ones are filled up with rows of no weight.
fn groups<'a, W: Copy + Default>(rows: &'a [(W, &'a [f32])]) -> impl Iterator<Item = [(W, &'a [f32]); TOGETHER]> + 'a {
    let group = |group: &'a [(W, &'a [f32])]| {
        std::array::from_fn(|k| group.get(k).copied().unwrap_or((W::default(), group[0].1)))
    };
    rows.chunks(TOGETHER).map(group)
}

/// `y += Σ α x` over rows.
pub fn add(arch: Arch, rows: &[(f32, &[f32])], y: &mut [f32]) {
    struct Add<'a>([(f32, &'a [f32]); TOGETHER], &'a mut [f32]);
    impl WithSimd for Add<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(rows, y) = self;
            let len = y.len();
            let [a, b, c, d] = rows.map(|(_, row)| &row[..len]);
            let n = rows.map(|(weight, _)| weight);
            for k in 0..len {
                y[k] += (n[0] * a[k] + n[1] * b[k]) + (n[2] * c[k] + n[3] * d[k]);
            }
        }
    }
    groups(rows).for_each(|rows| arch.dispatch(Add(rows, y)));
}

/// Deflections of all modes at a point and their slopes, from rows with their weights in both.
pub fn shape(arch: Arch, rows: &[([f32; 2], &[f32])], at: &mut [f32], slope: &mut [f32]) {
    struct Shape<'a, const FIRST: bool>([([f32; 2], &'a [f32]); TOGETHER], [&'a mut [f32]; 2]);
    impl<const FIRST: bool> WithSimd for Shape<'_, FIRST> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(rows, [at, slope]) = self;
            let len = at.len();
            let ([a, b, c, d], slope) = (rows.map(|(_, row)| &row[..len]), &mut slope[..len]);
            let [n, m] = [0, 1].map(|which| rows.map(|(weights, _)| weights[which]));
            for k in 0..len {
                let by_rows = (n[0] * a[k] + n[1] * b[k]) + (n[2] * c[k] + n[3] * d[k]);
                let slope_by_rows = (m[0] * a[k] + m[1] * b[k]) + (m[2] * c[k] + m[3] * d[k]);
                (at[k], slope[k]) = if FIRST {
                    (by_rows, slope_by_rows)
                } else {
                    (at[k] + by_rows, slope[k] + slope_by_rows)
                };
            }
        }
    }
    let mut groups = groups(rows);
    match groups.next() {
        Some(rows) => arch.dispatch(Shape::<true>(rows, [at, slope])),
        None => {
            at.fill(0.0);
            slope.fill(0.0);
        }
    }
    groups.for_each(|rows| arch.dispatch(Shape::<false>(rows, [at, slope])));
}

/// Modal motion `q`, `v` under the force `r`, moved on by one step with the force `known` at its end.
pub fn free(arch: Arch, factors: Factors<'_>, motion: [&[f32]; 3], known: &[f32], ends: [&mut [f32]; 2]) {
    struct Free<'a>(Factors<'a>, [&'a [f32]; 4], [&'a mut [f32]; 2]);
    impl WithSimd for Free<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let f = self.0;
            let n = f.qq.len();
            let [q, v, r, known] = self.1.map(|values| &values[..n]);
            let [qq, qv, q0, q1] = [f.qq, f.qv, f.q0, f.q1].map(|values| &values[..n]);
            let [vq, vv, v0, v1] = [f.vq, f.vv, f.v0, f.v1].map(|values| &values[..n]);
            let [q_end, v_end] = self.2.map(|values| &mut values[..n]);
            for k in 0..n {
                q_end[k] = q[k] + ((qq[k] * q[k] + qv[k] * v[k]) + (q0[k] * r[k] + q1[k] * known[k]));
                v_end[k] = v[k] + ((vq[k] * q[k] + vv[k] * v[k]) + (v0[k] * r[k] + v1[k] * known[k]));
            }
        }
    }
    let [q, v, r] = motion;
    arch.dispatch(Free(factors, [q, v, r, known], ends));
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

/// Motion `q` and `v` at the end of a step by a unit force there at a point that moves, and the bend `c₀` of the modal
/// force that a unit force at the begin makes by the move, for [`add_bend`], as `φ₁ (2 F₀ − F₋₁)/h²`.
pub fn pass(arch: Arch, factors: Factors<'_>, point: Passing<'_>, by_force: [&mut [f32]; 2], bend: &mut [f32]) {
    struct Pass<'a>(Factors<'a>, Passing<'a>, [&'a mut [f32]; 2], &'a mut [f32]);
    impl WithSimd for Pass<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(f, point, by_force, bend) = self;
            let n = f.q1.len();
            let [before, slope_before, now, slope_now] = point.shapes.map(|values| &values[..n]);
            let [q1, v1, qb, vb] = [f.q1, f.v1, f.qb, f.vb].map(|values| &values[..n]);
            let ([q, v], bend) = (by_force.map(|values| &mut values[..n]), &mut bend[..n]);
            let [along, change] = point.rates;
            for k in 0..n {
                let difference = (now[k] - before[k]) * change;
                let there = slope_now[k] * along + (now[k] * change + difference);
                q[k] = q1[k] * now[k] - qb[k] * there;
                v[k] = v1[k] * now[k] - vb[k] * there;
                bend[k] = slope_before[k] * along + difference;
            }
        }
    }
    arch.dispatch(Pass(factors, point, by_force, bend));
}

/// Motion at the end of a step, from that under the force `known` there and the force `r` besides, which becomes the
/// sum of both.
pub fn finish(arch: Arch, factors: Factors<'_>, [known, q_free, v_free]: [&[f32]; 3], [r, q, v]: [&mut [f32]; 3]) {
    struct Finish<'a>(Factors<'a>, [&'a [f32]; 3], [&'a mut [f32]; 3]);
    impl WithSimd for Finish<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let n = self.0.q1.len();
            let (q1, v1) = (&self.0.q1[..n], &self.0.v1[..n]);
            let [known, q_free, v_free] = self.1.map(|values| &values[..n]);
            let [r, q, v] = self.2.map(|values| &mut values[..n]);
            for k in 0..n {
                (q[k], v[k]) = (q_free[k] + q1[k] * r[k], v_free[k] + v1[k] * r[k]);
                r[k] += known[k];
            }
        }
    }
    arch.dispatch(Finish(factors, [known, q_free, v_free], [r, q, v]));
}

/// Adds a force `force` at a point to modal forces and to what they make: `r += φ F`, `q += q₁ F`, `v += v₁ F`.
pub fn add_answer(arch: Arch, force: f32, answer: [&[f32]; 3], ends: [&mut [f32]; 3]) {
    struct AddAnswer<'a>(f32, [&'a [f32]; 3], [&'a mut [f32]; 3]);
    impl WithSimd for AddAnswer<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(force, answer, ends) = self;
            let n = ends[0].len();
            let [shape, by_q, by_v] = answer.map(|values| &values[..n]);
            let [r, q, v] = ends.map(|values| &mut values[..n]);
            for k in 0..n {
                r[k] += force * shape[k];
                q[k] += force * by_q[k];
                v[k] += force * by_v[k];
            }
        }
    }
    arch.dispatch(AddAnswer(force, answer, ends));
}

/// Adds what modal forces with the second derivative `−b`, `b = Σ w bend`, change in a step: `q += q_b b`,
/// `v += v_b b`.
pub fn add_bend<const N: usize>(arch: Arch, factors: Factors<'_>, bends: [(f32, &[f32]); N], ends: [&mut [f32]; 2]) {
    struct AddBend<'a, const N: usize>(Factors<'a>, [(f32, &'a [f32]); N], [&'a mut [f32]; 2]);
    impl<const N: usize> WithSimd for AddBend<'_, N> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let n = self.0.qb.len();
            let (qb, vb) = (self.0.qb, &self.0.vb[..n]);
            let bends = self.1.map(|(w, bend)| (w, &bend[..n]));
            let [q, v] = self.2.map(|values| &mut values[..n]);
            for k in 0..n {
                let bend: f32 = bends.iter().map(|(w, bend)| w * bend[k]).sum();
                q[k] += qb[k] * bend;
                v[k] += vb[k] * bend;
            }
        }
    }
    arch.dispatch(AddBend(factors, bends, ends));
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
            let [mut q_free, mut v_free, mut by_q, mut by_v] = [zeros; 4];
            let factors = factors.of(0..LANES);
            free(arch, factors, [&q, &v, &r], &zeros, [&mut q_free, &mut v_free]);
            let passing = Passing {
                shapes: [&before, &slope_before, &now, &slope_now],
                rates: [turn / h, 1.0 / (h * h)].map(|rate| rate as f32),
            };
            let mut bend = zeros;
            pass(arch, factors, passing, [&mut by_q, &mut by_v], &mut bend);
            add_bend(
                arch,
                factors,
                [(1.0, &bend), ((1.0 / (h * h)) as f32, &now)],
                [&mut q_free, &mut v_free],
            );
            r = zeros;
            finish(arch, factors, [&zeros, &q_free, &v_free], [&mut r, &mut q, &mut v]);
            add_answer(arch, 1.0, [&now, &by_q, &by_v], [&mut r, &mut q, &mut v]);
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
        let (mut q, mut v) = ([0.0; LANES], [0.0; LANES]);
        add_bend(
            arch,
            factors.of(0..LANES),
            [(0.25, &[bend as f32; LANES]), (0.75, &[bend as f32; LANES])],
            [&mut q, &mut v],
        );
        // ½ τ (h − τ) bend from rest: q = particular solution and free motion.
        let (cos, sin) = ((omega * h).cos(), (omega * h).sin());
        let rest = bend / omega.powi(4);
        let q_end = rest - rest * cos - bend * h / (2.0 * omega.powi(3)) * sin;
        let v_end = -0.5 * bend * h / omega.powi(2) + rest * omega * sin - 0.5 * bend * h / omega.powi(2) * cos;
        assert!((f64::from(q[0]) / q_end - 1.0).abs() < 1e-5, "{} {q_end}", q[0]);
        assert!((f64::from(v[0]) / v_end - 1.0).abs() < 1e-5, "{} {v_end}", v[0]);
    }
}
