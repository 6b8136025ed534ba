//! Sums over all modes in the vector registers of the processor.
//!
//! Every vector is a multiple of `LANES` long, and sums run in that many parts whatever the registers: all machines
//! find the same bits.
use super::step::StepFactors;
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

/// `Σ a b` for each `b`, in single precision.
pub fn dots<const N: usize>(arch: Arch, a: &[f32], b: [&[f32]; N]) -> [f64; N] {
    struct Dots<'a, const N: usize>(&'a [f32], [&'a [f32]; N]);
    impl<const N: usize> WithSimd for Dots<'_, N> {
        type Output = [f64; N];
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> [f64; N] {
            let registers = LANES / S::F32_LANES;
            let mut sums = [[simd.splat_f32s(0.0); LANES]; N];
            let (a, _) = S::as_simd_f32s(self.0);
            let b = self.1.map(|b| S::as_simd_f32s(b).0);
            for (chunk, a) in a.chunks_exact(registers).enumerate() {
                let at = chunk * registers;
                let b = b.map(|b| &b[at..at + registers]);
                for (sums, b) in sums.iter_mut().zip(b) {
                    for k in 0..registers {
                        sums[k] = simd.add_f32s(sums[k], simd.mul_f32s(a[k], b[k]));
                    }
                }
            }
            sums.map(|sums| {
                let lanes: &[f32] = pulp::bytemuck::cast_slice(&sums[..registers]);
                lanes.iter().map(|lane| f64::from(*lane)).sum()
            })
        }
    }
    arch.dispatch(Dots(a, b))
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
pub fn free(arch: Arch, factors: &StepFactors, motion: [&[f32]; 3], known: &[f32], ends: [&mut [f32]; 2]) {
    struct Free<'a>(&'a StepFactors, [&'a [f32]; 4], [&'a mut [f32]; 2]);
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
                q_end[k] = q[k] + ((qq[k] * q[k] + qv[k] * v[k]) + (q0[k] * r[k] + q1[k] * known[k]));
                v_end[k] = v[k] + ((vq[k] * q[k] + vv[k] * v[k]) + (v0[k] * r[k] + v1[k] * known[k]));
            }
        }
    }
    let [q, v, r] = motion;
    arch.dispatch(Free(factors, [q, v, r, known], ends));
}

/// Motion at the end of a step, from that under the force `known` there and the force `r` besides, which becomes the
/// sum of both.
pub fn finish(arch: Arch, factors: &StepFactors, [known, q_free, v_free]: [&[f32]; 3], [r, q, v]: [&mut [f32]; 3]) {
    struct Finish<'a>(&'a StepFactors, [&'a [f32]; 3], [&'a mut [f32]; 3]);
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
