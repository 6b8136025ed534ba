//! Sums over all modes in the vector registers of the processor.
//!
//! Every vector is a multiple of `LANES` long, and sums run in that many parts whatever the registers: all machines
//! find the same bits.
use super::step::StepFactors;
use pulp::{Arch, Simd, WithSimd};

/// Numbers that are summed side by side.
pub const LANES: usize = 32;

/// A row of the modes with its weights in a deflection and in its slope.
pub type Weighted<'a> = (f64, f64, &'a [f64]);

/// Sums of `LANES` parts in registers of any width, the first ones in use.
struct Sums<S: Simd>([S::f64s; LANES]);

impl<S: Simd> Sums<S> {
    /// Registers that hold all parts.
    const REGISTERS: usize = LANES / S::F64_LANES;

    #[inline(always)]
    fn new(simd: S) -> Self {
        Self([simd.splat_f64s(0.0); LANES])
    }

    #[inline(always)]
    fn total(&self) -> f64 {
        let lanes: &[f64] = pulp::bytemuck::cast_slice(&self.0[..Self::REGISTERS]);
        let mut width = LANES;
        let mut sums = [0.0; LANES];
        sums.copy_from_slice(lanes);
        while width > 1 {
            width /= 2;
            for lane in 0..width {
                sums[lane] += sums[lane + width];
            }
        }
        sums[0]
    }
}

/// `Σ a b`.
pub fn dot(arch: Arch, a: &[f64], b: &[f64]) -> f64 {
    struct Dot<'a>(&'a [f64], &'a [f64]);
    impl WithSimd for Dot<'_> {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let mut sums = Sums::new(simd);
            let ((a, _), (b, _)) = (S::as_simd_f64s(self.0), S::as_simd_f64s(self.1));
            let registers = Sums::<S>::REGISTERS;
            for (a, b) in a.chunks_exact(registers).zip(b.chunks_exact(registers)) {
                for k in 0..registers {
                    sums.0[k] = simd.add_f64s(sums.0[k], simd.mul_f64s(a[k], b[k]));
                }
            }
            sums.total()
        }
    }
    arch.dispatch(Dot(a, b))
}

/// `Σ a b` and `Σ a c` in single precision.
pub fn dot2(arch: Arch, a: &[f32], b: &[f32], c: &[f32]) -> [f64; 2] {
    struct Dot2<'a>(&'a [f32], &'a [f32], &'a [f32]);
    impl WithSimd for Dot2<'_> {
        type Output = [f64; 2];
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
            let mut sums = [[simd.splat_f32s(0.0); LANES]; 2];
            let registers = LANES / S::F32_LANES;
            let [(a, _), (b, _), (c, _)] = [self.0, self.1, self.2].map(S::as_simd_f32s);
            let others = b.chunks_exact(registers).zip(c.chunks_exact(registers));
            for (a, (b, c)) in a.chunks_exact(registers).zip(others) {
                for k in 0..registers {
                    sums[0][k] = simd.add_f32s(sums[0][k], simd.mul_f32s(a[k], b[k]));
                    sums[1][k] = simd.add_f32s(sums[1][k], simd.mul_f32s(a[k], c[k]));
                }
            }
            sums.map(|sums| {
                let lanes: &[f32] = pulp::bytemuck::cast_slice(&sums[..registers]);
                lanes.iter().map(|lane| f64::from(*lane)).sum()
            })
        }
    }
    arch.dispatch(Dot2(a, b, c))
}

/// `Σ a b c`.
pub fn dot3(arch: Arch, a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    struct Dot3<'a>(&'a [f64], &'a [f64], &'a [f64]);
    impl WithSimd for Dot3<'_> {
        type Output = f64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let mut sums = Sums::new(simd);
            let [(a, _), (b, _), (c, _)] = [self.0, self.1, self.2].map(S::as_simd_f64s);
            let registers = Sums::<S>::REGISTERS;
            let others = b.chunks_exact(registers).zip(c.chunks_exact(registers));
            for (a, (b, c)) in a.chunks_exact(registers).zip(others) {
                for k in 0..registers {
                    let product = simd.mul_f64s(simd.mul_f64s(a[k], b[k]), c[k]);
                    sums.0[k] = simd.add_f64s(sums.0[k], product);
                }
            }
            sums.total()
        }
    }
    arch.dispatch(Dot3(a, b, c))
}

/// `y += α x`, with `x` in either precision.
pub fn add<X: Copy + Into<f64>>(arch: Arch, alpha: f64, x: &[X], y: &mut [f64]) {
    struct Add<'a, X>(f64, &'a [X], &'a mut [f64]);
    impl<X: Copy + Into<f64>> WithSimd for Add<'_, X> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            for (y, x) in self.2.iter_mut().zip(self.1) {
                *y += self.0 * (*x).into();
            }
        }
    }
    arch.dispatch(Add(alpha, x, y));
}

/// Deflections of all modes at a point and their slopes, four rows at a time.
pub fn shape(arch: Arch, rows: &[Weighted<'_>], at: &mut [f64], slope: &mut [f64]) {
    const TOGETHER: usize = 4;
    struct Shape<'a>([Weighted<'a>; TOGETHER], &'a mut [f64], &'a mut [f64]);
    impl WithSimd for Shape<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(rows, at, slope) = self;
            let len = at.len();
            let ([a, b, c, d], slope) = (rows.map(|(_, _, row)| &row[..len]), &mut slope[..len]);
            let [n, m] = [rows.map(|(n, _, _)| n), rows.map(|(_, m, _)| m)];
            for k in 0..len {
                at[k] += (n[0] * a[k] + n[1] * b[k]) + (n[2] * c[k] + n[3] * d[k]);
                slope[k] += (m[0] * a[k] + m[1] * b[k]) + (m[2] * c[k] + m[3] * d[k]);
            }
        }
    }
    at.fill(0.0);
    slope.fill(0.0);
    for group in rows.chunks(TOGETHER) {
        let rows = std::array::from_fn(|k| group.get(k).copied().unwrap_or((0.0, 0.0, group[0].2)));
        arch.dispatch(Shape(rows, at, slope));
    }
}

/// Modal motion `q`, `v` under the force `r`, moved on by one step with the force `known` at its end.
pub fn free(arch: Arch, factors: &StepFactors, motion: [&[f64]; 3], known: &[f64], ends: [&mut [f64]; 2]) {
    struct Free<'a>(&'a StepFactors, [&'a [f64]; 4], [&'a mut [f64]; 2]);
    impl WithSimd for Free<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let f = self.0;
            let n = f.qq.len();
            let [q, v, r, known] = self.1.map(|values| &values[..n]);
            let [qq, qv, q0, q1] = [&f.qq, &f.qv, &f.q0, &f.q1].map(|values| &values[..n]);
            let [vq, vv, v0, v1] = [&f.vq, &f.vv, &f.v0, &f.v1].map(|values| &values[..n]);
            let [q_end, v_end] = self.2.map(|values| &mut values[..n]);
            for k in 0..n {
                q_end[k] = (qq[k] * q[k] + qv[k] * v[k]) + (q0[k] * r[k] + q1[k] * known[k]);
                v_end[k] = (vq[k] * q[k] + vv[k] * v[k]) + (v0[k] * r[k] + v1[k] * known[k]);
            }
        }
    }
    let [q, v, r] = motion;
    arch.dispatch(Free(factors, [q, v, r, known], ends));
}

/// Motion at the end of a step, from that under the force `known` there and the force `r` besides, which becomes the
/// sum of both; `narrow` is the motion in single precision.
pub fn finish(
    arch: Arch,
    factors: &StepFactors,
    [known, q_free, v_free]: [&[f64]; 3],
    [r, q, v]: [&mut [f64]; 3],
    narrow: &mut [Vec<f32>; 2],
) {
    struct Finish<'a>(&'a StepFactors, [&'a [f64]; 3], [&'a mut [f64]; 3], [&'a mut [f32]; 2]);
    impl WithSimd for Finish<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let n = self.0.q1.len();
            let (q1, v1) = (&self.0.q1[..n], &self.0.v1[..n]);
            let [known, q_free, v_free] = self.1.map(|values| &values[..n]);
            let [r, q, v] = self.2.map(|values| &mut values[..n]);
            let [q_narrow, v_narrow] = self.3.map(|values| &mut values[..n]);
            for k in 0..n {
                let (q_end, v_end) = (q_free[k] + q1[k] * r[k], v_free[k] + v1[k] * r[k]);
                r[k] += known[k];
                (q[k], v[k]) = (q_end, v_end);
                (q_narrow[k], v_narrow[k]) = (q_end as f32, v_end as f32);
            }
        }
    }
    let [q_narrow, v_narrow] = narrow;
    arch.dispatch(Finish(
        factors,
        [known, q_free, v_free],
        [r, q, v],
        [q_narrow, v_narrow],
    ));
}
