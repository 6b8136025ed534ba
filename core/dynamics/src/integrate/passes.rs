//! The integrator's passes over all coordinates, in the vector registers of the processor.
use crate::State;
use pulp::{Simd, WithSimd};

/// Newmark's prediction in one pass.
pub(crate) struct Predict<'a> {
    pub start: &'a State,
    pub end: &'a mut State,
    /// Step, s.
    pub h: f64,
    /// See [`crate::integrate::scheme::Scheme`].
    pub alpha_f: f64,
    /// Ratio of this step to the one that `a` belongs to.
    pub stretch: f64,
}

impl WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            start,
            end,
            h,
            alpha_f,
            stretch,
        } = self;
        let n = start.q.len();
        let (q, v, v_dot, a) = (&start.q[..n], &start.v[..n], &start.v_dot[..n], &start.a[..n]);
        let ends = (&mut end.q[..n], &mut end.v[..n], &mut end.v_dot[..n], &mut end.a[..n]);
        let (q_end, v_end, v_dot_end, a_end) = ends;
        let inverse = 1.0 / (1.0 - alpha_f);
        for i in 0..n {
            let a = if stretch == 1.0 {
                a[i]
            } else {
                v_dot[i] + (a[i] - v_dot[i]) * stretch
            };
            q_end[i] = q[i] + h * (v[i] + 0.5 * h * a);
            v_end[i] = v[i] + h * a;
            v_dot_end[i] = (a - alpha_f * v_dot[i]) * inverse;
            a_end[i] = a;
        }
    }
}

/// A correction of positions with what follows for their rates, in one pass.
pub(crate) struct Apply<'a> {
    /// `Δq`.
    pub correction: &'a [f64],
    /// The part of it that is applied.
    pub damping: f64,
    /// Change of `v`, `v̇` and `a` per change of `q`.
    pub rates: [f64; 3],
    pub q: &'a mut [f64],
    pub v: &'a mut [f64],
    pub v_dot: &'a mut [f64],
    pub a: &'a mut [f64],
}

impl WithSimd for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            correction,
            damping,
            rates,
            q,
            v,
            v_dot,
            a,
        } = self;
        let n = correction.len();
        let (q, v, v_dot, a) = (&mut q[..n], &mut v[..n], &mut v_dot[..n], &mut a[..n]);
        for i in 0..n {
            let change = damping * correction[i];
            q[i] += change;
            v[i] += rates[0] * change;
            v_dot[i] += rates[1] * change;
            a[i] += rates[2] * change;
        }
    }
}
