//! Numbers of the factors, in double or single precision.
use pulp::Simd;

/// A number that a solution computes with.
pub(super) trait Number: Copy + Default {
    /// Numbers of one SIMD register.
    type Vector<S: Simd>: Copy;

    fn rounded(value: f64) -> Self;
    fn widened(self) -> f64;
    fn lanes<S: Simd>() -> usize;
    fn splat<S: Simd>(simd: S, value: Self) -> Self::Vector<S>;
    /// The whole vectors of a slice, and the rest.
    fn vectors<S: Simd>(x: &[Self]) -> (&[Self::Vector<S>], &[Self]);
    fn vectors_mut<S: Simd>(x: &mut [Self]) -> &mut [Self::Vector<S>];
    /// Fewer numbers than a vector has, filled up with zeros.
    fn partial<S: Simd>(simd: S, x: &[Self]) -> Self::Vector<S>;
    fn add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn multiply<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    /// `a b + c`
    fn multiply_add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>, c: Self::Vector<S>) -> Self::Vector<S>;
    fn sum<S: Simd>(simd: S, a: Self::Vector<S>) -> Self;
    /// Returns `true` if any absolute value is above its threshold, or no number.
    fn any_above<S: Simd>(simd: S, x: Self::Vector<S>, threshold: Self::Vector<S>) -> bool;
}

macro_rules! number {
    (
        $number:ty, $vector:ident, $lanes:ident, $splat:ident, $vectors:ident, $vectors_mut:ident, $partial:ident,
        $add:ident, $multiply:ident, $multiply_add:ident, $sum:ident, $abs:ident, $below:ident, $not:ident, $first:ident
    ) => {
        impl Number for $number {
            type Vector<S: Simd> = S::$vector;

            #[inline(always)]
            fn rounded(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn widened(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn lanes<S: Simd>() -> usize {
                S::$lanes
            }

            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$vector {
                simd.$splat(value)
            }

            #[inline(always)]
            fn vectors<S: Simd>(x: &[Self]) -> (&[S::$vector], &[Self]) {
                S::$vectors(x)
            }

            #[inline(always)]
            fn vectors_mut<S: Simd>(x: &mut [Self]) -> &mut [S::$vector] {
                S::$vectors_mut(x).0
            }

            #[inline(always)]
            fn partial<S: Simd>(simd: S, x: &[Self]) -> S::$vector {
                simd.$partial(x)
            }

            #[inline(always)]
            fn add<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$add(a, b)
            }

            #[inline(always)]
            fn multiply<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$multiply(a, b)
            }

            #[inline(always)]
            fn multiply_add<S: Simd>(simd: S, a: S::$vector, b: S::$vector, c: S::$vector) -> S::$vector {
                simd.$multiply_add(a, b, c)
            }

            #[inline(always)]
            fn sum<S: Simd>(simd: S, a: S::$vector) -> Self {
                simd.$sum(a)
            }

            #[inline(always)]
            fn any_above<S: Simd>(simd: S, x: S::$vector, threshold: S::$vector) -> bool {
                let below = simd.$below(simd.$abs(x), threshold);
                simd.$first(simd.$not(below)) < S::$lanes
            }
        }
    };
}

number!(
    f64,
    f64s,
    F64_LANES,
    splat_f64s,
    as_simd_f64s,
    as_mut_simd_f64s,
    partial_load_f64s,
    add_f64s,
    mul_f64s,
    mul_add_e_f64s,
    reduce_sum_f64s,
    abs_f64s,
    less_than_or_equal_f64s,
    not_m64s,
    first_true_m64s
);
number!(
    f32,
    f32s,
    F32_LANES,
    splat_f32s,
    as_simd_f32s,
    as_mut_simd_f32s,
    partial_load_f32s,
    add_f32s,
    mul_f32s,
    mul_add_e_f32s,
    reduce_sum_f32s,
    abs_f32s,
    less_than_or_equal_f32s,
    not_m32s,
    first_true_m32s
);
